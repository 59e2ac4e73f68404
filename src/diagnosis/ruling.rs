//! From evidence to one of the four verdicts: a pure function, the same for every kind of
//! recording.
//!
//! What the verdicts mean: `adequate`, nothing is missing that this recording could show;
//! `explained`, named effects bring the residual to the noise; `unexplained`, the mismatch is real
//! and no candidate, alone or together with others, accounts for it; `undecidable`, two or more
//! candidates fit equally, or the excitation is too weak. The order in which the questions are
//! asked follows from that:
//!
//! 1. *Is the base model determined?* If the recording cannot even fix the base model's own
//!    parameters, no candidate could be judged next to them. That nothing in the library accounts
//!    for the mismatch cannot be said then: `undecidable`.
//! 2. *Do the named effects account for the mismatch?* If what is left is real, no candidate does,
//!    alone or together: `unexplained`. This comes **before** ties. Two indistinguishable
//!    candidates that both leave more than noise fit equally badly; `undecidable` would claim that the truth is one of
//!    them and send the reader to an experiment that parts two candidates of which neither is
//!    right. Effects that hold in spite of the residual keep their names.
//! 3. *Is one of them indistinguishable?* Now the candidates do fit, and equally: `undecidable`.
//! 4. Otherwise `explained`; and where nothing is named and nothing is left, `adequate`.
//!
//! Something faint without a name is a recording too weak to decide, not a failure of the library:
//! `undecidable`. Silence counts as `adequate` only where an effect of some size would have been
//! seen.
//!
//! Not for deciding which effects hold: that is the kind's selection. Not for what counts as a real
//! mismatch: see `remainder`. Not for words: see `report::diagnosis`.

use super::remainder::Size;
use super::verdict::Outcome;

/// Facts that a verdict is decided by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// States whether the recording determines the parameters of the base model.
    pub base_determined: bool,
    /// States whether the recording follows the base model at all.
    pub base_follows: bool,
    /// States whether any effect, of any size, would have been seen.
    pub has_power: bool,
    /// Number of effects that hold.
    pub named: usize,
    /// States whether the form of one of them is not the stated one.
    pub departs: bool,
    /// Effects among them in whose place another candidate does as well.
    pub tied: usize,
    /// States whether terms that look alike, or too many to be told apart, do the work of something
    /// that the library lacks.
    pub stand_ins: bool,
    /// Relative fall of the error's variance by terms that earned no name.
    pub nameless: f64,
    /// Size of the structure that the final model leaves.
    pub remainder: Size,
    /// Fraction of the base model's held-out error variance that is gone with the named effects;
    /// zero where unknown.
    pub removed: f64,
    /// Part of what all effects remove of that error that those without a name remove.
    pub carried: f64,
    /// States whether a model with a named law errs more on held-out data than the base model.
    pub predicts_worse: bool,
    /// Root-mean-square error on held-out data with the named effects over that of the base model,
    /// the lower end of its 95 % interval; 1 where it is not known.
    pub held_out_ratio: f64,
    /// States whether the search ended by itself, not because its budget was spent.
    pub search_complete: bool,
}

/// Variance that terms without a name may remove while the base model still counts as adequate.
const NAMELESS: f64 = 0.05;
/// A model whose held-out error is larger by this factor than the base model's, beyond chance,
/// explains nothing. Noise terms weigh the samples differently and may raise the error of free
/// simulation by a few per cent.
const WORSE: f64 = 1.05;
/// Fraction of the held-out error that must be gone before a structured residual counts as a
/// detail, and of what goes that must have a name.
const NEARLY_ALL: f64 = 0.99;

impl Default for Evidence {
    /// Nothing is named and nothing is left.
    fn default() -> Self {
        Self {
            base_determined: true,
            base_follows: true,
            has_power: true,
            named: 0,
            departs: false,
            tied: 0,
            stand_ins: false,
            nameless: 0.0,
            remainder: Size::Negligible,
            removed: 0.0,
            carried: 0.0,
            predicts_worse: false,
            held_out_ratio: 1.0,
            search_complete: true,
        }
    }
}

