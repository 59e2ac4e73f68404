//! Any bytes for every reader and document: the corpus of the fuzz targets as it is, and mutated a
//! hundred thousand times.
//!
//! `PROOFMASS_FUZZ=N` makes N mutations for each target instead. The mutations are the same every
//! time, others with `PROOFMASS_FUZZ_SEED` (1 unless said); one that fails is kept in the folder
//! for temporary files, under its name.

#[path = "../../fuzz/oracles.rs"]
mod oracles;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};

use super::world::{check, test};

/// Mutations per target: as many as it can make in a few seconds. A hundred thousand in all.
const MUTATIONS: [(&str, usize); 13] = [
    ("recording", 5_000),
    ("formats", 40_000),
    ("allan", 200),
    ("unit", 40_000),
    ("study", 10_000),
    ("model", 15_000),
    ("map", 12_000),
    ("recipe", 8_000),
    ("truth", 6_000),
    ("verdicts", 4_000),
    ("state", 300),
    ("manifest", 5_000),
    ("diagnose", 12),
];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let of = |(name, oracle): oracles::Oracle| {
        test(&format!("fuzz: any bytes for {name} are read as they are or refused in words"), move || {
            replay(name, oracle)
        })
    };
    let mut all: Vec<Trial> = oracles::ALL.into_iter().map(of).collect();
    all.push(test("fuzz: the oracles notice what is wrong (control)", control));
    all
}

fn folder(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target)
}

fn corpus(target: &str) -> Result<Vec<Vec<u8>>, Failed> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder(target))?.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths.iter().map(std::fs::read).collect::<Result<_, _>>()?)
}

fn replay(target: &str, oracle: fn(&[u8]) -> oracles::Verdict) -> Result<(), Failed> {
    let corpus = corpus(target)?;
    check(!corpus.is_empty(), "no corpus")?;
    for input in &corpus {
        asked(target, oracle, input)?;
    }
    let usual = MUTATIONS.iter().find(|(name, _)| *name == target).map_or(0, |(_, n)| *n);
    let said = |name: &str| std::env::var(name).ok().and_then(|n| n.parse().ok());
    let wanted = said("PROOFMASS_FUZZ").unwrap_or(usual as u64);
    let mut mutator = Mutator { state: said("PROOFMASS_FUZZ_SEED").unwrap_or(1), corpus: &corpus };
    for _ in 0..wanted {
        asked(target, oracle, &mutator.mutated())?;
    }
    Ok(())
}

/// Asks the oracle; an input that it does not like is kept.
fn asked(target: &str, oracle: fn(&[u8]) -> oracles::Verdict, input: &[u8]) -> Result<(), Failed> {
    let said = match catch_unwind(AssertUnwindSafe(|| oracle(input))) {
        Ok(verdict) => verdict,
        Err(panic) => {
            let words = panic.downcast_ref::<String>().cloned();
            Err(format!("it panics: {}", words.unwrap_or_default()))
        }
    };
    said.or_else(|words| {
        let kept = std::env::temp_dir().join(format!("proofmass-fuzz-{target}"));
        std::fs::write(&kept, input)?;
        Err(format!("{words}\nthe input is kept in {}", kept.display()).into())
    })
}

/// Changes inputs of a corpus, with numbers of its own: the same every time.
struct Mutator<'a> {
    state: u64,
    corpus: &'a [Vec<u8>],
}

/// What formats trip over.
const TOKENS: [&[u8]; 32] = [
    b"nan",
    b"inf",
    b"-inf",
    b"1e308",
    b"-1e308",
    b"1e-308",
    b"1e400",
    b"0",
    b"-0",
    b"-1",
    b"18446744073709551615",
    b"18446744073709551616",
    b"9223372036854775807",
    b"4294967296",
    b"0x1f",
    b"1_000",
    b"\"",
    b"'''",
    b"\n",
    b"\r\n",
    b"\r",
    b",",
    b";",
    b"\t",
    b"=",
    b"[",
    b"]]",
    b"{ mean = 0.0, sd = 1.0 }",
    b"\0",
    b"\xff\xfe",
    b"\xc3",
    "\u{202e}µ".as_bytes(),
];

impl Mutator<'_> {
    /// SplitMix64: Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014.
    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// A stretch of some bytes.
    fn stretch(&mut self, of: &[u8]) -> std::ops::Range<usize> {
        let begin = self.below(of.len() + 1);
        let length = 1 << self.below(7);
        begin..of.len().min(begin + self.below(length) + 1)
    }

    fn mutated(&mut self) -> Vec<u8> {
        let chosen = self.below(self.corpus.len());
        let mut bytes = self.corpus[chosen].clone();
        for _ in 0..=self.below(4) {
            let place = self.stretch(&bytes);
            match self.below(7) {
                0 if !bytes.is_empty() => {
                    let at = self.below(bytes.len());
                    bytes[at] ^= 1 << self.below(8);
                }
                1 if !bytes.is_empty() => {
                    let at = self.below(bytes.len());
                    bytes[at] = self.next() as u8;
                }
                2 => drop(bytes.drain(place)),
                3 => {
                    let copy = bytes[place.clone()].to_vec();
                    bytes.splice(place.start..place.start, copy);
                }
                4 => {
                    let other = self.below(self.corpus.len());
                    let other = &self.corpus[other];
                    let from = self.stretch(other);
                    bytes.splice(place, other[from].iter().copied());
                }
                5 => bytes.truncate(place.start),
                _ => {
                    let token = TOKENS[self.below(TOKENS.len())];
                    bytes.splice(place, token.iter().copied());
                }
            }
        }
        bytes
    }
}

fn control() -> Result<(), Failed> {
    let wrong = asked("control", |bytes| if bytes == b"x" { Err("x".to_owned()) } else { Ok(()) }, b"x");
    check(wrong.is_err(), "an oracle that says no is not heard")?;
    let panics = asked("control", |bytes| if bytes == b"x" { panic!("{}", "x") } else { Ok(()) }, b"x");
    check(panics.is_err(), "a panic is not noticed")?;
    let corpus = [b"one, two".to_vec(), b"three\nfour".to_vec()];
    let mut mutator = Mutator { state: 1, corpus: &corpus };
    let made: std::collections::BTreeSet<Vec<u8>> = (0..1000).map(|_| mutator.mutated()).collect();
    check(made.len() > 500, format!("{} different inputs of 1000", made.len()))
}
