//! Draws cases of sweeps: laws to the letter of a statement, near to one, foreign to all, and noise as
//! noise is.

use super::balance::{Sizes, fundamental, sizes};
use super::draw::Draw;
use super::law::{Course, Law};
use super::readout::Noise;
use super::stepped::Resonator;
use super::swept::{LockIn, Swept, Written};
use super::truth::{Effect, Family, Parameter, SEEN, Truth};

/// Families of twenty cases, in turn.
const TURNS: [(Family, usize); 4] = [(Family::Letter, 9), (Family::Near, 4), (Family::Foreign, 3), (Family::Null, 4)];

const LETTER: [&str; 15] = [
    "cubic spring",
    "quadratic drag",
    "softening spring",
    "dry friction",
    "squeeze film",
    "second mode coupled",
    "quintic spring",
    "power spring",
    "power drag",
    "quadratic spring",
    "delay",
    "low-pass",
    "spring drift",
    "cubic spring and drag",
    "cubic spring and friction",
];
const NEAR: [&str; 7] = [
    "spring sin x",
    "friction tanh",
    "friction Stribeck",
    "spring drift t^p",
    "Bouc–Wen",
    "two modes read together",
    "quadratic and cubic spring",
];
const FOREIGN: [&str; 6] = [
    "gap on both sides",
    "spring drift without a clock",
    "gain drifts",
    "gap on one side",
    "gain falls with amplitude",
    "warms with its own power",
];
const NULL: [&str; 10] = [
    "normal noise",
    "Student t3 noise",
    "noise grows with amplitude",
    "lock-in with a lag",
    "gain drifts within the noise",
    "Student t5 noise",
    "noise grows with time",
    "strong background",
    "Laplace noise",
    "slightly coloured noise",
];

/// Draws until a foreign effect is one that no statement imitates.
const MOST_TRIES: usize = 12;

/// Family of the n-th case, and its number in the family.
pub(super) fn turn(n: usize) -> (Family, usize) {
    // 9 and 20 have no common factor: families are mixed.
    let place = |p: usize| {
        let mut at = p * 9 % 20;
        let found = TURNS.into_iter().find(|(_, count)| {
            let here = at < *count;
            at = at.wrapping_sub(if here { 0 } else { *count });
            here
        });
        found.unwrap_or(TURNS[0])
    };
    let (family, count) = place(n % 20);
    (family, n / 20 * count + (0..n % 20).filter(|p| place(*p).0 == family).count())
}

/// Returns the sub-family of the n-th case of a family.
pub(super) fn sub(family: Family, nth: usize) -> &'static str {
    let of = |subs: &[&'static str]| subs[nth % subs.len()];
    match family {
        Family::Letter => of(&LETTER),
        Family::Near => of(&NEAR),
        Family::Foreign => of(&FOREIGN),
        Family::Null => of(&NULL),
    }
}

/// A law of a sub-family with the names that are right for it.
type Named = (Law, &'static [&'static str]);

/// Names of springs of a power, and of drags of one.
const SPRINGS: [&str; 2] = ["cubic-stiffness", "power-law-stiffness"];
const DRAGS: [&str; 2] = ["quadratic-damping", "power-law-damping"];

/// Names of all that depends on amplitude.
const AMPLITUDE: [&str; 6] = [
    "cubic-stiffness",
    "power-law-stiffness",
    "quadratic-damping",
    "power-law-damping",
    "squeeze-film-damping",
    "coulomb-friction",
];

/// Two modes of light damping are a mass on a mass up to how their damping is shared out, and a mass on a mass is its
/// two modes.
const MODES: [&str; 2] = ["parasitic-mode", "coupled-mode"];

/// A law whose fundamental at unit amplitude has this size.
fn sized(of: impl Fn(f64) -> Law, size: f64) -> Law {
    of(size / fundamental(&of(1.0), 1.0, 1.0).norm())
}

