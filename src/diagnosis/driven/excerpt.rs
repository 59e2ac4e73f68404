//! A recording too long to be fitted at once: its loudest stretch stands for the whole, and that is said.
//!
//! A model's errors and their derivatives are held in memory, some kilobytes per sample; and what half a million samples
//! cannot show, more of the same will hardly show. Not for ranges that a model file names: those are its reader's choice.

use std::ops::Range;

use crate::diagnosis::model;
use crate::recording::{Column, Recording};

use super::start::spread;

/// Most samples that are fitted at once.
const LONGEST: usize = 500_000;
/// Places of the stretch that are compared.
const PLACES: usize = 32;

/// The loudest stretch as a recording of its own; `None` where the recording can be used whole.
pub fn excerpt(recording: &Recording, model: &model::Driven) -> Option<Recording> {
    let samples = recording.samples();
    let chosen = model.split.train.is_empty() && model.split.test.is_empty();
    if samples <= LONGEST || !chosen {
        return None;
    }
    let reading = recording.column(&model.columns.output)?;
    let windows = (0..PLACES).map(|i| (samples - LONGEST) * i / (PLACES - 1)).map(|a| a..a + LONGEST);
    let power = |r: &Range<usize>| spread(&reading[r.clone()]).1;
    let range = windows.max_by(|a, b| power(a).total_cmp(&power(b)))?;
    let columns = recording
        .columns
        .iter()
        .map(|c| Column { name: c.name.clone(), values: c.values[range.clone()].to_vec() })
        .collect();
    let filled = recording
        .filled
        .iter()
        .map(|f| f.start.max(range.start)..f.end.min(range.end))
        .filter(|f| f.start < f.end)
        .map(|f| f.start - range.start..f.end - range.start)
        .collect();
    let mut findings = recording.findings.clone();
    findings.push(format!(
        "of {samples} samples the loudest {LONGEST} in a row were judged, from sample {}; samples and times count from there",
        range.start
    ));
    let (path, sha256) = (recording.path.clone(), recording.sha256.clone());
    Some(Recording { path, sha256, rate_hz: recording.rate_hz, columns, findings, filled })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loud_end_of_a_long_recording_is_taken_and_a_short_one_left_whole() {
        let driven = |text: &str| match toml::from_str::<model::Driven>(text) {
            Ok(model) => model,
            Err(error) => unreachable!("{error}"),
        };
        let plain = driven("rate_hz = 1.0\n[columns]\noutput = 'y'\n");
        let split = driven("rate_hz = 1.0\n[columns]\noutput = 'y'\n[split]\ntrain = [[0, 9]]\n");
        let recording = |samples: usize| Recording {
            path: "y.csv".into(),
            sha256: String::new(),
            rate_hz: 1.0,
            columns: vec![Column {
                name: "y".into(),
                values: (0..samples).map(|k| ((k * k) % 977) as f64 * k as f64).collect(),
            }],
            findings: Vec::new(),
            filled: vec![0..3, samples - 4..samples - 1],
        };
        assert_eq!(excerpt(&recording(LONGEST), &plain), None);
        assert_eq!(excerpt(&recording(3 * LONGEST), &split), None);
        let long = recording(3 * LONGEST);
        let part = excerpt(&long, &plain).unwrap_or_else(|| long.clone());
        assert_eq!(part.columns[0].values, long.columns[0].values[2 * LONGEST..]);
        assert_eq!(part.filled, vec![LONGEST - 4..LONGEST - 1]);
        assert!(part.findings[0].contains("from sample 1000000"), "{:?}", part.findings);
    }
}
