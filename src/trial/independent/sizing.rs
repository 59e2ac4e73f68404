//! Sizing: puts effects on an oscillator at a visible size, and measures how much evidence of each a
//! recording holds.

use super::draw::Draw;
use super::driven::{Driven, rms};
use super::law::Law;
use super::readout::Readout;
use super::truth::{Effect, Truth};

/// One thing to put on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Piece {
    /// In the equation of motion.
    Law(Law),
    Stage(Readout),
    /// The measured input is late, s.
    Lag(f64),
    /// The measured input is noisy, of its rms.
    InputNoise(f64),
    /// Sampling instants scatter, rows.
    Jitter(f64),
    /// After this part of the recording this many rows are lost.
    Slip([f64; 2]),
}

impl Piece {
    /// Adds the effect to a driven recording.
    pub(crate) fn put(&self, driven: &mut Driven) {
        let o = &mut driven.oscillator;
        match self {
            Self::Law(law) => o.laws.push(law.clone()),
            Self::Stage(stage) => {
                o.readout.push(stage.clone());
                o.readout.sort_by_key(order);
            }
            Self::Lag(lag) => o.input_lag_s = *lag,
            Self::InputNoise(noise) => o.input_noise = *noise,
            Self::Jitter(rows) => o.jitter = *rows,
            Self::Slip(slip) => o.slip = Some(*slip),
        }
    }

    fn size_mut(&mut self) -> Option<&mut f64> {
        match self {
            Self::Law(Law::WhiteForce { .. }) | Self::Stage(Readout::Walk { .. }) => None,
            Self::Law(law) => Some(law.size_mut()),
            Self::Stage(stage) => stage.size_mut(),
            Self::Slip(_) => None,
            Self::Lag(x) | Self::InputNoise(x) | Self::Jitter(x) => {
                let _ = x;
                None
            }
        }
    }

    fn is_random(&self) -> bool {
        matches!(
            self,
            Self::Law(Law::WhiteForce { .. } | Law::Telegraph { .. } | Law::Foreign { .. })
                | Self::Stage(Readout::Walk { .. } | Readout::Cross { .. })
        )
    }
}

/// Order in which readout stages act.
fn order(stage: &Readout) -> usize {
    match stage {
        Readout::Poles { .. } | Readout::Delay { .. } => 0,
        Readout::Bend { .. } | Readout::Dead { .. } => 1,
        Readout::Feed { .. } | Readout::Cross { .. } | Readout::Line { .. } => 2,
        Readout::Slow { .. } | Readout::WarmUp { .. } | Readout::Walk { .. } => 3,
        Readout::Rails { .. } | Readout::Soft { .. } => 4,
        Readout::Round { .. } => 5,
    }
}

/// Scales a piece until what the base model leaves of the first rows is near `target` of the
/// output. False when no size does: the motion runs away, or the base model takes it all.
pub(crate) fn strengthen(base: &Driven, piece: &mut Piece, target: f64) -> bool {
    if piece.size_mut().is_none() {
        return true;
    }
    let o = &base.oscillator;
    let cycle = o.rate_hz * std::f64::consts::TAU / o.omega;
    let rows = o.rows.min(3000).max((12.0 * cycle) as usize).min(o.rows);
    let mut last = 0.0;
    // Friction beyond the spring's own force holds the mass for good.
    let most = match piece {
        Piece::Law(Law::Friction { .. } | Law::SmoothFriction { .. } | Law::Stribeck { .. }) => o.omega * o.omega,
        _ => f64::INFINITY,
    };
    for _ in 0..9 {
        if piece.size_mut().is_some_and(|size| size.abs() > most) {
            return false;
        }
        let mut with = base.clone();
        piece.put(&mut with);
        let visible = with.visible(rows);
        let factor = match visible {
            None => 0.2,
            Some(v) if v > target / 1.25 && v < target * 1.25 => return true,
            Some(v) => (target / v.max(1e-9)).powf(0.85).clamp(0.05, 20.0),
        };
        last = visible.unwrap_or(0.0);
        if let Some(size) = piece.size_mut() {
            *size *= factor;
        }
    }
    last > 0.2 * target && last < 3.0 * target
}

