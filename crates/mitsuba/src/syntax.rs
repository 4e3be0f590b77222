//! Turns the parser's errors into messages with positions.

use std::ops::Range;

use etendue_document::Fault;
use roxmltree::{Error, TextPos};

use crate::options::Limits;

/// What is wrong, and where in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SyntaxError {
    pub(crate) fault: Fault,
    pub(crate) message: String,
    /// In bytes.
    pub(crate) range: Range<usize>,
    /// The opening tag of the element that should have been closed.
    pub(crate) opened: Option<Range<usize>>,
}

/// Parses XML without a document type, within the limits.
pub(crate) fn parse<'a>(
    text: &'a str,
    limits: &Limits,
) -> Result<roxmltree::Document<'a>, SyntaxError> {
    let options = roxmltree::ParsingOptions {
        allow_dtd: false,
        nodes_limit: limits.xml_nodes,
        ..Default::default()
    };
    roxmltree::Document::parse_with_options(text, options).map_err(|error| describe(text, &error))
}

fn describe(text: &str, error: &Error) -> SyntaxError {
    let fault = match error {
        Error::NodesLimitReached
        | Error::AttributesLimitReached
        | Error::NamespacesLimitReached => Fault::Limit,
        Error::DtdDetected => Fault::Unsupported,
        _ => Fault::Syntax,
    };
    let message = message(error);
    // These errors mean that the text ended too early: report the element left open.
    let ends_early = matches!(error, Error::UnclosedRootNode | Error::UnexpectedEndOfStream);
    let range = match unclosed_element(text).filter(|_| ends_early) {
        Some(range) => range,
        None if matches!(error, Error::InvalidCharacterData(_)) => {
            // The reported position is the end of the text.
            let end = offset_of(text, error.pos());
            text[..end].rfind("]]>").map_or(end..end, |start| start..start + 3)
        }
        None if has_position(error) => word_at(text, offset_of(text, error.pos())),
        None => text.len()..text.len(),
    };
    let opened = match error {
        Error::UnexpectedCloseTag(..) => unclosed_element(&text[..range.start]),
        _ => None,
    };
    SyntaxError { fault, message, range, opened }
}

fn message(error: &Error) -> String {
    match error {
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => {
            "the file ends before this element is closed".to_owned()
        }
        Error::UnexpectedCloseTag(expected, actual, _) => {
            format!("`</{actual}>` where `</{expected}>` is expected")
        }
        Error::DuplicatedAttribute(name, _) => format!("the attribute `{name}` is given twice"),
        Error::UnknownEntityReference(name, _) => format!("the entity `&{name};` is not known"),
        Error::MalformedEntityReference(_) => {
            "`&` must be followed by an entity; the character itself is `&amp;`".to_owned()
        }
        Error::InvalidAttributeValue(_) | Error::InvalidChar(b'"' | b'\'', b'<', _) => {
            "`<` in an attribute's value: its quote is not closed, or `&lt;` is meant".to_owned()
        }
        Error::UnknownToken(_) => {
            "a file is one element, with nothing but comments around it".to_owned()
        }
        Error::NoRootNode => "there is no element in this file".to_owned(),
        Error::UnexpectedDeclaration(_) => {
            "the XML declaration must be the first thing in the file".to_owned()
        }
        Error::NodesLimitReached => "more XML nodes than are read".to_owned(),
        Error::InvalidCharacterData(_) => "`]]>` cannot stand in a text".to_owned(),
        Error::InvalidChar(expected, actual, _) => format!(
            "expected `{}`, found `{}`",
            char::from(*expected).escape_default(),
            char::from(*actual).escape_default()
        ),
        Error::InvalidChar2(expected, actual, _) => {
            format!("expected {expected}, found `{}`", char::from(*actual).escape_default())
        }
        other => without_position(&other.to_string()),
    }
}

