//! Scans a text before parsing for anything that would make parsing slow or unsafe.
//!
//! The parser compares every attribute of an element with every other one, copies the namespaces of
//! outer elements to inner ones, and reports a DOCTYPE without its position. This pass finds all
//! three in linear time. It knows just enough XML to skip comments and quotes; syntax errors are
//! left to the parser. It also finds what real files hold beyond XML, so that they can be read: `--` in
//! comments and elements after the root.

use std::ops::Range;

use etendue_document::Fault;

use crate::options::Limits;

/// The maximum number of namespace declarations in one file; scenes need none.
const NAMESPACE_LIMIT: usize = 16;

/// The target size of a piece in bytes. The parser needs about six times as much memory.
pub(crate) const PIECE: usize = 1 << 20;

/// Why a text is not passed to the parser.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refused {
    pub(crate) fault: Fault,
    pub(crate) message: String,
    /// In bytes.
    pub(crate) range: Range<usize>,
}

/// The structure of a text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Outline {
    /// The opening tag of the root.
    pub(crate) root: Range<usize>,
    /// The number of elements.
    pub(crate) elements: usize,
    /// Split points between two top-level elements, about [`PIECE`] bytes apart.
    pub(crate) breaks: Vec<usize>,
    /// Where the root ends, if its closing tag was found.
    pub(crate) end: Option<usize>,
    /// The comments that hold `--`, which XML does not allow.
    pub(crate) hyphenated_comments: Vec<Range<usize>>,
}

/// Checks nesting, attributes and declarations against the limits, and finds the split points of a
/// long text.
pub(crate) fn scan(text: &str, limits: &Limits) -> Result<Outline, Refused> {
    let outline = Outline::default();
    let mut scanner = Scanner { text, limits, position: 0, depth: 0, outline };
    while scanner.outline.end.is_none() && scanner.next_tag() {
        scanner.tag()?;
    }
    let outline = scanner.outline;
    let text = &text[..outline.end.unwrap_or(text.len())];
    match text.match_indices("xmlns").nth(NAMESPACE_LIMIT) {
        Some((start, found)) => {
            let message = format!("more than {NAMESPACE_LIMIT} namespace declarations");
            Err(Refused { fault: Fault::Limit, message, range: start..start + found.len() })
        }
        None => Ok(outline),
    }
}

struct Scanner<'a> {
    text: &'a str,
    limits: &'a Limits,
    position: usize,
    depth: usize,
    outline: Outline,
}

impl<'a> Scanner<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.position..]
    }

    /// Advances to the next `<`.
    fn next_tag(&mut self) -> bool {
        match self.rest().find('<') {
            Some(offset) => {
                self.position += offset;
                true
            }
            None => false,
        }
    }

    fn tag(&mut self) -> Result<(), Refused> {
        let rest = self.rest();
        if rest.starts_with("<!--") {
            self.comment();
        } else if rest.starts_with("<![CDATA[") {
            self.skip_past("]]>");
        } else if rest.starts_with("<?") {
            self.skip_past("?>");
        } else if rest.starts_with("<!") {
            let length = rest.find(['[', '>', '\n']).unwrap_or(rest.len());
            let message = "a DOCTYPE is not accepted, nor are the entities it could declare";
            return Err(self.refuse(Fault::Unsupported, message.to_owned(), length));
        } else if let Some(closed) = rest.strip_prefix("</") {
            self.depth = self.depth.saturating_sub(1);
            self.skip_past(">");
            self.note_break(self.position);
            self.note_end(closed.starts_with(self.root_name()));
        } else {
            self.opening_tag()?;
        }
        Ok(())
    }

    /// Skips a comment, and notes it if it is malformed.
    fn comment(&mut self) {
        const START: usize = "<!--".len();
        let start = self.position;
        self.position = (start + START).min(self.text.len());
        self.skip_past("-->");
        let is_closed = self.text[..self.position].ends_with("-->");
        let content = start + START..self.position.saturating_sub("-->".len());
        if is_closed
            && let Some(content) = self.text.get(content)
            && (content.contains("--") || content.ends_with('-'))
        {
            self.outline.hyphenated_comments.push(start..self.position);
        }
    }

    /// The length of an opening tag without its bracket, and the number of quoted values in it.
    fn measure_tag(&self) -> Result<(usize, usize), Refused> {
        let bytes = self.rest().as_bytes();
        let mut quote = None;
        let mut values = 0;
        for (offset, &byte) in bytes.iter().enumerate().skip(1) {
            match (quote, byte) {
                (Some((open, _)), _) if open == byte => quote = None,
                (Some((_, opened)), b'<') => return Err(self.unclosed_quote(opened)),
                (Some(_), _) => {}
                (None, b'"' | b'\'') => {
                    quote = Some((byte, offset));
                    values += 1;
                }
                (None, b'>') => return Ok((offset, values)),
                (None, _) => {}
            }
        }
        match quote {
            Some((_, opened)) => Err(self.unclosed_quote(opened)),
            None => Ok((bytes.len(), values)),
        }
    }

    /// The error for a quote at `offset` from the cursor, which has no end before the next tag.
    fn unclosed_quote(&self, offset: usize) -> Refused {
        let start = self.position + offset;
        let line = self.text[start..].lines().next().unwrap_or_default();
        let message = "this quote is not closed (`<` inside a value is written `&lt;`)";
        let range = start..start + line.trim_end().len();
        Refused { fault: Fault::Syntax, message: message.to_owned(), range }
    }

    /// Counts the quoted values up to the end of the tag.
    fn opening_tag(&mut self) -> Result<(), Refused> {
        let (end, values) = self.measure_tag()?;
        let bytes = self.rest().as_bytes();
        let name_length = bytes.iter().take_while(|b| !b" \t\r\n/>".contains(b)).count();
        if values > self.limits.attributes {
            let limit = self.limits.attributes;
            let message = format!("an element with {values} attributes; at most {limit} are read");
            return Err(self.refuse(Fault::Limit, message, name_length));
        }
        self.outline.elements += 1;
        if self.outline.elements > self.limits.elements {
            let message = format!("more than {} elements in one file", self.limits.elements);
            return Err(self.refuse(Fault::Limit, message, name_length));
        }
        let after = (self.position + end + 1).min(self.text.len());
        if self.outline.elements == 1 {
            self.outline.root = self.position..after;
        }
        if bytes[..end].last() == Some(&b'/') {
            self.note_break(after);
            self.position = after;
            self.note_end(self.outline.elements == 1);
            return Ok(());
        }
        self.depth += 1;
        if self.depth > self.limits.document.depth {
            let limit = self.limits.document.depth;
            let message = format!("elements nest more than {limit} deep");
            return Err(self.refuse(Fault::Limit, message, name_length));
        }
        self.position += end;
        Ok(())
    }

    /// Records the end of a top-level element.
    fn note_break(&mut self, place: usize) {
        let Outline { root, breaks, .. } = &mut self.outline;
        if self.depth == 1 && place >= breaks.last().unwrap_or(&root.end) + PIECE {
            breaks.push(place);
        }
    }

    /// Records the end of the root if the last tag closed it.
    fn note_end(&mut self, is_of_root: bool) {
        if self.depth == 0 && self.outline.elements > 0 && is_of_root {
            self.outline.end = Some(self.position);
        }
    }

    /// The name of the root, once its opening tag was read.
    fn root_name(&self) -> &'a str {
        let tag = self.text[self.outline.root.clone()].trim_start_matches('<');
        tag.split([' ', '\t', '\r', '\n', '/', '>']).next().unwrap_or_default()
    }

    fn skip_past(&mut self, end: &str) {
        let rest = self.rest();
        self.position += rest.find(end).map_or(rest.len(), |offset| offset + end.len());
    }

    fn refuse(&self, fault: Fault, message: String, length: usize) -> Refused {
        Refused { fault, message, range: self.position..self.position + length }
    }
}