/// Laws of a sub-family in a resonator of this damping that is driven this little at least.
fn laws(sub: &str, damping: f64, least: f64, draw: &mut Draw) -> Vec<Named> {
    // Widths by which a spring moves the resonance; of a stiffness of a fifth the motion stays one.
    let moves = (2.0 * damping * draw.log_between(0.1, 5.0)).min(0.2);
    let damps = damping * draw.log_between(0.1, 2.0);
    let sticks = damping * least * draw.between(0.05, 0.5);
    let (sign, power) = (draw.sign(), draw.between(3.6, 5.0));
    let spring = |p: f64, sign: f64| sized(|size| Law::OddSpring { size: sign * size, p }, moves);
    let drag = |p: f64| sized(|size| Law::Drag { size, p }, damps);
    let friction = |v_s: f64| sized(|size| Law::SmoothFriction { size: size / 1.2, v_s }, sticks);
    let stop = |gap: f64, both: bool, sign: f64| Law::Stop { size: 3.0 * moves, gap, p: 1.0, both, sign };
    let drift = |course: Course| Law::SpringDrift { size: sign * moves, course };
    let near = 1.0 + damping * draw.between(-2.5, 2.5);
    match sub {
        "cubic spring" => vec![(spring(3.0, 1.0), &SPRINGS[..1])],
        "softening spring" => vec![(spring(3.0, -1.0), &SPRINGS[..1])],
        "quintic spring" => vec![(spring(5.0, sign), &SPRINGS[1..])],
        "power spring" => {
            let p = if sign > 0.0 { draw.between(1.5, 2.5) } else { power };
            vec![(spring(p, 1.0), &SPRINGS[1..])]
        }
        "quadratic spring" => {
            let size = (0.4 * moves.min(0.1) / 0.3).sqrt() * sign;
            vec![(Law::EvenSpring { size: size.clamp(-0.35, 0.35) }, &["cubic-stiffness", "quadratic-stiffness"])]
        }
        "quadratic drag" => vec![(drag(2.0), &DRAGS[..1])],
        "power drag" => vec![(drag(if sign > 0.0 { 0.7 * (power - 2.0) } else { power }), &DRAGS[1..])],
        "squeeze film" => vec![(sized(|size| Law::Squeeze { size }, damps), &["squeeze-film-damping"])],
        "dry friction" => vec![(friction(0.004), &["coulomb-friction"])],
        "friction tanh" => vec![(friction(draw.log_between(0.02, 0.3)), &["coulomb-friction"])],
        "friction Stribeck" => {
            let of = |size| Law::Stribeck { size, rise: 0.6, v_s: 0.2, v_t: 0.01 };
            vec![(sized(of, sticks), &["coulomb-friction"])]
        }
        "second mode coupled" => {
            let size = (damping * draw.log_between(0.3, 2.0)).powi(2);
            let zeta = 0.5 * damping * draw.log_between(0.3, 1.5);
            vec![(Law::Absorber { size, omega: near, zeta }, &MODES)]
        }
        "two modes read together" => {
            let zeta = 0.5 * damping * draw.log_between(0.5, 1.5);
            vec![(Law::Beside { size: draw.log_between(0.05, 0.6), omega: near, zeta }, &MODES)]
        }
        "spring drift" => vec![(drift(Course::Linear), &["stiffness-drift"])],
        "spring drift t^p" => vec![(drift(Course::Power { p: draw.one_of(&[0.5, 2.0]) }), &["stiffness-drift"])],
        "spring drift without a clock" => vec![(drift(Course::Linear), &[])],
        "cubic spring and drag" => vec![(spring(3.0, sign), &SPRINGS[..1]), (drag(2.0), &DRAGS[..1])],
        "cubic spring and friction" => {
            vec![(spring(3.0, sign), &SPRINGS[..1]), (friction(0.004), &["coulomb-friction"])]
        }
        "spring sin x" => vec![(Law::Sine { size: (8.0 * moves).min(1.0) }, &SPRINGS[..1])],
        "Bouc–Wen" => vec![(Law::BoucWen { size: 3.0 * moves, b: draw.between(1.0, 4.0), g: 1.0, n: 1.0 }, &[])],
        "quadratic and cubic spring" => {
            let square = Law::EvenSpring { size: (moves.min(0.1)).sqrt() };
            vec![(square, &[]), (spring(3.0, 1.0), &SPRINGS[..1])]
        }
        "gap on both sides" => vec![(stop(draw.between(0.3, 0.7), true, 1.0), &[])],
        "gap on one side" => vec![(stop(draw.between(0.3, 0.7), false, sign), &[])],
        _ => Vec::new(),
    }
}

