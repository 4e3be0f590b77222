//! Parses long texts in pieces, so that the parser's tree and the finished document are never both
//! in memory as a whole.
//!
//! A piece is a range of top-level elements of the `<scene>`, wrapped in its opening and closing
//! tag. The parser sees a complete file with the same namespaces, so its errors are the same.

use std::borrow::Cow;
use std::ops::Range;

use etendue_document::{Diagnostic, Fault, SourceId, Span};

use crate::loader::Loader;
use crate::origin::Origin;
use crate::scan::{self, Outline};
use crate::syntax::{self, SyntaxError};

/// A piece of a text, and its position.
struct Piece {
    range: Range<usize>,
    is_first: bool,
    is_last: bool,
}

/// The pieces of a text; only a long scene has more than one.
fn pieces(text: &str, outline: &Outline) -> Vec<Piece> {
    let is_scene = text[outline.root.clone()].strip_prefix("<scene").is_some_and(|rest| {
        rest.starts_with(|next: char| next == '>' || next.is_ascii_whitespace())
    });
    let breaks = if is_scene { outline.breaks.as_slice() } else { &[] };
    let starts = std::iter::once(0).chain(breaks.iter().copied());
    let ends = breaks.iter().copied().chain([text.len()]);
    let piece = |(start, end)| Piece {
        range: start..end,
        is_first: start == 0,
        is_last: end == text.len(),
    };
    starts.zip(ends).map(piece).collect()
}

/// Adds the root's tags to a piece that lacks them.
fn wrap(text: &str, outline: &Outline, piece: &Piece, wrapped: &mut String) {
    wrapped.clear();
    if !piece.is_first {
        wrapped.push_str(&text[outline.root.clone()]);
    }
    wrapped.push_str(&text[piece.range.clone()]);
    if !piece.is_last {
        wrapped.push_str("</scene>");
    }
}

/// A text without the comments, instructions and white space at its front.
pub(crate) fn after_comments(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        let end = match text {
            _ if text.starts_with("<!--") => "-->",
            _ if text.starts_with("<?") => "?>",
            _ => return text,
        };
        text = text.split_once(end).map_or("", |(_, rest)| rest);
    }
}

impl Loader<'_> {
    /// Parses a stored text and calls `then` with the root of each piece, and whether it is the
    /// first piece. Errors in any piece are reported before the first call.
    pub(crate) fn for_each_piece(
        &mut self,
        source: SourceId,
        mut then: impl FnMut(&mut Self, roxmltree::Node<'_, '_>, bool),
    ) {
        let Some(text) = self.sources.get(source).map(etendue_document::Source::text) else {
            return;
        };
        let limits = &self.options.limits;
        let outline = match scan::scan(&text, limits) {
            Ok(outline) => outline,
            Err(refused) => {
                let span = Span::new(source, refused.range);
                self.diagnostics.error(refused.fault, span, refused.message);
                return;
            }
        };
        let text = self.readable(source, &text, &outline);
        let pieces = pieces(&text, &outline);
        let outer = self.origin;
        if pieces.len() > 1 {
            // Few objects use less than an instance: a reference and a transform of two operations.
            self.builder.reserve(outline.elements / 4);
        }
        let mut wrapped = String::new();
        // Several pieces are parsed twice, so that a malformed file yields no nodes at all.
        for is_trial in [true, false].into_iter().skip(usize::from(pieces.len() == 1)) {
            for piece in &pieces {
                let parsed = if pieces.len() == 1 {
                    &*text
                } else {
                    wrap(&text, &outline, piece, &mut wrapped);
                    &*wrapped
                };
                let wrapper = if piece.is_first { 0 } else { outline.root.len() };
                let (root, start) = (outline.root.start, piece.range.start);
                let origin = Origin { source, wrapper, root, start };
                match self.parse_piece(parsed, piece) {
                    Ok(_) if is_trial => {}
                    Ok(document) => {
                        self.origin = origin;
                        then(self, document.root_element(), piece.is_first);
                    }
                    Err(error) => {
                        self.report(error, &origin);
                        self.origin = outer;
                        return;
                    }
                }
            }
        }
        self.origin = outer;
    }

    /// The text up to the end of its root, with comments that the parser accepts. Offsets stay the
    /// same. Warns of what is left out or changed.
    fn readable<'t>(&self, source: SourceId, text: &'t str, outline: &Outline) -> Cow<'t, str> {
        let end = outline.end.unwrap_or(text.len());
        let rest = after_comments(&text[end..]);
        if !rest.is_empty() {
            let start = text.len() - rest.len();
            let line = rest.lines().next().unwrap_or_default().trim_end();
            let place = Span::new(source, start..start + line.len());
            let message = "what follows the end of the root element is left out";
            self.diagnostics.warning(Fault::Syntax, place, message);
        }
        let comments = &outline.hyphenated_comments;
        let Some(first) = comments.first() else { return Cow::Borrowed(&text[..end]) };
        let message = "`--` inside a comment is not XML, but is read";
        self.diagnostics.warning(Fault::Syntax, Span::new(source, first.clone()), message);
        let mut readable = String::with_capacity(end);
        for comment in comments {
            readable.push_str(&text[readable.len()..comment.start + 4]);
            readable.push_str(&text[comment.start + 4..comment.end - 3].replace('-', " "));
            readable.push_str("-->");
        }
        readable.push_str(&text[readable.len()..end]);
        Cow::Owned(readable)
    }

    fn report(&self, error: SyntaxError, origin: &Origin) {
        let SyntaxError { fault, message, range, opened } = error;
        let mut diagnostic = Diagnostic::error(fault, origin.span(range), message);
        if let Some(opened) = opened {
            diagnostic = diagnostic.related(origin.span(opened), "opened here");
        }
        self.diagnostics.push(diagnostic);
    }

    /// Parses a piece unless it is too large.
    fn parse_piece<'a>(
        &self,
        text: &'a str,
        piece: &Piece,
    ) -> Result<roxmltree::Document<'a>, SyntaxError> {
        let limits = &self.options.limits;
        if text.len() > limits.object_bytes.saturating_add(2 * scan::PIECE) {
            let message = format!("an object here takes more than {} bytes", limits.object_bytes);
            let start = text.len() - piece.range.len();
            return Err(SyntaxError {
                fault: Fault::Limit,
                message,
                range: start..start + 1,
                opened: None,
            });
        }
        syntax::parse(text, limits)
    }
}

