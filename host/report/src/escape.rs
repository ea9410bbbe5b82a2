//! Escapes text from files and arguments: characters that control a terminal or reorder text are replaced by their
//! code, `\u{1b}` for ESC. Colours of this program are added afterwards.

use std::borrow::Cow;
use std::fmt::Write as _;

/// Returns the text with every control character and every directional character replaced by its code. Line ends and
/// tabs stay.
pub fn escaped(text: &str) -> Cow<'_, str> {
    replaced(text, |code| format!("\\u{{{code:x}}}"))
}

/// Returns equivalent JSON without such characters; outside its strings JSON has only ASCII.
pub fn escaped_json(text: &str) -> Cow<'_, str> {
    replaced(text, |code| format!("\\u{code:04x}"))
}

/// Returns a text for a text node or a quoted attribute of XML. Control characters stay.
pub fn escaped_xml(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns true if [`escaped`] leaves a text unchanged.
pub fn is_plain(text: &str) -> bool {
    matches!(escaped(text), Cow::Borrowed(_))
}

/// Returns the position in the escaped text [bytes] of a position in the original text.
pub fn place_in_escaped(text: &str, place: usize) -> usize {
    // A position within a character moves to its start.
    let whole = (0..=place.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    let split_line_end = usize::from(text[..whole].ends_with('\r') && text[whole..].starts_with('\n'));
    escaped(&text[..whole - split_line_end]).len() + split_line_end
}

fn replaced(text: &str, code: impl Fn(u32) -> String) -> Cow<'_, str> {
    if !text.chars().any(is_dangerous) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    let mut letters = text.chars().peekable();
    let mut changed = false;
    while let Some(letter) = letters.next() {
        let ends_line = letter == '\r' && letters.peek() == Some(&'\n');
        if is_dangerous(letter) && !ends_line {
            changed = true;
            // Writing to a string cannot fail.
            let _ = write!(shown, "{}", code(letter.into()));
        } else {
            shown.push(letter);
        }
    }
    if changed { Cow::Owned(shown) } else { Cow::Borrowed(text) }
}

/// Returns true for control characters (C0, DEL, C1), separators that some programs take for line ends, and the marks,
/// embeddings, overrides and isolates of Unicode's bidirectional algorithm (UAX #9).
fn is_dangerous(letter: char) -> bool {
    letter.is_control() && letter != '\n' && letter != '\t'
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped() {
        for (text, shown) in [
            ("\u{1b}[31mred", "\\u{1b}[31mred"),
            ("a\rb\u{7f}\u{8}\u{0}", "a\\u{d}b\\u{7f}\\u{8}\\u{0}"),
            ("\u{9b}2J", "\\u{9b}2J"),
            ("q1\u{202e}lmot.\u{2066}", "q1\\u{202e}lmot.\\u{2066}"),
        ] {
            assert_eq!(escaped(text), shown);
            assert!(!is_plain(text) && is_plain(shown));
        }
    }

    #[test]
    fn letters_newlines_and_tabs_stay() {
        let text = "Getriebe für µm\tΔθ\r\n中文 🙂 é\n";
        assert!(is_plain(text));
        assert_eq!(escaped(text), text);
    }

    #[test]
    fn positions_follow_escaped_letters() {
        let text = "a\u{9b}\u{1b}b\r\nc\u{202e}d";
        let shown = escaped(text);
        for (place, letter) in text.char_indices() {
            let moved = place_in_escaped(text, place);
            assert!(shown[moved..].starts_with(&*escaped(&letter.to_string())) || letter == '\r', "{letter:?}");
        }
        assert_eq!(place_in_escaped(text, text.len()), shown.len());
        assert_eq!(place_in_escaped("ab", 9), 2);
    }

    #[test]
    fn escaped_json_keeps_its_value() {
        let value = serde_json::json!({ "title": "\u{1b}[31m \u{9b} \u{202e} µ" });
        let text = value.to_string();
        let shown = escaped_json(&text);
        assert!(is_plain(&shown) && !is_plain(&text), "{shown}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).expect("still JSON"), value);
    }
}
