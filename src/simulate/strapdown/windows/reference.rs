//! The attitude error of the reference, from the flight that it is the reference of: an error of a
//! sensor goes with it from flight to flight, one of a laser tracker does not go into a room with
//! motion capture. The sensor's coefficients are those of other flights; this one is of windows
//! that share no time with the one it is used in.

use super::finding::Finding;
use super::inflation::{CAUSES, Cause, DROP, FEWEST, Inflation, Whose, likelihood};
use super::length::{Length, Seen};

/// Adds the inflated sensor to every length. Where it is of other flights, the attitude error of
/// the reference is still this flight's.
pub(super) fn lay(mut inflation: Inflation, lengths: &mut [Length], found: &mut Vec<Finding>) -> Inflation {
    let squares = inflation.coefficients.map(|c| c * c);
    let reference = (inflation.whose != Whose::Own).then(|| Reference::new(&lengths[0].seen(), &squares));
    for length in lengths {
        let mut without = 0;
        let one = |seen: Seen| {
            let attitude = reference.as_ref().map(|reference| reference.outside(seen.span_s));
            without += usize::from(attitude == Some(None));
            let squares = attitude.flatten().map_or(squares, |own| with(&squares, own.value_rad));
            seen.end.1.expected(&squares)
        };
        let expected = length.seen().into_iter().map(one).collect();
        length.expected.push(expected);
        if without > 0 {
            found.push(Finding::ReferenceOfOthers { seconds: length.seconds, windows: without });
        }
    }
    if let Some(own) = reference.and_then(|reference| reference.everywhere()) {
        for place in (0..CAUSES.len()).filter(|place| CAUSES[*place] == Cause::Attitude) {
            (inflation.coefficients[place], inflation.interval[place]) = (own.value_rad, own.ci95_rad);
        }
        inflation.whose = Whose::OwnReference { windows: own.windows };
    }
    inflation
}

/// Attitude errors that are tried, rad: from the least to the largest, each by this factor more.
const LEAST_RAD: f64 = 1e-5;
const LARGEST_RAD: f64 = 1.0;
const FACTOR: f64 = 1.05;

/// Likelihood of each window under each attitude error of the reference.
struct Reference {
    /// Attitude errors that are tried, rad; the first is none.
    tried_rad: Vec<f64>,
    /// Per window, its time and the logarithm of its likelihood at each of them.
    windows: Vec<([f64; 2], Vec<f64>)>,
}

/// An attitude error of the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Attitude {
    /// The most likely one, rad about each axis.
    value_rad: f64,
    /// Its 95 % interval by the likelihood, the other causes as given.
    ci95_rad: [f64; 2],
    /// Windows that it is fitted on.
    windows: usize,
}

impl Reference {
    /// Of windows that do not overlap, the squared coefficients of the other causes as given.
    fn new(windows: &[Seen], squares: &[f64; CAUSES.len()]) -> Self {
        let mut tried_rad = vec![0.0];
        let mut next = LEAST_RAD;
        while next < LARGEST_RAD {
            tried_rad.push(next);
            next *= FACTOR;
        }
        let at = |seen: &Seen, rad: f64| likelihood(&[seen.end], &with(squares, rad));
        let curve = |seen: &Seen| (seen.span_s, tried_rad.iter().map(|rad| at(seen, *rad)).collect());
        let windows = windows.iter().map(curve).collect();
        Self { tried_rad, windows }
    }

    /// Returns the estimate of the windows outside this time; `None` where they are too few.
    fn outside(&self, span_s: [f64; 2]) -> Option<Attitude> {
        let meets = |[from, to]: [f64; 2]| from < span_s[1] && span_s[0] < to;
        self.of(|span| !meets(span))
    }

    /// Returns the estimate of all windows; `None` where they are too few.
    fn everywhere(&self) -> Option<Attitude> {
        self.of(|_| true)
    }

    fn of(&self, counts: impl Fn([f64; 2]) -> bool) -> Option<Attitude> {
        let mut sum = vec![0.0; self.tried_rad.len()];
        let mut windows = 0;
        for (_, curve) in self.windows.iter().filter(|(span, _)| counts(*span)) {
            windows += 1;
            sum.iter_mut().zip(curve).for_each(|(sum, one)| *sum += one);
        }
        if windows < FEWEST {
            return None;
        }
        let best = (0..sum.len()).max_by(|a, b| sum[*a].total_cmp(&sum[*b]))?;
        let holds = |place: &usize| sum[*place] > sum[best] - DROP;
        let (low, high) = ((0..best).find(holds).unwrap_or(best), (best..sum.len()).rev().find(holds).unwrap_or(best));
        // The ends lie between two that were tried: of them, the outer ones.
        let most_rad = self.tried_rad.get(high + 1).copied().unwrap_or(f64::INFINITY);
        Some(Attitude {
            value_rad: self.tried_rad[best],
            ci95_rad: [self.tried_rad[low.saturating_sub(1)], most_rad],
            windows,
        })
    }
}

/// Squared coefficients with this attitude error of the reference.
fn with(squares: &[f64; CAUSES.len()], rad: f64) -> [f64; CAUSES.len()] {
    std::array::from_fn(|place| if CAUSES[place] == Cause::Attitude { rad * rad } else { squares[place] })
}
