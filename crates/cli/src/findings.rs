//! What was found while loading a scene, on standard error.

use etendue::Findings;
use etendue::document::{Diagnostic, Severity};
use serde_json::{Value, json};

use crate::alike::{Listing, Repeats};
use crate::{color, terminal, text};

/// How much of it is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Detail {
    /// Errors alone.
    Errors,
    /// Errors and warnings.
    Warnings,
    /// Notes too; of many findings alike, all but a few in a line each.
    Notes,
    /// Notes too, and all there is to each finding however many are alike.
    Everything,
}

/// Of many findings alike, how many are listed in a line each where brevity matters.
const LINES: usize = 20;

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
            Self::Errors | Self::Warnings => Repeats::Lines(LINES),
            Self::Notes => Repeats::Lines(usize::MAX),
            Self::Everything => Repeats::Whole,
        }
    }
}

/// Shows findings with their excerpts, and what they add up to, if there are any.
pub(crate) fn show(findings: &Findings, detail: Detail) {
    if show_list(findings, detail) {
        terminal::message_line(&summary(findings));
    }
}

/// Shows findings with their excerpts; returns whether there were any to show.
pub(crate) fn show_list(findings: &Findings, detail: Detail) -> bool {
    let mut listing = Listing::new(&findings.sources, detail.repeats(), color::is_wanted());
    let shown = findings.list.iter().filter(|diagnostic| detail.shows(diagnostic));
    shown.for_each(|diagnostic| listing.add(diagnostic));
    let all = listing.finish();
    terminal::message(&all);
    !all.is_empty()
}

/// `2 errors, 1 warning`.
pub(crate) fn summary(findings: &Findings) -> String {
    let errors = text::counted(findings.error_count, "error");
    let is_warning = |diagnostic: &&Diagnostic| diagnostic.severity == Severity::Warning;
    let warnings = findings.list.iter().filter(is_warning).count();
    let mut summary = format!("{errors}, {}", text::counted(warnings, "warning"));
    if findings.omitted > 0 {
        summary.push_str(&format!(", {} more findings not shown", text::grouped(findings.omitted)));
    }
    summary
}

/// The findings for other programs: severity, message, place and advice of each.
pub(crate) fn as_json(findings: &Findings) -> Value {
    let place = |diagnostic: &Diagnostic| {
        let location = findings.sources.locate(diagnostic.span?);
        Some(json!({ "file": location.name, "line": location.line, "column": location.column }))
    };
    let finding = |diagnostic: &Diagnostic| {
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
    findings.list.iter().map(finding).collect()
}
