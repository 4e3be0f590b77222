//! Text from outside, made safe to print.

use std::borrow::Cow;

/// Escapes every character that would act on a terminal instead of being shown: control characters,
/// line breaks, and marks that change the direction of writing. So a name stays on its line, and
/// what is printed is what it contains.
///
/// Names, messages and excerpts of files go through this wherever they are printed.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(acts_on_terminal) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        if acts_on_terminal(character) {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    Cow::Owned(shown)
}

/// As [`printable`] for each line of a text of several lines.
#[must_use]
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    let acts = |character| character != '\n' && acts_on_terminal(character);
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let lines: Vec<_> = text.split('\n').map(printable).collect();
    Cow::Owned(lines.join("\n"))
}

fn acts_on_terminal(character: char) -> bool {
    character.is_control()
        || matches!(
            character,
            // Line and paragraph separators; embeddings, overrides and isolates of directions.
            '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
                | '\u{200e}' | '\u{200f}' | '\u{061c}'
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_on_a_terminal_is_escaped_and_the_rest_stays() {
        assert_eq!(printable("scène ä 景.xml"), "scène ä 景.xml");
        assert_eq!(printable("a\u{1b}[31mb\nc\u{9b}2J"), r"a\u{1b}[31mb\nc\u{9b}2J");
        assert_eq!(printable("\u{202e}gnp.exe\u{2069}\t"), r"\u{202e}gnp.exe\u{2069}\t");
        assert_eq!(printable_lines("a\u{7}\nb\r\n"), "a\\u{7}\nb\\r\n");
        assert!(matches!(printable_lines("a\nb"), Cow::Borrowed(_)));
    }
}
