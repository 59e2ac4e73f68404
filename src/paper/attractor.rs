//! Figures 17 to 19: the strange attractor, with numbers for what the paper shows by eye.
//!
//! Not for other oscillators: `map` takes any.

use super::check::{Check, Exhibit};
use super::forcing::{OMEGA_OF_HERTZ_RAD_S, OMEGA_RAD_S, Scan, choose, scan};
use proofmass_base::control::{Control, Stopped};
use proofmass_base::parallel;
use proofmass_kernel::orbit::{Orbit, Plan, Point};
use proofmass_physics::dynamics::duffing::{Drive, PAPER, State};
use proofmass_physics::dynamics::estimate::Estimate;
use proofmass_physics::dynamics::fractal::{Dimension, Scales, box_counting, correlation};
use proofmass_physics::dynamics::lyapunov::{Span, kaplan_yorke_dimension, spectrum};
use proofmass_physics::dynamics::poincare::{Window, portrait};
use proofmass_simulate::backend::orbits::explore;

/// Groups of orbits between which errors are estimated.
const GROUPS: usize = 8;
const ORBITS: usize = 64;
/// Each enlargement is this much smaller than the one before.
const ENLARGEMENT: f64 = 1.0 / 8.0;

/// A window into the section and what the points in it measure.
#[derive(Debug, Clone)]
pub struct View {
    /// Rectangle of the section that the window shows.
    pub window: Window,
    /// Points to draw, at most 100,000.
    pub cloud: Vec<[f32; 2]>,
    /// Correlation dimension of the points inside, scales relative to the window.
    pub correlation: Dimension,
}

/// Curves, clouds and checks of figures 17 to 19.
#[derive(Debug, Clone)]
pub struct Attractor {
    /// λ₁ along F₀ at 1.5 rad/s.
    pub radian: Scan,
    /// λ₁ along F₀ at 1.5 Hz.
    pub hertz: Scan,
    /// The drive that is plotted.
    pub drive: Drive,
    /// Some periods of the orbit.
    pub portrait: Vec<State>,
    /// Largest exponent over independent orbits, 1/s.
    pub exponent: Estimate,
    /// Kaplan–Yorke dimension of the section.
    pub kaplan_yorke: Estimate,
    /// Box-counting dimension of the section.
    pub boxes: Dimension,
    /// Mean correlation dimension over many parts an eighth, and a sixty-fourth, of the section's
    /// size.
    pub parts: [Estimate; 2],
    /// The whole section, its enlargement, and the enlargement's enlargement.
    pub views: [View; 3],
    /// Figures 17, 18, 19.
    pub exhibits: [Exhibit; 3],
}

