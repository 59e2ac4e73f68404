//! States what a kind of recording gives to the engine.

use std::ops::Range;

/// Parts of the rows: segments, each simulated from its own start, and blocks within them, each
/// left out in turn.
#[derive(Debug, Clone, Default)]
pub(crate) struct Layout {
    /// Rows of each segment.
    pub segments: Vec<Range<usize>>,
    /// Rows of each block.
    pub blocks: Vec<Range<usize>>,
    /// Segment of each block.
    pub owner: Vec<usize>,
    /// States whether a row counts: one that was not recorded, or is known to be wrong, does not.
    pub counts: Vec<bool>,
}

impl Layout {
    /// Blocks of about `rows` rows, at least three in each segment.
    pub(crate) fn new(segments: Vec<Range<usize>>, rows: usize, counts: Vec<bool>) -> Self {
        let (mut blocks, mut owner) = (Vec::new(), Vec::new());
        for (s, segment) in segments.iter().enumerate() {
            let count = (segment.len() / rows.max(1)).max(3).min(segment.len());
            blocks.extend(
                (0..count).map(|b| {
                    segment.start + segment.len() * b / count..segment.start + segment.len() * (b + 1) / count
                }),
            );
            owner.resize(blocks.len(), s);
        }
        Self { segments, blocks, owner, counts }
    }

    /// Number of rows that count in a range.
    pub(crate) fn counted(&self, rows: &Range<usize>) -> usize {
        self.counts[rows.clone()].iter().filter(|c| **c).count()
    }

    /// Number of rows that count in all segments.
    pub(crate) fn rows(&self) -> usize {
        self.segments.iter().map(|s| self.counted(s)).sum()
    }
}

/// Quantity that a missing effect depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Argument {
    /// Displacement of the mass.
    Displacement,
    /// Velocity of the mass.
    Velocity,
    /// Displacement and velocity together.
    Both,
    /// Path taken: displacement with a memory.
    Path,
    /// The measured input.
    Input,
    /// Time since the motion began.
    Time,
    /// A recorded environment column.
    Environment,
    /// The reading itself.
    Readout,
    /// Frequency: linear dynamics next to the base model's, or a line.
    Frequency,
    /// A further mode.
    Motion,
    /// A second frequency, which may be a harmonic of the first.
    Line,
    /// Time, periodically.
    Rhythm,
}

impl Argument {
    /// Returns whether what depends on one may depend on the other: both are displacement, or velocity, in part.
    pub(crate) fn overlaps(self, other: Self) -> bool {
        let parts = |argument: Self| match argument {
            Self::Both | Self::Path => [Self::Displacement, Self::Velocity],
            one => [one, one],
        };
        parts(self).iter().any(|part| parts(other).contains(part))
    }

    /// The word for it in public documents.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Both => "displacement and velocity",
            Self::Path => "the path taken",
            Self::Input => "input",
            Self::Time | Self::Rhythm => "time",
            Self::Environment => "environment",
            Self::Readout => "reading",
            Self::Frequency => "frequency",
            Self::Motion | Self::Line => "a second frequency",
        }
    }
}

/// Use of a law in the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// The form that its name states.
    Stated,
    /// With an exponent or a shape that is fitted: named only in the place of a stated law of its
    /// argument that it betters.
    Exponent,
    /// Visible only next to a stated law of the same argument: tried there, as an alternative to a fitted
    /// exponent.
    Beside,
    /// With its shape free: it shows on what the residual depends and is never named.
    Free,
}

/// Coordinates of a model: those that all segments share, and where each segment begins.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point {
    /// Base model, then law by law.
    pub shared: Vec<f64>,
    /// Per segment.
    pub starts: Vec<Vec<f64>>,
}

/// A model's residual with its derivatives by all coordinates, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Linearised {
    /// Reading less prediction.
    pub residual: Vec<f64>,
    /// Derivatives of the prediction by each shared coordinate.
    pub shared: Vec<Vec<f64>>,
    /// Derivatives by each start coordinate of the row's own segment.
    pub starts: Vec<Vec<f64>>,
}

/// A set of laws, by their places in the space, in order of addition.
pub(crate) type Set = Vec<usize>;

/// Recordings of one kind, as the engine sees them.
pub(crate) trait Kind: Sync {
    /// Rows, segments and blocks.
    fn layout(&self) -> &Layout;
    /// Number of laws in the space.
    fn laws(&self) -> usize;
    /// Quantity that a law depends on.
    fn argument(&self, law: usize) -> Argument;
    /// Use of a law in the search.
    fn form(&self, law: usize) -> Form;
    /// Laws of the same public name, or of which one is a special case of the other: not together
    /// in one set.
    fn excludes(&self, law: usize, other: usize) -> bool;
    /// Rewrites the law at `place` as `law`, which equals it at one value of its exponent: the same model, with
    /// `law` last in the set. `None` where `law` never equals it, or where the kind has no such pair.
    fn widened(&self, _set: &[usize], _point: &Point, _place: usize, _law: usize) -> Option<Point> {
        None
    }
    /// Points at which a law joins a fitted set; empty where it cannot.
    fn joined(&self, set: &[usize], point: &Point, law: usize) -> Vec<Point>;
    /// The point with the last law of the set so many times as strong; `None` where it cannot be.
    fn strengthened(&self, set: &[usize], point: &Point, factor: f64) -> Option<Point>;
    /// The point without the law at a place of the set.
    fn without(&self, set: &[usize], point: &Point, place: usize) -> Point;
    /// Residuals at several points; `None` where the model breaks down.
    fn residuals(&self, set: &[usize], points: &[Point]) -> Vec<Option<Vec<f64>>>;
    /// Residual with its derivatives; `None` where the model breaks down.
    fn linearise(&self, set: &[usize], point: &Point) -> Option<Linearised>;
    /// Returns whether two laws are one, of which a set may hold several: neither is a rival of the other.
    fn are_alike(&self, _law: usize, _other: usize) -> bool {
        false
    }
    /// Returns whether the 95 % interval of a law's exponent contains an odd whole number, as a smooth symmetric
    /// force has: then it is one term of a series by itself, and needs no further one.
    fn may_be_whole(&self, _set: &[usize], _place: usize, _point: &Point, _deviations: &[f64]) -> bool {
        false
    }
    /// Moves a point into the allowed region.
    fn confine(&self, set: &[usize], point: &mut Point);
    /// Which shared coordinates are on a bound.
    fn at_bound(&self, set: &[usize], point: &Point) -> Vec<bool>;
    /// Shared coordinates of the law at a place of the set.
    fn coordinates(&self, set: &[usize], place: usize) -> Range<usize>;
    /// Those of them that are zero where the law does nothing.
    fn strengths(&self, set: &[usize], place: usize) -> Vec<usize>;
}
