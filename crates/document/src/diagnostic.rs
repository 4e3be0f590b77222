//! Diagnostics: what is wrong, whose fault it is, and where.

use std::collections::HashSet;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::span::Span;

/// The severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The scene cannot be rendered.
    Error,
    /// The picture may not be what the author meant.
    Warning,
    /// Worth knowing.
    Note,
}

/// Whose fault it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fault {
    /// A file is missing or cannot be read.
    Io,
    /// The text violates its format.
    Syntax,
    /// There is no plugin of that name.
    UnknownPlugin,
    /// The plugin has no parameter or child of that name.
    UnknownParameter,
    /// A required parameter or child is missing.
    MissingParameter,
    /// A value has the wrong type or is out of range.
    BadValue,
    /// A known feature that this version does not support.
    Unsupported,
    /// Larger, deeper or more than the limits allow.
    Limit,
    /// Invalid geometry.
    Geometry,
    /// An approximation is rendered instead of what the scene asks for.
    Approximation,
}

/// Another position related to a diagnostic.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Related {
    /// Where.
    pub span: Span,
    /// What is found there.
    pub message: String,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[must_use = "a diagnostic is lost unless it is pushed"]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Whose fault it is.
    pub fault: Fault,
    /// One sentence without a full stop.
    pub message: String,
    /// Where, if there is a position.
    pub span: Option<Span>,
    /// Related positions.
    pub related: Vec<Related>,
    /// How to fix it, one line each.
    pub help: Vec<String>,
}

impl Diagnostic {
    /// A finding of the given severity, to be completed and reported.
    pub fn new(
        severity: Severity,
        fault: Fault,
        span: impl Into<Option<Span>>,
        message: impl Into<String>,
    ) -> Self {
        Self {
            severity,
            fault,
            message: message.into(),
            span: span.into(),
            related: Vec::new(),
            help: Vec::new(),
        }
    }

    /// An error, to be completed and reported.
    pub fn error(fault: Fault, span: impl Into<Option<Span>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, fault, span, message)
    }

    /// A warning, to be completed and reported.
    pub fn warning(
        fault: Fault,
        span: impl Into<Option<Span>>,
        message: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Warning, fault, span, message)
    }

    /// Adds a line of advice.
    pub fn help(mut self, line: impl Into<String>) -> Self {
        self.help.push(line.into());
        self
    }

    /// Adds a related position.
    pub fn related(mut self, span: Span, message: impl Into<String>) -> Self {
        self.related.push(Related { span, message: message.into() });
        self
    }

    /// The order in which findings are shown: by position, those without one first.
    fn order(&self) -> (Option<Span>, Severity, &str) {
        (self.span, self.severity, &self.message)
    }
}

/// Messages quote files, and a single word of a file may be megabytes long, so messages are cut
/// after this many characters.
const MESSAGE_LENGTH: usize = 1000;

/// A hostile file can have millions of errors; nobody reads more than this.
const KEPT: usize = 1000;

#[derive(Debug, Default)]
struct Found {
    list: Vec<Diagnostic>,
    known: HashSet<Diagnostic>,
    error_count: usize,
    omitted: usize,
}

/// All findings of one run, without duplicates. The threads that build a scene share them.
///
/// At most 1,000 are kept; [`Diagnostics::omitted`] counts the rest.
#[derive(Debug, Default)]
pub struct Diagnostics {
    strict: bool,
    found: Mutex<Found>,
}

impl Diagnostics {
    /// A collection that treats unknown parameters as warnings.
    pub fn new() -> Self {
        Self::default()
    }

    /// A collection that treats unknown parameters as errors.
    pub fn strict() -> Self {
        Self { strict: true, ..Self::default() }
    }

