//! States what the input can distinguish at all, whatever was recorded: how many spectral lines it
//! has that move the reading, against the parameters of what is linear.
//!
//! In the steady state a linear model is seen at the input's lines alone, by amplitude and phase at
//! each: with K lines two models with 2K parameters or more answer alike (persistent excitation:
//! Ljung, System Identification, ch. 13). What parts them then is the transient of the start, which
//! a base model that errs elsewhere fits as it pleases; it decides nothing here. Laws that make
//! harmonics are seen at those and do not belong to the class.

use std::f64::consts::TAU;

use crate::driven::base::{GAIN, OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::intake::input::Input;
use crate::driven::intake::lines::{HALF_WIDTH, power};
use crate::driven::intake::reading_noise::{Sample, reading_noise};
use crate::physics::law::{Place, Role};
use crate::physics::library::Term;

/// Parameters of the base model that the steady state shows: gain, ω₀ and ζ.
const BASE_SEEN: usize = 3;
/// More lines than this decide between all linear laws of the library, alone and in pairs.
const MANY: usize = 8;
/// Power of a line over the strongest one below which it is the window's own.
const FAINTEST: f64 = 1e-8;
/// Log-likelihood that a line must be worth in the reading.
const WORTH: f64 = 12.0;
/// Cycles of the resonance below which its frequency and damping, and what stands next to them, are
/// not determined.
pub(crate) const FEWEST_CYCLES: f64 = 4.0;

/// Limits of what the input and the length of the recording determine.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Identifiability {
    /// Frequencies of the input's lines, Hz, strongest first; empty where there are many, or no
    /// input.
    pub lines_hz: Vec<f64>,
    /// Cycles of the base model's resonance in the recording, where they are too few.
    pub few_cycles: Option<f64>,
    /// States whether the base model's resonance lies beyond half the sampling rate: the reading then follows its input
    /// at once, whether a stiff mass passes it on or nothing stands between.
    pub is_quasi_static: bool,
}

impl Identifiability {
    /// Finds the limits of a recording and its base model.
    pub fn of(data: &Data, base: &Fit) -> Self {
        let cycles = base.point[OMEGA] * data.hull.len() as f64 * data.interval_s() / TAU;
        // A chaotic response is seen at all frequencies, whatever the input.
        let lines = if data.windows.is_some() { Vec::new() } else { lines(data, base) };
        Self {
            lines_hz: if lines.len() > MANY { Vec::new() } else { lines },
            few_cycles: (cycles < FEWEST_CYCLES).then_some(cycles),
            is_quasi_static: base.point[OMEGA] / TAU > 0.5 * data.rate_hz,
        }
    }

    /// Returns the ids of the laws that answer this input alike next to these terms: all that is
    /// linear, where the terms among them have as many parameters as the lines have amplitudes and
    /// phases, or where a reading that follows its input at once does so past the mass. Empty where the input
    /// distinguishes them.
    pub fn class(&self, terms: &[Term]) -> Vec<&'static str> {
        let linear: Vec<&Term> = terms.iter().filter(|t| is_linear(t)).collect();
        if self.is_quasi_static && terms.iter().any(|t| matches!(t, Term::Feedthrough(_))) {
            return Term::all().into_iter().filter(is_linear).map(|t| t.id()).collect();
        }
        let seen = |t: &Term| t.candidate().parameters.len();
        let used: usize = linear.iter().map(|t| seen(t)).sum();
        if self.lines_hz.is_empty() || linear.is_empty() || !self.is_full(used) {
            return Vec::new();
        }
        let least = linear.iter().map(|t| seen(t)).min().unwrap_or(0);
        let others = Term::all().into_iter().filter(|t| is_linear(t) && self.is_full(used - least + seen(t)));
        others.map(|t| t.id()).collect()
    }

    /// Returns whether no linear law of the library, added to the base model, could be
    /// distinguished from another.
    pub fn tells_nothing_linear_apart(&self) -> bool {
        !self.lines_hz.is_empty() && self.is_full(1)
    }

    /// Returns whether a linear model with this many parameters added to the base model's fits any
    /// amplitudes and phases at the lines.
    fn is_full(&self, parameters: usize) -> bool {
        BASE_SEEN + parameters >= 2 * self.lines_hz.len()
    }
}

