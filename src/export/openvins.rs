//! OpenVINS' kalibr_imu_chain.yaml: Kalibr's four numbers under `imu0`. Its simulator draws σ/√Δt
//! per sample and σ_b√Δt per step of the bias (class Simulator).

use super::imu::Imu;
use super::kalibr;
use super::sheet::Sheet;
use proofmass_base::error::Result;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    // OpenCV's reader wants this first.
    sheet.line("%YAML:1.0");
    sheet.head("the OpenVINS documentation, Sensor Calibration, section IMU Intrinsic Calibration");
    sheet.line("imu0:");
    sheet.indent(2);
    sheet.note("T_i_b: from IMU to body; the identity, as the sensor file does not state the mounting");
    sheet.line("T_i_b:");
    for row in ["[1.0, 0.0, 0.0, 0.0]", "[0.0, 1.0, 0.0, 0.0]", "[0.0, 0.0, 1.0, 0.0]", "[0.0, 0.0, 0.0, 1.0]"] {
        sheet.line(&format!("  - {row}"));
    }
    kalibr::fields(imu, sheet);
    sheet.line("rostopic: /imu0");
    sheet.line("time_offset: 0.0");
    sheet.line(&format!("update_rate: {:?}  # Hz", imu.rate_hz));
}

pub(super) fn read(name: &str, text: &str) -> Result<Imu> {
    kalibr::read(name, text)
}
