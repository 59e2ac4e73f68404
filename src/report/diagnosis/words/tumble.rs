//! The verdict on an IMU that was hand-rotated, in plain words.

use super::listed::listed;
use proofmass_base::number::short;
use proofmass_diagnosis::tumble::account::{Account, Drift, NamedTerm, Rms};
use proofmass_diagnosis::tumble::detail::Detail;
use proofmass_diagnosis::tumble::group::{GROUPS, Group};
use proofmass_diagnosis::verdict::Outcome;
use proofmass_scenario::sensor::Sense;

/// One or two sentences for the first screen.
pub(crate) fn sentence(outcome: Outcome, detail: &Detail) -> String {
    let account = &detail.account;
    let improvement = |group: Group| {
        let n = GROUPS.iter().position(|g| *g == group).unwrap_or(0);
        let [before, after] = detail.held_out[n];
        format!("{} {} → {} {}", residual(group), short(before), short(after), group.unit())
    };
    let names: Vec<String> = account.named.iter().map(name).collect();
    match outcome {
        Outcome::Adequate => format!(
            "Nothing is missing that these {} poses could show: the residual of {} is noise.",
            detail.poses.len(),
            if account.with_gyro { "gravity, of the gyro at rest and of the turns" } else { "gravity" }
        ),
        Outcome::Explained => format!(
            "The model left out {}. With {} fitted, poses that were held out agree: {}.",
            listed(&names),
            if names.len() == 1 { "it" } else { "them" },
            listed(&groups(account).map(improvement).collect::<Vec<_>>())
        ),
        Outcome::Unexplained => {
            let part = match names.is_empty() {
                true => "No candidate in the library explains the mismatch".to_owned(),
                false => format!(
                    "{} {} on held-out poses ({}), but something else is missing",
                    listed(&names),
                    if names.len() == 1 { "is named and holds" } else { "are named and hold" },
                    listed(&judging(account).map(improvement).collect::<Vec<_>>())
                ),
            };
            let beyond = account.oversized.iter().map(|(id, sensor)| {
                format!(
                    " {} would explain it, but only with implausible values: check units and columns.",
                    phrase(id, *sensor)
                )
            });
            let still = match account.above.first() {
                Some((group, times)) => {
                    format!("the error of {} is still {} times its noise", residual(*group), short(times.sqrt()))
                }
                None => "held-out poses are predicted worse than without it".to_owned(),
            };
            format!("{part}: {still}.") + &beyond.collect::<String>()
        }
        Outcome::Undecidable if !account.base_determined => {
            "These poses do not span all directions, so that not even offsets and scales are determined.".into()
        }
        Outcome::Undecidable => {
            let pairs: Vec<String> = account.named.iter().filter(|n| !n.rivals.is_empty()).map(name).collect();
            match (&pairs[..], account.above.first()) {
                ([], Some((group, times))) => format!(
                    "The error of {} is {} times its noise, and these poses cannot tell why.",
                    residual(*group),
                    short(times.sqrt())
                ),
                ([], None) => "Something is missing, but these poses cannot tell what.".to_owned(),
                _ => format!("Something is missing, but these poses cannot tell what: {}.", listed(&pairs)),
            }
        }
    }
}

/// The residuals that this recording has.
fn groups(account: &Account) -> impl Iterator<Item = Group> {
    let with_gyro = account.with_gyro;
    GROUPS.into_iter().filter(move |g| with_gyro || *g == Group::Gravity)
}

/// Those in which a named effect acts.
fn judging(account: &Account) -> impl Iterator<Item = Group> {
    let of = |sensor: Sense| account.named.iter().any(|n| n.sensor == sensor);
    let (force, rate) = (of(Sense::Accelerometer), of(Sense::Gyro));
    groups(account).filter(move |g| if *g == Group::Gravity { force } else { rate })
}