    /// Adds a finding unless an identical one exists.
    pub fn push(&self, mut diagnostic: Diagnostic) {
        if self.strict && diagnostic.fault == Fault::UnknownParameter {
            diagnostic.severity = Severity::Error;
        }
        shorten(&mut diagnostic.message);
        let is_error = diagnostic.severity == Severity::Error;
        let mut found = self.lock();
        if found.known.contains(&diagnostic) {
            return;
        }
        found.error_count += usize::from(is_error);
        if found.list.len() >= KEPT {
            found.omitted += 1;
            return;
        }
        found.known.insert(diagnostic.clone());
        found.list.push(diagnostic);
    }

    /// Adds an error.
    pub fn error(&self, fault: Fault, span: impl Into<Option<Span>>, message: impl Into<String>) {
        self.push(Diagnostic::error(fault, span, message));
    }

    /// Adds a warning.
    pub fn warning(&self, fault: Fault, span: impl Into<Option<Span>>, message: impl Into<String>) {
        self.push(Diagnostic::warning(fault, span, message));
    }

    /// Adds a note.
    pub fn note(&self, fault: Fault, span: impl Into<Option<Span>>, message: impl Into<String>) {
        self.push(Diagnostic::new(Severity::Note, fault, span, message));
    }

    /// Whether any finding prevents rendering.
    pub fn has_errors(&self) -> bool {
        self.error_count() > 0
    }

    /// The number of errors, including those beyond the first 1,000 findings.
    pub fn error_count(&self) -> usize {
        self.lock().error_count
    }

    /// Whether further findings are only counted, so that preparing help for them is wasted work.
    pub fn is_full(&self) -> bool {
        self.lock().list.len() >= KEPT
    }

    /// The number of findings that were not kept.
    pub fn omitted(&self) -> usize {
        self.lock().omitted
    }

    /// The sorted findings: file by file in the order of reading, from top to bottom; then those at
    /// nodes built in code, in the order of the nodes.
    pub fn sorted(&self) -> Vec<Diagnostic> {
        let mut list = self.lock().list.clone();
        list.sort_by(|a, b| a.order().cmp(&b.order()));
        list
    }

    /// Recovers from poisoning: a panicking thread cannot leave a partly written finding.
    fn lock(&self) -> MutexGuard<'_, Found> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Cuts a message to [`MESSAGE_LENGTH`].
fn shorten(message: &mut String) {
    if let Some((end, _)) = message.char_indices().nth(MESSAGE_LENGTH) {
        message.truncate(end);
        message.push('…');
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Sources;

    #[test]
    fn the_same_finding_counts_once_and_they_sort_by_place() {
        let mut sources = Sources::default();
        let id = sources.add("scene.xml", "abcdef");
        let diagnostics = Diagnostics::new();
        for _ in 0..3 {
            diagnostics.error(Fault::BadValue, Span::new(id, 4..5), "later");
            diagnostics.warning(Fault::BadValue, Span::new(id, 1..2), "earlier");
        }
        let messages: Vec<String> =
            diagnostics.sorted().into_iter().map(|found| found.message).collect();
        assert_eq!(messages, ["earlier", "later"]);
        assert_eq!(diagnostics.error_count(), 1);
    }

    #[test]
    fn strict_turns_unknown_parameters_into_errors_and_nothing_else() {
        let strict = Diagnostics::strict();
        strict.warning(Fault::Approximation, None, "near enough");
        assert!(!strict.has_errors());
        strict.warning(Fault::UnknownParameter, None, "what is this");
        assert!(strict.has_errors());
    }

    #[test]
    fn messages_are_bounded() {
        let diagnostics = Diagnostics::new();
        diagnostics.error(Fault::UnknownPlugin, None, "ä".repeat(1_000_000));
        assert_eq!(diagnostics.sorted()[0].message.chars().count(), MESSAGE_LENGTH + 1);
    }

    #[test]
    fn the_number_kept_is_bounded_but_all_errors_count() {
        let diagnostics = Diagnostics::new();
        for index in 0..KEPT + 500 {
            diagnostics.error(Fault::Syntax, None, format!("fault {index}"));
        }
        assert_eq!(diagnostics.sorted().len(), KEPT);
        assert_eq!(diagnostics.omitted(), 500);
        assert_eq!(diagnostics.error_count(), KEPT + 500);
    }
}