/// Names that point to the right place without saying what is there.
fn tolerable(sub: &str) -> &'static [&'static str] {
    match sub {
        "quintic spring" | "gap on both sides" | "gap on one side" | "warms with its own power" => &SPRINGS,
        "power spring" | "spring sin x" | "cubic spring" | "softening spring" | "quadratic spring" => &SPRINGS,
        "power drag" | "quadratic drag" => &DRAGS,
        "friction tanh" | "friction Stribeck" | "dry friction" => &["power-law-damping"],
        // Stiffness and damping of a loop depend on amplitude both.
        "Bouc–Wen" => &AMPLITUDE,
        // In a narrow band each turns the phase in proportion to frequency.
        "delay" | "low-pass" => &["readout-delay", "readout-lowpass", "readout-highpass"],
        _ => &[],
    }
}

/// The lock-in of a sub-family, with the names of its effect.
fn lock_in(sub: &str, half: f64, draw: &mut Draw) -> (LockIn, &'static [&'static str]) {
    let plain = LockIn { lag: if draw.chance(0.3) { draw.between(0.02, 0.15) } else { 0.0 }, ..LockIn::default() };
    match sub {
        "delay" => (LockIn { delay: draw.log_between(0.3, 2.0) / half, ..plain }, &["readout-delay"]),
        "low-pass" => (LockIn { tau: draw.log_between(0.3, 3.0), ..plain }, &["readout-lowpass"]),
        "gain drifts" => (LockIn { drift: draw.sign() * draw.log_between(0.02, 0.3), ..plain }, &[]),
        "gain drifts within the noise" => (LockIn { drift: 0.01 * draw.sign(), ..plain }, &[]),
        "gain falls with amplitude" => (LockIn { bend: draw.log_between(0.03, 0.4), ..plain }, &[]),
        "lock-in with a lag" => (LockIn { lag: draw.between(0.1, 0.5), ..plain }, &[]),
        _ => (plain, &[]),
    }
}

fn noise(sub: &str, draw: &mut Draw) -> Noise {
    match sub {
        "Laplace noise" => Noise::Laplace,
        "Student t3 noise" => Noise::Student { freedom: 3 },
        "Student t5 noise" => Noise::Student { freedom: 5 },
        "noise grows with amplitude" => Noise::WithAmplitude { more: draw.log_between(0.2, 3.0) },
        "noise grows with time" => Noise::Growing { factor: draw.log_between(1.5, 6.0) },
        "slightly coloured noise" => Noise::Coloured { correlation: draw.between(0.05, 0.3) * draw.sign() },
        _ => Noise::Gauss,
    }
}

/// Drives in the order taken; one in four recordings has a single one.
fn drives(draw: &mut Draw) -> Vec<f64> {
    let mut all = vec![1.0];
    for _ in 0..draw.one_of(&[0, 1, 1, 2]) {
        all.push(all[all.len() - 1] * draw.between(0.3, 0.7));
    }
    if draw.chance(0.5) {
        all.reverse();
    }
    all
}