/// Count and variance of the Haar details of each octave, finest first.
pub(crate) fn octaves(values: &[f64]) -> Vec<(f64, f64)> {
    let mut level = values.to_vec();
    let mut octaves = Vec::new();
    while level.len() >= 16 {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let detail: f64 = level.chunks_exact(2).map(|p| (half * (p[0] - p[1])).powi(2)).sum();
        let count = (level.len() / 2) as f64;
        octaves.push((count, detail / count));
        level = level.chunks_exact(2).map(|p| half * (p[0] + p[1])).collect();
    }
    octaves
}

/// Twice the log-likelihood by which noise of several octaves is told from white noise (Haar
/// wavelet variances).
pub(super) fn coloured_evidence(residual: &[f64], sigma: f64) -> f64 {
    let octaves: Vec<(f64, f64)> =
        octaves(residual).into_iter().map(|(count, level)| (count, level / (sigma * sigma) + 1.0)).collect();
    let total: f64 = octaves.iter().map(|o| o.0).sum();
    let mean = octaves.iter().map(|o| o.0 * o.1).sum::<f64>() / total.max(1.0);
    octaves.iter().map(|(n, level)| n * (mean / level).ln()).sum::<f64>().max(0.0)
}

/// Returns what a good test has to see, over the noise: evidence and rms.
fn evidence(driven: &Driven, random: bool) -> Option<[f64; 2]> {
    let o = &driven.oscillator;
    let readings = driven.readings(o.rows, false)?;
    let mut residual = driven.left_by_base(&readings.reading);
    if o.input_noise > 0.0 {
        // Noise of the measured input is force noise of the model: its displacement, at resonance.
        let fraction = o.input_noise * (o.omega / (o.rate_hz * 4.0 * o.zeta)).sqrt();
        let size = (fraction * rms(&readings.input) * o.gain / (o.omega * o.omega)) / driven.sigma;
        return Some([o.rows as f64 * size.powi(4) / (1.0 + size * size), size]);
    }
    let over_noise = rms(&residual) / driven.sigma;
    let steps: f64 = o
        .readout
        .iter()
        .map(|r| if let Readout::Round { step } = r { (step / driven.sigma).powi(4) / 144.0 } else { 0.0 })
        .sum();
    let found = if random {
        coloured_evidence(&residual, driven.sigma)
    } else {
        // Beyond 10 σ nothing is gained.
        residual.iter_mut().for_each(|l| *l = (*l / driven.sigma).clamp(-10.0, 10.0));
        residual.iter().map(|l| l * l).sum()
    };
    Some([found + steps * o.rows as f64, over_noise.max(steps.sqrt())])
}

/// Puts pieces on and measures them. None when the motion runs away.
pub(super) fn assemble(base: Driven, pieces: &[(Piece, Effect)], mut truth: Truth) -> Option<(Driven, Truth)> {
    let random = pieces.iter().all(|(p, _)| p.is_random());
    let mut all = base.clone();
    pieces.iter().for_each(|(p, _)| p.put(&mut all));
    let whole = evidence(&all, random)?;
    truth.evidence = whole[0];
    for (piece, effect) in pieces {
        let [evidence, over_noise] = if pieces.len() == 1 {
            whole
        } else {
            let mut alone = base.clone();
            piece.put(&mut alone);
            evidence(&alone, piece.is_random())?
        };
        if !effect.right.is_empty() {
            truth.effects.push(Effect { evidence, over_noise, ..effect.clone() });
        }
    }
    truth.parameters = all.parameters();
    Some((all, truth))
}

/// Visible size as a fraction of the output: 1 to 20 %, but at least what the noise lets be seen in
/// most cases.
pub fn target(draw: &mut Draw, base: &Driven) -> f64 {
    let least = (3.0 * base.sigma).min(0.15);
    draw.log_between(0.01f64.max(least), 0.2)
}
