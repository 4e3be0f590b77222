//! What was found while a scene was loaded.

use std::fmt;

use etendue_document::{Diagnostic, Diagnostics, Severity, Sources, Span, render_diagnostic};

/// Everything that was found, with the texts that it was found in.
#[derive(Clone, Debug, Default)]
pub struct DiagnosticReport {
    /// By place: file by file, then down the page.
    pub list: Vec<Diagnostic>,
    /// How many errors there are, those not kept included.
    pub error_count: usize,
    /// How many diagnostics were not kept.
    pub omitted: usize,
    /// The texts.
    pub sources: Sources,
}

impl DiagnosticReport {
    pub(crate) fn new(diagnostics: &Diagnostics, mut sources: Sources) -> Self {
        let list = diagnostics.sorted();
        // Every excerpt would unpack a large text of its own.
        let places = list.iter().flat_map(|found| {
            found.span.into_iter().chain(found.related.iter().map(|related| related.span))
        });
        places.filter_map(Span::source).for_each(|source| sources.unpack(source));
        Self {
            list,
            error_count: diagnostics.error_count(),
            omitted: diagnostics.omitted(),
            sources,
        }
    }

    /// Whether anything forbids rendering.
    pub fn has_errors(&self) -> bool {
        self.error_count > 0
    }
}

impl fmt::Display for DiagnosticReport {
    /// The errors, each with its place and excerpt.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let errors = self.list.iter().filter(|diagnostic| diagnostic.severity == Severity::Error);
        for error in errors {
            formatter.write_str(&render_diagnostic(error, &self.sources, false))?;
        }
        Ok(())
    }
}
