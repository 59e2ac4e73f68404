//! Where kernel and filter are compared: each candidate alone, as a term with parameters and as a point of the kernel, and all
//! of them at once.

use proofmass::diagnosis::driven::terms::term::Term;
use proofmass::diagnosis::driven::terms::{contact, damping, drift, drive, hysteresis, lag, mode, readout, spring};
use proofmass::kernel::misfit::Point;

/// ω₀ of the base point.
pub const OMEGA: f64 = 502.65;
/// Its square.
pub const STIFF: f64 = OMEGA * OMEGA;

/// The base point as the kernel takes it; the filter's is [`FITTED`].
pub fn base() -> Point {
    let [gain, omega_rad_s, zeta, offset, x0, v0] = FITTED;
    Point { gain, omega_rad_s, zeta, offset, x0, v0, ..Point::default() }
}

/// Base parameters as the filter takes them.
pub const FITTED: [f64; 6] = [0.9, OMEGA, 0.1, 0.001, 0.002, 0.3];

/// Each candidate as a term with parameters, and as a point.
pub fn cases() -> Vec<(&'static str, Term, Vec<f64>, Point)> {
    use contact::{EndStop, Side};
    let b = base();
    let stop = |side| Term::EndStop(EndStop(side));
    let steady = spring::Drift { environment: None };
    vec![
        ("cubic", Term::CubicStiffness(spring::Cubic), vec![2e3 * STIFF], Point { cubic: 2e3 * STIFF, ..b }),
        (
            "quadratic",
            Term::QuadraticStiffness(spring::Quadratic),
            vec![9.0 * STIFF],
            Point { quadratic: 9.0 * STIFF, ..b },
        ),
        ("speed", Term::QuadraticDamping(damping::Quadratic), vec![20.0], Point { speed_damping: 20.0, ..b }),
        ("squeeze", Term::SqueezeFilm(damping::SqueezeFilm), vec![1e5], Point { squeeze_film: 1e5, ..b }),
        ("friction", Term::Coulomb(damping::Coulomb), vec![150.0], Point { friction: 150.0, ..b }),
        ("drift", Term::StiffnessDrift(steady), vec![0.02], Point { stiffness_drift: 0.02, ..b }),
        ("drive", Term::DriveNonlinearity(drive::Square), vec![1e-4], Point { drive_square: 1e-4, ..b }),
        (
            "stop above",
            stop(Side::Upper),
            vec![5.0 * STIFF, 0.005],
            Point { stop_above: 5.0 * STIFF, gap_above: 0.005, ..b },
        ),
        (
            "stop below",
            stop(Side::Lower),
            vec![3.0 * STIFF, 0.004],
            Point { stop_below: 3.0 * STIFF, gap_below: 0.004, ..b },
        ),
        (
            "hysteresis",
            Term::Hysteresis(hysteresis::BoucWen),
            vec![0.1 * STIFF, 0.003, 0.7, 0.001],
            Point { hysteresis: 0.1 * STIFF, yield_displacement: 0.003, slip_share: 0.7, hysteresis_z0: 0.001, ..b },
        ),
        (
            "mode",
            Term::ParasiticMode(mode::Parasitic),
            vec![0.2, 2.0 * OMEGA, 0.03, 0.001, 0.2],
            Point { mode_gain: 0.2, mode_omega_rad_s: 2.0 * OMEGA, mode_zeta: 0.03, mode_x0: 0.001, mode_v0: 0.2, ..b },
        ),
        ("low-pass", Term::Lowpass(lag::Lowpass), vec![1e-3], Point { lowpass_s: 1e-3, ..b }),
        ("delay", Term::Delay(lag::Delay), vec![1.3e-3], Point { delay_s: 1.3e-3, ..b }),
        ("feedthrough", Term::Feedthrough(drive::Feedthrough), vec![1e-6], Point { feedthrough: 1e-6, ..b }),
        (
            "bend",
            Term::ReadoutNonlinearity(readout::Polynomial),
            vec![5.0, 300.0],
            Point { bend_2: 5.0, bend_3: 300.0, ..b },
        ),
        ("ramp", Term::BiasDrift(drift::Ramp), vec![0.002], Point { ramp: 0.002, ..b }),
        ("warm-up", Term::WarmUp(drift::WarmUp), vec![0.004, 0.3], Point { warm_up: 0.004, warm_up_s: 0.3, ..b }),
        ("rails", Term::Saturation(readout::Saturation), vec![-0.008, 0.006], Point { low: -0.008, high: 0.006, ..b }),
    ]
}

/// Every part of the kernel at once.
pub fn everything() -> Point {
    Point {
        cubic: 300.0 * STIFF,
        quadratic: 3.0 * STIFF,
        speed_damping: 5.0,
        squeeze_film: 1e4,
        friction: 30.0,
        stiffness_drift: 0.01,
        drive_square: 2e-5,
        stop_above: STIFF,
        gap_above: 0.012,
        stop_below: 2.0 * STIFF,
        gap_below: 0.01,
        hysteresis: 0.05 * STIFF,
        yield_displacement: 0.004,
        slip_share: 0.6,
        hysteresis_z0: 0.001,
        mode_gain: 0.1,
        mode_omega_rad_s: 1.7 * OMEGA,
        mode_zeta: 0.05,
        mode_x0: 0.001,
        mode_v0: 0.1,
        lowpass_s: 3e-4,
        delay_s: 7e-4,
        feedthrough: 5e-7,
        bend_2: 1.0,
        bend_3: 50.0,
        ramp: 5e-4,
        warm_up: 0.002,
        warm_up_s: 0.3,
        low: -0.011,
        high: 0.013,
        ..base()
    }
}
