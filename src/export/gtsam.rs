//! GTSAM's `PreintegrationCombinedParams`: continuous covariances, which a step makes discrete as
//! N²/Δt held for Δt and K²Δt (`PreintegratedCombinedMeasurements::integrateMeasurement`, 4.2 and
//! later).
//!
//! Held over a step, noise moves the position by N²Δt³/4, and continuous noise by N²Δt³/3: the rest
//! is an integration covariance of N²Δt²/12. With it the sum over any time T is N²T³/3 exactly, and
//! a factor of a single message has an inverse.

use super::drift::{self, Form};
use super::imu::{Errors, Imu};
use super::message::Of;
use super::sheet::{Sheet, number};
use proofmass_base::units::STANDARD_GRAVITY_M_S2;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("GTSAM, PreintegrationParams.h and PreintegrationCombinedParams.h");
    imu.say_messages(sheet);
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    sheet.note("for a navigation frame with z up; MakeSharedD where it is down");
    sheet.line("import gtsam");
    sheet.line("import numpy as np");
    sheet.line("");
    sheet.line(&format!("params = gtsam.PreintegrationCombinedParams.MakeSharedU({STANDARD_GRAVITY_M_S2:?})"));
    let rate_hz = imu.rate_hz;
    let density = |errors: &Errors| imu.filter.seen(errors.white.mean, rate_hz).powi(2);
    let within = |errors: &Errors| density(errors) / (12.0 * rate_hz * rate_hz);
    let walk = |errors: &Errors| drift::process(errors, Form::Walk).drive.powi(2);
    let white = ("white noise", "GTSAM then takes the identity");
    let moving = (
        "random walk or bias instability",
        "GTSAM then takes the identity: for a bias that does not move use ImuFactor",
    );
    let seen = "continuous: N^2 of what a sum of messages sees, not the variance of one";
    let held = "continuous: the part of N^2 dt^3/3 that holding the noise over a step leaves out, N^2 dt^2/12; the \
                error of holding the motion is the vehicle's";
    let walks = "continuous: the variance K^2 per second of the bias' random walk (IEEE 952)";
    let [density, within, walk]: [Of<'_>; 3] = [&density, &within, &walk];
    for (sense, key, unit, means, lacking, of) in [
        (1, "GyroscopeCovariance", "(rad/s)^2/Hz", seen, white, density),
        (0, "AccelerometerCovariance", "(m/s^2)^2/Hz", seen, white, density),
        (0, "IntegrationCovariance", "m^2/s", held, white, within),
        (1, "BiasOmegaCovariance", "(rad/s)^2/s", walks, moving, walk),
        (0, "BiasAccCovariance", "(m/s^2)^2/s", walks, moving, walk),
    ] {
        if let Some(axes) = imu.stated(sheet, sense, key, lacking, of) {
            sheet.explain(key, unit, means);
            sheet.line(&format!("params.set{key}(np.diag([{}]))", axes.map(number).join(", ")));
        }
    }
    sheet.note(
        "up to 4.2, biasAccOmegaInt is the identity and adds to the white noise of every step; how well the first \
         bias is known belongs in its prior (GTSAM, pull request 2199)",
    );
    sheet.line("for name in (\"setBiasAccOmegaInt\", \"setBiasAccOmegaInit\"):");
    sheet.line("    if hasattr(params, name):");
    sheet.line("        getattr(params, name)(np.zeros((6, 6)))");
}
