//! The WGSL of one law of reading errors, in the places that the ensemble shader has for it.
//!
//! It stands next to the law's CPU code, in `cpu::reading` and `cpu::flicker`; `source` puts it
//! together.

/// WGSL of one law. In it, `$TERM` and `$term` stand for the term's name, `$out` for the error it
/// is added to, `$sense` for the instrument and `$base` for where its flicker terms begin.
pub struct Fragment {
    /// Before the samples: coefficients and state.
    pub begin: &'static str,
    /// Before each sixteen samples.
    pub block: &'static str,
    /// Before each four samples that share a counter.
    pub draw: &'static str,
    /// WGSL that is inserted at each sample.
    pub add: &'static str,
    /// After the samples: state for the next tile.
    pub end: &'static str,
}
