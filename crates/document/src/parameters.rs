//! How a plugin reads its node and how unread entries are reported.

mod reading;
mod report;
#[cfg(test)]
mod tests;
mod typed;

pub use reading::Reading;

use std::cell::RefCell;

use crate::class::Class;
use crate::diagnostic::{Diagnostics, Fault};
use crate::document::{Child, Document, FlatNode, Parameter};
use crate::span::{NodeId, Span};
use crate::value::Value;

impl Document {
    /// The reader for a plugin's node.
    pub fn parameters<'a>(&'a self, node: NodeId, diagnostics: &'a Diagnostics) -> Parameters<'a> {
        Parameters::new(self, node, diagnostics)
    }
}

/// The two forms of a colour-or-texture parameter.
#[derive(Clone, Copy, Debug)]
pub enum Entry<'a> {
    /// A value and its position.
    Value(&'a Value, Span),
    /// A nested or referenced object.
    Child(&'a Child),
}

/// Reads a node's parameters while a plugin is built from them.
///
/// It records which names were asked for and which entries were read; [`Parameters::finish`]
/// reports the rest. A value of the wrong type or out of range is reported with its position and
/// replaced by the default, so that one run shows all errors.
pub struct Parameters<'a> {
    document: &'a Document,
    id: NodeId,
    node: &'a FlatNode,
    diagnostics: &'a Diagnostics,
    /// The names asked for: the names that the plugin accepts.
    asked: RefCell<Vec<String>>,
    parameters_read: RefCell<Vec<bool>>,
    children_read: RefCell<Vec<bool>>,
}

impl<'a> Parameters<'a> {
    fn new(document: &'a Document, id: NodeId, diagnostics: &'a Diagnostics) -> Self {
        let node = document.node(id);
        let parameters = Self {
            document,
            id,
            node,
            diagnostics,
            asked: RefCell::default(),
            parameters_read: RefCell::new(vec![false; node.parameters.len()]),
            children_read: RefCell::new(vec![false; node.children.len()]),
        };
        parameters.report_duplicates();
        parameters
    }

    /// The id of the node being read.
    pub fn node(&self) -> NodeId {
        self.id
    }

    /// The document the node belongs to.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// The node's class.
    pub fn class(&self) -> Class {
        self.node.class
    }

    /// The plugin's name.
    pub fn plugin(&self) -> &'a str {
        &self.node.plugin
    }

    /// The node's own id in the scene.
    pub fn id(&self) -> Option<&'a str> {
        self.node.id.as_deref()
    }

    /// The position of the node.
    pub fn span(&self) -> Span {
        self.node.span
    }

    /// Where findings go.
    pub fn diagnostics(&self) -> &'a Diagnostics {
        self.diagnostics
    }

    /// Whether a child could not be read or found, which has been reported.
    pub fn is_incomplete(&self) -> bool {
        self.document.incomplete.contains(&self.id)
    }

    /// Reports an error at the position of parameter or child `name`, or of the node. Missing
    /// entries of an incomplete node are not reported.
    pub fn error(&self, fault: Fault, name: &str, message: impl Into<String>) {
        if fault != Fault::MissingParameter || !self.is_incomplete() {
            self.diagnostics.error(fault, self.span_of(name), message);
        }
    }

    /// Reports a warning at the position of parameter or child `name`, or of the node.
    pub fn warning(&self, fault: Fault, name: &str, message: impl Into<String>) {
        self.diagnostics.warning(fault, self.span_of(name), message);
    }

    /// Whether there is a parameter or child of that name. This does not count as reading it.
    pub fn has(&self, name: &str) -> bool {
        self.ask(name);
        self.find(name).is_some() || self.find_child(name).is_some()
    }

    /// The position of the parameter or child of that name, or else of the node.
    pub fn span_of(&self, name: &str) -> Span {
        let parameter = self.find(name).map(|(_, parameter)| parameter.span);
        let child = || self.find_child(name).map(|(_, child)| child.span);
        parameter.or_else(child).unwrap_or(self.node.span)
    }

    /// A parameter of any type.
    pub fn value(&self, name: &str) -> Option<(&'a Value, Span)> {
        self.ask(name);
        let (index, parameter) = self.find(name)?;
        self.parameters_read.borrow_mut()[index] = true;
        Some((&parameter.value, parameter.span))
    }

    /// A value or a child of that name; if there are both, the later one.
    pub fn entry(&self, name: &str) -> Option<Entry<'a>> {
        let value = self.value(name);
        let child = self.child(name);
        match (value, child) {
            (Some((_, span)), Some(child)) if child.span > span => Some(Entry::Child(child)),
            (Some((value, span)), _) => Some(Entry::Value(value, span)),
            (None, child) => child.map(Entry::Child),
        }
    }

    /// The child of that name.
    pub fn child(&self, name: &str) -> Option<&'a Child> {
        self.ask(name);
        let (index, child) = self.find_child(name)?;
        self.children_read.borrow_mut()[index] = true;
        Some(child)
    }

    /// All children of a class, named or not, in order.
    pub fn children_of(&self, class: Class) -> Vec<&'a Child> {
        let of_class = self.indexed_children().filter(|(_, child)| self.class_of(child) == class);
        let mut read = self.children_read.borrow_mut();
        let mark = |(index, child): (usize, &'a Child)| {
            read[index] = true;
            child
        };
        of_class.map(mark).collect()
    }

    /// The child of a class, if the plugin takes one and its name does not matter: the first
    /// without a name, or else the first not yet read. Further ones stay unread.
    pub fn unnamed_child(&self, class: Class) -> Option<&'a Child> {
        let read = self.children_read.borrow().clone();
        let free = || {
            self.indexed_children()
                .filter(|(index, child)| !read[*index] && self.class_of(child) == class)
        };
        let found = free().find(|(_, child)| child.name.is_none()).or_else(|| free().next());
        let (index, child) = found?;
        self.children_read.borrow_mut()[index] = true;
        Some(child)
    }

    /// Like [`Self::unnamed_child`], for a required child; reports its absence and returns `None`.
    pub fn required_child(&self, class: Class) -> Option<&'a Child> {
        let found = self.unnamed_child(class);
        if found.is_none() {
            let message = format!("`{}` needs a {} inside it", self.plugin(), class.name());
            self.diagnostics.error(Fault::MissingParameter, self.node.span, message);
        }
        found
    }

    fn ask(&self, name: &str) {
        let mut asked = self.asked.borrow_mut();
        if !asked.iter().any(|known| known == name) {
            asked.push(name.to_owned());
        }
    }

    /// The last parameter of that name: later ones replace earlier ones.
    fn find(&self, name: &str) -> Option<(usize, &'a Parameter)> {
        let mut parameters = self.node.parameters.iter().enumerate();
        parameters.rfind(|(_, parameter)| parameter.name == name)
    }

    fn find_child(&self, name: &str) -> Option<(usize, &'a Child)> {
        self.indexed_children().rfind(|(_, child)| child.name.as_deref() == Some(name))
    }

    fn indexed_children(&self) -> impl DoubleEndedIterator<Item = (usize, &'a Child)> + use<'a> {
        self.node.children.iter().enumerate()
    }

    fn class_of(&self, child: &Child) -> Class {
        self.document.node(child.node).class
    }
}
