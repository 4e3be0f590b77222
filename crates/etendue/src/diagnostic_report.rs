//! The diagnostics of loading a scene.

use std::fmt;

use etendue_document::{
    Diagnostic, Diagnostics, ExcerptStyle, Severity, Sources, Span, render_diagnostic,
};

/// All diagnostics, with the source texts they refer to.
#[derive(Clone, Debug, Default)]
pub struct DiagnosticReport {
    /// Sorted by file, then by position.
    pub list: Vec<Diagnostic>,
    /// The number of errors, including those not kept.
    pub error_count: usize,
    /// The number of diagnostics not kept.
    pub omitted: usize,
    /// The source texts.
    pub sources: Sources,
}

impl DiagnosticReport {
    pub(crate) fn new(diagnostics: &Diagnostics, mut sources: Sources) -> Self {
        let list = diagnostics.sorted();
        // Otherwise each excerpt would unpack a large text again.
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

    /// Whether any diagnostic prevents rendering.
    pub fn has_errors(&self) -> bool {
        self.error_count > 0
    }
}

impl fmt::Display for DiagnosticReport {
    /// The errors, each with its position and excerpt.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let errors = self.list.iter().filter(|diagnostic| diagnostic.severity == Severity::Error);
        for error in errors {
            formatter.write_str(&render_diagnostic(
                error,
                &self.sources,
                ExcerptStyle::default(),
            ))?;
        }
        Ok(())
    }
}
