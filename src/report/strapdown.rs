//! The page and the terminal text of a study in motion.

mod doubt;
mod figures;
mod outages;
mod windows;

use self::doubt::doubt;
use super::html::Page;
use super::study::moment::{moment, plain};
use super::study::{further, jcgm101, percent};
use super::table::Table;
use proofmass_base::number::{duration, significant, worth};
use proofmass_base::units::DEGREE;
use proofmass_numerics::statistics::jcgm101::Stated;
use proofmass_simulate::backend::flight::Quantity;
use proofmass_simulate::decision::further::Further;
use proofmass_simulate::strapdown::answer::{Answer, Departure};
use proofmass_simulate::strapdown::covariance::{Cause, Part};
use proofmass_study::Study;

/// The page; `stated` is the last horizontal error where digits were asked for.
pub fn page(study: &Study, answer: &Answer, stated: Option<&Stated>, further: &Further) -> Page {
    let mut page = Page::new(&format!("{}: how far it drifts", study.name), &lede(answer));
    page.section("How far it drifts");
    let distance = figures::distance(answer).draw();
    let names = ["north", "east", "down"];
    let position = figures::spreads(answer, "Position error", "position error, sd / m", 0, names, 1.0).draw();
    page.figure_row(&[
        (&distance, "Distance from the truth that half and 95 of 100 navigators stay within: CEP and SEP over time."),
        (&position, "Standard deviation along each axis, over the covariance of the linear error model."),
    ]);
    page.table(&position_table(answer));
    page.list(&findings(answer));
    if let Some(stated) = stated {
        page.section(jcgm101::TITLE);
        page.paragraph(&jcgm101::sentence("Horizontal", stated));
    }
    further::drift(&mut page, further);
    page.section("Where it drifts to");
    let (map, magnified) = figures::map(answer);
    let scale = if magnified == 1.0 { String::new() } else { format!(", magnified {magnified} times") };
    let caption = format!("The track from above, with the ellipses that hold 95 % of the position errors{scale}.");
    page.figure(&map.draw(), &caption);
    outages::section(&mut page, study, answer);
    page.section("Velocity and attitude");
    let names = ["north", "east", "down"];
    let velocity = figures::spreads(answer, "Velocity error", "velocity error, sd / (m/s)", 3, names, 1.0).draw();
    page.figure_row(&[
        (&velocity, "Standard deviation of the velocity error."),
        (&figures::attitude(answer).draw(), "Standard deviation of the attitude error about the vehicle's level axes."),
    ]);
    page.table(&attitude_table(answer));
    if let Some(compared) = &answer.compared {
        windows::section(&mut page, compared);
    }
    page.section("Which error is to blame");
    page.figure(&figures::shares(answer).draw(), "Fraction of the mean square of the horizontal position error.");
    page.paragraph(
        "Fraction of the mean square of the horizontal position error due to each source, and the root mean square of \
         the position error that each makes alone at the last report time, by the linear error model. The navigator's \
         integration error is that of the same navigator on perfect readings.",
    );
    if !answer.simulated.is_empty() {
        let names: Vec<&str> = answer.simulated.iter().map(|part| part.cause.name()).collect();
        page.paragraph(&format!(
            "The linear model leaves out {}: each is what the same sensors err less without it.",
            names.join(", ")
        ));
    }
    page.table(&budget_table(answer));
    further::blame(&mut page, further);
    super::study::sensor::section(&mut page, study);
    page.section("The study");
    page.preformatted(study.text.trim());
    super::study::note(&mut page, study);
    page.section("How this was made");
    page.table(&provenance(study, answer));
    page
}

/// The answer in a sentence.
pub fn lede(answer: &Answer) -> String {
    let Some(last) = answer.report.last().copied() else { return String::new() };
    let aided = !answer.flight.fixes.is_empty();
    let (last, when) = match outages::worst(answer) {
        Some((outage, end)) => {
            (end, format!("At the end of the GNSS outage from {} s to {} s", outage.from_s, outage.until_s))
        }
        None if aided => (last, format!("After {} with aiding", moment(answer.ensemble.time_s[last]))),
        None => (last, format!("After {} without aiding", moment(answer.ensemble.time_s[last]))),
    };
    let horizontal = answer.ensemble.summary(last, Quantity::Horizontal);
    let doubt = doubt(horizontal);
    let failed = match answer.ensemble.failed {
        0 => String::new(),
        failed => format!(" that did not fail ({failed} did)"),
    };
    format!(
        "{when}, half of {} simulated navigators{failed} are within {} m of the truth horizontally, and 95 of \
         100 within {} m.",
        answer.ensemble.members - answer.ensemble.failed,
        worth(horizontal.percentiles[2], doubt),
        worth(horizontal.percentiles[3], 2.0 * doubt),
    )
}

