//! The parts of the ensemble shader that follow from the table of sensor terms.
//!
//! `shaders/simulate.wgsl` has lines `#terms WHERE`; each is replaced by what the law of every term
//! has to say there. The text of a law stands next to its CPU code, in `cpu::reading`, `cpu::force_errors`,
//! `cpu::slow` and `cpu::flicker`. Laws that act on the reading as a whole (constants, proportional
//! errors, rounding, full scale) are written in the shader itself.

use crate::cpu::reading;
use crate::fragment::Fragment;
use crate::layout::state;
use crate::member::{COLUMNS, column};
use crate::places::Places;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::{Sense, SensorTerm};

/// Name of a term in WGSL: VELOCITY_RANDOM_WALK.
pub fn name(term: SensorTerm) -> String {
    let mut name = String::new();
    for c in format!("{term:?}").chars() {
        if c.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.extend(c.to_uppercase());
    }
    name
}

/// Name of the switch that says whether some member has the term.
pub fn switch(term: SensorTerm) -> String {
    format!("HAS_{}", name(term))
}

/// Columns, states, streams and switches of all terms.
pub(super) fn declarations(places: &Places) -> String {
    let mut text = String::new();
    for term in SensorTerm::ALL {
        let name = name(term);
        text += &format!("const {name} = {}u;\noverride HAS_{name}: bool = false;\n", places.column(column::of(term)));
        // The first number of its shape.
        if column::of(term) + 1 < COLUMNS {
            text += &format!("const NEXT_TO_{name} = {}u;\n", places.column(column::of(term) + 1));
        }
        if let Some(stream) = term.law().stream() {
            text += &format!("const STREAM_{name} = {}u;\n", stream as u32);
        }
        let place = match term.law() {
            ErrorLaw::Walk(_) => format!("const STATE_{name} = {}u;\n", state::WALKS + term.rank()),
            ErrorLaw::Markov(_) => format!("const STATE_{name} = {}u;\n", state::MARKOVS + term.rank()),
            // Behind the phase and the step of the excitation.
            ErrorLaw::Sine => format!("const TURNS_{name} = {}u;\n", 2 + 2 * term.rank()),
            _ => String::new(),
        };
        text += &place;
    }
    for sense in [Sense::Accelerometer, Sense::Gyro] {
        let name = sense.name().to_uppercase();
        // A Gauss–Markov process draws for itself.
        let of_samples = |t: &SensorTerm| t.law().stream().is_some() && !matches!(t.law(), ErrorLaw::Markov(_));
        let drawn = SensorTerm::ALL.into_iter().filter(|t| t.sense() == sense && of_samples(t));
        let switches: Vec<String> = drawn.map(switch).collect();
        let stream = reading::sample_stream(sense) as u32;
        text += &format!("const STREAM_{name} = {stream}u;\n");
        text += &format!("fn draws_{}() -> bool {{\n    return {};\n}}\n", sense.name(), switches.join(" || "));
    }
    text
}

/// A shader's text with each line `#terms WHERE` replaced. An unknown WHERE stays, and no shader
/// with it compiles.
pub(crate) fn expand(text: &str) -> String {
    let mut out = String::with_capacity(2 * text.len());
    for line in text.lines() {
        let pick: fn(&Fragment) -> &'static str = match line.trim() {
            "#terms begin" => |f| f.begin,
            "#terms block" => |f| f.block,
            "#terms draw" => |f| f.draw,
            "#terms add accelerometer" | "#terms add gyro" => |f| f.add,
            "#terms end" => |f| f.end,
            _ => {
                out += line;
                out.push('\n');
                continue;
            }
        };
        let of_line = |term: &SensorTerm| match line.trim() {
            "#terms add accelerometer" => term.sense() == Sense::Accelerometer,
            "#terms add gyro" => term.sense() == Sense::Gyro,
            _ => true,
        };
        for term in SensorTerm::ALL.into_iter().filter(of_line) {
            if let Some(fragment) = reading::fragment(term.law()) {
                out += &named(pick(fragment), term);
            }
        }
    }
    out
}

fn named(text: &str, term: SensorTerm) -> String {
    let name = name(term);
    let out = match term.sense() {
        Sense::Accelerometer => "error",
        Sense::Gyro => "turn",
    };
    text.replace("$base", &base(term))
        .replace("$TERM", &name)
        .replace("$term", &name.to_lowercase())
        .replace("$out", out)
        .replace("$sense", term.sense().name())
}

/// Returns where the flicker terms of a sensor term begin: behind those of earlier sensor terms
/// that are switched on.
fn base(term: SensorTerm) -> String {
    let earlier = SensorTerm::ALL.into_iter().take(term as usize).filter(|t| matches!(t.law(), ErrorLaw::Flicker(_)));
    let sets = earlier.map(|t| format!(" + select(0u, tile.flicker_terms, {})", switch(t)));
    format!("STATE_TERMS{}", sets.collect::<String>())
}
