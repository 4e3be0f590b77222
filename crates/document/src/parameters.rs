//! How a plugin reads its node, and how what it did not read is reported.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::RangeBounds;

use glam::{DMat4, DVec3};

use crate::{
    Child, Class, Diagnostic, Diagnostics, Document, Fault, Node, NodeId, Parameter, Span, Value,
    list_names, near_names,
};

/// Either form in which a colour-or-texture parameter may come.
#[derive(Clone, Copy, Debug)]
pub enum Entry<'a> {
    /// A value and its place.
    Value(&'a Value, Span),
    /// A nested object or a reference.
    Child(&'a Child),
}

/// A node's parameters while a plugin is built from them.
///
/// It remembers which names were asked for and which entries were read; [`Parameters::finish`]
/// reports the rest. A value of the wrong type or out of range is an error with its place, and
/// the default takes its place, so that one run shows every error.
pub struct Parameters<'a> {
    document: &'a Document,
    id: NodeId,
    node: &'a Node,
    diagnostics: &'a Diagnostics,
    /// The names asked for, which are the names the plugin takes.
    asked: RefCell<Vec<String>>,
    parameters_read: RefCell<Vec<bool>>,
    children_read: RefCell<Vec<bool>>,
}

impl<'a> Parameters<'a> {
    pub(crate) fn new(document: &'a Document, id: NodeId, diagnostics: &'a Diagnostics) -> Self {
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

    /// The id of the node that is read.
    pub fn node(&self) -> NodeId {
        self.id
    }

    /// The document the node belongs to.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// What the node is.
    pub fn class(&self) -> Class {
        self.node.class
    }

    /// The plugin's name.
    pub fn plugin(&self) -> &'a str {
        &self.node.plugin
    }

