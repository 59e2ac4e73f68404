//! Configurations for the next tool: a sensor's noise in the units and conventions of estimators
//! and simulators, and back.
//!
//! Inside stands one convention: N and K of IEEE 952, two-sided, SI. Each target's file turns them
//! into what that tool computes with, and says so in a comment next to each number. What a tool
//! cannot represent is said, with the error of what stands for it. Not for the numbers of a run:
//! those are `report`'s.
//!
//! # Adding a target
//! A file with `write` (and `read`, where the tool's numbers come back), and a line in [`TARGETS`].

#![warn(unreachable_pub)]

mod airsim;
mod ardupilot_sitl;
mod drift;
mod ekf2;
mod fast_lio;
pub mod filter;
mod gazebo_sdf;
mod gnss_ins_sim;
mod gtsam;
pub mod imu;
mod isaac_lab;
mod kalibr;
mod kf_gins;
mod lio_sam;
mod matlab;
mod message;
mod openvins;
mod orb_slam3;
mod px4;
mod robot_localization;
mod ros_covariance;
mod sheet;
mod vins;

use imu::Imu;
use proofmass_base::error::{Error, Result, nearest};
use proofmass_scenario::sensor::SensorTerm;
use sheet::Sheet;

/// A tool that a sensor can be handed to.
#[derive(Debug)]
pub struct Target {
    /// Name of the target, as given after `--to`.
    pub name: &'static str,
    /// The tool, and which of its files this is.
    pub about: &'static str,
    /// Usual name of the file.
    pub file: &'static str,
    /// Holds where its numbers are those of messages at a rate, behind a filter.
    pub messages: bool,
    /// Terms next to white noise, bias instability and random walk that it represents.
    keeps: &'static [SensorTerm],
    write: fn(&Imu, &mut Sheet),
    read: Option<fn(&str, &str) -> Result<Imu>>,
    syntax: sheet::Syntax,
}

const BIASES: &[SensorTerm] = &[SensorTerm::AccelerometerBias, SensorTerm::GyroBias];
const BIASES_RANGE_STEP: &[SensorTerm] =
    &[SensorTerm::AccelerometerBias, SensorTerm::GyroBias, SensorTerm::Range, SensorTerm::Quantisation];

macro_rules! target {
    ($module:ident, $name:literal, $about:literal, $file:literal, $syntax:ident) => {
        Target { messages: true, ..target!($module, $name, $about, $file, $syntax, &[], None) }
    };
    ($module:ident, $name:literal, $about:literal, $file:literal, $syntax:ident, $keeps:expr, $read:expr) => {
        Target {
            name: $name,
            about: $about,
            file: $file,
            keeps: $keeps,
            messages: false,
            write: $module::write,
            read: $read,
            syntax: sheet::Syntax::$syntax,
        }
    };
}

/// All of them: messages and estimators, then simulators.
#[rustfmt::skip]
pub static TARGETS: [Target; 18] = [
    target!(ros_covariance, "ros-covariance", "ROS, covariances of sensor_msgs/Imu", "imu_covariance.yaml", Yaml),
    target!(robot_localization, "robot-localization", "robot_localization, covariances of its imuN", "imu_covariance.yaml", Yaml),
    target!(gtsam, "gtsam", "GTSAM, PreintegrationCombinedParams", "imu_params.py", Python),
    target!(ekf2, "ekf2", "PX4 EKF2, EKF2_* parameters", "ekf2.params", Params),
    target!(kalibr, "kalibr", "Kalibr, imu.yaml", "imu.yaml", Yaml, &[], Some(kalibr::read)),
    target!(openvins, "openvins", "OpenVINS, kalibr_imu_chain.yaml", "kalibr_imu_chain.yaml", Yaml, &[], Some(openvins::read)),
    target!(vins, "vins", "VINS-Mono and VINS-Fusion, config yaml", "vins.yaml", Yaml, &[], None),
    target!(lio_sam, "lio-sam", "LIO-SAM, params.yaml", "params.yaml", Yaml, &[], None),
    target!(fast_lio, "fast-lio", "FAST-LIO and FAST-LIO2, config yaml", "fast_lio.yaml", Yaml, &[], None),
    target!(orb_slam3, "orb-slam3", "ORB-SLAM3, settings yaml", "orb_slam3.yaml", Yaml, &[], None),
    target!(kf_gins, "kf-gins", "KF-GINS, kf-gins.yaml", "kf-gins.yaml", Yaml, &[], None),
    target!(gazebo_sdf, "gazebo-sdf", "Gazebo (gz-sensors), <sensor> of an SDF", "imu.sdf", Xml, BIASES, Some(gazebo_sdf::read)),
    target!(px4, "px4", "PX4 SITL for Gazebo Classic, IMU plugin", "px4_imu.sdf", Xml, BIASES, None),
    target!(ardupilot_sitl, "ardupilot-sitl", "ArduPilot SITL, SIM_* parameters", "imu.parm", Parm, BIASES, None),
    target!(airsim, "airsim", "AirSim, settings.json", "settings.json", Json, &[], None),
    target!(isaac_lab, "isaac-lab", "Isaac Lab, noise model configuration", "imu_noise.py", Python, BIASES, None),
    target!(matlab, "matlab", "MATLAB imuSensor", "imu_noise.m", Matlab, BIASES_RANGE_STEP, Some(matlab::read)),
    target!(gnss_ins_sim, "gnss-ins-sim", "gnss-ins-sim, imu_err", "imu_err.py", Python, BIASES, None),
];

/// The target of this name.
///
/// # Errors
/// There is none; the nearest is named.
pub fn target(name: &str) -> Result<&'static Target> {
    TARGETS.iter().find(|t| t.name == name).ok_or_else(|| {
        let names = TARGETS.iter().map(|t| t.name);
        Error::new(
            format!("could not find the target `{name}`"),
            format!("known: {}", names.clone().collect::<Vec<_>>().join(", ")),
            match nearest(name, names) {
                Some(near) => format!("did you mean `{near}`?"),
                None if name.to_lowercase().starts_with("ros") => {
                    "for the covariances of sensor_msgs/Imu give ros-covariance, for those that an estimator on top of \
                     it needs robot-localization"
                        .into()
                }
                None => "`proofmass export --list` says what each is".into(),
            },
        )
    })
}

impl Target {
    /// The sensor as this tool's configuration.
    pub fn export(&self, imu: &Imu) -> String {
        let mut sheet = Sheet::new(self.syntax, self.about, self.keeps, imu);
        (self.write)(imu, &mut sheet);
        sheet.finish()
    }

    /// Returns whether [`import`](Self::import) reads this tool's configuration.
    pub fn imports(&self) -> bool {
        self.read.is_some()
    }

    /// The sensor of this tool's configuration; `name` stands in messages for where it came from.
    ///
    /// # Errors
    /// The tool's configurations are not read, or a number is missing or cannot be read.
    pub fn import(&self, name: &str, text: &str) -> Result<Imu> {
        match self.read {
            Some(read) => read(name, text),
            None => {
                let known: Vec<&str> = TARGETS.iter().filter(|t| t.imports()).map(|t| t.name).collect();
                Err(Error::new(
                    format!("could not import {name} from {}", self.name),
                    format!("configurations are read from {}", known.join(", ")),
                    "write the numbers into a study.toml by hand; `proofmass export` states each convention",
                ))
            }
        }
    }
}
