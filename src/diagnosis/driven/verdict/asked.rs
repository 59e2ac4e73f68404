//! States the question that a diagnosis answers: recordings and model.

use crate::driven::intake::several::Piece;
use crate::model;
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
