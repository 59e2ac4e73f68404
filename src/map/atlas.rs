//! States what a map.toml asks for, computed.

use super::diagram::Bifurcation;
use super::document::Document;
use super::grid::Grid;

/// A computed map.toml: its maps and bifurcation diagrams.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// The map.toml that it was computed from.
    pub document: Document,
    /// The maps, one per `[[map]]`.
    pub grids: Vec<Grid>,
    /// The bifurcation diagrams, one per `[[bifurcation]]`.
    pub diagrams: Vec<Bifurcation>,
}
