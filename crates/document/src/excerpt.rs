//! Formats findings as text: file, line, column, the line itself, a caret, and advice.

use std::ops::Range;

use codespan_reporting::diagnostic as codespan;
use codespan_reporting::files::{Error, Files};
use codespan_reporting::term;

use crate::diagnostic::{Diagnostic, Severity};
use crate::printable::{printable, printable_lines};
use crate::source::{Source, Sources, floor_boundary};
use crate::span::{Location, Span};

/// Lines of up to this many characters are shown whole. A scene may be a single line of megabytes,
/// so of longer lines only the part around the span is shown.
const SHOWN: usize = 120;

/// How excerpts look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExcerptStyle {
    /// Whether there are the colour codes of a terminal.
    pub is_colored: bool,
    /// Whether frames consist of ASCII characters alone.
    pub is_ascii: bool,
}

/// Formats a finding for a terminal.
///
/// The position is shown as `file:line:column`, with the line and carets under the span, or as the
/// path of a node built in code. Lines of advice follow. The text ends with a line break.
pub fn render_diagnostic(
    diagnostic: &Diagnostic,
    sources: &Sources,
    style: ExcerptStyle,
) -> String {
    let ellipsis = if style.is_ascii { "..." } else { "…" };
    let mut excerpts = Excerpts { list: Vec::new(), ellipsis };
    let (mut labels, mut notes) = (Vec::new(), Vec::new());
    match diagnostic.span.map(|span| excerpts.add(span, sources)) {
        Some(Shown::Excerpt(file, range)) => labels.push(codespan::Label::primary(file, range)),
        Some(Shown::Path(path)) => notes.push(format!("at {}", printable(&path))),
        Some(Shown::Nothing) | None => {}
    }
    for related in &diagnostic.related {
        match excerpts.add(related.span, sources) {
            Shown::Excerpt(file, range) => {
                let label = codespan::Label::secondary(file, range);
                labels.push(label.with_message(printable(&related.message)));
            }
            Shown::Path(path) => {
                notes.push(format!("at {}: {}", printable(&path), printable(&related.message)));
            }
            Shown::Nothing => {}
        }
    }
    notes.extend(diagnostic.help.iter().map(|help| printable_lines(help).into_owned()));
    let severity = match diagnostic.severity {
        Severity::Error => codespan::Severity::Error,
        Severity::Warning => codespan::Severity::Warning,
        Severity::Note => codespan::Severity::Note,
    };
    let shown = codespan::Diagnostic::new(severity)
        .with_message(printable(&diagnostic.message))
        .with_labels(labels)
        .with_notes(notes);
    match emit(&shown, &excerpts, style) {
        Ok(text) => text.trim_end().to_owned() + "\n",
        // Layout fails only for a broken excerpt; the message must still be shown.
        Err(_) => format!("{}\n", printable(&diagnostic.message)),
    }
}

fn emit(
    shown: &codespan::Diagnostic<usize>,
    excerpts: &Excerpts,
    style: ExcerptStyle,
) -> Result<String, Error> {
    let mut config = term::Config::default();
    if style.is_ascii {
        config.chars = term::Chars::ascii();
    }
    if !style.is_colored {
        return term::emit_into_string(&config, excerpts, shown);
    }
    let mut writer = term::termcolor::Ansi::new(Vec::new());
    term::emit_to_write_style(&mut writer, &config, excerpts, shown)?;
    Ok(String::from_utf8_lossy(&writer.into_inner()).into_owned())
}

/// One source line as shown.
struct Excerpt {
    name: String,
    line_number: usize,
    column_number: usize,
    text: String,
}

/// How a position is shown.
enum Shown {
    /// An excerpt and the span within it.
    Excerpt(usize, Range<usize>),
    /// The path of a node, or a place in a text that is not quoted.
    Path(String),
    /// The position is unknown.
    Nothing,
}

/// The shown lines. The layout library sees each one as a separate file.
struct Excerpts {
    list: Vec<Excerpt>,
    /// What stands for the parts that are left out.
    ellipsis: &'static str,
}

