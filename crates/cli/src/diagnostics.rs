//! Prints the diagnostics of a loaded scene on standard error.

use etendue::DiagnosticReport;
use etendue::document::{Diagnostic, Location, Severity};
use serde_json::{Value, json};

use crate::listing::{Listing, Repeats};
use crate::{style, terminal, text};

/// How many of the diagnostics to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Detail {
    /// Only errors.
    Errors,
    /// Errors and warnings.
    Warnings,
    /// Notes too; many similar diagnostics are shortened to one line each.
    Notes,
    /// Notes too, and every diagnostic in full.
    Everything,
}

/// How many similar diagnostics are listed in one line each where brevity matters.
const MAX_LINES: usize = 20;

impl Detail {
    fn shows(self, diagnostic: &Diagnostic) -> bool {
        match diagnostic.severity {
            Severity::Error => true,
            Severity::Warning => self != Self::Errors,
            Severity::Note => matches!(self, Self::Notes | Self::Everything),
        }
    }

    fn repeats(self) -> Repeats {
        match self {
            Self::Errors | Self::Warnings => Repeats::Lines(MAX_LINES),
            Self::Notes => Repeats::Lines(usize::MAX),
            Self::Everything => Repeats::Full,
        }
    }
}

/// Prints diagnostics with their excerpts, and a summary if there are any.
pub(crate) fn show(diagnostics: &DiagnosticReport, detail: Detail) {
    if show_list(diagnostics, detail) {
        terminal::message_line(&summary(diagnostics));
    }
}

/// Prints diagnostics with their excerpts; returns whether there were any to print.
pub(crate) fn show_list(diagnostics: &DiagnosticReport, detail: Detail) -> bool {
    let mut listing = Listing::new(&diagnostics.sources, detail.repeats(), style::excerpts());
    let shown = diagnostics.list.iter().filter(|diagnostic| detail.shows(diagnostic));
    shown.for_each(|diagnostic| listing.add(diagnostic));
    let all = listing.finish();
    terminal::styled(&all);
    !all.is_empty()
}

/// `2 errors, 1 warning`.
pub(crate) fn summary(diagnostics: &DiagnosticReport) -> String {
    let errors = text::counted(diagnostics.error_count, "error");
    let is_warning = |diagnostic: &&Diagnostic| diagnostic.severity == Severity::Warning;
    let warnings = diagnostics.list.iter().filter(is_warning).count();
    let mut summary = format!("{errors}, {}", text::counted(warnings, "warning"));
    if diagnostics.omitted > 0 {
        summary.push_str(&format!(
            ", {} more diagnostics not shown",
            text::grouped(diagnostics.omitted)
        ));
    }
    summary
}

/// The diagnostics as JSON: severity, message, place and help of each.
pub(crate) fn as_json(diagnostics: &DiagnosticReport) -> Value {
    let place = |diagnostic: &Diagnostic| {
        Some(match diagnostics.sources.locate(diagnostic.span?) {
            Location::Text { name, line, column } => {
                json!({ "file": name, "line": line, "column": column })
            }
            Location::Node { path } => json!({ "node": path }),
        })
    };
    let entry = |diagnostic: &Diagnostic| {
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        json!({
            "severity": severity,
            "message": diagnostic.message,
            "place": place(diagnostic),
            "help": diagnostic.help,
        })
    };
    diagnostics.list.iter().map(entry).collect()
}