/// Computes all three figures.
///
/// # Errors
/// Stopped.
pub fn compute(control: &Control) -> Result<Attractor, Stopped> {
    let radian = scan(OMEGA_RAD_S, 100.0, 400, control)?;
    let hertz = scan(OMEGA_OF_HERTZ_RAD_S, 6000.0, 600, control)?;
    let amplitude_n = choose(&radian, control)?.unwrap_or(f64::NAN);
    let drive = Drive { amplitude_n, omega_rad_s: OMEGA_RAD_S };
    let steps_per_period = PAPER.steps_per_period(amplitude_n, OMEGA_RAD_S);
    let plan =
        Plan { seed: 0, first_member: 0, steps_per_period, transient_periods: 500, periods: 1000, strobes: 10_000 };
    let starts: Vec<Point> = (0..GROUPS * ORBITS)
        .map(|i| Point { x_m: 0.01 * i as f64, v_m_s: 0.01 * (i % 7) as f64, ..Point::at_rest(&PAPER, &drive) })
        .collect();
    let orbits = explore::<f32>(&starts, &plan, control)?;
    let exponents: Vec<f64> = orbits.iter().map(|o| o.exponent_per_s).collect();
    let exponent = Estimate::of_mean(&exponents);
    let divergence = PAPER.damping_kg_s / PAPER.mass_kg;
    let kaplan_yorke = Estimate {
        value: kaplan_yorke_dimension([exponent.value, -divergence - exponent.value]),
        standard_error: exponent.standard_error * divergence / (divergence + exponent.value).powi(2),
    };
    let all: Vec<[f32; 2]> = orbits.iter().flat_map(|o| o.strobes.iter().copied()).collect();
    let whole = Window::around(&all);
    let groups: Vec<Vec<[f64; 2]>> = orbits.chunks(ORBITS).map(|g| inside(g, &whole, usize::MAX)).collect();
    let boxes = box_counting(&groups, Scales { coarse: 5, fine: 9 });
    let first = densest(&all, &whole);
    let second = densest(&all, &first);
    let views = [whole, first, second].map(|window| view(&orbits, window));
    let parts = [1, 2].map(|n| parts(&orbits, &whole, ENLARGEMENT.powi(n)));
    let spectra: Vec<[f64; 2]> = parallel::map_indices(8, |i| {
        let span = Span { steps_per_period: 400, transient_periods: 200, periods: 1500 };
        spectrum(&PAPER, &drive, State { x_m: 0.1 * i as f64, v_m_s: 0.0 }, span)
    });
    let exhibits = [
        Exhibit::simulated(
            17,
            "Phase portrait in the chaotic regime",
            figure_17_checks(&radian, &hertz, &exponents, &spectra),
        ),
        Exhibit::simulated(
            18,
            "Poincaré section: a strange attractor",
            figure_18_checks(kaplan_yorke, &boxes, &views[0]),
        ),
        Exhibit::simulated(19, "The section enlarged, twice", figure_19_checks(&parts, &views[0], kaplan_yorke)),
    ];
    // Fine enough that its loops are round.
    let portrait = portrait(&PAPER, &drive, 4 * steps_per_period, 200, 30);
    Ok(Attractor { radian, hertz, drive, portrait, exponent, kaplan_yorke, boxes, parts, views, exhibits })
}

/// Points of some orbits inside a window, in its own coordinates, taken evenly down to `at_most`.
fn inside(orbits: &[Orbit], window: &Window, at_most: usize) -> Vec<[f64; 2]> {
    let points: Vec<_> =
        orbits.iter().flat_map(|o| &o.strobes).filter(|p| window.holds(p)).map(|p| window.unit(p)).collect();
    let every = points.len().div_ceil(at_most).max(1);
    points.into_iter().step_by(every).collect()
}

/// The eight-times smaller window that holds most points, among those centred on some of the points
/// inside `within`.
fn densest(points: &[[f32; 2]], within: &Window) -> Window {
    let inside: Vec<&[f32; 2]> = points.iter().filter(|p| within.holds(p)).collect();
    let some: Vec<&[f32; 2]> = inside.iter().copied().step_by((inside.len() / 20_000).max(1)).collect();
    let candidates = some.iter().step_by((some.len() / 200).max(1)).map(|p| within.scaled(**p, ENLARGEMENT));
    candidates.max_by_key(|w| some.iter().filter(|p| w.holds(p)).count()).unwrap_or(*within)
}

fn view(orbits: &[Orbit], window: Window) -> View {
    // 6000 points a group are 18 million pairs: enough at every scale used, and a tenth of a
    // second.
    let groups: Vec<Vec<[f64; 2]>> = orbits.chunks(ORBITS).map(|g| inside(g, &window, 6000)).collect();
    let cloud: Vec<[f32; 2]> =
        orbits.iter().flat_map(|o| &o.strobes).filter(|p| window.holds(p)).take(100_000).copied().collect();
    View { window, cloud, correlation: correlation(&groups, Scales { coarse: 2, fine: 6 }) }
}

