//! Keeps values made from a node and its files, together with their side effects.

use super::assets::{Assets, FileRead, Made};
use crate::cache::Digest;
use etendue_document::{Diagnostic, Diagnostics, FlatNode, Parameters, Reading, Span};
use std::any::Any;
use std::path::PathBuf;
use std::sync::Arc;

/// A value and its side effects: parameters read, files read, problems reported.
struct Kept<T> {
    value: T,
    digest: u128,
    reading: Reading,
    findings: Vec<Finding>,
    files: Vec<(Place, FileRead)>,
}

struct Finding {
    place: Place,
    related: Vec<Place>,
    diagnostic: Diagnostic,
}

/// A place within a node, independent of the document's spans.
#[derive(Clone, Copy)]
enum Place {
    Node,
    Parameter(usize),
    Child(usize),
}

impl Place {
    /// `None` if the span is not one of the node's.
    fn of(span: Span, node: &FlatNode) -> Option<Self> {
        if span == node.span {
            return Some(Self::Node);
        }
        let parameter = node.parameters.iter().position(|parameter| parameter.span == span);
        let child = || node.children.iter().position(|child| child.span == span);
        parameter.map(Self::Parameter).or_else(|| child().map(Self::Child))
    }

    fn span(self, node: &FlatNode) -> Span {
        let span = match self {
            Self::Node => None,
            Self::Parameter(index) => node.parameters.get(index).map(|parameter| parameter.span),
            Self::Child(index) => node.children.get(index).map(|child| child.span),
        };
        span.unwrap_or(node.span)
    }
}

impl Finding {
    /// `None` if it lies outside the node.
    fn new(diagnostic: &Diagnostic, node: &FlatNode) -> Option<Self> {
        let related = diagnostic.related.iter().map(|related| Place::of(related.span, node));
        Some(Self {
            place: Place::of(diagnostic.span?, node)?,
            related: related.collect::<Option<_>>()?,
            diagnostic: diagnostic.clone(),
        })
    }

    fn in_node(&self, node: &FlatNode) -> Diagnostic {
        let mut diagnostic = self.diagnostic.clone();
        diagnostic.span = Some(self.place.span(node));
        for (related, place) in diagnostic.related.iter_mut().zip(&self.related) {
            related.span = place.span(node);
        }
        diagnostic
    }
}

impl Assets<'_> {
    /// The result of `make` for a node, or the kept result of an equal node of an earlier scene.
    ///
    /// `make` may depend only on the node's parameters except those that `except` names, on files,
    /// and on children that are not materials, emitters, media or sensors.
    pub(crate) fn kept<T: Any + Clone + Send + Sync>(
        &self,
        parameters: &Parameters<'_>,
        except: &[&str],
        make: impl Fn(&Assets<'_>, &Parameters<'_>) -> Option<T>,
    ) -> Option<T> {
        self.kept_with_digest(parameters, except, make).map(|made| made.value)
    }

    /// [`Self::kept`], with the digest of all inputs of the value.
    pub(super) fn kept_with_digest<T: Any + Clone + Send + Sync>(
        &self,
        parameters: &Parameters<'_>,
        except: &[&str],
        make: impl Fn(&Assets<'_>, &Parameters<'_>) -> Option<T>,
    ) -> Option<Made<T>> {
        let (Some(cache), Some(digests)) = (self.cache, &self.digests) else {
            return make(self, parameters).map(|value| Made { value, digest: 0 });
        };
        let of_node = digests.without_appearance(self.document, parameters.node(), except);
        if let Some(kept) = cache.find::<Kept<T>>(of_node)
            && self.repeat(&kept, parameters)
        {
            return Some(Made { value: kept.value.clone(), digest: kept.digest });
        }
        let findings = Diagnostics::new();
        let recording = self.recording(&findings);
        let own = self.document.parameters(parameters.node(), &findings);
        let value = make(&recording, &own);
        if findings.omitted() > 0 {
            // Some findings were dropped, so they cannot be passed on.
            return make(self, parameters).map(|value| Made { value, digest: 0 });
        }
        let findings = findings.sorted();
        findings.iter().for_each(|finding| self.diagnostics.push(finding.clone()));
        let reading = own.reading();
        parameters.repeat(&reading);
        let files = self.absorb(recording);

        let value = value?;
        let digest = digest_with_files(of_node, &files);
        let made = Made { value: value.clone(), digest };
        let node = self.document.node(parameters.node());
        let findings = findings.iter().map(|finding| Finding::new(finding, node)).collect();
        let paths: Vec<PathBuf> = files.iter().map(|file| file.path.clone()).collect();
        let placed = files.into_iter().map(|file| Some((Place::of(file.span, node)?, file)));
        if let (Some(findings), Some(files)) = (findings, placed.collect()) {
            let kept = Kept { value, digest, reading, findings, files };
            cache.keep(of_node, Arc::new(kept), paths);
        }
        Some(made)
    }

    /// Repeats the side effects of making a value. False if one of its files has changed.
    fn repeat<T>(&self, kept: &Kept<T>, parameters: &Parameters<'_>) -> bool {
        let node = self.document.node(parameters.node());
        let mut files = Vec::with_capacity(kept.files.len());
        for (place, file) in &kept.files {
            let span = place.span(node);
            let found = self.document.resolve(&file.name, span, self.resources);
            if found.as_ref() != Ok(&file.path) {
                return false;
            }
            files.push(FileRead { span, ..file.clone() });
        }
        self.note_files(files);
        kept.findings.iter().for_each(|finding| self.diagnostics.push(finding.in_node(node)));
        parameters.repeat(&kept.reading);
        true
    }
}

fn digest_with_files(of_node: u128, files: &[FileRead]) -> u128 {
    let mut digest = Digest::default();
    digest.number(of_node);
    for file in files {
        digest.path(&file.path);
        digest.number(file.hash);
    }
    digest.finish()
}