/// The parser's own message without its trailing position, which the excerpt shows.
fn without_position(message: &str) -> String {
    let cut = message
        .rfind(" at ")
        .filter(|at| message[at + 4..].chars().all(|c| c.is_ascii_digit() || c == ':'));
    message[..cut.unwrap_or(message.len())].to_owned()
}

fn has_position(error: &Error) -> bool {
    !matches!(
        error,
        Error::NoRootNode
            | Error::UnclosedRootNode
            | Error::DtdDetected
            | Error::NodesLimitReached
            | Error::AttributesLimitReached
            | Error::NamespacesLimitReached
            | Error::UnexpectedEndOfStream
    )
}

/// The byte offset of a row and a column, both counted from 1, the column in characters.
fn offset_of(text: &str, position: TextPos) -> usize {
    let row = position.row.saturating_sub(1) as usize;
    let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
    let line_start = match row.checked_sub(1) {
        Some(index) => breaks.map(|(offset, _)| offset + 1).nth(index).unwrap_or(text.len()),
        None => 0,
    };
    let column = position.col.saturating_sub(1) as usize;
    let line = &text[line_start..];
    line_start + line.char_indices().nth(column).map_or(line.len(), |(offset, _)| offset)
}

/// The word at an offset, or the character if there is none.
fn word_at(text: &str, offset: usize) -> Range<usize> {
    let rest = &text[offset..];
    let word = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    let character = rest.chars().next().map_or(0, char::len_utf8);
    offset..offset + word.max(character)
}

/// The opening tag of the innermost unclosed element, found by counting opening and closing tags.
fn unclosed_element(text: &str) -> Option<Range<usize>> {
    let mut open = Vec::new();
    let mut position = 0;
    while let Some(found) = text[position..].find('<') {
        let start = position + found;
        let rest = &text[start..];
        let end = if rest.starts_with("<!--") { "-->" } else { ">" };
        let length = rest.find(end).map_or(rest.len(), |offset| offset + end.len());
        if rest.starts_with("</") {
            if rest[..length].ends_with('>') {
                open.pop();
            }
        } else if !rest.starts_with("<!") && !rest.starts_with("<?") {
            let name_length = rest[1..].find([' ', '\t', '\r', '\n', '/', '>']);
            let name_end = start + name_length.map_or(rest.len(), |length| length + 1);
            if !rest[..length].ends_with("/>") {
                open.push(start..name_end);
            }
        }
        position = start + length;
    }
    open.pop()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> SyntaxError {
        parse(text, &Limits::default()).unwrap_err()
    }

    #[test]
    fn a_truncated_file_points_at_the_open_element() {
        for text in ["<scene>\n <shape>\n  <float/>\n", "<scene>\n <shape>\n  <float/>\n </sha"] {
            let found = error(text);
            assert_eq!(found.range, 9..15, "{text}");
            assert!(found.message.contains("ends before"), "{}", found.message);
        }
        assert_eq!(error("<scene>\n <shape id='a").range, 9..15, "inside a tag");
    }

    #[test]
    fn errors_point_at_their_character() {
        let found = error("<scene>\n<ä/>\n<b></c>\n</scene>");
        assert_eq!(&"<scene>\n<ä/>\n<b></c>\n</scene>"[found.range.start..][..4], "</c>");
        assert_eq!(found.message, "`</c>` where `</b>` is expected");
        assert_eq!(found.opened, Some(14..16));
        assert_eq!(error("<a x='1' x='2'/>").range.start, 9);
        assert!(error("<a x='&foo;'/>").message.contains("&foo;"));
        assert!(!error("<a x=1/>").message.contains(" at "), "{}", error("<a x=1/>").message);
    }

    #[test]
    fn the_number_of_nodes_is_bounded() {
        let limits = Limits { xml_nodes: 10, ..Limits::default() };
        let text = format!("<a>{}</a>", "<b/>".repeat(100));
        assert_eq!(parse(&text, &limits).unwrap_err().fault, Fault::Limit);
    }
}