/// The verdict on this evidence.
pub fn rule(evidence: &Evidence) -> Outcome {
    if !evidence.base_determined {
        Outcome::Undecidable
    } else if evidence.named == 0 {
        silent(evidence)
    } else if !accounts_for_all(evidence) {
        Outcome::Unexplained
    } else if evidence.tied > 0 {
        Outcome::Undecidable
    } else {
        Outcome::Explained
    }
}

/// Rules where nothing has a name.
fn silent(evidence: &Evidence) -> Outcome {
    let base_suffices = evidence.base_follows && !evidence.stand_ins && evidence.nameless < NAMELESS;
    match evidence.remainder {
        Size::Negligible if base_suffices && evidence.has_power => Outcome::Adequate,
        Size::Negligible | Size::Faint if base_suffices => Outcome::Undecidable,
        // Nothing is left that could be called a mismatch, whatever the base model follows.
        Size::Negligible if !evidence.base_follows && !evidence.stand_ins && evidence.nameless < NAMELESS => {
            Outcome::Undecidable
        }
        _ => Outcome::Unexplained,
    }
}

/// Returns whether the named effects bring the residual to the noise, or so close that the rest is
/// a detail.
fn accounts_for_all(evidence: &Evidence) -> bool {
    // Of the error of a base model that the recording does not follow, any law absorbs most.
    let a_detail = evidence.base_follows && evidence.search_complete && evidence.removed > NEARLY_ALL;
    let noise = evidence.remainder == Size::Negligible || a_detail;
    let by_name = evidence.carried < 1.0 - NEARLY_ALL;
    noise
        && by_name
        && !evidence.departs
        && !evidence.stand_ins
        && !evidence.predicts_worse
        && evidence.held_out_ratio <= WORSE
}

#[cfg(test)]
mod tests {
    use super::*;
    use Outcome::{Adequate, Explained, Undecidable, Unexplained};
    use Size::{Faint, Material, Negligible};

    /// One rule of honesty per row: the rule, the evidence, the verdict that it demands.
    #[test]
    fn the_table_of_verdicts() {
        let none = Evidence::default();
        let one = Evidence { named: 1, removed: 0.9, ..none };
        let rows: &[(&str, Evidence, Outcome)] = &[
            // Nothing named.
            ("adequate: nothing is missing that this recording could show", none, Adequate),
            (
                "the error of a base model that the recording does not follow is no measure, though nearly all of it goes",
                Evidence { base_follows: false, removed: 0.999, remainder: Faint, ..one },
                Unexplained,
            ),
            ("to the noise is a measure", Evidence { base_follows: false, removed: 0.999, ..one }, Explained),
            (
                "noise is no mismatch, whatever the base model follows",
                Evidence { base_follows: false, ..none },
                Undecidable,
            ),
            (
                "what is left of a recording that follows no base model is one",
                Evidence { base_follows: false, remainder: Faint, ..none },
                Unexplained,
            ),
            ("silence without power says nothing", Evidence { has_power: false, ..none }, Undecidable),
            ("a faint remainder is too weak to be named", Evidence { remainder: Faint, ..none }, Undecidable),
            ("a real mismatch without a name", Evidence { remainder: Material, ..none }, Unexplained),
            ("a real mismatch needs no power", Evidence { remainder: Material, has_power: false, ..none }, Unexplained),
            ("a series of stand-ins is foreign", Evidence { stand_ins: true, ..none }, Unexplained),
            ("what only nameless terms remove is foreign", Evidence { nameless: 0.2, ..none }, Unexplained),
            ("what they remove within the noise is not", Evidence { nameless: 0.01, ..none }, Adequate),
            ("nameless terms beside a faint rest", Evidence { nameless: 0.2, remainder: Faint, ..none }, Unexplained),
            // Named, no rival.
            ("explained: named effects bring the residual to the noise", one, Explained),
            ("several effects", Evidence { named: 3, ..one }, Explained),
            ("a law near the one named is not the one named", Evidence { departs: true, ..one }, Unexplained),
            ("… nor one of two that are tied", Evidence { departs: true, tied: 1, ..one }, Unexplained),
            ("a name beside a faint remainder", Evidence { remainder: Faint, ..one }, Unexplained),
            ("a name beside a real remainder", Evidence { remainder: Material, ..one }, Unexplained),
            ("… which is a detail", Evidence { remainder: Material, removed: 0.995, ..one }, Explained),
            (
                "… but not where the search was cut short",
                Evidence { remainder: Material, removed: 0.995, search_complete: false, ..one },
                Unexplained,
            ),
            ("a search cut short that ends at the noise", Evidence { search_complete: false, ..one }, Explained),
            ("a repair that predicts worse explains nothing", Evidence { held_out_ratio: 1.2, ..one }, Unexplained),
            (
                "… nor does a law that predicts worse by however little",
                Evidence { predicts_worse: true, ..one },
                Unexplained,
            ),
            ("… but for the few per cent of noise terms", Evidence { held_out_ratio: 1.03, ..one }, Explained),
            ("what goes with nameless effects is not explained", Evidence { carried: 0.98, ..one }, Unexplained),
            ("… but for a detail", Evidence { carried: 0.002, ..one }, Explained),
            ("names beside a series of stand-ins", Evidence { stand_ins: true, ..one }, Unexplained),
            // Named, with rivals.
            ("undecidable: two candidates fit equally", Evidence { tied: 1, ..one }, Undecidable),
            ("one tie among three effects", Evidence { named: 3, tied: 1, ..one }, Undecidable),
            ("a tie of which neither fits", Evidence { tied: 1, remainder: Material, ..one }, Unexplained),
            ("a tie beside a faint remainder", Evidence { tied: 1, remainder: Faint, ..one }, Unexplained),
            ("a tie that leaves a detail", Evidence { tied: 1, remainder: Faint, removed: 0.995, ..one }, Undecidable),
            ("a tie that predicts worse", Evidence { tied: 1, held_out_ratio: 52.0, ..one }, Unexplained),
            // Excitation too weak for the base model itself.
            ("an undetermined base", Evidence { base_determined: false, ..none }, Undecidable),
            (
                "an undetermined base, whatever is left",
                Evidence { base_determined: false, remainder: Material, ..none },
                Undecidable,
            ),
            ("an undetermined base, whatever is named", Evidence { base_determined: false, ..one }, Undecidable),
        ];
        for (rule_of_honesty, evidence, verdict) in rows {
            assert_eq!(rule(evidence), *verdict, "{rule_of_honesty}: {evidence:?}");
        }
    }