/// Lists what was found in the recording and is no effect, in sentences.
pub(crate) fn findings(account: &Account) -> Vec<String> {
    let mut out: Vec<String> = account.drifts.iter().map(|d| drift(d, account.has_column)).collect();
    out.extend(account.knocked.iter().map(|k| {
        format!(
            "pose {} ({} to {} s) disagrees with all the others, as if the sensor had been touched; it was left out",
            k.pose,
            short(k.time_s[0]),
            short(k.time_s[1])
        )
    }));
    if account.wanders {
        out.push(
            "the offsets vary between poses by more than the noise within a pose predicts, as 1/f noise does; the \
             noise of each pose was increased accordingly"
                .into(),
        );
    }
    out
}

fn drift(drift: &Drift, has_column: bool) -> String {
    let unit = if drift.sensor == Sense::Gyro { "°/s" } else { "mm/s²" };
    let [x, y, z] = drift.range.map(short);
    let why = if has_column {
        "the environment column explains it no better"
    } else {
        "1/f noise, warm-up and a draining battery look alike here; a temperature column under `environment` would \
        tell them apart"
    };
    let but = if drift.is_named { "what drives it is open" } else { "it is not named" };
    format!(
        "slow drift of the {}: its offsets move by {x}, {y} and {z} {unit} (x, y, z) over the recording; it was \
        fitted together with the calibration; {but}: {why}",
        drift.sensor.name()
    )
}

/// Says where the base model's mismatch lives.
pub(crate) fn place(detail: &Detail) -> String {
    let location = &detail.account.location;
    let of = |r: &Rms| {
        let unit = r.group.unit();
        let [value, noise] = [r.value, r.noise].map(short);
        format!("{}: {value} {unit} rms, noise {noise} {unit}", residual(r.group))
    };
    let present = |r: &&Rms| detail.account.with_gyro || r.group == Group::Gravity;
    let kinds: Vec<String> = location.residuals.iter().filter(present).map(of).collect();
    let poses = detail.poses.len();
    let place = match (location.standing_out, location.axis) {
        (0, _) => "no pose stands out from the noise".to_owned(),
        (n, None) => format!("{n} of {poses} poses stand out"),
        (n, Some(axis)) => format!(
            "{n} of {poses} poses stand out, mostly with the component of gravity along \
                                    {axis}"
        ),
    };
    format!("{}; {place}", kinds.join("; "))
}

/// A kind of residual.
pub(crate) fn residual(group: Group) -> &'static str {
    match group {
        Group::Gravity => "magnitude of gravity",
        Group::Still => "gyro at rest",
        Group::Turn => "gravity's direction after a turn",
    }
}

/// Says what would decide or confirm.
pub(crate) fn next_experiment(outcome: Outcome, account: &Account) -> &'static str {
    match outcome {
        Outcome::Adequate => {
            "To see smaller effects: more poses, each longer, spread over all directions, and quick turns \
                              between them."
        }
        Outcome::Explained => {
            "Repeat the poses on another day with this calibration: constants that repeat belong to the sensor, \
            constants that change are due to temperature or mounting."
        }
        Outcome::Unexplained => match account.above.first() {
            Some((Group::Still, _)) => {
                "Repeat the same attitude at another heading, and approach it from the other side: a rate that \
                depends on heading originates outside the sensor, one that depends on the approach points to \
                hysteresis."
            }
            Some((Group::Turn, _)) => {
                "Repeat single turns about one axis, slow and fast, in both directions: a dependence on speed points \
                to the gyro's bandwidth or clock, a dependence on direction to its scale."
            }
            _ => {
                "Return to the same attitude from opposite sides several times: a bias that depends on the approach \
                is hysteresis, a bias that does not repeat comes from the mount."
            }
        },
        Outcome::Undecidable if !account.base_determined => {
            "Add poses on the faces and edges that are missing: each axis up, down and tilted."
        }
        Outcome::Undecidable => {
            "Add poses where the candidates differ: each axis up and down, tilted in between, and every attitude \
            twice at different times."
        }
    }
}

/// "misalignment of the gyro", or "misalignment of the gyro or scale-factor" where they are
/// indistinguishable.
fn name(named: &NamedTerm) -> String {
    std::iter::once(phrase(named.id, named.sensor).as_str())
        .chain(named.rivals.iter().copied())
        .collect::<Vec<_>>()
        .join(" or ")
}

/// "misalignment of the gyro".
fn phrase(id: &str, sensor: Sense) -> String {
    format!("{id} of the {}", sensor.name())
}
