//! One XML element with expanded attributes and their positions.

use std::borrow::Cow;
use std::ops::Range;

use etendue_document::{Diagnostic, Diagnostics, Fault, Span, list_names, near_names};
use glam::DVec3;

use crate::defines::{Defines, ExpansionError};
use crate::numbers::{self, NumberError};
use crate::origin::Origin;

/// An attribute after `$name` expansion.
#[derive(Clone, Debug)]
pub(crate) struct Attribute<'a> {
    pub(crate) name: &'a str,
    pub(crate) value: Cow<'a, str>,
    /// The span of the value.
    pub(crate) span: Span,
    /// Whether the value is byte for byte the same as in the file.
    verbatim: bool,
}

impl Attribute<'_> {
    /// The position of a part of the value; after an expansion, of the whole value.
    pub(crate) fn part(&self, range: Range<usize>) -> Span {
        let Some(source) = self.span.source().filter(|_| self.verbatim) else {
            return self.span;
        };
        let start = self.span.range().start;
        Span::new(source, start + range.start..start + range.end)
    }
}

/// An element whose attributes have been expanded.
pub(crate) struct Element<'a> {
    pub(crate) node: roxmltree::Node<'a, 'a>,
    /// The opening tag without its closing bracket.
    pub(crate) span: Span,
    attributes: Vec<Attribute<'a>>,
    /// An attribute could not be expanded, which has been reported.
    pub(crate) broken: bool,
}

impl<'a> Element<'a> {
    /// Expands the attributes; reports those that cannot be expanded.
    pub(crate) fn open(
        node: roxmltree::Node<'a, 'a>,
        origin: &Origin,
        defines: &mut Defines,
        diagnostics: &Diagnostics,
    ) -> Self {
        let start = node.range().start;
        let name_end = start + 1 + node.tag_name().name().len();
        let end = node.attributes().next_back().map_or(name_end, |last| last.range().end);
        let span = origin.span(start..end);
        let mut element = Self { node, span, attributes: Vec::new(), broken: false };
        for attribute in node.attributes() {
            let span = origin.span(attribute.range_value());
            match defines.expand(attribute.value()) {
                Ok(value) => element.push(&attribute, value, span),
                Err(error) => {
                    element.broken = true;
                    describe(&error, span).into_iter().for_each(|found| diagnostics.push(found));
                }
            }
        }
        element
    }

    fn push(&mut self, attribute: &roxmltree::Attribute<'a, 'a>, value: Cow<'a, str>, span: Span) {
        let length = attribute.range_value().len();
        let verbatim = matches!(value, Cow::Borrowed(_)) && value.len() == length;
        self.attributes.push(Attribute { name: attribute.name(), value, span, verbatim });
    }

    /// The element's name.
    pub(crate) fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// An attribute, if the element has it.
    pub(crate) fn attribute(&self, name: &str) -> Option<&Attribute<'a>> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// The value of an attribute, if the element has it.
    pub(crate) fn value(&self, name: &str) -> Option<&str> {
        self.attribute(name).map(|attribute| &*attribute.value)
    }

