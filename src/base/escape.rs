//! Foreign text (headings, names, paths) made harmless for the place it is written to: terminal,
//! shell, comment, XML, file name.
//!
//! Strings in TOML and JSON are not here: their own crates write them.

use std::borrow::Cow;

/// Control characters, and the marks that reverse or isolate the direction of the text around them.
fn steers(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn escaped(text: &str, harmful: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&harmful) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match harmful(c) {
            true => out += &format!("\\u{:04x}", c as u32),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

/// Text for a terminal. Line breaks and tabs stay; what would move the cursor, change colours or
/// reverse the writing is shown as `\u001b`. That is how JSON writes it too, so a JSON document
/// stays the same document.
pub fn terminal(text: &str) -> Cow<'_, str> {
    escaped(text, |c| steers(c) && c != '\n' && c != '\t')
}

/// Text that must stay on one line: a table's cell, a comment.
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, steers)
}

/// A word of a shell's command line, in quotes where a shell needs them.
pub fn word(text: &str) -> Cow<'_, str> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./,:+=@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(format!("'{}'", text.replace('\'', r"'\''")))
}

/// Text without the characters that XML 1.0 forbids even when escaped; each becomes U+FFFD.
pub fn xml(text: &str) -> Cow<'_, str> {
    let forbidden =
        |c: char| matches!(c, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}');
    match text.contains(forbidden) {
        true => Cow::Owned(text.replace(forbidden, "\u{fffd}")),
        false => Cow::Borrowed(text),
    }
}

/// Text made safe to stand in HTML and SVG.
pub fn html(text: &str) -> String {
    xml(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Text as part of a file name: ASCII letters, digits, `_` and `-`, at most `longest` of them.
/// Different texts may give the same name.
pub fn file_name(text: &str, longest: usize) -> String {
    text.chars().take(longest).map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_gets_no_escape_sequence_and_json_stays_the_same_document() {
        assert_eq!(terminal("a\u{1b}[31mb\u{9b}2J\n\tc"), "a\\u001b[31mb\\u009b2J\n\tc");
        assert_eq!(line("a\nb\u{202e}"), "a\\u000ab\\u202e");
        assert!(matches!(terminal("µg/√Hz, 加速度, שלום"), Cow::Borrowed(_)));
        let value = serde_json::json!({ "name": "a\u{1b}\u{9b}\u{7f}\u{2028}\"\\" });
        let text = serde_json::to_string_pretty(&value).expect("JSON");
        let back: serde_json::Value = serde_json::from_str(&terminal(&text)).expect("still JSON");
        assert_eq!(back, value);
        assert!(!terminal(&text).contains(|c: char| c.is_control() && c != '\n'));
    }

    #[test]
    fn forbidden_characters_leave_xml_and_the_others_stay() {
        assert_eq!(xml("a\u{1b}b\u{ffff}\t\u{85}é"), "a\u{fffd}b\u{fffd}\t\u{85}é");
    }

    #[test]
    fn file_names_are_bounded_and_plain() {
        assert_eq!(file_name("a/b ü", 80), "a-b--");
        assert_eq!(file_name(&"é".repeat(500), 80).len(), 80);
    }
}