/// Position errors at the report times.
pub fn position_table(answer: &Answer) -> Table {
    let mut table = Table::new(&[
        "time / s",
        "north sd / m",
        "east sd / m",
        "down sd / m",
        "CEP50 / m",
        "CEP95 / m",
        "SEP50 / m",
        "SEP95 / m",
    ]);
    for k in &answer.report {
        let at = |quantity| answer.ensemble.summary(*k, quantity);
        let mut row = vec![plain(answer.ensemble.time_s[*k])];
        row.extend((0..3).map(|axis| at(Quantity::Position(axis))).map(|s| worth(s.sd, doubt(s))));
        for quantity in [Quantity::Horizontal, Quantity::Spherical] {
            row.extend([2, 3].map(|p| worth(at(quantity).percentiles[p], 2.0 * doubt(at(quantity)))));
        }
        table.row(row);
    }
    table
}

/// Velocity and attitude errors at the report times.
pub fn attitude_table(answer: &Answer) -> Table {
    let mut table = Table::new(&[
        "time / s",
        "north sd / (m/s)",
        "east sd / (m/s)",
        "down sd / (m/s)",
        "roll sd / °",
        "pitch sd / °",
        "heading sd / °",
    ]);
    for k in &answer.report {
        let at = |quantity, unit: f64| {
            let summary = answer.ensemble.summary(*k, quantity);
            worth(summary.sd / unit, doubt(summary) / unit)
        };
        let mut row = vec![plain(answer.ensemble.time_s[*k])];
        row.extend((0..3).map(|axis| at(Quantity::Velocity(axis), 1.0)));
        row.extend((0..3).map(|axis| at(Quantity::Attitude(axis), DEGREE)));
        table.row(row);
    }
    table
}

/// Tabulates what each source does to the position.
pub fn budget_table(answer: &Answer) -> Table {
    let times = answer.report_times_s();
    let mut headings = vec!["source".to_owned()];
    headings.extend(times.iter().map(|t| moment(*t)));
    headings.extend(["horizontal / m".to_owned(), "down / m".to_owned()]);
    let mut table = Table { headings, rows: Vec::new() };
    let Some(last) = answer.report.last().copied() else { return table };
    let mut parts: Vec<&Part> = answer.parts().collect();
    parts.sort_by(|a, b| b.horizontal_m2(last).total_cmp(&a.horizontal_m2(last)));
    for part in parts {
        let mut row = vec![part.cause.name().to_owned()];
        row.extend(answer.report.iter().map(|k| percent(answer.fraction(part, *k))));
        row.extend([part.horizontal_m2(last).sqrt(), part.down_m(last)].map(|m| significant(m, 3)));
        table.row(row);
    }
    table
}

/// Returns whether the ensemble is what the linear model says, and what that model leaves out.
pub fn findings(answer: &Answer) -> Vec<String> {
    let mut all: Vec<String> = answer.notes.iter().map(|note| format!("Note: {note}.")).collect();
    let worst = answer.apart.iter().max_by(|a, b| a.times.total_cmp(&b.times));
    if let Some(apart) = worst {
        let (unit, per) = unit(apart.quantity);
        let at = answer.ensemble.time_s.iter().position(|time_s| *time_s == apart.time_s).unwrap_or_default();
        let rms = |part: &Part| part.mean_square(at, apart.quantity.place()).sqrt() / per;
        let worst = answer.simulated.iter().max_by(|a, b| rms(a).total_cmp(&rms(b)));
        let cause = match worst {
            None => "the errors are no longer small".to_owned(),
            Some(part) => format!(
                "the errors are no longer small, or what the linear model leaves out matters, most of it {} \
                 ({} {unit})",
                part.cause.name(),
                significant(rms(part), 3),
            ),
        };
        let what = match apart.departure {
            Departure::Spread { ratio, standard_errors } => format!(
                "the standard deviation of the {} is {} times the linear one ({} standard errors)",
                quantity_name(apart.quantity),
                significant(ratio, 4),
                significant(standard_errors, 2),
            ),
            Departure::Mean { ensemble, model } => format!(
                "the mean of the {} is {} {unit} and the linear one {} {unit}",
                quantity_name(apart.quantity),
                significant(ensemble / per, 3),
                significant(model / per, 3),
            ),
        };
        all.push(format!(
            "The ensemble departs from the linear model: after {} {what}, so {cause}. The ensemble is the answer; the \
             error budget is the linear model's, with what that leaves out simulated.",
            duration(apart.time_s),
        ));
    }
    if answer.covariance.left_out.contains(&Cause::Vibration) {
        all.push(
            "One draw of the vibration shakes every member: what it moves the mean by is another with another seed."
                .into(),
        );
    }
    let failed = answer.ensemble.failed;
    if failed > 0 {
        all.push(format!(
            "{failed} of {} members failed, for their errors left the range of numbers, and are in none of these figures: \
             the survivors err by less than all would.",
            answer.ensemble.members
        ));
    }
    all
}

