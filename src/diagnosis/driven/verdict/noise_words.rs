//! Writes from what the noise was measured, as a clause.

use crate::driven::intake::reading_noise::How;
use crate::number::short;

/// Writes a clause that follows "measured from".
pub(crate) fn how(how: How) -> String {
    match how {
        How::Periods { count, samples } => {
            format!("scatter between {count} periods of the input, of {samples} samples")
        }
        How::Still { samples } => format!("scatter about a line over {samples} samples in which nothing moves"),
        How::Differences { order } => format!("differences of order {order}"),
        How::Spectrum { from_hz, to_hz } => {
            format!("the quietest band of the spectrum, {} to {} Hz", short(from_hz), short(to_hz))
        }
        How::Rounding => "the step in which readings come".to_owned(),
    }
}