    /// The node's own id in the file.
    pub fn id(&self) -> Option<&'a str> {
        self.node.id.as_deref()
    }

    /// The place of the node: its opening tag.
    pub fn span(&self) -> Span {
        self.node.span
    }

    /// Where findings go.
    pub fn diagnostics(&self) -> &'a Diagnostics {
        self.diagnostics
    }

    /// Reports an error at the place of parameter or child `name`, or of the node.
    pub fn error(&self, fault: Fault, name: &str, message: impl Into<String>) {
        self.diagnostics.error(fault, self.span_of(name), message);
    }

    /// Reports a warning at the place of parameter or child `name`, or of the node.
    pub fn warning(&self, fault: Fault, name: &str, message: impl Into<String>) {
        self.diagnostics.warning(fault, self.span_of(name), message);
    }

    /// Whether there is a parameter or child of that name; does not count as reading it.
    pub fn has(&self, name: &str) -> bool {
        self.ask(name);
        self.find(name).is_some() || self.find_child(name).is_some()
    }

    /// The place of the parameter or child of that name, or else of the node.
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

    /// A value or a child of that name; where there are both, the later one in the file.
    pub fn entry(&self, name: &str) -> Option<Entry<'a>> {
        let value = self.value(name);
        let child = self.child(name);
        match (value, child) {
            (Some((_, span)), Some(child)) if child.span > span => Some(Entry::Child(child)),
            (Some((value, span)), _) => Some(Entry::Value(value, span)),
            (None, child) => child.map(Entry::Child),
        }
    }

    /// True or false.
    pub fn optional_boolean(&self, name: &str) -> Option<bool> {
        self.typed(name, "a boolean", |value| match value {
            Value::Boolean(boolean) => Some(*boolean),
            _ => None,
        })
    }

    /// True or false.
    pub fn boolean(&self, name: &str, default: bool) -> bool {
        self.optional_boolean(name).unwrap_or(default)
    }

    /// A whole number; a float that is one is accepted.
    pub fn optional_integer(&self, name: &str) -> Option<i64> {
        self.typed(name, "an integer", |value| match value {
            Value::Integer(integer) => Some(*integer),
            Value::Float(float) if float.fract() == 0.0 && float.abs() < 2f64.powi(53) => {
                Some(*float as i64)
            }
            _ => None,
        })
    }

    /// A whole number; a float that is one is accepted.
    pub fn integer(&self, name: &str, default: i64) -> i64 {
        self.optional_integer(name).unwrap_or(default)
    }

    /// A whole number within `range`; outside, an error is reported and the default returned.
    pub fn integer_in(&self, name: &str, default: i64, range: impl RangeBounds<i64>) -> i64 {
        match self.optional_integer(name) {
            Some(integer) if range.contains(&integer) => integer,
            Some(integer) => {
                self.out_of_range(name, &integer.to_string(), &describe(&range));
                default
            }
            None => default,
        }
    }

    /// A number; an integer, or a spectrum that is one number, is accepted.
    pub fn optional_float(&self, name: &str) -> Option<f64> {
        self.typed(name, "a number", |value| match value {
            Value::Float(float) => Some(*float),
            Value::Integer(integer) => Some(*integer as f64),
            Value::Spectrum(crate::SpectrumValue::Constant(constant)) => Some(*constant),
            _ => None,
        })
    }

    /// A number; an integer, or a spectrum that is one number, is accepted.
    pub fn float(&self, name: &str, default: f64) -> f64 {
        self.optional_float(name).unwrap_or(default)
    }

    /// A finite number within `range`; otherwise an error is reported and the default returned.
    pub fn float_in(&self, name: &str, default: f64, range: impl RangeBounds<f64>) -> f64 {
        match self.optional_float(name) {
            Some(float) if float.is_finite() && range.contains(&float) => float,
            Some(float) => {
                self.out_of_range(name, &float.to_string(), &describe(&range));
                default
            }
            None => default,
        }
    }

    /// A text.
    pub fn optional_string(&self, name: &str) -> Option<&'a str> {
        let (value, span) = self.value(name)?;
        match value {
            Value::String(string) => Some(string),
            other => {
                self.wrong_type(name, "a string", other, span);
                None
            }
        }
    }

    /// A text.
    pub fn string(&self, name: &str, default: &'a str) -> &'a str {
        self.optional_string(name).unwrap_or(default)
    }

    /// A text the plugin cannot do without; `None` after its absence has been reported.
    pub fn required_string(&self, name: &str) -> Option<&'a str> {
        self.require(name).then(|| self.optional_string(name)).flatten()
    }

    /// A number the plugin cannot do without; `None` after its absence has been reported.
    pub fn required_float(&self, name: &str) -> Option<f64> {
        self.require(name).then(|| self.optional_float(name)).flatten()
    }

    /// A position; a vector is accepted.
    pub fn optional_point(&self, name: &str) -> Option<DVec3> {
        self.typed(name, "a point", three_numbers)
    }

    /// A position; a vector is accepted.
    pub fn point(&self, name: &str, default: DVec3) -> DVec3 {
        self.optional_point(name).unwrap_or(default)
    }

    /// A direction; a point is accepted.
    pub fn optional_vector(&self, name: &str) -> Option<DVec3> {
        self.typed(name, "a vector", three_numbers)
    }

    /// A direction; a point is accepted.
    pub fn vector(&self, name: &str, default: DVec3) -> DVec3 {
        self.optional_vector(name).unwrap_or(default)
    }

    /// A transformation, if there is one.
    pub fn optional_transform(&self, name: &str) -> Option<DMat4> {
        self.typed(name, "a transform", |value| match value {
            Value::Transform(matrix) => Some(*matrix),
            _ => None,
        })
    }

    /// A transformation; the identity when absent.
    pub fn transform(&self, name: &str) -> DMat4 {
        self.optional_transform(name).unwrap_or(DMat4::IDENTITY)
    }

    /// The control points of a curve; none when absent.
    pub fn points(&self, name: &str) -> &'a [DVec3] {
        match self.value(name) {
            Some((Value::Points(points), _)) => points,
            Some((other, span)) => {
                self.wrong_type(name, "a list of points", other, span);
                &[]
            }
            None => &[],
        }
    }

    /// One of a few names; any other is an error that lists them, and the default is returned.
    pub fn choice<T: Copy>(&self, name: &str, default: T, choices: &[(&str, T)]) -> T {
        let Some(typed) = self.optional_string(name) else {
            return default;
        };
        if let Some((_, chosen)) = choices.iter().find(|(choice, _)| *choice == typed) {
            return *chosen;
        }
        let names = || choices.iter().map(|(choice, _)| *choice);
        let message = format!("`{}` cannot be `{typed}`", self.original_name(name));
        let mut diagnostic = Diagnostic::error(Fault::BadValue, self.span_of(name), message);
        if let Some(near) = near_names(typed, names()).first() {
            diagnostic = diagnostic.help(format!("did you mean `{near}`?"));
        }
        self.diagnostics.push(diagnostic.help(format!("it can be {}", list_names(names()))));
        default
    }

    /// The child of that name.
    pub fn child(&self, name: &str) -> Option<&'a Child> {
        self.ask(name);
        let (index, child) = self.find_child(name)?;
        self.children_read.borrow_mut()[index] = true;
        Some(child)
    }

    /// Every child of a class, named or not, in the order of the file.
    pub fn children_of(&self, class: Class) -> Vec<&'a Child> {
        let of_class = self.indexed_children().filter(|(_, child)| self.class_of(child) == class);
        let mut read = self.children_read.borrow_mut();
        let mark = |(index, child): (usize, &'a Child)| {
            read[index] = true;
            child
        };
        of_class.map(mark).collect()
    }

    /// The child of a class where a plugin takes one and its name does not matter: the first
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

    /// The same, where the plugin cannot do without; `None` after its absence has been reported.
    pub fn required_child(&self, class: Class) -> Option<&'a Child> {
        let found = self.unnamed_child(class);
        if found.is_none() {
            let message = format!("`{}` needs a {} inside it", self.plugin(), class.name());
            self.diagnostics.error(Fault::MissingParameter, self.node.span, message);
        }
        found
    }

    /// Reports every parameter and child that was not read, with the near names among those that
    /// were asked for, and what the plugin takes.
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

    fn ask(&self, name: &str) {
        let mut asked = self.asked.borrow_mut();
        if !asked.iter().any(|known| known == name) {
            asked.push(name.to_owned());
        }
    }

    /// The last parameter of that name: a later one replaces an earlier one.
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

    fn typed<T>(
        &self,
        name: &str,
        wanted: &str,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> Option<T> {
        let (value, span) = self.value(name)?;
        let result = read(value);
        if result.is_none() {
            self.wrong_type(name, wanted, value, span);
        }
        result
    }

    fn wrong_type(&self, name: &str, wanted: &str, found: &Value, span: Span) {
        let name = self.original_name(name);
        let message = format!("`{name}` must be {wanted}, not {}", found.kind());
        self.diagnostics.error(Fault::BadValue, span, message);
    }

    fn out_of_range(&self, name: &str, found: &str, wanted: &str) {
        let original = self.original_name(name);
        let message = format!("`{original}` is {found}, but must be {wanted}");
        self.diagnostics.error(Fault::BadValue, self.span_of(name), message);
    }

    /// The name as the file spells it.
    fn original_name<'b>(&self, name: &'b str) -> &'b str
    where
        'a: 'b,
    {
        self.find(name).map_or(name, |(_, parameter)| &parameter.original_name)
    }

    fn require(&self, name: &str) -> bool {
        self.ask(name);
        let present = self.find(name).is_some();
        if !present {
            let message = format!("`{}` needs the parameter `{name}`", self.plugin());
            self.diagnostics.error(Fault::MissingParameter, self.node.span, message);
        }
        present
    }

    fn report_duplicates(&self) {
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

    /// Adds the near names among those asked for, and all of them.
    fn with_names(&self, mut diagnostic: Diagnostic, name: &str) -> Diagnostic {
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

fn three_numbers(value: &Value) -> Option<DVec3> {
    match value {
        Value::Point(vector) | Value::Vector(vector) => Some(*vector),
        _ => None,
    }
}

/// A range in words: "at least 0 and below 180".
fn describe<T: std::fmt::Display>(range: &impl RangeBounds<T>) -> String {
    use std::ops::Bound::{Excluded, Included, Unbounded};
    let low = match range.start_bound() {
        Included(low) => format!("at least {low}"),
        Excluded(low) => format!("above {low}"),
        Unbounded => String::new(),
    };
    let high = match range.end_bound() {
        Included(high) => format!("at most {high}"),
        Excluded(high) => format!("below {high}"),
        Unbounded => String::new(),
    };
    match (low.is_empty(), high.is_empty()) {
        (false, false) => format!("{low} and {high}"),
        (true, true) => "finite".to_owned(),
        _ => low + &high,
    }
}
