//! Times as a page writes them.

use proofmass_base::number::duration;

/// A time as it was written in the study, without the noise of its arithmetic.
pub(crate) fn plain(time_s: f64) -> String {
    format!("{}", (time_s * 1e6).round() / 1e6)
}

/// A time in words, "60 s" and not "60.0 s".
pub(crate) fn moment(time_s: f64) -> String {
    if (1.0..120.0).contains(&time_s) { format!("{} s", plain(time_s)) } else { duration(time_s) }
}
