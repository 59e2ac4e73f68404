//! Sentences that differ only in their numbers, about several channels, become one: each thing is
//! reported once.

/// A sentence about one channel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Said {
    /// Name of the channel.
    pub of: String,
    /// Sentence about it, without the name.
    pub sentence: String,
    /// Says whether numbers that differ may become a range: those of a list of frequencies may not.
    pub ranges: bool,
}

/// The sentences in order of their first channel, with the names of all that share each; `all` is
/// the number of channels.
pub(crate) fn grouped(said: &[Said], all: usize) -> Vec<String> {
    let mut groups: Vec<(String, Vec<&Said>)> = Vec::new();
    for one in said {
        let shape = if one.ranges { shape(&one.sentence) } else { one.sentence.clone() };
        match groups.iter_mut().find(|(known, _)| *known == shape) {
            Some((_, members)) => members.push(one),
            None => groups.push((shape, vec![one])),
        }
    }
    let of = |members: &[&Said]| match members.len() {
        n if n == all && n > 1 => format!("all {n} channels"),
        _ => members.iter().map(|one| one.of.as_str()).collect::<Vec<_>>().join(", "),
    };
    groups.iter().map(|(_, members)| format!("{}: {}", of(members), merged(members))).collect()
}

/// A word's number, with what stands before and behind it.
fn number(word: &str) -> Option<(&str, f64, &str)> {
    let begin = word.find(|c: char| c.is_ascii_digit())?;
    let behind = |c: char| !(c.is_ascii_digit() || c == '.');
    let end = word[begin..].find(behind).map_or(word.len(), |at| begin + at);
    // A full stop is the sentence's.
    let end = begin + word[begin..end].trim_end_matches('.').len();
    Some((&word[..begin], word[begin..end].parse().ok()?, &word[end..]))
}

/// The sentence without its numbers.
fn shape(sentence: &str) -> String {
    let bare = |word: &str| number(word).map_or(word.to_owned(), |(front, _, back)| format!("{front}#{back}"));
    sentence.split(' ').map(bare).collect::<Vec<_>>().join(" ")
}

/// The first sentence, its numbers as ranges where they differ.
fn merged(members: &[&Said]) -> String {
    let words: Vec<Vec<&str>> = members.iter().map(|one| one.sentence.split(' ').collect()).collect();
    let word = |place: usize| {
        let all: Vec<&str> = words.iter().filter_map(|w| w.get(place).copied()).collect();
        let value = |word: &&str| number(word).map_or(0.0, |n| n.1);
        let low = all.iter().copied().min_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default();
        let high = all.iter().copied().max_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default();
        match (number(low), number(high)) {
            (Some((front, from, back)), Some((_, to, _))) if from < to => {
                let digits = |word: &str, back: &str| word[front.len()..word.len() - back.len()].to_owned();
                format!("{front}{} to {}{back}", digits(low, back), digits(high, back))
            }
            _ => all.first().copied().unwrap_or_default().to_owned(),
        }
    };
    (0..words.first().map_or(0, Vec::len)).map(word).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(of: &str, sentence: &str) -> Said {
        Said { of: of.into(), sentence: sentence.into(), ranges: true }
    }

    #[test]
    fn what_differs_only_in_numbers_is_reported_once() {
        let six: Vec<Said> = ["gx", "gy", "gz"]
            .iter()
            .zip(["0.12", "0.2", "0.15"])
            .map(|(of, n)| said(of, &format!("{n} times (p = 1).")))
            .collect();
        assert_eq!(grouped(&six, 3), ["all 3 channels: 0.12 to 0.2 times (p = 1)."]);
        assert_eq!(grouped(&six, 6), ["gx, gy, gz: 0.12 to 0.2 times (p = 1)."]);
        // Controls: another sentence, and numbers that are no range.
        let two = [said("a", "3 steps"), said("b", "4 lines")];
        assert_eq!(grouped(&two, 2), ["a: 3 steps", "b: 4 lines"]);
        let lines = two.map(|one| Said { sentence: one.sentence.replace("steps", "lines"), ranges: false, ..one });
        assert_eq!(grouped(&lines, 2).len(), 2);
    }
}
