//! The answer, what a recording can know and what would tell more, a sentence a line.

use super::values::difference_in_words;
use super::words::{axis, kind, list, name, noise, place};
use proofmass_base::number::{duration, short};
use proofmass_diagnosis::check::{Checked, Compared, Surroundings};
use proofmass_diagnosis::repeatability::agreement::{Agreement, Joint, Odd};
use proofmass_diagnosis::repeatability::besides::{Besides, What};
use proofmass_diagnosis::repeatability::information::Known;
use proofmass_diagnosis::repeatability::parameter::{Estimate, Parameter};
use proofmass_diagnosis::repeatability::run::{Motion, Remedy, Run, Split};
use proofmass_scenario::sensor::Sense;

/// Differences that a sentence lists.
const LISTED: usize = 3;

/// The answer in a sentence.
pub(super) fn answer(files: &[String], checked: &Checked) -> String {
    let what = |compared: &Compared| match compared {
        Compared::Halves(_) => format!("The two halves of {}", files.first().map_or("it", String::as_str)),
        Compared::Runs => format!("The {} recordings", files.len()),
    };
    let Some((compared, agreement)) = &checked.agreement else {
        return "It is too short to be divided: one recording alone says nothing of how well it repeats.".into();
    };
    let told = match &agreement.joint {
        None => format!("{} determine no parameter in common: there is nothing to compare.", what(compared)),
        Some(joint) if joint.agrees() => {
            let each = if *compared == Compared::Runs { "all" } else { "both" };
            let differ = agreement.lines.iter().filter(|l| !l.agrees()).count();
            let expected = 0.05 * agreement.lines.len() as f64;
            // Errors that go together differ together.
            let one_by_one = match differ as f64 > expected {
                true => format!(
                    ", all together; one by one, {differ} of them {} at 95 % (chance alone would make {} differ)",
                    differs(differ),
                    short(expected)
                ),
                false => String::new(),
            };
            format!(
                "{} agree in the {} parameters that {each} determine{one_by_one}.",
                what(compared),
                agreement.lines.len()
            )
        }
        Some(_) => {
            let surroundings: String = checked.surroundings.iter().map(unlike).collect();
            format!("{} do not agree{}.{surroundings}", what(compared), differing(checked, agreement))
        }
    };
    let told = match agreement.odd {
        Some(Odd::Run(run)) => format!(
            "{told} {} is the odd one: without it the others agree, and without no other.",
            files.get(run).map_or("one", String::as_str)
        ),
        Some(Odd::Undecided) => format!("{told} No one of them alone accounts for it."),
        None => told,
    };
    match besides(checked) {
        Some(besides) if checked.runs.iter().flat_map(|run| &run.besides).any(is_beyond) => format!(
            "{told} But {besides}: what is not linear goes into offsets and scales, whose intervals do not hold it."
        ),
        Some(besides) => format!("{told} But {besides}: what is marked * is not noise alone."),
        None => told,
    }
}

/// Says that an environment column differs between the recordings.
fn unlike(Surroundings { column, means }: &Surroundings) -> String {
    let [least, most] = means.map(short);
    format!(
        " `{column}` differs between them, from {least} to {most} in the mean: what follows it is part of what they differ by."
    )
}

/// "ay holds sinusoid in a.csv and b.csv": what a diagnosis finds besides noise.
fn besides(checked: &Checked) -> Option<String> {
    let mut all: Vec<String> = Vec::new();
    for besides in checked.runs.iter().flat_map(|run| &run.besides) {
        let said = holds(besides);
        if !all.contains(&said) {
            all.push(said);
        }
    }
    let more = all.len().saturating_sub(LISTED);
    all.truncate(LISTED);
    if more > 0 {
        all.push(format!("{more} more channels hold something else than noise"));
    }
    (!all.is_empty()).then(|| list(&all))
}

fn is_beyond(besides: &Besides) -> bool {
    matches!(besides.what, What::Beyond(_))
}

fn holds(besides: &Besides) -> String {
    let channel = &besides.channel;
    match &besides.what {
        What::Named(ids) => format!("{channel} holds {}", list(ids)),
        What::Jumps(at_s) => {
            let at: Vec<String> = at_s.iter().take(LISTED).map(|s| duration(*s)).collect();
            format!("the bias of {channel} jumps at {}", list(&at))
        }
        What::Beyond(times) => format!("the linear model of the {channel} leaves {} times its noise", short(*times)),
        What::Unnamed => format!("no noise law that is known here describes {channel}"),
    }
}

/// ": gyro bias z differs by 0.03 ± 0.01 °/s", the clearest first.
fn differing(checked: &Checked, agreement: &Agreement) -> String {
    let Some(run) = checked.runs.first() else { return String::new() };
    let mut lines: Vec<_> = agreement.lines.iter().filter(|l| !l.agrees()).collect();
    lines.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    let said: Vec<String> = lines
        .iter()
        .take(LISTED)
        .map(|line| {
            let parameter = &run.estimate.parameters[line.parameter];
            format!("{} differs by {}", name(parameter), difference_in_words(parameter, line))
        })
        .collect();
    let more = match lines.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    if said.is_empty() { String::new() } else { format!(": {}{more}", said.join(", ")) }
}

