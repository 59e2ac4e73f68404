//! Configurations that others wrote: what they state twice, what has no meaning and what has no
//! place here is refused or listed, and never chosen without a word.

use libtest_mimic::Failed;
use proofmass::export;

use super::{SENSOR, check, exported};

fn import(target: &str, text: &str) -> Result<String, String> {
    let target = export::target(target).map_err(|e| e.to_string())?;
    let imu = target.import("configuration", text).map_err(|e| e.to_string())?;
    Ok(imu.sensor_toml(target.name))
}

pub(super) fn made_by_others() -> Result<(), Failed> {
    let [kalibr, sdf, matlab] =
        [exported("kalibr", SENSOR)?, exported("gazebo-sdf", SENSOR)?, exported("matlab", SENSOR)?];
    let key = "accelerometer_noise_density: ";
    let stddev = |to: &str| sdf.replace("<stddev>", &format!("<stddev>{to}"));
    let density = "gyroscope.NoiseDensity = ";
    for (target, text, words) in [
        ("kalibr", format!("{kalibr}\n{key}9e-3\n"), "stands in line"),
        // Two IMUs in one chain.
        ("openvins", format!("imu0:\n{kalibr}\nimu1:\n{kalibr}\n"), "stands in line"),
        ("gazebo-sdf", format!("{sdf}{sdf}"), "several IMUs"),
        ("gazebo-sdf", stddev("-"), "need zero or more"),
        ("gazebo-sdf", sdf.replace("\"gaussian\"", "\"uniform\""), "`uniform`"),
        ("matlab", matlab.replace(density, &format!("{density}-")), "need zero or more"),
        ("matlab", format!("{matlab}\nother = gyroparams;\n"), "more than one gyroparams"),
    ] {
        let said = import(target, &text).err().unwrap_or_else(|| "it was read".into());
        check(said.contains(words), format!("{target}: {said}"))?;
    }
    // A sensor whose noise is switched off has none, and a mean of the noise is a bias: 0.5 rad/s.
    let silent = import("gazebo-sdf", &sdf.replace("\"gaussian\"", "\"none\""))?;
    check(!silent.contains("random_walk"), silent)?;
    let shifted = import("gazebo-sdf", &sdf.replace("<mean>0.0", "<mean>0.5"))?;
    let deg_h = format!("bias_deg_h = {:.1}", 0.5_f64.to_degrees() * 3600.0);
    check(shifted.contains(&deg_h), format!("{deg_h}\n{shifted}"))?;
    // What has no place is listed.
    let bounded = sdf.replace("<dynamic_bias_correlation_time>1.00000000e+06", "<dynamic_bias_correlation_time>40");
    let listed = import("gazebo-sdf", &bounded)?;
    check(listed.contains("# not read: <angular_velocity> <x>: the bias forgets in 40 s"), listed)?;
    let listed = import("matlab", &format!("{matlab}\ngyroscope.BiasInstability = 0.002;\n"))?;
    check(listed.contains("# not read: gyroscope.BiasInstability = 0.002"), listed)?;
    let calibrated = format!("imu0:\n{kalibr}time_offset: 0.013\nTw:\n  - [1.01, 0.0]\n  - [0.0, 1.0]\n");
    let listed = import("openvins", &calibrated)?;
    let found = ["time_offset: 0.013", "Tw of imu0: [1.01, 0.0], [0.0, 1.0]"];
    check(found.iter().all(|f| listed.contains(&format!("# not read: {f}"))), listed)?;
    // An axis that is left out has no noise in Gazebo.
    let (before, rest) = sdf.split_once("<y>").ok_or("no <y>")?;
    let without = before.to_owned() + rest.split_once("</y>").ok_or("no </y>")?.1;
    let listed = import("gazebo-sdf", &without)?;
    check(listed.contains("# not read: <angular_velocity> has no <y>"), &listed)?;
    check(listed.contains("angle_random_walk_deg_rth = [") && listed.contains(", 0.0, "), listed)?;
    // Other ways to write the same script.
    for other in [
        matlab.replace('"', "'"),
        matlab.replace(";\n", "; "),
        "gps = gpsSensor;\ngps.SampleRate = 1;\n".to_owned()
            + &matlab.replace("\"SampleRate\", ", "\"Rate\", ")
            + "\nimu.SampleRate = 10;\n",
    ] {
        let (read, same) = (import("matlab", &other)?, import("matlab", &matlab)?);
        check(read == same, format!("{other}\n{read}\n{same}"))?;
    }
    // Control: what this program writes has all of its numbers read.
    for (target, text) in [("kalibr", kalibr), ("gazebo-sdf", sdf), ("matlab", matlab)] {
        let read = import(target, &text)?;
        check(!read.contains("not read"), format!("{target}:\n{read}"))?;
    }
    Ok(())
}