#[cfg(test)]
mod tests {
    use etendue_document::{Diagnostics, Document, MemoryResources};

    use super::*;
    use crate::options::{Limits, LoadOptions};
    use crate::read_text;

    /// Several pieces of shapes, followed by `last`.
    fn long_scene(last: &str) -> String {
        let mut text = "<?xml version='1.0'?>\n<scene version='3.0.0'>\n".to_owned();
        text.push_str("<shape type='shapegroup' id='größe'><shape type='cube'/></shape>\n");
        for index in 0..3 * scan::PIECE / 60 {
            text.push_str(&format!(
                "<shape type='instance'><ref id='größe'/><float name='x' value='{index}'/></shape>\n"
            ));
        }
        text + last
    }

    fn load(text: &str) -> (Option<Document>, Vec<(String, String)>) {
        let diagnostics = Diagnostics::new();
        let options = LoadOptions::default();
        let document = read_text(text, &MemoryResources::default(), &options, &diagnostics).ok();
        let words = |found: &etendue_document::Diagnostic| {
            let span = found.span.unwrap();
            (found.message.clone(), text[span.range()].to_owned())
        };
        let found = diagnostics.sorted().iter().map(words).collect();
        (document, found)
    }

    #[test]
    fn a_long_scene_is_taken_apart_between_its_objects() {
        let text = long_scene("</scene>");
        let outline = scan::scan(&text, &Limits::default()).unwrap();
        let pieces = pieces(&text, &outline);
        assert!(pieces.len() >= 3, "{}", pieces.len());
        assert_eq!(&text[outline.root], "<scene version='3.0.0'>");
        for (piece, next) in pieces.iter().zip(&pieces[1..]) {
            assert!(text[piece.range.clone()].ends_with("</shape>"));
            assert_eq!(piece.range.end, next.range.start);
        }
    }

    #[test]
    fn every_object_of_a_long_scene_is_read_once_and_knows_its_place() {
        let text = long_scene("<bsdf type='diffuse' id='last'/></scene>");
        let (document, found) = load(&text);
        assert_eq!(found, []);
        let document = document.unwrap();
        let scene = document.node(document.root);
        assert_eq!(scene.children.len(), text.matches("\n<").count() - 1);
        for (child, line) in scene.children.iter().zip(text.lines().skip(2)) {
            let node = document.node(child.node);
            assert!(line.starts_with(&text[node.span.range()]), "{line}");
            if let [parameter] = &*node.parameters {
                assert!(line.contains(&text[parameter.span.range()]), "{line}");
                assert_eq!(node.children[0].node.index(), 1);
            }
        }
    }

    #[test]
    fn what_is_wrong_with_a_long_scene_is_said_as_of_a_short_one() {
        let cases = [
            (
                "<bsdf type='diffuse'></shape></scene>",
                "`</shape>` where `</bsdf>` is expected",
                "<",
            ),
            ("<bsdf type='diffuse'>", "the file ends before this element is closed", "<bsdf"),
            ("", "the file ends before this element is closed", "<scene"),
            ("<x:b/></scene>", "", ""),
        ];
        for (last, message, place) in cases {
            let short = load(&format!("<?xml version='1.0'?>\n<scene version='3.0.0'>\n{last}"));
            let (document, found) = load(&long_scene(last));
            assert!(document.is_none(), "{last}");
            assert_eq!(found, short.1, "{last}");
            assert!(found[0].0.contains(message) && found[0].1.starts_with(place), "{found:?}");
        }
        let (document, found) = load(&long_scene("</scene> <scene/>\n<!-- -->"));
        assert!(document.is_some());
        assert_eq!(found[0].1, "<scene/>", "{found:?}");
        let (document, found) = load(&long_scene("words <nothing/></scene>"));
        assert!(document.is_some());
        let words: Vec<&str> = found.iter().map(|(_, word)| word.as_str()).collect();
        assert_eq!(words, ["words", "<nothing"]);
    }

    #[test]
    fn what_is_parsed_at_once_is_bounded() {
        let options = LoadOptions {
            limits: Limits { object_bytes: 100, ..Limits::default() },
            ..LoadOptions::default()
        };
        let inside = "<float name='x' value='1'/>".repeat(4 * scan::PIECE / 27);
        let text = format!("<scene>\n<shape type='cube'>{inside}</shape></scene>");
        let diagnostics = Diagnostics::new();
        read_text(&text, &MemoryResources::default(), &options, &diagnostics).ok();
        let found = diagnostics.sorted();
        assert_eq!((found.len(), found[0].fault), (1, Fault::Limit));
    }
}
