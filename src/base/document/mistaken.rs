//! Documents that are taken for another kind of file, and numbers as other countries write them:
//! the one sentence that helps.

/// The hint for a document that could not be read, where it is known what was meant: `line` is the
/// one at fault, counted from one; `name` stands for the file.
pub(super) fn hint(name: &str, text: &str, line: Option<usize>, message: &str) -> Option<String> {
    let head = text.lines().take_while(|l| !l.trim_start().starts_with('['));
    let kind = head.clone().find_map(|l| l.trim().strip_prefix("kind")?.trim_start().strip_prefix('='));
    let is_model = || {
        let kind = kind.unwrap_or_default();
        ["\"driven\"", "\"static\"", "\"tumble\"", "\"trajectory\"", "\"response\""].iter().any(|k| kind.contains(k))
    };
    // A study has no kind outside its sections.
    if message.starts_with("unknown field") && message.contains("`members`") && is_model() {
        return Some(format!("this is a model, not a study: proofmass diagnose LOG --model {name}"));
    }
    let begins = |key: &str| head.clone().any(|l| l.trim_start().starts_with(key));
    if message.starts_with("missing field `kind`") && (begins("duration_s") || begins("members")) {
        return Some(format!("this is a study, not a model: proofmass study {name}"));
    }
    let first = text.lines().find(|l| !l.trim().is_empty() && !l.starts_with('#'))?;
    let cells = first.split([',', ';', '\t']).count();
    if cells > 1 && !first.contains('=') && !first.trim_start().starts_with('[') {
        return Some(format!(
            "this is a recording, not a .toml: proofmass inspect {name} says what it holds; proofmass allan {name} --to \
             TARGET makes a configuration of its noise"
        ));
    }
    let value = text.lines().nth(line?.checked_sub(1)?)?.split_once('=')?.1;
    number_advice(value.split('#').next().unwrap_or_default())
}

/// Returns how to write a number that stands in `value` as other countries or word processors do.
pub fn number_advice(value: &str) -> Option<String> {
    if value.contains('−') {
        return Some("write the minus sign as - (a hyphen)".to_owned());
    }
    decimal_comma(value).map(|point| format!("write a decimal point, not a comma: {point}"))
}

/// A number with a decimal comma, with a point in its place; `[1,2]` is a list.
fn decimal_comma(value: &str) -> Option<String> {
    if value.trim_start().starts_with('[') {
        return None;
    }
    let is_digit = |c: char| c.is_ascii_digit();
    value.match_indices(',').find_map(|(at, _)| {
        let (before, rest) = (&value[..at], &value[at + 1..]);
        let whole = &before[before.trim_end_matches(is_digit).len()..];
        let part = &rest[..rest.find(|c| !is_digit(c)).unwrap_or(rest.len())];
        (!whole.is_empty() && !part.is_empty()).then(|| format!("{whole}.{part}"))
    })
}

#[cfg(test)]
mod tests {
    use super::hint;

    #[test]
    fn each_mistake_has_the_sentence_that_helps() {
        for (text, line, message, words) in [
            ("kind = \"driven\"\n[columns]\n", Some(2), "unknown field `columns`, … `members`", "this is a model"),
            ("members = 4\nduration_s = 1.0\n", None, "missing field `kind`", "this is a study"),
            ("t_s,gx,gy\n0,1,2\n", Some(1), "expected `=`", "this is a recording"),
            ("a = 3,5\n", Some(1), "unexpected", "3.5"),
            ("a = { mean = 0.0, sd = 3,5 }\n", Some(1), "invalid", "3.5"),
            // A character of several bytes stands before the digits, as a damaged file has it.
            ("a = { mean = \u{fffd}3,5 }\n", Some(1), "invalid", "3.5"),
            ("a = 1\nb = −3.0\n", Some(2), "invalid", "hyphen"),
        ] {
            let found = hint("x.toml", text, line, message);
            assert!(found.as_ref().is_some_and(|h| h.contains(words)), "{text}: {found:?}");
        }
        // Control: an ordinary slip has no such sentence.
        assert_eq!(hint("x.toml", "membrs = 3\n", Some(1), "unknown field `membrs`"), None);
        assert_eq!(hint("x.toml", "a = [1, 2\n", Some(1), "unclosed"), None);
    }
}