impl Excerpts {
    /// Extracts the line of a span from its source.
    fn add(&mut self, span: Span, sources: &Sources) -> Shown {
        let source = span.source().and_then(|id| sources.get(id));
        match (sources.locate(span), source) {
            (Location::Node { path }, _) => Shown::Path(path),
            (Location::Text { .. }, None) => Shown::Nothing,
            (place @ Location::Text { .. }, Some(source)) if source.is_withheld() => {
                Shown::Path(place.to_string())
            }
            (Location::Text { name, line, column }, Some(source)) => {
                let (text, range) = cut(source, span, self.ellipsis);
                let name = printable(&name).into_owned();
                self.list.push(Excerpt { name, line_number: line, column_number: column, text });
                Shown::Excerpt(self.list.len() - 1, range)
            }
        }
    }
}

/// The part of a span's first line around the span, and the span within it. A span over several
/// lines is cut to the first one.
fn cut(source: &Source, span: Span, ellipsis: &str) -> (String, Range<usize>) {
    let whole = source.text();
    let start = floor_boundary(&whole, span.range().start);
    let line = source.line_range(source.line_index(start), &whole);
    let start = start.min(line.end);
    let end = floor_boundary(&whole, span.range().end.clamp(start, line.end));
    let before = &whole[line.start..start];
    let inside = &whole[start..end];
    let after = &whole[end..line.end];

    let is_long = whole[line].chars().nth(SHOWN).is_some();
    let limit = |count: usize| if is_long { count } else { SHOWN };
    let (before, before_cut) = last_characters(before, limit(SHOWN / 3));
    let (inside, inside_cut) = first_characters(inside, limit(SHOWN / 2));
    let after_limit = if inside_cut { 0 } else { limit(SHOWN / 3) };
    let (after, after_cut) = first_characters(after, after_limit);
    let opening = if before_cut { ellipsis } else { "" };
    let closing = if inside_cut || after_cut { ellipsis } else { "" };
    let shown_before = format!("{opening}{}", shown_in_line(before));
    let shown_inside = shown_in_line(inside);
    let text = format!("{shown_before}{shown_inside}{}{closing}", shown_in_line(after));
    let start = shown_before.len();
    (text, start..start + shown_inside.len())
}

fn first_characters(text: &str, count: usize) -> (&str, bool) {
    match text.char_indices().nth(count) {
        Some((end, _)) => (&text[..end], true),
        None => (text, false),
    }
}

fn last_characters(text: &str, count: usize) -> (&str, bool) {
    match text.char_indices().rev().nth(count) {
        Some((start, first)) => (&text[start + first.len_utf8()..], true),
        None => (text, false),
    }
}

/// A part of a line. Tabs become spaces.
fn shown_in_line(text: &str) -> String {
    printable(&text.replace('\t', " ")).into_owned()
}

impl<'a> Files<'a> for Excerpts {
    type FileId = usize;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: usize) -> Result<&'a str, Error> {
        Ok(&self.get(id)?.name)
    }

    fn source(&'a self, id: usize) -> Result<&'a str, Error> {
        Ok(&self.get(id)?.text)
    }

    fn line_index(&'a self, _: usize, _: usize) -> Result<usize, Error> {
        Ok(0)
    }

    fn line_number(&'a self, id: usize, _: usize) -> Result<usize, Error> {
        Ok(self.get(id)?.line_number)
    }

    fn column_number(&'a self, id: usize, _: usize, _: usize) -> Result<usize, Error> {
        Ok(self.get(id)?.column_number)
    }

    fn line_range(&'a self, id: usize, _: usize) -> Result<Range<usize>, Error> {
        Ok(0..self.get(id)?.text.len())
    }
}

