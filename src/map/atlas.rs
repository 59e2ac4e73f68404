//! What a map.toml asks for, computed.

use super::diagram::Bifurcation;
use super::document::Document;
use super::grid::Grid;

/// A computed document.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// What was asked.
    pub document: Document,
    /// One per `[[map]]`.
    pub grids: Vec<Grid>,
    /// One per `[[bifurcation]]`.
    pub diagrams: Vec<Bifurcation>,
}