/// Unit in which a quantity is printed, and how many SI units it has.
fn unit(quantity: Quantity) -> (&'static str, f64) {
    match quantity {
        Quantity::Velocity(_) => ("m/s", 1.0),
        Quantity::Attitude(_) => ("°", DEGREE),
        _ => ("m", 1.0),
    }
}

fn quantity_name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Position(0) => "position error north",
        Quantity::Position(1) => "position error east",
        Quantity::Position(_) => "position error down",
        Quantity::Velocity(0) => "velocity error north",
        Quantity::Velocity(1) => "velocity error east",
        Quantity::Velocity(_) => "velocity error down",
        Quantity::Attitude(0) => "roll error",
        Quantity::Attitude(1) => "pitch error",
        Quantity::Attitude(_) => "heading error",
        Quantity::Horizontal => "horizontal distance",
        Quantity::Spherical => "distance",
        Quantity::NorthPlusEast => "north plus east error",
    }
}

fn provenance(study: &Study, answer: &Answer) -> Table {
    let (ensemble, machine) = (&answer.ensemble, &answer.ensemble.machine);
    let rate = ensemble.member_steps as f64 / ensemble.seconds.max(1e-9);
    let mut table = Table::new(&["what", "value"]);
    for (what, value) in [
        ("version", format!("proofmass {}", env!("CARGO_PKG_VERSION"))),
        ("seed", study.seed.to_string()),
        ("members", format!("{} ({} failed and left out)", ensemble.members, ensemble.failed)),
        ("run", format!("{} s in steps of {} s", study.duration_s(), study.clock.step_s)),
        ("backend", format!("{}: {}, {}", machine.kind, machine.name, machine.driver)),
        ("precision", machine.precision.clone()),
        ("integrator of the proof mass", machine.integrator.clone()),
        ("speed", format!("{} million member-steps/s", significant(rate / 1e6, 3))),
    ] {
        table.row([what.to_owned(), value]);
    }
    table
}

/// The sensor that the recorded flight justifies, as a file; none where there is no such flight.
pub fn inflated_toml(study: &Study, answer: &Answer) -> Option<String> {
    answer.compared.as_ref().and_then(|compared| windows::inflated_toml(study, compared))
}

/// Writes the answer for a terminal.
pub fn terminal(answer: &Answer) -> String {
    let (ensemble, machine) = (&answer.ensemble, &answer.ensemble.machine);
    let flown: String = match &answer.compared {
        Some(compared) => {
            let lines: String = windows::sentences(compared).iter().map(|line| format!("{line}\n")).collect();
            let found: String = compared.findings.iter().map(|f| format!("Note: {f}\n")).collect();
            format!("recorded flight\n{lines}{found}\n")
        }
        None => String::new(),
    };
    let outages = match answer.outages.is_empty() {
        true => String::new(),
        false => format!("GNSS outages: errors at their end\n{}\n", outages::table(answer)),
    };
    let findings: String = findings(answer).iter().map(|sentence| format!("{sentence}\n\n")).collect();
    format!(
        "{}\n\n{flown}{outages}position error\n{}\nvelocity and attitude error\n{}\nerror budget: fraction of the mean square \
        horizontal error; rms alone at the end\n{}\n{findings}integrator: {}\nbackend:    {} ({}, {}), {} for {} \
        million member-steps\n",
        lede(answer),
        position_table(answer),
        attitude_table(answer),
        budget_table(answer),
        machine.integrator,
        machine.name,
        machine.kind,
        machine.precision,
        duration(ensemble.seconds),
        significant(ensemble.member_steps as f64 / 1e6, 3),
    )
}
