//! The page on the random walk: whether real gyros and accelerometers have one, axis by axis, and
//! what the length of a log can tell of it.

use super::numbers::{coefficient, estimate};
use super::origin;
use super::walk_sentences::{doubt, name, sentences};
use crate::recording_atlas::measured::Quantity;
use crate::recording_atlas::recipe::Temperature;
use crate::recording_atlas::walk::{Answer, Line, strongest};
use proofmass_base::number::{duration, significant};
use proofmass_report::table::Table;

/// Returns the page; `command` is what made it.
pub fn page(lines: &[Line], command: &str) -> String {
    let gyros = Quantity::Gyro;
    let accelerometers = Quantity::Accelerometer;
    format!(
        "# Is there a random walk in real MEMS gyros?\n\n{}\n\n{HOW}\n\n{}\n## Accelerometers\n\n{}\n\n{}\n\
         ## What the length of a log can tell\n\n{LENGTH}\n\n{}\n{}",
        sentences(lines, gyros),
        table(lines, gyros).to_markdown(),
        sentences(lines, accelerometers),
        table(lines, accelerometers).to_markdown(),
        lengths(lines).to_markdown(),
        origin(command)
    )
}

const HOW: &str = "K is the random walk of the bias (IEEE 952: rate random walk of a gyro, acceleration random walk of an \
    accelerometer) by `proofmass allan`, which fits quantisation, white noise, flicker B, walk K and ramp R to the Allan \
    deviation together: an estimate with its 95 % interval, or “<” and an upper limit (95 %) where the interval begins at \
    zero. K in °/h/√h is also the bias in °/h that a walk gathers in an hour (one standard deviation); K in µg/√s gathers \
    60 times that in µg. Simulators and Kalibr take K in rad/s²/√Hz: 1 °/h/√h is 8.08×10⁻⁸ of them. The second witness is \
    `proofmass diagnose`, which also knows temperature, warm-up, Gauss–Markov processes and jumps. An axis has a walk \
    (“yes”) where both say so and nothing else fits as well. It cannot tell where its limit lies above the strongest walk \
    of the table.";

const LENGTH: &str = "A walk of coefficient K makes an Allan deviation of K √(τ/3), and averaging times τ end at a third of \
    the log. The walk shows where that rises above white noise, N/√τ, and flicker, 0.664 B. So twice the length shows half \
    the K above white noise, and 1/√2 of it above flicker. Every log is one draw of its walk, of one unit: an interval says \
    what the sensor did in this log, not what others of its part will do.";

fn table(lines: &[Line], quantity: Quantity) -> Table {
    let mut table = Table::new(&["recording", "axis", "length", "K", "has a walk", "`diagnose` names", "B", "R"]);
    for line in lines.iter().filter(|l| l.quantity == quantity) {
        table.row([
            format!("[{}]({}.md)", line.recording, line.page),
            line.axis.clone(),
            duration(line.length_s),
            coefficient(&line.walk),
            answer(&line.answer),
            named(line),
            coefficient(&line.flicker),
            coefficient(&line.ramp),
        ]);
    }
    table
}

/// The answer of an axis in a few words.
fn answer(answer: &Answer) -> String {
    match answer {
        Answer::Shown => "yes".into(),
        Answer::Perhaps(_) => format!("perhaps: {}", doubt(answer).unwrap_or_default()),
        Answer::NoneSeen => "none seen".into(),
        Answer::CannotTell => "cannot tell".into(),
        Answer::BiasRemoved => "cannot tell: bias taken off".into(),
    }
}

fn named(line: &Line) -> String {
    let walk = line.named.map(|[k, low, high]| format!("random-walk, K = {}", estimate(k, [low, high])));
    let all: Vec<String> = walk.into_iter().chain(line.others.iter().cloned()).collect();
    if all.is_empty() { "–".into() } else { all.join(", ") }
}

/// One row a log and quantity: the strongest walk that it leaves possible.
fn lengths(lines: &[Line]) -> Table {
    let headings = ["axes", "recording", "length", "longest τ", "temperature", "largest K that it leaves possible"];
    let mut table = Table::new(&headings);
    for quantity in [Quantity::Gyro, Quantity::Accelerometer] {
        let of: Vec<&Line> = lines.iter().filter(|l| l.quantity == quantity).collect();
        let mut done: Vec<&str> = Vec::new();
        for line in &of {
            if done.contains(&line.recording.as_str()) {
                continue;
            }
            done.push(&line.recording);
            let same = of.iter().filter(|l| l.recording == line.recording);
            let highest = same.clone().map(|l| l.walk.ci95[1]).fold(0.0, f64::max);
            let removed = same.clone().any(|l| l.answer == Answer::BiasRemoved);
            let limit = format!("{} {}", significant(highest, 2), line.walk.unit);
            table.row([
                format!("{}s", name(quantity)),
                line.recording.clone(),
                duration(line.length_s),
                duration(line.longest_s),
                temperature(line.temperature).to_owned(),
                if removed { format!("{limit} in the log; any in the sensor") } else { limit },
            ]);
        }
        if let Some(line) = strongest(lines, quantity) {
            let walk = coefficient(&line.walk);
            let cells =
                [format!("{}s", name(quantity)), format!("strongest walk: `{}` of {}", line.axis, line.recording)];
            let rest = [duration(line.length_s), duration(line.longest_s), temperature(line.temperature).into(), walk];
            table.row(cells.into_iter().chain(rest));
        }
    }
    table
}

fn temperature(record: Temperature) -> &'static str {
    match record {
        Temperature::NotLogged => "not logged",
        Temperature::Withheld => "logged, withheld",
    }
}
