//! Compares what a page shows with what is printed: words exactly, numbers within 1 % or a unit of their last digit, so that
//! another processor may round otherwise. A line that is only `…` stands for any number of lines.

use libtest_mimic::Failed;

use super::super::world::check;

/// The line that stands for any number of lines.
pub const ANY: &str = "…";

/// Largest difference of two numbers, of themselves.
const WITHIN: f64 = 0.01;

/// Largest difference of two coordinates of a figure, in its units: less than the width of a line.
const PIXELS: f64 = 1.0;

/// A part of a line.
#[derive(Debug, PartialEq)]
enum Part<'a> {
    /// Anything else than a number, without blanks.
    Word(&'a str),
    /// A number as it is written, and its value.
    Number(&'a str, f64),
}

/// The words and numbers of a line. A digit inside a word, as in `m_s2`, is not a number.
fn parts(line: &str) -> Vec<Part<'_>> {
    let mut all = Vec::new();
    for word in line.split_whitespace() {
        let (mut from, mut at) = (0, 0);
        while at < word.len() {
            let before = word[..at].chars().next_back();
            let in_word = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
            let length = if in_word { 0 } else { number(&word[at..]) };
            if length == 0 {
                at += word[at..].chars().next().map_or(1, char::len_utf8);
                continue;
            }
            let text = &word[at..at + length];
            if from < at {
                all.push(Part::Word(&word[from..at]));
            }
            let value = text.replace('−', "-").parse().unwrap_or(f64::NAN);
            all.push(Part::Number(text, value));
            at += length;
            from = at;
        }
        if from < word.len() {
            all.push(Part::Word(&word[from..]));
        }
    }
    all
}