/// The n-th case of a family.
pub(super) fn draw(family: Family, nth: usize, draw: &mut Draw) -> (String, Swept, Truth) {
    let sub = sub(family, nth);
    let mut tries = 0;
    loop {
        tries += 1;
        let (mut swept, rights) = recipe(sub, draw);
        let motion = swept.resonator.motion(&swept.taken());
        let peak = motion.iter().map(|x| x.norm()).fold(0.0, f64::max);
        let size = sizes(&swept, &motion);
        swept.sigma *= peak;
        if family == Family::Null {
            // What a null has besides noise stays within it.
            swept.sigma = swept.sigma.max((size.whole / (0.2 * SEEN)).sqrt());
            return (sub.to_owned(), swept, Truth::default());
        }
        // Quieter where the effect would not be seen; one in ten stays as it is. What is foreign must be
        // seen as such.
        let shows = if family == Family::Foreign { nearest(&size) } else { size.whole };
        let seen = (shows / (SEEN * draw.log_between(1.5, 50.0))).sqrt();
        if family == Family::Foreign || !draw.chance(0.1) {
            swept.sigma = swept.sigma.min(seen).max(1e-3 * peak);
        }
        if family != Family::Foreign || shows > SEEN * swept.sigma.powi(2) || tries == MOST_TRIES {
            let truth = truth(family, &swept, &size, &rights, tolerable(sub));
            return (sub.to_owned(), swept, truth);
        }
    }
}

/// The recording of a sub-family, its noise as a part of the peak, and the right names of each effect.
fn recipe(sub: &str, draw: &mut Draw) -> (Swept, Vec<&'static [&'static str]>) {
    // A filter shows where the band is wide.
    let quality = if sub == "low-pass" { draw.between(8.0, 20.0) } else { draw.log_between(20.0, 200.0) };
    let (damping, drives) = (1.0 / quality, drives(draw));
    let least = drives.iter().copied().fold(1.0, f64::min);
    let named = laws(sub, damping, least, draw);
    let warms = match sub {
        "warms with its own power" => {
            [2.0 * damping * draw.sign() * draw.log_between(0.2, 2.0), draw.between(2.0, 8.0)]
        }
        _ => [0.0; 2],
    };
    let side = damping * draw.between(2.5, 5.0);
    // The band follows the resonance to where springs move it.
    let shift: f64 = named.iter().map(|(law, _)| 0.5 * fundamental(law, 1.0, 1.0).re).sum();
    let band = [1.0 - side + shift.min(0.0), 1.0 + side + shift.max(0.0)];
    let (lock_in, read) = lock_in(sub, 0.5 * (band[1] - band[0]), draw);
    let strong = if sub == "strong background" { 1.0 } else { 0.15 };
    let background = std::array::from_fn(|_| [0, 1].map(|_| strong * draw.between(-1.0, 1.0)));
    let swept = Swept {
        seed: draw.bits(),
        resonator: Resonator { quality, laws: named.iter().map(|(law, _)| law.clone()).collect(), warms },
        drives,
        band,
        steps: 40 + draw.below(50),
        lock_in,
        background,
        noise: noise(sub, draw),
        sigma: draw.log_between(1e-3, 0.05),
        written: Written {
            f0_hz: draw.log_between(10.0, 1e7),
            scale: draw.log_between(1e-9, 10.0),
            turn: draw.between(-3.0, 3.0),
            drive: draw.log_between(1e-6, 10.0),
            mirrored: draw.chance(0.2),
            polar: draw.chance(0.25),
            clock: matches!(sub, "spring drift" | "spring drift t^p"),
            kilo: draw.chance(0.3),
        },
    };
    let rights = named.iter().map(|(_, right)| *right).chain([read]).filter(|r| !r.is_empty()).collect();
    (swept, rights)
}

/// Left by the nearest statement, or the nearest two.
fn nearest(size: &Sizes) -> f64 {
    let all = size.alone.iter().map(|l| l.1).chain(size.paired.iter().map(|l| l.1));
    all.fold(size.whole, f64::min)
}

