//! Reports entries that were given twice or never read.

use std::collections::HashMap;

use super::Parameters;
use crate::diagnostic::{Diagnostic, Fault};
use crate::document::{Child, Parameter};
use crate::names::{list_names, near_names};

impl Parameters<'_> {
    /// Reports every parameter and child that was not read, with similar names among those asked
    /// for, and what the plugin accepts.
    pub fn finish(self) {
        let parameters = self.node.parameters.iter().zip(self.parameters_read.borrow().clone());
        for (parameter, _) in parameters.filter(|(_, read)| !read) {
            self.report_unknown(parameter);
        }
        let children = self.node.children.iter().zip(self.children_read.borrow().clone());
        for (child, _) in children.filter(|(_, read)| !read) {
            self.report_unread_child(child);
        }
    }

    /// Warns of parameters given twice; only the last one can be read.
    pub(super) fn report_duplicates(&self) {
        let mut last: HashMap<&str, usize> = HashMap::new();
        for (index, parameter) in self.node.parameters.iter().enumerate() {
            let Some(earlier) = last.insert(&parameter.name, index) else {
                continue;
            };
            self.parameters_read.borrow_mut()[earlier] = true;
            let message = format!("`{}` is given twice; the last one counts", parameter.name);
            let first = self.node.parameters[earlier].span;
            self.diagnostics.push(
                Diagnostic::warning(Fault::BadValue, parameter.span, message)
                    .related(first, "given here before"),
            );
        }
    }

    fn report_unknown(&self, parameter: &Parameter) {
        let plugin = self.plugin();
        let message = format!("`{plugin}` has no parameter `{}`", parameter.original_name);
        let diagnostic = Diagnostic::warning(Fault::UnknownParameter, parameter.span, message);
        self.diagnostics.push(self.with_names(diagnostic, &parameter.name));
    }

    fn report_unread_child(&self, child: &Child) {
        let node = self.document.node(child.node);
        let (plugin, class) = (self.plugin(), node.class.name());
        let message = match &child.name {
            Some(name) => format!("`{plugin}` has no use for a {class} named `{name}`"),
            None => format!("`{plugin}` has no use for this {class}"),
        };
        let diagnostic = Diagnostic::warning(Fault::UnknownParameter, child.span, message);
        let name = child.name.as_deref().unwrap_or_default();
        self.diagnostics.push(self.with_names(diagnostic, name));
    }

    /// Adds similar names among those asked for, and the full list.
    fn with_names(&self, mut diagnostic: Diagnostic, name: &str) -> Diagnostic {
        if self.diagnostics.is_full() {
            return diagnostic;
        }
        let mut asked = self.asked.borrow().clone();
        asked.sort();
        let names = || asked.iter().map(String::as_str);
        let near = near_names(name, names());
        if !near.is_empty() {
            diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
        }
        if asked.is_empty() {
            return diagnostic.help(format!("`{}` takes no named parameters", self.plugin()));
        }
        diagnostic.help(format!("`{}` takes {}", self.plugin(), list_names(names())))
    }
}
