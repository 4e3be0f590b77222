//! Files: the scene's own and those it includes.

use std::path::Path;

use etendue_document::{Diagnostic, Fault, SourceId, Span};

use crate::element::Element;
use crate::loader::{Loader, OpenFile};
use crate::text::{self, Decoded, NotText};

/// The maximum number of missing files for which similar names are suggested, because each search
/// lists whole folders.
const SUGGESTED: usize = 20;

/// Opens the file of `<include filename="..."/>`: the text of a `<scene>`, or of one object. Call
/// [`close`] after it has been read.
pub(crate) fn open(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<SourceId> {
    let file = element.required("filename", loader.diagnostics)?;
    let resolver = &loader.resolver;
    let path = match resolver.resolve(&file.value, file.span.source(), loader.resources) {
        Ok(path) => path,
        Err(missing) => {
            let mut diagnostic = Diagnostic::error(Fault::Io, file.span, missing.to_string());
            loader.missing_includes += 1;
            diagnostic.help = match loader.missing_includes {
                0..=SUGGESTED => missing.help_with_near_names(loader.resources),
                _ => missing.help(),
            };
            loader.diagnostics.push(diagnostic);
            return None;
        }
    };
    if !may_include(loader, &path, file.span) {
        return None;
    }
    loader.include_count += 1;
    let source = loader.read_source(&path, Some(file.span))?;
    loader.open_files.push(OpenFile { path, included_at: Some(file.span) });
    Some(source)
}

/// Closes the file that was opened last.
pub(crate) fn close(loader: &mut Loader<'_>) {
    loader.open_files.pop();
}

/// Whether a file may be included here; reports cycles, with all files on them, and exceeded
/// limits.
fn may_include(loader: &Loader<'_>, path: &Path, span: Span) -> bool {
    let report = |fault, message: String| {
        let mut diagnostic = Diagnostic::error(fault, span, message);
        for file in &loader.open_files {
            if let Some(place) = file.included_at {
                let message = format!("{} is included here", file.path.display());
                diagnostic = diagnostic.related(place, message);
            }
        }
        loader.diagnostics.push(diagnostic);
        false
    };
    let limits = &loader.options.limits;
    if loader.open_files.iter().any(|file| file.path == path) {
        let message = format!("{} includes itself", path.display());
        return report(Fault::Syntax, message);
    }
    if loader.open_files.len() > limits.include_depth {
        let message = format!("files include each other more than {} deep", limits.include_depth);
        return report(Fault::Limit, message);
    }
    if loader.include_count >= limits.includes {
        let message = format!("more than {} includes", limits.includes);
        return report(Fault::Limit, message);
    }
    true
}

impl Loader<'_> {
    /// Reads a file and stores its text; reports errors.
    pub(crate) fn read_source(&mut self, path: &Path, span: Option<Span>) -> Option<SourceId> {
        let name = self.display_name(path);
        let bytes = match self.resources.read(path) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.diagnostics.error(Fault::Io, span, format!("cannot read {name}: {error}"));
                return None;
            }
        };
        self.total_bytes = self.total_bytes.saturating_add(bytes.len());
        let limit = self.options.limits.total_bytes;
        if self.total_bytes > limit {
            let message = format!("{name}: the scene's files together exceed {limit} bytes");
            self.diagnostics.error(Fault::Limit, span, message);
            return None;
        }
        match text::decode(bytes) {
            Ok(Decoded { text, warning }) => {
                let source = self.add_source(name, text, path.parent());
                if let Some((message, place)) = warning {
                    let place = Span::new(source, place);
                    self.diagnostics.warning(Fault::Syntax, place, message);
                }
                Some(source)
            }
            Err(NotText(message)) => {
                let source = self.add_source(name, String::new(), path.parent());
                let place = Span::new(source, 0..1);
                let diagnostic = Diagnostic::error(Fault::Syntax, place, message);
                self.diagnostics.push(match span {
                    Some(span) => diagnostic.related(span, "included here"),
                    None => diagnostic,
                });
                None
            }
        }
    }

    /// The path as a user would write it.
    fn display_name(&self, path: &Path) -> String {
        let working_directory = &self.options.working_directory;
        let short = path.strip_prefix(working_directory).ok();
        short.filter(|short| !short.as_os_str().is_empty()).unwrap_or(path).display().to_string()
    }
}
