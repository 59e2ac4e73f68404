//! Reads a page of the tutorials: the files that it has the reader write, the commands that it has him run, with what they
//! print, and the figures that they write.
//!
//! A fenced block is a file where the line of text before it ends with its name, as in "`study.toml`:". A block of the language
//! `console` has commands after `$ `, each followed by what it prints. A comment `recordings: PATH…` names files of the
//! folder of recordings, `figure: NAME = PATH` the file of the run that a figure was copied from, and `by hand: NUMBER…` what
//! the text states and no command prints.

use std::path::Path;

use libtest_mimic::Failed;

/// One thing that a page has the reader do.
pub enum Shown {
    /// A file to be written.
    File {
        /// Its name.
        name: String,
        /// Its text.
        text: String,
    },
    /// A command.
    Run {
        /// The command line.
        command: String,
        /// The lines that it prints, as the page shows them.
        lines: Vec<String>,
    },
}

/// A page.
#[derive(Default)]
pub struct Page {
    /// Files and commands, in order.
    pub shown: Vec<Shown>,
    /// Files of the folder of recordings that it needs.
    pub recordings: Vec<String>,
    /// Each figure next to the page, and the file of the run that it is.
    pub figures: Vec<(String, String)>,
    /// The lines outside blocks and comments.
    pub prose: Vec<String>,
    /// Numbers of the prose that no command prints.
    pub by_hand: String,
}

impl Page {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, Failed> {
        Ok(Self::parse(&std::fs::read_to_string(path)?)?)
    }

    /// The commands.
    pub fn runs(&self) -> impl Iterator<Item = &str> {
        self.shown.iter().filter_map(|shown| match shown {
            Shown::Run { command, .. } => Some(command.as_str()),
            Shown::File { .. } => None,
        })
    }

    /// The texts of the files.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.shown.iter().filter_map(|shown| match shown {
            Shown::File { text, .. } => Some(text.as_str()),
            Shown::Run { .. } => None,
        })
    }

    fn parse(text: &str) -> Result<Self, String> {
        let (mut page, mut before, mut lines) = (Self::default(), "", text.lines());
        while let Some(line) = lines.next() {
            if let Some(language) = line.strip_prefix("```") {
                let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
                match (language, named(before)) {
                    ("console", _) => page.shown.extend(runs(&block)?),
                    (_, Some(name)) => {
                        let text = block.iter().map(|line| format!("{line}\n")).collect();
                        page.shown.push(Shown::File { name: name.to_owned(), text });
                    }
                    _ => {}
                }
                continue;
            }
            match line.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->")).and_then(|c| c.split_once(": "))
            {
                Some(("recordings", paths)) => page.recordings.extend(paths.split(' ').map(str::to_owned)),
                Some(("figure", figure)) => {
                    let (name, path) = figure.split_once(" = ").ok_or(format!("no NAME = PATH in {line}"))?;
                    page.figures.push((name.to_owned(), path.to_owned()));
                }
                Some(("by hand", numbers)) => page.by_hand.push_str(numbers),
                _ if line.trim().is_empty() => {}
                _ => {
                    page.prose.push(line.to_owned());
                    before = line;
                }
            }
        }
        Ok(page)
    }
}

/// The name at the end of a line like "Save this as `study.toml`:".
fn named(line: &str) -> Option<&str> {
    let mut parts = line.strip_suffix("`:")?.rsplit('`');
    parts.next().filter(|name| !name.is_empty() && !name.contains(' '))
}

fn runs(block: &[&str]) -> Result<Vec<Shown>, String> {
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for line in block {
        match (line.strip_prefix("$ "), found.last_mut()) {
            (Some(command), _) => found.push((command.to_owned(), Vec::new())),
            (None, Some((_, lines))) => lines.push((*line).to_owned()),
            (None, None) => return Err(format!("a block begins without a command: {line}")),
        }
    }
    Ok(found.into_iter().map(|(command, lines)| Shown::Run { command, lines }).collect())
}

/// The words of a command line, as a shell takes them: blanks divide, quotes hold together.
pub fn words(command: &str) -> Vec<String> {
    let (mut all, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in command.chars() {
        match (c, quote) {
            (c, Some(q)) if c == q => quote = None,
            ('\'' | '"', None) => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (' ', None) => all.extend(word.take()),
            (c, _) => word.get_or_insert_default().push(c),
        }
    }
    all.extend(word);
    all
}
