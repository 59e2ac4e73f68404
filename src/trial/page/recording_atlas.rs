//! Shows an atlas of recordings as short Markdown pages: one a set, one on the random walk, and an
//! index of them.

pub mod index;
mod numbers;
pub mod random_walk;
pub mod set;
mod walk_sentences;

/// Sentence of where a page comes from; `command` is what made it.
fn origin(command: &str) -> String {
    format!(
        "*Made by `{command}` in this folder, from the recordings themselves. No sample of them is shown; what is known of them from \
         elsewhere was not used.*\n"
    )
}