/// Tells what a run can know.
pub(super) fn of_run(run: &Run) -> Vec<String> {
    let mut out: Vec<String> = run.findings.iter().map(|f| format!("found: {f}")).collect();
    out.extend(run.besides.iter().map(|b| format!("found: {}: proofmass diagnose says more", holds(b))));
    out.extend(run.motion.iter().flat_map(motion));
    let undetermined = of_known(&run.estimate, Known::Not);
    if undetermined.is_empty() {
        out.push(format!("all {} parameters are determined", run.estimate.parameters.len()));
    } else {
        let about = run.motion.as_ref().and_then(Motion::turned_about).filter(|axes| axes.len() < 3);
        let about = about.map_or(String::new(), |axes| {
            let axes: Vec<String> = axes.into_iter().map(|a| axis(a).to_owned()).collect();
            format!("turned about {} only: ", list(&axes))
        });
        out.push(format!("not determined, and not estimated: {about}{}", undetermined.join("; ")));
    }
    out.extend(mixed(run));
    let weak = of_known(&run.estimate, Known::Weakly);
    if !weak.is_empty() {
        let to = match at_rest(run) {
            // A tenth of the factor of two of data sheets: 1.96 · 0.1 · ln 2.
            true => "to more than ±14 %",
            false => "to a third of a data sheet's tolerance or less",
        };
        out.push(format!("weakly determined ({to}): {}", weak.join("; ")));
    }
    out.extend(remedies(&run.remedies));
    out
}

/// Returns whether it is the noise of a sensor that was checked.
fn at_rest(run: &Run) -> bool {
    run.estimate.parameters.iter().any(|p| matches!(p, Parameter::AtRest(_)))
}

/// "gyro scale z", "gyro misalignment xz, yz", by sensor and role.
fn of_known(estimate: &Estimate, known: Known) -> Vec<String> {
    let mut groups: Vec<(&Parameter, Vec<String>)> = Vec::new();
    for (parameter, told) in estimate.parameters.iter().zip(&estimate.known) {
        if *told != known {
            continue;
        }
        let alike = |other: &Parameter| kind(other) == kind(parameter);
        match groups.iter_mut().find(|(other, _)| alike(other)) {
            Some((_, places)) => places.push(place(parameter)),
            None => groups.push((parameter, vec![place(parameter)])),
        }
    }
    let said = |(parameter, places): &(&Parameter, Vec<String>)| match parameter {
        Parameter::Element(_) => format!("{} {}", kind(parameter), places.join(", ")),
        Parameter::AtRest(_) => format!("{} of {}", kind(parameter), places.join(", ")),
        Parameter::Named(_) => kind(parameter),
    };
    groups.iter().map(said).collect()
}

/// Of what is not determined: the terms of which only a combination is.
fn mixed(run: &Run) -> Vec<String> {
    // Two directions of the same parameters, in which they weigh differently, are one thing to say.
    let mut said: Vec<Vec<usize>> = Vec::new();
    for direction in run.information.undetermined.iter().filter(|d| d.parts.len() > 1) {
        let mut parts: Vec<usize> = direction.parts.iter().map(|(parameter, _)| *parameter).collect();
        parts.sort_unstable();
        if !said.contains(&parts) {
            said.push(parts);
        }
    }
    let names = |parts: &Vec<usize>| -> Vec<String> {
        parts.iter().filter_map(|p| run.estimate.parameters.get(*p)).map(name).collect()
    };
    said.iter().take(2).map(|parts| format!("this motion does not tell apart: {}", list(&names(parts)))).collect()
}

fn motion(motion: &Motion) -> Vec<String> {
    let poses = motion.poses.map(|poses| format!("{poses} still poses"));
    let turned = motion.turned_rad.map(|turned| {
        let turned = [0, 1, 2].map(|a| format!("{:.0}° about {}", turned[a].to_degrees(), axis(a)));
        format!("turned through {}", list(&turned))
    });
    let said = [poses, turned].into_iter().flatten().collect::<Vec<_>>().join("; ");
    let reached = [0, 1, 2].map(|a| {
        let [low, high] = motion.reached[a].map(|share| format!("{share:+.1}").replace('-', "−"));
        format!("{} from {low} to {high} g", axis(a))
    });
    let seen = if motion.poses.is_some() { "gravity was seen" } else { "specific force was read" };
    let mut out = vec![said, format!("{seen} along {}", list(&reached))];
    if !motion.left_out.is_empty() {
        let poses: Vec<String> = motion.left_out.iter().map(usize::to_string).collect();
        out.push(format!("left out, as it disagrees with all the others: pose {}", list(&poses)));
    }
    out
}

