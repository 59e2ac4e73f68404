//! The verdict on sweeps of a resonator, in plain words.

use proofmass_base::number::{rounded, short};
use proofmass_diagnosis::answer::Answer;
use proofmass_diagnosis::response::detail::{Detail, Jump};
use proofmass_diagnosis::verdict::{Outcome, Thermal};

use super::listed::holding;

/// One or two sentences for the first screen.
pub(super) fn sentence(answer: &Answer, detail: &Detail) -> String {
    let ids: Vec<String> = answer.effects.iter().map(|e| e.id.clone()).collect();
    let names = holding(&answer.effects, &ids);
    let [f0, width] = detail.resonance_hz;
    let resonance =
        format!("f₀ = {} Hz, width {} Hz, Q = {}", rounded(f0, 7), rounded(width, 4), rounded(f0 / width, 4));
    let times = |rmse: f64| format!("{} times the noise", short(rmse / detail.noise));
    let before = times(answer.fit.test.rmse_before);
    let after = answer.fit.test.rmse_after.map_or(before.clone(), times);
    match answer.outcome {
        Outcome::Adequate => format!(
            "Nothing is missing that these sweeps could show: a linear resonance with a background leaves noise ({resonance})."
        ),
        Outcome::Explained => format!(
            "The model left out {}. With it the error on held-out steps falls from {before} to {after} ({resonance}).",
            names.join(" and ")
        ),
        Outcome::Unexplained if names.is_empty() => {
            let imitations = match detail.imitations.is_empty() {
                true => String::new(),
                false => format!("; {} removes part of it, too little to be named", detail.imitations.join(" with ")),
            };
            format!(
                "The sweeps depart from a linear resonance by {before}, and no law of the library explains it{imitations}."
            )
        }
        Outcome::Unexplained => format!(
            "The model left out {}, and something else: the error on held-out steps falls from {before} to {after} \
             ({resonance}).",
            names.join(" and ")
        ),
        Outcome::Undecidable => match names.is_empty() {
            true => "These sweeps cannot decide whether anything is missing.".into(),
            false => format!("Something is missing, and these sweeps do not show which: {}.", names.join(", and ")),
        },
    }
}

/// Says what the resonator's own temperature makes of the reading.
pub(in crate::diagnosis) fn thermal(noise: &Thermal, unit: &str) -> String {
    let [force, displacement] = [noise.force_psd_n2_hz, noise.displacement_psd_m2_hz].map(f64::sqrt);
    let at_all = format!(
        "at {} K the resonator's own noise is a force of {} N/√Hz, and at resonance a displacement of {} m/√Hz ({} m over \
         all frequencies)",
        short(noise.temperature_k),
        short(force),
        short(displacement),
        short(noise.displacement_rms_m)
    );
    match (noise.bandwidth_hz, noise.reading_rms, noise.residual_ratio) {
        (Some(bandwidth), Some(rms), Some(ratio)) => format!(
            "{at_all}; in {} Hz it makes {} {unit} of X and of Y, and the residual is {} times that",
            short(bandwidth),
            short(rms),
            short(ratio)
        ),
        _ => format!("{at_all}; `bandwidth_hz` under [thermal] compares it with the residual"),
    }
}

/// Says where the mismatch lives, and where the motion jumps.
pub(super) fn place(answer: &Answer, detail: &Detail) -> String {
    let places = &answer.places;
    let mut parts = Vec::new();
    match (places.frequency_hz.first(), places.state.first()) {
        (Some(f), Some(a)) => parts.push(format!(
            "most between {} and {} Hz, at readings of {} to {} {}",
            rounded(f.from, 7),
            rounded(f.to, 7),
            short(a.from),
            short(a.to),
            detail.unit
        )),
        _ => parts.push("nowhere more than the noise".to_owned()),
    }
    if let Some(argument) = &places.argument {
        parts.push(format!("the residual depends on {} ({} of it)", argument.name, short(argument.share.value)));
    }
    parts.extend(detail.jumps.iter().map(|j| jump(j, &detail.drive_unit)));
    parts.join("; ")
}

fn jump(jump: &Jump, unit: &str) -> String {
    let way = if jump.rises { "up" } else { "down" };
    let at = |f: Option<f64>| f.map_or("nowhere".to_owned(), |f| format!("at {} Hz", rounded(f, 7)));
    format!(
        "on the way {way} at {} {unit} the motion jumps {}, by the model {}",
        short(jump.drive),
        at(jump.read_hz),
        at(jump.predicted_hz)
    )
}

/// Names what would decide or confirm.
pub(super) fn next_experiment(answer: &Answer, detail: &Detail) -> String {
    let one_drive = detail.backbone.branches.len() < 2;
    match answer.outcome {
        Outcome::Adequate if one_drive => {
            "Sweep at two or three times the drive: what depends on amplitude shows there first.".into()
        }
        Outcome::Adequate => "Raise the drive until the peak over the drive changes: that is where a linear model ends.".into(),
        Outcome::Explained if detail.may_be_quadratic => {
            "A quadratic spring softens the fundamental alike: read the second harmonic of the drive, which it alone has.".into()
        }
        Outcome::Explained => "Repeat both directions at a drive between those recorded: peak and jumps are predicted.".into(),
        Outcome::Unexplained | Outcome::Undecidable => {
            "Sweep both directions at several drives, twice each and in mixed order: what follows the drive is the resonator, \
             what follows time is drift."
                .into()
        }
    }
}