#[cfg(test)]
mod tests {
    use etendue_document::DocumentLimits;

    use super::*;

    fn refused(text: &str) -> Refused {
        scan(text, &Limits::default()).unwrap_err()
    }

    #[test]
    fn ordinary_scenes_pass() {
        let text = "<?xml version='1.0'?><!-- <a><a> --><scene a='>' b=\"'\"><x/><y></y></scene>";
        let document = DocumentLimits { depth: 2, ..DocumentLimits::default() };
        let limits = Limits { document, ..Limits::default() };
        assert!(scan(text, &limits).is_ok());
    }

    #[test]
    fn a_doctype_is_refused_at_its_place() {
        let found = refused("<?xml version='1.0'?>\n<!DOCTYPE scene [<!ENTITY a 'b'>]>\n<scene/>");
        assert_eq!((found.fault, found.range.start), (Fault::Unsupported, 22));
        assert!(scan("<!-- <!DOCTYPE --><scene/>", &Limits::default()).is_ok());
    }

    #[test]
    fn depth_is_bounded_at_the_first_element_too_deep() {
        let found = refused(&"<a>".repeat(200_000));
        assert_eq!((found.fault, found.range.start), (Fault::Limit, 64 * 3));
    }

    #[test]
    fn an_unclosed_quote_is_pointed_at() {
        for (text, quoted) in [
            ("<a>\n<b x='1' y=\"35.6/>\n<c z=\"1\"/></a>", "\"35.6/>"),
            ("<a x='1>", "'1>"),
            ("<a x=\"1'/><b/>\r\n</a>", "\"1'/><b/>"),
        ] {
            let found = refused(text);
            assert_eq!((found.fault, &text[found.range]), (Fault::Syntax, quoted), "{text}");
        }
    }

    #[test]
    fn the_root_ends_at_its_closing_tag() {
        let end = |text: &str| scan(text, &Limits::default()).unwrap().end;
        assert_eq!(end("<a><b/></a><c>"), Some(11));
        assert_eq!(end("<a/> <b>"), Some(4));
        assert_eq!(end("<a></b><c/>"), None, "what is malformed is left to the parser");
        assert_eq!(end("<a><b></a>"), None);
    }

    #[test]
    fn comments_with_two_hyphens_are_noted() {
        let text = "<!-- a -- b --><a><!-- c --><!--- d ---></a>";
        let outline = scan(text, &Limits::default()).unwrap();
        let found: Vec<&str> =
            outline.hyphenated_comments.iter().map(|range| &text[range.clone()]).collect();
        assert_eq!(found, ["<!-- a -- b -->", "<!--- d --->"]);
    }

    #[test]
    fn attributes_and_namespaces_are_bounded() {
        let attributes: String = (0..100_000).map(|index| format!(" a{index}='1'")).collect();
        let found = refused(&format!("<scene>\n<b{attributes}/></scene>"));
        assert_eq!((found.fault, found.range), (Fault::Limit, 8..10));
        let found = refused(&format!("<r>{}</r>", "<a xmlns:x='u'/>".repeat(50)));
        assert_eq!((found.fault, found.range.start), (Fault::Limit, 16 * 16 + 3 + 3));
    }
}