fn truth(family: Family, swept: &Swept, size: &Sizes, rights: &[&[&str]], tolerable: &[&str]) -> Truth {
    let over = swept.sigma.powi(2);
    let rows = (4 * swept.steps * swept.drives.len()) as f64;
    let words = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    // A statement that leaves less than a good test sees, and takes more than half of what there is, is
    // as right.
    let is_near = |left: f64| left.max(size.floor) < SEEN * over && left < 0.5 * size.whole;
    let near: Vec<&str> = size.alone.iter().filter(|(_, left)| is_near(*left)).map(|(name, _)| *name).collect();
    let pairs = size.paired.iter().filter(|(_, left)| is_near(*left)).flat_map(|(names, _)| *names);
    // Two statements together count as right where no single one does.
    let pairs: Vec<&str> = if near.is_empty() { pairs.collect() } else { Vec::new() };
    let effect = |(i, right): (usize, &&[&str])| {
        let several = rights.len() > 1;
        let evidence = if several { size.each[i] } else { size.whole } / over;
        let others = near.iter().filter(|name| !several && !right.contains(name)).copied();
        let right = words(&right.iter().copied().chain(others).collect::<Vec<_>>());
        Effect { right, evidence, over_noise: (evidence / rows).sqrt() }
    };
    let mut also = [near.clone(), pairs].concat();
    also.sort_unstable();
    also.dedup();
    let mut effects: Vec<Effect> = rights.iter().enumerate().map(effect).collect();
    if effects.is_empty() && !also.is_empty() {
        effects.push(effect((0, &&also[..])));
    }
    let is_stated = rights.iter().all(|right| size.alone.iter().any(|(name, _)| right.contains(name)));
    Truth {
        effects,
        also: words(&also),
        tolerable: words(tolerable),
        evidence: size.whole / over,
        departure: (family == Family::Near && is_stated && rights.len() == 1).then_some(nearest(size) / over),
        parameters: if family == Family::Letter { parameters(swept) } else { Vec::new() },
        ..Truth::default()
    }
}

/// Strengths of laws in the units of the columns.
fn parameters(swept: &Swept) -> Vec<Parameter> {
    let w = &swept.written;
    let (omega, scale) = (std::f64::consts::TAU * w.f0_hz, w.scale);
    let of = |law: &Law| {
        let (id, name, value) = match *law {
            Law::OddSpring { size, p: 3.0 } => ("cubic-stiffness", "beta", size * (omega / scale).powi(2)),
            Law::Drag { size, p: 2.0 } => ("quadratic-damping", "c2", size / scale),
            Law::Squeeze { size } => ("squeeze-film-damping", "c", size * omega / scale.powi(2)),
            Law::SmoothFriction { size, .. } => ("coulomb-friction", "f_c", size * scale * omega.powi(2)),
            Law::SpringDrift { size, .. } => ("stiffness-drift", "kappa", size / swept.length_s()),
            _ => return None,
        };
        Some(Parameter { id: id.into(), channel: None, name: name.into(), value })
    };
    swept.resonator.laws.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_cases_hold_the_families_in_turn() {
        for (family, count) in TURNS {
            let nths: Vec<usize> = (0..40).map(turn).filter(|t| t.0 == family).map(|t| t.1).collect();
            assert_eq!(nths, (0..2 * count).collect::<Vec<_>>());
        }
    }

    // What is planted is left by no other statement and by its own wholly taken away.
    #[test]
    fn the_statement_that_is_there_leaves_nothing() {
        for (nth, own) in
            [(0, "cubic-stiffness"), (1, "quadratic-damping"), (3, "coulomb-friction"), (4, "squeeze-film-damping")]
        {
            let (sub, swept, truth) = draw(Family::Letter, nth, &mut Draw::new(5, nth as u64, 1));
            let size = sizes(&swept, &swept.resonator.motion(&swept.taken()));
            let left = |name: &str| size.alone.iter().find(|l| l.0 == name).map_or(f64::NAN, |l| l.1 / size.whole);
            assert!(left(own) < 0.02, "{sub}: {}", left(own));
            let other = if own == "cubic-stiffness" { "quadratic-damping" } else { "cubic-stiffness" };
            assert!(left(other) > 0.2, "{sub}: {}", left(other));
            assert!(truth.allows(own));
        }
    }
}