fn remedies(remedies: &[Remedy]) -> Vec<String> {
    let percent = |share: f64| format!("±{} %", short(200.0 * share));
    let said = |remedy: &Remedy| match remedy {
        Remedy::Turns { axis: a, count, to } => format!(
            "to determine what turns about {0} tell: {count} quarter turns about {0}, with {0} level, from still pose to \
             still pose, give the scale of {0} to {1}",
            axis(*a),
            percent(*to)
        ),
        Remedy::UpAndDown { sensor: Sense::Accelerometer, axis: a, count, to } => format!(
            "to determine {0} of the accelerometer: {count} poses with {0} up and {count} with {0} down{1}",
            axis(*a),
            to.map_or(String::new(), |to| format!(" give its scale to {}", percent(to)))
        ),
        Remedy::UpAndDown { axis: a, count, .. } => {
            format!(
                "to determine what {0} does to the gyro: {count} poses with {0} up and {count} with {0} down",
                axis(*a)
            )
        }
        Remedy::AsAbout { axis: a, other, turned_rad, to } => format!(
            "to determine what turns about {} tell: turns about it as about {}, {:.0}° in all, give its scale to {}",
            axis(*a),
            axis(*other),
            turned_rad.to_degrees(),
            percent(*to)
        ),
        Remedy::Longer { term, shows, duration_s, to } => format!(
            "to know {} to ±{:.0} %{}: {} at rest",
            if *shows { format!("the {}", noise(*term)) } else { format!("a {}", noise(*term)) },
            100.0 * to,
            if *shows { ", wherever it shows" } else { ", were it as large as this log leaves open" },
            duration(*duration_s)
        ),
        Remedy::Between { axes: [a, b] } => format!(
            "to determine the misalignment {0}{1}: poses with gravity midway between {0} and {1}, on all four sides",
            axis(*a),
            axis(*b)
        ),
    };
    remedies.iter().map(said).collect()
}

/// Tells how the comparison was made and what came of it.
pub(super) fn of_agreement(checked: &Checked) -> Vec<String> {
    let Some((compared, agreement)) = &checked.agreement else { return Vec::new() };
    let mut out = Vec::new();
    if let Compared::Halves(split) = compared {
        out.push(match split {
            Split::FirstAndSecond => "halves: the first half against the second".to_owned(),
            Split::Alternating { parts } => format!(
                "halves: every other of {parts} stretches, as the first half and the second are not moved alike"
            ),
            Split::Blocks { poses } => format!(
                "halves: blocks of {poses} poses in turn, as the first half and the second are not turned alike"
            ),
        });
    }
    if let Some(Joint { chi_squared, freedom, p_value, least_p_value }) = agreement.joint {
        out.push(format!(
            "all together: χ² = {} at {freedom:.0} degrees of freedom; chance alone gives as much or more in {} of cases",
            short(chi_squared),
            of_cases(p_value)
        ));
        let differ = agreement.lines.iter().filter(|l| !l.agrees()).count();
        out.push(format!(
            "one by one: {differ} of {} {} at 95 %; chance alone would make {} differ, and one of them as clearly as the \
             clearest in {} of cases",
            agreement.lines.len(),
            differs(differ),
            short(0.05 * agreement.lines.len() as f64),
            of_cases(least_p_value)
        ));
    }
    out
}

/// "2.1 %".
fn of_cases(p_value: f64) -> String {
    if p_value < 1e-6 { "less than one in a million".to_owned() } else { format!("{} %", short(100.0 * p_value)) }
}

fn differs(count: usize) -> &'static str {
    if count == 1 { "differs" } else { "differ" }
}

/// The next steps.
pub(super) fn next(files: &[String], checked: &Checked) -> Vec<String> {
    let mut out = Vec::new();
    let agrees = checked.agreement.as_ref().and_then(|(_, a)| a.joint).is_some_and(|j| j.agrees());
    let at_rest = checked.runs.first().is_some_and(at_rest);
    let left_out =
        if at_rest { "which noise and which drift there is" } else { "what physics the linear model leaves out" };
    if let ([file], [run]) = (files, &checked.runs[..]) {
        if let Some(poses) = run.motion.as_ref().and_then(|m| m.poses).filter(|_| agrees) {
            out.push(format!("{} poses of the same kind would halve every interval (now {poses})", 4 * poses));
        }
        if at_rest && agrees {
            out.push("a log four times as long would halve the intervals of what is determined".into());
        }
        let of_what = if at_rest { "noise and bias last" } else { "the calibration lasts" };
        out.push(match agrees {
            true if run.besides.iter().any(is_beyond) => format!("proofmass diagnose {file} says {left_out}"),
            true => format!("halves share a day: proofmass check {file} ANOTHER.csv says whether {of_what}"),
            false => format!("proofmass diagnose {file} says {left_out}"),
        });
    } else if !agrees {
        out.push(format!("proofmass diagnose RECORDING, on each of them, says {left_out}"));
    }
    out
}
