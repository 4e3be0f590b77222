//! Approximations, collected so that each kind is reported once.

use std::collections::BTreeMap;

use etendue_document::{Diagnostic, Diagnostics, Fault, SourceId, Sources, Span};

/// Further positions are counted, not listed.
const LISTED: usize = 40;

/// The approximations of a scene by message.
#[derive(Debug, Default)]
pub(super) struct Approximations {
    places: BTreeMap<String, Vec<Span>>,
}

impl Approximations {
    /// Records one with its position.
    pub(super) fn add(&mut self, message: impl Into<String>, span: Span) {
        self.places.entry(message.into()).or_default().push(span);
    }

    /// Emits one warning per kind at its first position, listing the lines of the others.
    pub(super) fn report(self, sources: &Sources, diagnostics: &Diagnostics) {
        for (message, mut places) in self.places {
            places.sort();
            places.dedup();
            let Some((first, others)) = places.split_first() else {
                continue;
            };
            let mut diagnostic = Diagnostic::warning(Fault::Approximation, *first, message);
            if !others.is_empty() {
                diagnostic = diagnostic.help(list_places(*first, others, sources));
            }
            diagnostics.push(diagnostic);
        }
    }
}

/// "also on lines 3, 5, 8, and in base.xml on line 2".
fn list_places(first: Span, others: &[Span], sources: &Sources) -> String {
    let mut files: Vec<(SourceId, Vec<String>)> = Vec::new();
    for place in others.iter().take(LISTED) {
        let (Some(source), Some(line)) = (place.source(), sources.locate(*place).line()) else {
            continue;
        };
        let line = line.to_string();
        match files.last_mut() {
            Some((last, lines)) if *last == source => lines.push(line),
            _ => files.push((source, vec![line])),
        }
    }
    let part = |(source, mut lines): (SourceId, Vec<String>)| {
        lines.dedup();
        let file = sources.get(source).filter(|_| Some(source) != first.source());
        let file = file.map_or(String::new(), |file| format!("in {} ", file.name()));
        let word = if lines.len() == 1 { "line" } else { "lines" };
        format!("{file}on {word} {}", lines.join(", "))
    };
    let parts: Vec<String> = files.into_iter().map(part).collect();
    let more = others.len().saturating_sub(LISTED);
    let rest = if more > 0 { format!(", and in {more} more places") } else { String::new() };
    format!("also {}{rest}", parts.join(", and "))
}