/// Returns whether a law changes how the reading answers the input at each frequency, and nothing
/// else.
pub(super) fn is_linear(term: &Term) -> bool {
    use Role::{Filter, InputDelay, InputLead, Mode, Readout};
    matches!(term.role(), InputDelay | InputLead | Filter(_) | Mode | Readout(Place::Input))
        || matches!(term, Term::CoupledMode(_) | Term::InputHighpass(_))
}

/// Frequencies of the lines of the input that move the reading beyond its noise, strongest first;
/// as soon as they are many, no further ones are looked for.
fn lines(data: &Data, base: &Fit) -> Vec<f64> {
    let Some(input) = &data.input else { return Vec::new() };
    let power = power(&Input::samples(input)[data.hull.clone()]);
    let n = data.hull.len() as f64;
    let [gain, omega, zeta] = [GAIN, OMEGA, ZETA].map(|i| base.point[i]);
    let answer = |bin: usize| {
        let w = TAU * bin as f64 / n * data.rate_hz;
        gain * gain / ((omega * omega - w * w).powi(2) + (2.0 * zeta * omega * w).powi(2))
    };
    let mut remaining: Vec<f64> = power.iter().enumerate().map(|(bin, p)| p * answer(bin)).collect();
    // The mean of the input is in the offset.
    remaining.iter_mut().take(HALF_WIDTH).for_each(|p| *p = 0.0);
    // What the base model leaves may be far more than noise.
    let measured = reading_noise(&Sample::of(data)).map_or(f64::INFINITY, |n| n.deviation.powi(2));
    let noise = base.variance.min(measured).max(1e-300);
    let mut strongest: f64 = 0.0;
    let mut found = Vec::new();
    while found.len() <= MANY {
        let Some((bin, most)) = remaining.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        strongest = strongest.max(power[bin]);
        // Over all samples the line's part of the reading has this power; half of it over the noise
        // is its log-likelihood.
        if !(most > 0.0 && 0.5 * n * most / noise > WORTH && power[bin] > FAINTEST * strongest) {
            break;
        }
        found.push(bin as f64 / n * data.rate_hz);
        let end = (bin + HALF_WIDTH + 1).min(remaining.len());
        remaining[bin.saturating_sub(HALF_WIDTH)..end].fill(0.0);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driven::base::{BASE, OFFSET};
    use crate::driven::intake::input::Interpolation;
    use crate::driven::intake::observed::Observed;
    use crate::driven::intake::work::Work;
    use crate::driven::simulation::structure::ModelStructure;
    use crate::numerics::least_squares::Linear;
    use crate::physics::cubic_stiffness::CubicStiffness;
    use crate::physics::feedthrough::Feedthrough;
    use crate::physics::input_lag::InputLag;
    use crate::physics::parasitic_mode::ParasiticMode;
    use crate::physics::readout_delay::ReadoutDelay;
    use crate::trace::Trace;

    const RATE_HZ: f64 = 1000.0;

    fn reach(u: Vec<f64>) -> Identifiability {
        let n = u.len();
        let data = Data {
            reading: (0..n).map(|k| 1e-3 * (k as f64 * 12.9898).sin().mul_add(43758.5, 0.0).fract()).collect(),
            observed: Observed::default(),
            input: Some(Input::new(u, Interpolation::BandLimited)),
            environment: Vec::new(),
            environments: 0,
            followed: Vec::new(),
            rate_hz: RATE_HZ,
            hull: 20..n - 20,
            breaks: Vec::new(),
            train: Vec::new(),
            validation: Vec::new(),
            test: Vec::new(),
            own_test: false,
            windows: None,
            clock_s: Vec::new(),
            work: Work::default(),
            trace: Trace::default(),
        };
        let mut point = vec![0.0; BASE];
        let omega = TAU * 40.0;
        (point[GAIN], point[OMEGA], point[ZETA], point[OFFSET]) = (omega * omega, omega, 0.05, 0.0);
        let base = Fit {
            structure: ModelStructure::new(&[]),
            point,
            steps: 2,
            linear: Linear { residual: Vec::new(), columns: Vec::new() },
            free: Vec::new(),
            slopes: Vec::new(),
            variance: 1e-6,
            converged: true,
        };
        Identifiability::of(&data, &base)
    }

    fn sines(hz: &[f64]) -> Vec<f64> {
        let at = |k: usize| hz.iter().map(|f| (TAU * f * k as f64 / RATE_HZ + f).sin()).sum();
        (0..4000).map(at).collect()
    }

    #[test]
    fn lines_are_counted_wherever_they_lie_between_the_bins() {
        for hz in [vec![31.37], vec![30.0, 52.123], vec![20.0, 33.3, 47.7, 61.1]] {
            let found = reach(sines(&hz)).lines_hz;
            assert_eq!(found.len(), hz.len(), "{hz:?}: {found:?}");
            for f in &hz {
                assert!(found.iter().any(|g| (g - f).abs() < 0.3), "{hz:?}: {found:?}");
            }
        }
    }

    // The negative controls: noise, a sweep, a pulse and a step are no lines.
    #[test]
    fn what_moves_all_frequencies_has_no_lines() {
        let mut rng = crate::rng::Philox::new(5, 0, crate::rng::Stream::Host);
        let noise: Vec<f64> = (0..4000).map(|_| rng.normal()).collect();
        let sweep =
            (0..4000).map(|k| (std::f64::consts::PI * 80.0 / 4000.0 * (k as f64).powi(2) / RATE_HZ).sin()).collect();
        let pulse = (0..4000).map(|k| if (60..66).contains(&k) { 1.0 } else { 0.0 }).collect();
        let late = (0..4000).map(|k| if (300..304).contains(&k) { 1.0 } else { 0.0 }).collect();
        let step = (0..4000).map(|k| if k < 1500 { 0.0 } else { 1.0 }).collect();
        for (name, u) in [("noise", noise), ("sweep", sweep), ("pulse", pulse), ("late", late), ("step", step)] {
            assert!(reach(u).lines_hz.is_empty(), "{name}");
        }
    }

    #[test]
    fn two_parameters_a_line_and_no_more_are_told_apart() {
        let delay = Term::ReadoutDelay(ReadoutDelay);
        let (mode, cubic) = (Term::ParasiticMode(ParasiticMode(0)), Term::CubicStiffness(CubicStiffness));
        let lines = |n: usize| Identifiability { lines_hz: vec![1.0; n], ..Identifiability::default() };
        // One line, two numbers, four parameters; two lines, four numbers, four parameters; three
        // lines, six numbers.
        let lag = Term::InputLag(InputLag);
        assert!(lines(1).class(&[lag]).contains(&"readout-delay") && lines(1).class(&[delay]).contains(&"input-lag"));
        assert!(lines(1).class(&[delay]).len() > 3 && lines(2).class(&[delay]).len() > 3);
        assert!(lines(3).class(&[delay]).is_empty());
        // A mode has three parameters: with three lines it is one with what has as many, and no
        // delay.
        let class = lines(3).class(&[mode]);
        assert!(
            class.contains(&"parasitic-mode") && class.contains(&"coupled-mode") && !class.contains(&"readout-delay")
        );
        assert!(lines(4).class(&[mode]).is_empty());
        assert!(lines(1).class(&[cubic]).is_empty(), "a law with harmonics is no member");
        let past = [delay, Term::Feedthrough(Feedthrough)];
        assert!(lines(0).class(&past).is_empty());
        // Far below its resonance a mass answers as what passes it by does.
        let quasi_static = Identifiability { is_quasi_static: true, ..lines(0) };
        assert!(quasi_static.class(&past).contains(&"feedthrough") && quasi_static.class(&[delay]).is_empty());
        assert!(lines(1).tells_nothing_linear_apart() && !lines(3).tells_nothing_linear_apart());
    }

    #[test]
    fn few_cycles_of_the_resonance_are_said() {
        assert_eq!(reach(sines(&[31.37])).few_cycles, None);
        // 40 Hz for 80 ms, less 20 samples at either end: 1.6 cycles.
        let short = reach(sines(&[31.37])[..80].to_vec()).few_cycles;
        assert!(short.is_some_and(|c| (c - 1.6).abs() < 1e-9), "{short:?}");
    }
}