/// The length of the number that a text begins with, in bytes; zero where it begins with none.
fn number(text: &str) -> usize {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let sign = |text: &str| text.chars().next().filter(|c| "+-−".contains(*c)).map_or(0, char::len_utf8);
    let mut end = sign(text);
    let whole = digits(&text[end..]);
    if whole == 0 {
        return 0;
    }
    end += whole;
    if let Some(rest) = text[end..].strip_prefix('.') {
        end += if digits(rest) > 0 { 1 + digits(rest) } else { 0 };
    }
    if let Some(rest) = text[end..].strip_prefix('e') {
        let sign = sign(rest);
        let exponent = digits(&rest[sign..]);
        end += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    end
}

/// The unit of the last digit that is written, where it may round otherwise: in a decimal fraction, and in a percentage.
fn last_digit(text: &str, of_hundred: bool) -> f64 {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let decimals = mantissa.split_once('.').map(|(_, decimals)| decimals.len() as i32);
    let place = match decimals {
        Some(decimals) => -decimals,
        None if of_hundred || text.contains('e') => 0,
        None => return 0.0,
    };
    10f64.powi(place + exponent.replace('−', "-").parse::<i32>().unwrap_or(0))
}

fn is_percent(part: Option<&Part<'_>>) -> bool {
    matches!(part, Some(Part::Word(word)) if word.starts_with('%'))
}

/// States whether two lines say the same.
pub fn alike(shown: &str, printed: &str) -> bool {
    let (shown, printed) = (parts(shown), parts(printed));
    let same = |(k, (a, b)): (usize, (&Part<'_>, &Part<'_>))| match (a, b) {
        (Part::Word(a), Part::Word(b)) => a == b || (is_rule(a) && is_rule(b)),
        (Part::Number(text, a), Part::Number(_, b)) => {
            let unit = last_digit(text, is_percent(shown.get(k + 1)));
            (a - b).abs() <= (WITHIN * a.abs()).max(1.001 * unit)
        }
        _ => false,
    };
    shown.len() == printed.len() && shown.iter().zip(&printed).enumerate().all(same)
}

/// The rule under a heading of a table, as long as the longest word of its column.
fn is_rule(word: &str) -> bool {
    word.chars().all(|c| c == '─')
}

/// The first difference between the lines of a page and those printed, in words.
pub fn lines(shown: &[String], printed: &[String]) -> Option<String> {
    let pieces: Vec<&[String]> = shown.split(|line| line.trim() == ANY).collect();
    let mut at = 0;
    for (k, piece) in pieces.iter().enumerate() {
        let begins = |from: usize| {
            printed.get(from..from + piece.len()).is_some_and(|p| piece.iter().zip(p).all(|(a, b)| alike(a, b)))
        };
        let last = printed.len().saturating_sub(piece.len());
        let found = match (k, k + 1 == pieces.len()) {
            (0, false) => Some(0).filter(|from| begins(*from)),
            (0, true) => Some(0).filter(|from| begins(*from) && piece.len() == printed.len()),
            (_, true) => Some(last).filter(|from| *from >= at && begins(*from)),
            (_, false) => (at..=last).find(|from| begins(*from)),
        };
        match found {
            Some(from) => at = from + piece.len(),
            None if k > 0 => return Some(format!("nowhere after line {at}, in this order:\n{}", piece.join("\n"))),
            None => {
                let line = piece.iter().enumerate().find(|(j, a)| !printed.get(*j).is_some_and(|b| alike(a, b)));
                let at = line.map_or(piece.len(), |(j, _)| j);
                let of = |lines: &[String]| lines.get(at).cloned().unwrap_or_else(|| "(no line)".to_owned());
                return Some(format!(
                    "line {}: the page shows\n{}\nand printed is\n{}",
                    at + 1,
                    of(piece),
                    of(printed)
                ));
            }
        }
    }
    None
}

/// The first difference between two figures, in words.
pub fn figures(kept: &str, written: &str) -> Option<String> {
    let (kept, written) = (spaced(kept), spaced(written));
    let (kept, written) = (parts(&kept), parts(&written));
    if kept.len() != written.len() {
        return Some(format!("{} words and numbers instead of {}", written.len(), kept.len()));
    }
    let same = |(a, b): &(&Part<'_>, &Part<'_>)| match (a, b) {
        (Part::Number(_, a), Part::Number(_, b)) => (a - b).abs() <= (WITHIN * a.abs()).clamp(0.2, PIXELS),
        (a, b) => a == b,
    };
    kept.iter().zip(&written).find(|pair| !same(pair)).map(|(a, b)| format!("{b:?} instead of {a:?}"))
}

/// The text of a figure with the commands of its paths apart from their numbers.
fn spaced(figure: &str) -> String {
    let mut text = String::with_capacity(2 * figure.len());
    for (k, piece) in figure.split('"').enumerate() {
        // Every second piece is the value of an attribute.
        for c in piece.chars() {
            let is_command = k % 2 == 1 && "MLHVCQZmlhvcqz,".contains(c);
            let apart = if is_command { " " } else { "" };
            text.extend([apart, c.encode_utf8(&mut [0; 4]), apart]);
        }
        text.push_str(" \" ");
    }
    text
}

/// The decimal fractions and percentages of a line of text that none of the numbers of these others is.
pub fn unfounded(line: &str, others: &[f64]) -> Vec<String> {
    let parts = parts(line);
    let is_unfounded = |(k, part): (usize, &Part<'_>)| {
        let Part::Number(text, value) = part else { return None };
        let unit = last_digit(text, is_percent(parts.get(k + 1)));
        let is_it = |other: &f64| (value.abs() - other.abs()).abs() <= (WITHIN * value.abs()).max(1.001 * unit);
        (unit > 0.0 && !others.iter().any(is_it)).then(|| (*text).to_owned())
    };
    parts.iter().enumerate().filter_map(is_unfounded).collect()
}

/// The numbers of some lines.
pub fn numbers<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<f64> {
    let value = |part| match part {
        Part::Number(_, value) => Some(value),
        Part::Word(_) => None,
    };
    lines.flat_map(parts).filter_map(value).collect()
}

/// The line with each of its numbers made wrong, one at a time: by a twentieth, and by at least two units of the last digit.
pub fn wrong_numbers(line: &str) -> Vec<String> {
    let parts = parts(line);
    let wrong = |k: usize| {
        let write = |(j, part): (usize, &Part<'_>)| match part {
            Part::Number(text, value) if j == k => {
                let unit = last_digit(text, is_percent(parts.get(j + 1)));
                format!("{:e}", value + (0.05 * value.abs()).max(2.0 * unit).max(1e-9))
            }
            Part::Number(text, _) | Part::Word(text) => (*text).to_owned(),
        };
        parts.iter().enumerate().map(write).collect::<Vec<String>>().join(" ")
    };
    let is_number = |k: &usize| matches!(parts[*k], Part::Number(..));
    (0..parts.len()).filter(is_number).map(wrong).collect()
}

/// Comparisons whose answer is known.
pub fn control() -> Result<(), Failed> {
    let same = [
        ("sd of 11.3 m", "sd of 11.4 m"),
        ("a  b", "a b"),
        ("91 %", "92 %"),
        ("(−26.1 ± 0.18)×10⁻⁴ m", "(−26.1 ± 0.18)×10⁻⁴ m"),
        ("4.3e-2,7", "4.2e-2,7"),
        ("──── ──", "─── ──"),
        ("12345 rows", "12346 rows"),
    ];
    for (a, b) in same {
        check(alike(a, b), format!("{a} and {b} differ: {:?} {:?}", parts(a), parts(b)))?;
    }
    let other = [
        ("sd of 11.3 m", "sd of 11.6 m"),
        ("sd of 11.3 m", "sd of 11.3 mm"),
        ("sd of 11.3 m", "sd of 11.3"),
        ("60 s", "61 s"),
        ("−26.1", "26.1"),
        ("1.0×10⁻⁴", "1.0×10⁻⁵"),
        ("in m_s2", "in m_s3"),
        ("91 %", "93 %"),
    ];
    for (a, b) in other {
        check(!alike(a, b), format!("{a} and {b} are alike"))?;
    }
    let text = |text: &str| -> Vec<String> { text.split('|').map(str::to_owned).collect() };
    let printed = text("a|b|c 1.00|d|e");
    for shown in ["a|b|c 1.00|d|e", "a|…", "…|e", "a|…|c 1.00|…|e", "…", "…|d|…"] {
        check(lines(&text(shown), &printed).is_none(), format!("{shown} is not seen"))?;
    }
    for shown in ["a|b", "b|…", "…|d", "a|…|c 1.10|…", "…|d|…|b|…", "a|b|c 1.00|d|e|f", "…|x|…"] {
        check(lines(&text(shown), &printed).is_some(), format!("{shown} passes"))?;
    }
    let known = numbers(["sd 16.9 m (55 %)", "−0.0021"].into_iter());
    check(unfounded("17.0 m, 54 %, (0.0021, in 60 s)", &known).is_empty(), "what is printed is unfounded")?;
    check(unfounded("19.0 m, 50 %, 0.0041", &known) == ["19.0", "50", "0.0041"], "a number from nowhere is founded")?;
    let figure = "<path d=\"M10.0,20.0L30.5,40.5\"/><text>60 s</text>";
    check(figures(figure, &figure.replace("40.5", "40.6")).is_none(), "a tenth of a pixel is another figure")?;
    for wrong in [("40.5", "42.5"), ("60 s", "61 s"), ("L30", "M30"), ("L30.5,40.5", "")] {
        check(figures(figure, &figure.replace(wrong.0, wrong.1)).is_some(), format!("{wrong:?} is the same figure"))?;
    }
    Ok(())
}