impl Excerpts {
    fn get(&self, id: usize) -> Result<&Excerpt, Error> {
        self.list.get(id).ok_or(Error::FileMissing)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    use crate::diagnostic::Fault;

    const PLAIN: ExcerptStyle = ExcerptStyle { is_colored: false, is_ascii: false };
    const COLORED: ExcerptStyle = ExcerptStyle { is_colored: true, ..PLAIN };

    fn sources(text: &str) -> Sources {
        let mut sources = Sources::default();
        sources.add("scene.xml", text);
        sources
    }

    fn span(range: Range<usize>) -> Span {
        Span::new(crate::span::SourceId::default(), range)
    }

    #[test]
    fn an_excerpt_shows_place_line_caret_and_help() {
        let text = "<scene>\n\t<float name=\"alpah\" value=\"1\"/>\n</scene>";
        let diagnostic = Diagnostic::warning(Fault::UnknownParameter, span(22..27), "no `alpah`")
            .related(span(0..6), "in this scene")
            .help("did you mean `alpha`?");
        let expected = "\
warning: no `alpah`
  ┌─ scene.xml:2:15
  │
2 │  <float name=\"alpah\" value=\"1\"/>
  │               ^^^^^
  │
  ┌─ scene.xml:1:1
  │
1 │ <scene>
  │ ------ in this scene
  │
  = did you mean `alpha`?
";
        assert_eq!(render_diagnostic(&diagnostic, &sources(text), PLAIN), expected);
    }

    #[test]
    fn a_finding_without_a_place_is_its_message() {
        let diagnostic = Diagnostic::error(Fault::Io, None, "cannot read x.xml");
        let text = render_diagnostic(&diagnostic, &Sources::default(), PLAIN);
        assert_eq!(text, "error: cannot read x.xml\n");
    }

    #[test]
    fn of_long_lines_and_long_spans_a_part_is_shown() {
        let text = format!("{}here{}", "a".repeat(1_000_000), "b".repeat(1_000_000));
        let diagnostic = Diagnostic::error(Fault::Syntax, span(1_000_000..1_000_004), "wrong");
        let shown = render_diagnostic(&diagnostic, &sources(&text), PLAIN);
        assert!(shown.contains("scene.xml:1:1000001"), "{shown}");
        assert!(shown.contains("…aaa") && shown.contains("ahereb") && shown.contains("bbb…"));
        assert!(shown.lines().all(|line| line.chars().count() < 150), "{shown}");
        let diagnostic = Diagnostic::error(Fault::Syntax, span(0..2_000_000), "wrong");
        let shown = render_diagnostic(&diagnostic, &sources(&text), PLAIN);
        assert!(shown.lines().all(|line| line.chars().count() < 150), "{shown}");
    }

    #[test]
    fn colors_come_only_when_asked_for_and_files_cannot_send_any() {
        let diagnostic = Diagnostic::error(Fault::Syntax, span(0..3), "bad \u{1b}[31m");
        let sources = sources("a\u{1b}[2J");
        assert!(!render_diagnostic(&diagnostic, &sources, PLAIN).contains('\u{1b}'));
        assert!(render_diagnostic(&diagnostic, &sources, COLORED).contains("\u{1b}["));
    }

    #[test]
    fn a_name_stays_on_its_line() {
        let diagnostic = Diagnostic::error(Fault::Io, span(0..1), "no file `x\nerror: all gone`");
        let mut sources = Sources::default();
        sources.add("p\u{9b}2J\n.xml", "a");
        let shown = render_diagnostic(&diagnostic.help("in\n/a\u{202e}"), &sources, PLAIN);
        assert!(shown.starts_with("error: no file `x\\nerror: all gone`\n"), "{shown}");
        assert!(shown.contains(r"p\u{9b}2J\n.xml:1:1") && shown.contains(r"/a\u{202e}"), "{shown}");
    }

    #[test]
    fn ascii_frames_need_no_other_characters() {
        let text = "a".repeat(1000);
        let diagnostic = Diagnostic::error(Fault::Syntax, span(500..501), "wrong").help("advice");
        let style = ExcerptStyle { is_ascii: true, ..PLAIN };
        let shown = render_diagnostic(&diagnostic, &sources(&text), style);
        assert!(shown.is_ascii() && shown.contains("...aaa"), "{shown}");
    }

    proptest! {
        #[test]
        fn any_span_of_any_text_can_be_shown(text in "[a-cö\u{1F600}\n\r\t]{0,40}",
                                             start in 0usize..60, length in 0usize..60) {
            let diagnostic = Diagnostic::error(Fault::Syntax, span(start..start + length), "x");
            let shown = render_diagnostic(&diagnostic, &sources(&text), PLAIN);
            prop_assert!(shown.starts_with("error: x\n"));
            prop_assert!(shown.contains("scene.xml:"));
        }
    }
}
