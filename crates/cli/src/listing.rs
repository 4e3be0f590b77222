//! Lists many similar diagnostics: the first few in full, the others in one line each.
//!
//! After a scene's folder has moved, every mesh is missing. Three hundred excerpts would bury all
//! other problems, and each would repeat the same list of searched folders.

use std::collections::{HashMap, HashSet};

use etendue::document::{Diagnostic, Fault, Severity, Sources, printable};
use etendue::{ExcerptStyle, render_diagnostic};

use crate::text;

/// How many diagnostics of one kind are shown in full.
const FULL_COUNT: usize = 5;

/// How to show diagnostics beyond the first few of their kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Repeats {
    /// One line each, up to this many of one kind, then the number of the rest.
    Lines(usize),
    /// In full, like the first ones.
    Full,
}

/// What diagnostics of one kind have in common: severity, fault, and the message without names and
/// numbers.
type Kind = (Severity, Fault, String);

/// Formats diagnostics for the terminal.
pub(crate) struct Listing<'a> {
    sources: &'a Sources,
    repeats: Repeats,
    style: ExcerptStyle,
    text: String,
    counts: HashMap<Kind, usize>,
    /// Multi-line help texts that have been shown; each is shown only once.
    lists: HashSet<&'a str>,
    /// Diagnostics to show in one line each, grouped by kind in order of first appearance.
    repeated: Vec<(Kind, Vec<&'a Diagnostic>)>,
}

impl<'a> Listing<'a> {
    pub(crate) fn new(sources: &'a Sources, repeats: Repeats, style: ExcerptStyle) -> Self {
        Self {
            sources,
            repeats,
            style,
            text: String::new(),
            counts: HashMap::new(),
            lists: HashSet::new(),
            repeated: Vec::new(),
        }
    }

    /// Adds a diagnostic, in full or to the short lines at the end.
    pub(crate) fn add(&mut self, diagnostic: &'a Diagnostic) {
        if self.repeats == Repeats::Full {
            self.text += &render_diagnostic(diagnostic, self.sources, self.style);
            return;
        }
        let kind = (diagnostic.severity, diagnostic.fault, skeleton(&diagnostic.message));
        let count = self.counts.entry(kind.clone()).or_default();
        *count += 1;
        if *count <= FULL_COUNT {
            let shown = self.without_known_lists(diagnostic);
            self.text += &render_diagnostic(&shown, self.sources, self.style);
            return;
        }
        match self.repeated.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, list)) => list.push(diagnostic),
            None => self.repeated.push((kind, vec![diagnostic])),
        }
    }

    /// Returns the whole text.
    pub(crate) fn finish(mut self) -> String {
        for (_, list) in std::mem::take(&mut self.repeated) {
            self.add_lines(&list);
        }
        self.text
    }

    /// The diagnostic without lists that an earlier one has shown, such as the folders searched for
    /// a missing file.
    fn without_known_lists(&mut self, diagnostic: &'a Diagnostic) -> Diagnostic {
        let lists = &mut self.lists;
        let mut shown = diagnostic.clone();
        shown.help.clear();
        let is_new = |line: &&'a String| !line.contains('\n') || lists.insert(line);
        shown.help.extend(diagnostic.help.iter().filter(is_new).cloned());
        shown
    }

    fn add_lines(&mut self, list: &[&Diagnostic]) {
        let Repeats::Lines(limit) = self.repeats else {
            return;
        };
        let severity = match list[0].severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        let count = text::counted(list.len(), &format!("more {severity}"));
        self.text += &format!("{count} like these:\n");
        for diagnostic in list.iter().take(limit) {
            let place = diagnostic.span.map(|span| format!("{}: ", self.sources.locate(span)));
            let line = format!("{}{}", place.unwrap_or_default(), diagnostic.message);
            self.text += &format!("  {}\n", printable(&line));
        }
        if let Some(rest) = list.len().checked_sub(limit).filter(|rest| *rest > 0) {
            let rest = text::grouped(rest);
            self.text += &format!("  and {rest} more; --verbose shows all of them\n");
        }
    }
}

/// A message without quoted text, paths, and words with digits.
fn skeleton(message: &str) -> String {
    let unquoted: String = message.split('`').step_by(2).collect();
    let is_plain = |word: &&str| !word.contains(|c: char| c.is_ascii_digit() || "/\\".contains(c));
    unquoted.split_whitespace().filter(is_plain).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue::document::Span;

    /// A source of one missing file per line, and the diagnostics.
    fn missing(count: usize) -> (Sources, Vec<Diagnostic>) {
        let lines: Vec<String> = (0..count).map(|index| format!("m{index:03}.obj")).collect();
        let mut sources = Sources::default();
        let id = sources.add("scene.xml", lines.join("\n"));
        let find = |(index, name): (usize, &String)| {
            let span = Span::new(id, index * 9..index * 9 + 8);
            let message = format!("no file `{name}`");
            Diagnostic::error(Fault::Io, span, message).help("looked for it in\n/here\n/there")
        };
        let list = lines.iter().enumerate().map(find).collect();
        (sources, list)
    }

    fn listing(sources: &Sources, list: &[Diagnostic], repeats: Repeats) -> String {
        let mut listing = Listing::new(sources, repeats, ExcerptStyle::default());
        list.iter().for_each(|diagnostic| listing.add(diagnostic));
        listing.finish()
    }

    #[test]
    fn the_first_of_a_kind_are_shown_in_full_and_the_others_in_one_line() {
        let (sources, list) = missing(300);
        let text = listing(&sources, &list, Repeats::Lines(20));
        assert_eq!(text.matches('^').count(), FULL_COUNT * "m000.obj".len());
        assert_eq!(text.matches("/there").count(), 1, "the folders are listed once");
        assert!(
            text.contains("295 more errors like these:\n  scene.xml:6:1: no file `m005.obj`\n")
        );
        assert!(text.ends_with("`m024.obj`\n  and 275 more; --verbose shows all of them\n"));
    }

    #[test]
    fn few_diagnostics_and_verbose_lists_are_shown_in_full() {
        let (sources, list) = missing(FULL_COUNT);
        assert!(!listing(&sources, &list, Repeats::Lines(20)).contains("more"));
        let (sources, list) = missing(300);
        let text = listing(&sources, &list, Repeats::Full);
        assert_eq!(text.matches("/there").count(), 300);
    }

    #[test]
    fn names_and_numbers_do_not_affect_the_kind() {
        assert_eq!(
            skeleton("/a/m1.obj: line 4: index 7 is out of range"),
            "line index is out of range"
        );
        assert_eq!(skeleton("no file `a b`"), skeleton("no file `c`"));
        assert_ne!(skeleton("no file `a`"), skeleton("no object `a`"));
    }
}