    /// Over every combination: no verdict contradicts the evidence that it rests on.
    #[test]
    fn no_verdict_contradicts_its_evidence() {
        let bools = [false, true];
        let mut seen = 0;
        let triples = bools.iter().flat_map(|a| bools.iter().flat_map(move |b| bools.map(|c| (*a, *b, c))));
        for (base_determined, base_follows, has_power) in triples {
            for (named, tied) in [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)] {
                for remainder in [Negligible, Faint, Material] {
                    for (stand_ins, held_out_ratio) in bools.iter().flat_map(|a| [1.0, 2.0].map(|b| (*a, b))) {
                        for (removed, nameless) in [(0.0, 0.0), (0.5, 0.2), (0.999, 0.0)] {
                            let evidence = Evidence {
                                base_determined,
                                base_follows,
                                has_power,
                                named,
                                departs: false,
                                tied,
                                stand_ins,
                                nameless,
                                remainder,
                                removed,
                                carried: 0.0,
                                predicts_worse: false,
                                held_out_ratio,
                                search_complete: true,
                            };
                            let (verdict, predicts_worse) = (rule(&evidence), held_out_ratio > 1.5);
                            seen += 1;
                            let consistent = match verdict {
                                Adequate => base_follows && named == 0 && remainder == Negligible && has_power,
                                Explained => named > 0 && tied == 0 && !predicts_worse && !stand_ins,
                                Unexplained => {
                                    base_determined
                                        && (remainder > Negligible || stand_ins || predicts_worse || nameless > 0.0)
                                }
                                Undecidable => {
                                    !base_determined
                                        || (tied > 0 && !predicts_worse)
                                        || (named == 0 && (remainder < Material || !has_power || !base_follows))
                                }
                            };
                            assert!(consistent, "{verdict:?}: {evidence:?}");
                        }
                    }
                }
            }
        }
        assert_eq!(seen, 8 * 6 * 3 * 4 * 3);
    }
}
