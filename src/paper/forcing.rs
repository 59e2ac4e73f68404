//! The force that the paper withholds: how the largest Lyapunov exponent depends on F₀ under both
//! readings of "1.5 Hz".
//!
//! Chaos can be a long farewell: an orbit may wander for hundreds of periods before it falls into a
//! periodic one. An exponent counts here only after a long transient, and from several starts,
//! since attractors coexist. Not the two-dimensional maps (`map`).

use proofmass_base::control::{Control, Stopped};
use proofmass_kernel::orbit::{Orbit, Plan, Point};
use proofmass_numerics::numerics::order;
use proofmass_physics::dynamics::duffing::{Drive, PAPER};
use proofmass_simulate::backend::orbits::explore;

/// "f = 1.5 Hz" read as an angular frequency.
pub(super) const OMEGA_RAD_S: f64 = 1.5;
/// "f = 1.5 Hz" read as printed.
pub(super) const OMEGA_OF_HERTZ_RAD_S: f64 = 2.0 * std::f64::consts::PI * 1.5;

/// An exponent counts as positive above this, 1/s: a periodic orbit near a bifurcation shows up to
/// 0.002.
const POSITIVE_PER_S: f64 = 0.01;

/// Starts per force: displacements in units of the static deflection, at rest.
const STARTS: [f64; 8] = [0.0, 0.3, -0.3, 0.7, -0.7, 1.0, -1.0, 1.4];

/// λ₁ along F₀ at one frequency, from several starts.
#[derive(Debug, Clone)]
pub struct Scan {
    /// Frequency of the force.
    pub omega_rad_s: f64,
    /// For each F₀, N: the exponents of all starts, 1/s, smallest first.
    pub exponents: Vec<(f64, Vec<f64>)>,
    /// For each F₀, N: the exponent from rest over the first periods, transients included, 1/s.
    pub early: Vec<(f64, f64)>,
}

fn positive(exponent: f64) -> bool {
    exponent > POSITIVE_PER_S
}

impl Scan {
    /// The first F₀ at which some start ends in chaos.
    pub fn first_n(&self) -> Option<f64> {
        self.exponents.iter().find(|(_, e)| e.iter().any(|e| positive(*e))).map(|p| p.0)
    }

    /// Returns where a band of at least ten successive forces begins, each of which is chaotic from
    /// some start.
    pub fn band_n(&self) -> Option<f64> {
        let chaotic = |(_, e): &(f64, Vec<f64>)| e.iter().any(|e| positive(*e));
        self.exponents.windows(10).find(|w| w.iter().all(chaotic)).map(|w| w[0].0)
    }

    /// Forces that are chaotic from every start, the largest least exponent first: F₀ and that
    /// exponent.
    fn everywhere(&self) -> Vec<(f64, f64)> {
        let least = self.exponents.iter().map(|(f, e)| (*f, e[0]));
        let mut found: Vec<_> = least.filter(|p| positive(p.1)).collect();
        order::sort_by_key(&mut found, |f| -f.1);
        found
    }

    /// Returns how many forces up to a limit are chaotic from any start.
    pub fn chaotic_below(&self, limit_n: f64) -> usize {
        self.exponents.iter().filter(|(f, e)| *f <= limit_n && e.iter().any(|e| positive(*e))).count()
    }

    /// Share of forces that look chaotic early and, of these, the share that no start keeps up.
    pub fn early_and_fading(&self) -> (f64, f64) {
        let early: Vec<usize> = (0..self.early.len()).filter(|i| positive(self.early[*i].1)).collect();
        let fading = early.iter().filter(|i| !self.exponents[**i].1.iter().any(|e| positive(*e))).count();
        (early.len() as f64 / self.early.len() as f64, fading as f64 / early.len().max(1) as f64)
    }
}

/// Scans F₀ from one step up to `to_n` in `points` steps.
///
/// # Errors
/// Stopped.
pub(crate) fn scan(omega_rad_s: f64, to_n: f64, points: u32, control: &Control) -> Result<Scan, Stopped> {
    let force = |i: u32| to_n * f64::from(i + 1) / f64::from(points);
    let at_rest = |i: u32| Point::at_rest(&PAPER, &Drive { amplitude_n: force(i), omega_rad_s });
    let starts = (0..points).flat_map(|i| {
        let deflection = PAPER.equilibrium_m(force(i));
        STARTS.map(|s| Point { x_m: s * deflection, ..at_rest(i) })
    });
    let early = Plan {
        seed: 0,
        first_member: 0,
        steps_per_period: PAPER.steps_per_period(to_n, omega_rad_s),
        transient_periods: 0,
        periods: 600,
        strobes: 0,
    };
    // 1500 periods are about 300 (1.5 rad/s) or 50 (1.5 Hz) decay times 2m/D₀ of the linear
    // oscillator.
    let late = Plan { transient_periods: 1500, periods: 1000, strobes: 32, ..early };
    let kept = explore::<f32>(&starts.collect::<Vec<_>>(), &late, control)?;
    let exponents = kept.chunks(STARTS.len()).enumerate().map(|(i, orbits)| {
        let mut e: Vec<f64> = orbits.iter().map(settled).collect();
        order::sort(&mut e);
        (force(i as u32), e)
    });
    let first = explore::<f32>(&(0..points).map(at_rest).collect::<Vec<_>>(), &early, control)?;
    let early = first.iter().enumerate().map(|(i, o)| (force(i as u32), o.exponent_per_s)).collect();
    Ok(Scan { omega_rad_s, exponents: exponents.collect(), early })
}

/// Of the twenty most chaotic forces of a scan, the one whose least exponent over 64 further starts
/// is largest: there the strange attractor has no rival, and every start ends on it.
///
/// # Errors
/// Stopped.
pub(crate) fn choose(scan: &Scan, control: &Control) -> Result<Option<f64>, Stopped> {
    let candidates: Vec<f64> = scan.everywhere().into_iter().take(20).map(|p| p.0).collect();
    let Some(largest) = candidates.iter().copied().max_by(f64::total_cmp) else { return Ok(None) };
    let starts: Vec<Point> = candidates
        .iter()
        .flat_map(|f| {
            let deflection = PAPER.equilibrium_m(*f);
            let at_rest = Point::at_rest(&PAPER, &Drive { amplitude_n: *f, omega_rad_s: scan.omega_rad_s });
            (0..64).map(move |i| {
                let (column, row) = (f64::from(i % 8), f64::from(i / 8));
                let speed = scan.omega_rad_s * deflection;
                Point { x_m: (column - 3.5) / 2.0 * deflection, v_m_s: (row - 3.5) / 2.0 * speed, ..at_rest }
            })
        })
        .collect();
    let steps_per_period = PAPER.steps_per_period(largest, scan.omega_rad_s);
    let plan = Plan { seed: 0, first_member: 0, steps_per_period, transient_periods: 1500, periods: 500, strobes: 32 };
    let orbits = explore::<f32>(&starts, &plan, control)?;
    let least = orbits.chunks(64).map(|o| o.iter().map(settled).fold(f64::INFINITY, f64::min));
    Ok(candidates.into_iter().zip(least).max_by(|a, b| a.1.total_cmp(&b.1)).map(|p| p.0))
}

/// The exponent of an orbit, not counting one that was positive only until the orbit became
/// periodic.
fn settled(orbit: &Orbit) -> f64 {
    match orbit.period(1e-3) {
        Some(_) => orbit.exponent_per_s.min(0.0),
        None => orbit.exponent_per_s,
    }
}