fn figure_17_checks(radian: &Scan, hertz: &Scan, exponents: &[f64], spectra: &[[f64; 2]]) -> Vec<Check> {
    let lanes = Estimate::of_mean(exponents);
    let oracle = Estimate::of_mean(&spectra.iter().map(|s| s[0]).collect::<Vec<_>>());
    let chaotic = exponents.iter().filter(|e| **e > 0.0).count() as f64 / exponents.len() as f64;
    let sum = spectra.iter().map(|s| s[0] + s[1]).sum::<f64>() / spectra.len() as f64;
    vec![
        Check::near(
            "1.5 rad/s: F₀ where the first band of lasting chaos begins / N",
            "a separate scan (Runge–Kutta, 400 steps a period, 600 periods) found 57.5; its grid and ours are 0.25 N",
            57.5,
            radian.band_n().unwrap_or(f64::NAN),
            0.75,
        ),
        Check::near(
            "1.5 Hz: forces up to 60 N that end in chaos",
            "a separate scan found none below 60 N at 1.5 Hz, hence the frequency plotted here",
            0.0,
            hertz.chaotic_below(60.0) as f64,
            0.0,
        ),
        Check::near(
            "fraction of starts whose largest exponent is positive",
            "chaos from every start",
            1.0,
            chaotic,
            0.0,
        ),
        Check::near(
            "largest Lyapunov exponent of the lanes / (1/s)",
            "the f64 oracle with two orthogonalised tangents and other steps; four joint standard errors",
            oracle.value,
            lanes.value,
            4.0 * lanes.standard_error.hypot(oracle.standard_error),
        ),
        Check::near(
            "sum of both exponents / (1/s)",
            "−D₀/m: the rate at which damping shrinks every area of the phase plane (Liouville)",
            -PAPER.damping_kg_s / PAPER.mass_kg,
            sum,
            1e-5,
        ),
    ]
}

fn figure_18_checks(kaplan_yorke: Estimate, boxes: &Dimension, whole: &View) -> Vec<Check> {
    let correlation = whole.correlation.estimate;
    let joint = 4.0 * correlation.standard_error.hypot(kaplan_yorke.standard_error);
    vec![
        Check::between(
            "correlation dimension of the section",
            "more than a curve (1), at most the Kaplan–Yorke dimension from the exponents, within four standard errors",
            1.0,
            kaplan_yorke.value + joint,
            correlation.value,
        ),
        Check::between(
            "box-counting dimension of the section",
            "at least the correlation dimension (Rényi dimensions fall with their order), within four standard errors, and \
             less than the plane (2). In the limit it is at least the Kaplan–Yorke dimension too; with finite points some \
             boxes are never visited, which leaves it a little below",
            correlation.value - 4.0 * correlation.standard_error.hypot(boxes.estimate.standard_error),
            2.0,
            boxes.estimate.value,
        ),
    ]
}

/// Parts of the section looked into, at each scale.
const PARTS: usize = 48;

/// Mean correlation dimension of parts of the section, `factor` times its size, centred on points
/// of the attractor.
fn parts(orbits: &[Orbit], whole: &Window, factor: f64) -> Estimate {
    let every = orbits.len() / PARTS;
    let windows: Vec<Window> =
        orbits.iter().step_by(every).filter_map(|o| o.strobes.first()).map(|p| whole.scaled(*p, factor)).collect();
    let dimensions: Vec<f64> = parallel::map(&windows, |w| {
        correlation(&[inside(orbits, w, 5000)], Scales { coarse: 3, fine: 6 }).estimate.value
    });
    Estimate::of_mean(&dimensions)
}

fn figure_19_checks(parts: &[Estimate; 2], whole: &View, kaplan_yorke: Estimate) -> Vec<Check> {
    let [eighth, sixty_fourth] = parts;
    let whole = whole.correlation.estimate;
    let joint = 4.0 * eighth.standard_error.hypot(sixty_fourth.standard_error);
    vec![
        Check::near(
            "mean dimension of parts at 1/64 of the size, against those at 1/8",
            "self-similarity: equal at both scales; four joint standard errors over 48 parts each",
            eighth.value,
            sixty_fourth.value,
            joint,
        ),
        Check::between(
            "mean dimension of parts at 1/64 of the size",
            "parts average logarithms where the whole averages pairs, so they lie from its correlation dimension up to the \
             Kaplan–Yorke dimension; four standard errors on both sides",
            whole.value - 4.0 * whole.standard_error.hypot(sixty_fourth.standard_error),
            kaplan_yorke.value + 4.0 * kaplan_yorke.standard_error.hypot(sixty_fourth.standard_error),
            sixty_fourth.value,
        ),
    ]
}
