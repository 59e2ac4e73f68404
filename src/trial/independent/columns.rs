//! States how a recording is written: units, signs, headings, order of columns, every k-th row.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::draw::Draw;

/// Units and headings of a driven recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Columns {
    /// Column units per internal displacement, with its sign.
    pub output_scale: f64,
    /// Column units per internal input, with its sign.
    pub input_scale: f64,
    /// Offset of the reading, column units.
    pub offset: f64,
    /// Step of the reading, column units; zero when written in full. The base model of a null
    /// rounds finely.
    pub step: f64,
    /// Headings of input, reading, environment.
    pub headings: [String; 3],
    /// States whether the reading stands before the input.
    pub swapped: bool,
    /// Only every so many-th row is written.
    pub every: usize,
}

const OUTPUTS: [&str; 8] = ["reading", "V2_V", "acc_m_s2", "x_m", "ax [g]", "counts", "ch 2", "Auslenkung_µm"];
const INPUTS: [&str; 8] = ["force", "V1_V", "ref_m_s2", "drive", "input [V]", "u", "ch 1", "Anregung"];

impl Columns {
    /// Draws units and names. The reading spans about one internal unit.
    pub fn draw(draw: &mut Draw) -> Self {
        let which = draw.below(OUTPUTS.len());
        let size = match which {
            1 => draw.log_between(0.01, 3.0),
            2 => draw.log_between(0.05, 50.0),
            3 => draw.log_between(1e-9, 1e-5),
            4 => draw.log_between(0.01, 8.0),
            5 => draw.log_between(3e3, 3e5),
            7 => draw.log_between(0.01, 10.0),
            _ => draw.log_between(0.1, 10.0),
        };
        Self {
            output_scale: size * draw.sign(),
            input_scale: draw.log_between(0.01, 100.0) * draw.sign(),
            offset: if draw.chance(0.6) { size * draw.between(-3.0, 3.0) } else { 0.0 },
            step: if which == 5 { 1.0 } else { 0.0 },
            headings: [INPUTS[draw.below(INPUTS.len())].into(), OUTPUTS[which].into(), "temp_C".into()],
            swapped: draw.chance(0.4),
            every: 1,
        }
    }

    /// Texts of recording.csv and model.toml.
    pub fn driven(
        &self,
        input: &[f64],
        reading: &[f64],
        environment: Option<&[f64]>,
        rate_hz: f64,
        hints: Option<[f64; 2]>,
    ) -> [String; 2] {
        let every = self.every.max(1);
        let keep = |values: &[f64]| -> Vec<f64> { values.iter().step_by(every).copied().collect() };
        let reading: Vec<f64> = keep(reading)
            .iter()
            .map(|y| {
                let value = self.output_scale * y + self.offset;
                if self.step > 0.0 { self.step * (value / self.step).round() } else { value }
            })
            .collect();
        let input: Vec<f64> = keep(input).iter().map(|u| self.input_scale * u).collect();
        let mut columns: Vec<(&str, &[f64])> = vec![(&self.headings[1], &reading)];
        let mut model = format!("kind = \"driven\"\nrate_hz = {}\n[columns]\n", rate_hz / every as f64);
        if !input.is_empty() {
            columns.push((&self.headings[0], &input));
            let _ = writeln!(model, "input = {:?}", self.headings[0]);
        }
        if !self.swapped {
            columns.reverse();
        }
        let _ = writeln!(model, "output = {:?}", self.headings[1]);
        let environment = environment.map(keep);
        if let Some(environment) = &environment {
            columns.push((&self.headings[2], environment));
            let _ = writeln!(model, "environment = [{:?}]", self.headings[2]);
        }
        if let Some([resonance_hz, damping_ratio]) = hints {
            let _ = write!(model, "[start]\nresonance_hz = {resonance_hz:e}\ndamping_ratio = {damping_ratio:e}\n");
        }
        [table(&columns), model]
    }
}

/// Columns under their headings.
pub fn table(columns: &[(&str, &[f64])]) -> String {
    let headings: Vec<&str> = columns.iter().map(|c| c.0).collect();
    let mut text = headings.join(",") + "\n";
    for row in 0..columns.first().map_or(0, |c| c.1.len()) {
        for (c, (_, values)) in columns.iter().enumerate() {
            let comma = if c > 0 { "," } else { "" };
            let value = values[row];
            let _ = match value == value.round() && value.abs() < 1e9 {
                true => write!(text, "{comma}{}", value + 0.0),
                false => write!(text, "{comma}{value:.9e}"),
            };
        }
        text.push('\n');
    }
    text
}