    /// A required attribute; reports its absence.
    pub(crate) fn required(&self, name: &str, diagnostics: &Diagnostics) -> Option<&Attribute<'a>> {
        let found = self.attribute(name);
        if found.is_none() && !self.broken {
            let message = format!("`<{}>` needs the attribute `{name}`", self.name());
            diagnostics.error(Fault::MissingParameter, self.span, message);
        }
        found
    }

    /// Warns of every attribute that is not in the list.
    pub(crate) fn check_attributes(&self, known: &[&str], diagnostics: &Diagnostics) {
        for attribute in &self.attributes {
            if known.contains(&attribute.name) {
                continue;
            }
            let message = format!("`<{}>` has no attribute `{}`", self.name(), attribute.name);
            let mut diagnostic =
                Diagnostic::warning(Fault::UnknownParameter, attribute.span, message);
            if diagnostics.is_full() {
                diagnostics.push(diagnostic);
                continue;
            }
            let near = near_names(attribute.name, known.iter().copied());
            if !near.is_empty() {
                diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
            }
            let takes = list_names(known.iter().copied());
            diagnostics.push(diagnostic.help(format!("it takes {takes}")));
        }
    }

    /// Reads an attribute with one of the number readers; reports errors.
    pub(crate) fn read<T>(
        &self,
        attribute: &Attribute<'a>,
        read: impl FnOnce(&str) -> Result<T, NumberError>,
        diagnostics: &Diagnostics,
    ) -> Option<T> {
        let report = |error: NumberError| {
            let place = attribute.part(error.range);
            let mut found = Diagnostic::error(Fault::BadValue, place, error.message);
            found.help.extend(error.help);
            diagnostics.push(found);
        };
        read(&attribute.value).map_err(report).ok()
    }

    /// Three numbers in `value`, or one for all three, or `x`, `y` and `z`, each of which defaults
    /// to `default`; without a default all three are required.
    pub(crate) fn vector(&self, default: Option<f64>, diagnostics: &Diagnostics) -> Option<DVec3> {
        if let Some(value) = self.attribute("value") {
            return self.vector_in(value, diagnostics);
        }
        if self.broken {
            return None;
        }
        let mut components = [0.0; 3];
        for (component, name) in components.iter_mut().zip(["x", "y", "z"]) {
            *component = match (self.attribute(name), default) {
                (Some(attribute), _) => self.read(attribute, numbers::number, diagnostics)?,
                (None, Some(default)) => default,
                (None, None) => {
                    self.required(name, diagnostics);
                    return None;
                }
            };
        }
        Some(components.into())
    }

    /// Three numbers in an attribute, or one for all three.
    pub(crate) fn vector_in(
        &self,
        attribute: &Attribute<'a>,
        diagnostics: &Diagnostics,
    ) -> Option<DVec3> {
        match self.read(attribute, numbers::numbers, diagnostics)?[..] {
            [all] => Some(DVec3::splat(all)),
            [x, y, z] => Some(DVec3::new(x, y, z)),
            ref other => {
                let message = format!("three numbers are expected, not {}", other.len());
                self.report_count(attribute, message, diagnostics);
                None
            }
        }
    }

    /// Reports a wrong number of numbers; decimal commas make two of each.
    pub(crate) fn report_count(
        &self,
        attribute: &Attribute<'a>,
        message: String,
        diagnostics: &Diagnostics,
    ) {
        let diagnostic = Diagnostic::error(Fault::BadValue, attribute.span, message);
        diagnostics.push(if numbers::has_decimal_commas(&attribute.value) {
            diagnostic.help("decimals have a point: write `0.5, 0.5, 0.5`, not `0,5 0,5 0,5`")
        } else {
            diagnostic
        });
    }
}

/// Reports a failed expansion unless that has been reported already.
fn describe(error: &ExpansionError, span: Span) -> Option<Diagnostic> {
    let diagnostic = match error {
        ExpansionError::Broken => return None,
        ExpansionError::TooLong => Diagnostic::error(
            Fault::Limit,
            span,
            "the values of all `$names` together have grown beyond the limit",
        ),
        ExpansionError::Bracketed { name, offset } => {
            let start = span.range().start + offset;
            let end = (start + name.len() + "${}".len()).min(span.range().end);
            let place = span.source().map(|source| Span::new(source, start.min(end)..end));
            let message = format!("a value is named without brackets: `${name}`");
            Diagnostic::error(Fault::BadValue, place, message)
                .help(format!("write `${name}` instead of `${{{name}}}`"))
        }
        ExpansionError::Undefined { name, offset, near } => {
            let start = span.range().start + offset;
            let end = (start + 1 + name.len()).min(span.range().end);
            let place = span.source().map(|source| Span::new(source, start.min(end)..end));
            let message = format!("`${name}` is not defined");
            let mut diagnostic = Diagnostic::error(Fault::BadValue, place, message);
            if !near.is_empty() {
                let near: Vec<String> = near.iter().map(|name| format!("${name}")).collect();
                let near = list_names(near.iter().map(String::as_str));
                diagnostic = diagnostic.help(format!("did you mean {near}?"));
            }
            diagnostic.help(format!(
                "give it a value with `-D {name}=…`, or before its first use with \
                 `<default name=\"{name}\" value=\"…\"/>`"
            ))
        }
    };
    Some(diagnostic)
}
