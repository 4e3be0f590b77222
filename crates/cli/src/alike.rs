//! DiagnosticReport of one kind by the hundred: the first few as a whole, the others in a line each.
//!
//! A scene whose folder has moved misses every mesh it names. Three hundred excerpts bury what else
//! is wrong, and the folders that were searched are the same for all.

use std::collections::{HashMap, HashSet};

use etendue::document::{Diagnostic, Fault, Severity, Sources};
use etendue::render_diagnostic;

use crate::text;

/// How many diagnostics of one kind are shown as a whole.
const WHOLE: usize = 5;

/// How much is shown of the diagnostics beyond the first few of their kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Repeats {
    /// A line each, up to this many of one kind, and how many more there are.
    Lines(usize),
    /// As much as of the first.
    Whole,
}

/// What diagnostics of one kind have in common: whose fault they are, and what is said but for names
/// and numbers.
type Kind = (Severity, Fault, String);

/// DiagnosticReport on their way to the terminal.
pub(crate) struct Listing<'a> {
    sources: &'a Sources,
    repeats: Repeats,
    colored: bool,
    text: String,
    counts: HashMap<Kind, usize>,
    /// Lists in the advice of diagnostics, each of which is shown once.
    lists: HashSet<&'a str>,
    /// What is shown in a line each, by kind, in the order of the first of each kind.
    repeated: Vec<(Kind, Vec<&'a Diagnostic>)>,
}

impl<'a> Listing<'a> {
    pub(crate) fn new(sources: &'a Sources, repeats: Repeats, colored: bool) -> Self {
        Self {
            sources,
            repeats,
            colored,
            text: String::new(),
            counts: HashMap::new(),
            lists: HashSet::new(),
            repeated: Vec::new(),
        }
    }

    /// Shows a finding, now or at the end.
    pub(crate) fn add(&mut self, diagnostic: &'a Diagnostic) {
        if self.repeats == Repeats::Whole {
            self.text += &render_diagnostic(diagnostic, self.sources, self.colored);
            return;
        }
        let kind = (diagnostic.severity, diagnostic.fault, skeleton(&diagnostic.message));
        let count = self.counts.entry(kind.clone()).or_default();
        *count += 1;
        if *count <= WHOLE {
            let shown = self.without_known_lists(diagnostic);
            self.text += &render_diagnostic(&shown, self.sources, self.colored);
            return;
        }
        match self.repeated.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, list)) => list.push(diagnostic),
            None => self.repeated.push((kind, vec![diagnostic])),
        }
    }

    /// Everything as text.
    pub(crate) fn finish(mut self) -> String {
        for (_, list) in std::mem::take(&mut self.repeated) {
            self.add_lines(&list);
        }
        self.text
    }

    /// The finding without lists that have been shown with an earlier one, such as the folders in
    /// which a missing file was sought.
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
        self.text += &format!("{} more like these:\n", text::counted(list.len(), severity));
        for diagnostic in list.iter().take(limit) {
            let place = diagnostic.span.map(|span| format!("{}: ", self.sources.locate(span)));
            // A line of its own, without what could command the terminal.
            let line: String = diagnostic.message.chars().filter(|c| !c.is_control()).collect();
            self.text += &format!("  {}{line}\n", place.unwrap_or_default());
        }
        if let Some(rest) = list.len().checked_sub(limit).filter(|rest| *rest > 0) {
            let rest = text::grouped(rest);
            self.text += &format!("  and {rest} more; --verbose shows all of them\n");
        }
    }
}

/// A message without what it quotes, paths, and words with digits.
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
        let mut listing = Listing::new(sources, repeats, false);
        list.iter().for_each(|diagnostic| listing.add(diagnostic));
        listing.finish()
    }

    #[test]
    fn the_first_of_a_kind_are_whole_and_the_others_a_line() {
        let (sources, list) = missing(300);
        let text = listing(&sources, &list, Repeats::Lines(20));
        assert_eq!(text.matches('^').count(), WHOLE * "m000.obj".len());
        assert_eq!(text.matches("/there").count(), 1, "the folders once");
        assert!(
            text.contains("295 errors more like these:\n  scene.xml:6:1: no file `m005.obj`\n")
        );
        assert!(text.ends_with("`m024.obj`\n  and 275 more; --verbose shows all of them\n"));
    }

    #[test]
    fn few_or_all_are_shown_as_a_whole() {
        let (sources, list) = missing(WHOLE);
        assert!(!listing(&sources, &list, Repeats::Lines(20)).contains("more"));
        let (sources, list) = missing(300);
        let text = listing(&sources, &list, Repeats::Whole);
        assert_eq!(text.matches("/there").count(), 300);
    }

    #[test]
    fn what_is_said_makes_the_kind_not_the_names_and_numbers_in_it() {
        assert_eq!(
            skeleton("/a/m1.obj: line 4: index 7 is out of range"),
            "line index is out of range"
        );
        assert_eq!(skeleton("no file `a b`"), skeleton("no file `c`"));
        assert_ne!(skeleton("no file `a`"), skeleton("no object `a`"));
    }
}
