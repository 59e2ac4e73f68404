//! What is asked of a diagnosis.

use crate::diagnosis::driven::intake::several::Piece;
use crate::diagnosis::model;
use crate::numerics::moments::mean_sd;
use crate::recording::Recording;

/// The recordings and the model that are to be diagnosed.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The first recording; its hash and columns stand in the verdict.
    pub recording: &'a Recording,
    /// Range and role of each recording in the data.
    pub pieces: &'a [Piece],
    /// Samples that the model file names as judging.
    pub judging: &'a [[usize; 2]],
    /// Columns of input, output and environment.
    pub columns: &'a model::DrivenColumns,
    /// Unit of the output, where the model file states it.
    pub unit: Option<&'a str>,
}

impl<'a> Asked<'a> {
    /// Headings and values of the environment columns that laws may follow, in the first recording: one
    /// that stays as it is was left out.
    pub fn environment(&self) -> impl Iterator<Item = (&'a str, &'a [f64])> {
        let recording = self.recording;
        let all = self.columns.environment.iter();
        let logged = all.filter_map(move |name| Some((name.as_str(), recording.column(name)?)));
        logged.filter(|(_, values)| mean_sd(values).1 > 0.0)
    }
}
