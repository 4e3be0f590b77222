//! Decides how messages look: colours, and characters beyond ASCII.

use std::env::var_os;
use std::io::{IsTerminal, stderr};

use etendue::ExcerptStyle;

/// Whether to colour messages: standard error is a terminal that knows colours, and the environment
/// does not forbid them (<https://no-color.org>).
pub(crate) fn is_colored() -> bool {
    let is_forbidden = var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    is_moving() && !is_forbidden
}

/// Whether standard error is a terminal on which a line can be drawn anew.
pub(crate) fn is_moving() -> bool {
    let is_dumb = var_os("TERM").is_some_and(|value| value == "dumb");
    stderr().is_terminal() && !is_dumb
}

/// Whether frames and bars consist of ASCII characters alone, because the locale names another
/// encoding than UTF-8. Without a locale, as in many containers, UTF-8 is assumed.
pub(crate) fn is_ascii() -> bool {
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"]
        .into_iter()
        .find_map(|name| var_os(name).filter(|value| !value.is_empty()));
    locale.is_some_and(|locale| !is_utf8(&locale.to_string_lossy()))
}

fn is_utf8(locale: &str) -> bool {
    let plain: String = locale.chars().filter(|c| *c != '-').collect();
    plain.to_ascii_lowercase().contains("utf8")
}

/// The style of excerpts.
pub(crate) fn excerpts() -> ExcerptStyle {
    ExcerptStyle { is_colored: is_colored(), is_ascii: is_ascii() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf8_is_spelled_in_several_ways() {
        assert!(["de_DE.UTF-8", "C.utf8", "en_US.utf-8"].into_iter().all(is_utf8));
        assert!(!["C", "POSIX", "de_DE.ISO-8859-1", "ja_JP.eucJP"].into_iter().any(is_utf8));
    }
}
