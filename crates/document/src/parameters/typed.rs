//! Typed values, with errors for wrong types and ranges.

use std::ops::RangeBounds;

use glam::{DMat4, DVec3};

use super::Parameters;
use crate::buffer::Buffer;
use crate::diagnostic::{Diagnostic, Fault};
use crate::document::Parameter;
use crate::names::{list_names, near_names};
use crate::span::Span;
use crate::value::{SpectrumValue, Value};

impl<'a> Parameters<'a> {
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

    /// An integer; a float without a fraction is accepted.
    pub fn optional_integer(&self, name: &str) -> Option<i64> {
        self.typed(name, "an integer", |value| match value {
            Value::Integer(integer) => Some(*integer),
            Value::Float(float) if float.fract() == 0.0 && float.abs() < 2f64.powi(53) => {
                Some(*float as i64)
            }
            _ => None,
        })
    }

    /// An integer; a float without a fraction is accepted.
    pub fn integer(&self, name: &str, default: i64) -> i64 {
        self.optional_integer(name).unwrap_or(default)
    }

    /// An integer within `range`; otherwise an error is reported and the default returned.
    pub fn integer_in(&self, name: &str, default: i64, range: impl RangeBounds<i64>) -> i64 {
        match self.optional_integer(name) {
            Some(integer) if range.contains(&integer) => integer,
            Some(integer) => {
                self.out_of_range(name, &integer.in_words(), &describe(&range));
                default
            }
            None => default,
        }
    }

    /// A number; an integer, or a spectrum given as one number, is accepted.
    pub fn optional_float(&self, name: &str) -> Option<f64> {
        self.typed(name, "a number", |value| match value {
            Value::Float(float) => Some(*float),
            Value::Integer(integer) => Some(*integer as f64),
            Value::Spectrum(SpectrumValue::Constant(constant)) => Some(*constant),
            _ => None,
        })
    }

    /// A number; an integer, or a spectrum given as one number, is accepted.
    pub fn float(&self, name: &str, default: f64) -> f64 {
        self.optional_float(name).unwrap_or(default)
    }

    /// A finite number within `range`; otherwise an error is reported and the default returned.
    pub fn float_in(&self, name: &str, default: f64, range: impl RangeBounds<f64>) -> f64 {
        match self.optional_float(name) {
            Some(float) if float.is_finite() && range.contains(&float) => float,
            Some(float) => {
                self.out_of_range(name, &float.in_words(), &describe(&range));
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

    /// A required text; reports its absence and returns `None`.
    pub fn required_string(&self, name: &str) -> Option<&'a str> {
        self.require(name).then(|| self.optional_string(name)).flatten()
    }

    /// A required number; reports its absence and returns `None`.
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
            Value::Transform(affine) => Some((*affine).into()),
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

    /// A shared array, if there is one.
    pub fn buffer(&self, name: &str) -> Option<&'a Buffer> {
        self.typed(name, "a buffer", |value| match value {
            Value::Buffer(buffer) => Some(buffer),
            _ => None,
        })
    }

    /// The shared arrays whose names start with `prefix` and have not been asked for, with their
    /// names, in order. Messages list them as `prefix*`.
    pub fn buffers_with_prefix(&self, prefix: &str) -> Vec<(&'a str, &'a Buffer)> {
        let is_wanted = |parameter: &&Parameter| {
            let name = parameter.name.as_str();
            name.starts_with(prefix) && !self.asked.borrow().iter().any(|asked| asked == name)
        };
        let buffer = |parameter: &'a Parameter| match &parameter.value {
            Value::Buffer(buffer) => Some((parameter.name.as_str(), buffer)),
            _ => None,
        };
        let found = self.node.parameters.iter().filter(is_wanted).filter_map(buffer).collect();
        for (index, parameter) in self.node.parameters.iter().enumerate() {
            if is_wanted(&parameter) && buffer(parameter).is_some() {
                self.parameters_read.borrow_mut()[index] = true;
            }
        }
        self.ask(&format!("{prefix}*"));
        found
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

    /// The name as the scene spells it.
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
}

fn three_numbers(value: &Value) -> Option<DVec3> {
    match value {
        Value::Point(vector) | Value::Vector(vector) => Some(*vector),
        _ => None,
    }
}

/// Formats a number for messages.
trait InWords {
    fn in_words(&self) -> String;

    /// Whether it is the smallest positive number, which as a bound means "above zero".
    fn is_least_positive(&self) -> bool;
}

impl InWords for i64 {
    fn in_words(&self) -> String {
        self.to_string()
    }

    fn is_least_positive(&self) -> bool {
        false
    }
}

impl InWords for f64 {
    /// Uses an exponent instead of rows of zeros.
    fn in_words(&self) -> String {
        match self.abs() {
            magnitude if magnitude >= 1e9 || (magnitude > 0.0 && magnitude < 1e-4) => {
                format!("{self:e}")
            }
            _ => self.to_string(),
        }
    }

    fn is_least_positive(&self) -> bool {
        [Self::MIN_POSITIVE, f32::MIN_POSITIVE.into()].contains(self)
    }
}

/// A range in words: "at least 0 and below 180".
fn describe<T: InWords>(range: &impl RangeBounds<T>) -> String {
    use std::ops::Bound::{Excluded, Included, Unbounded};
    let low = match range.start_bound() {
        Included(low) if low.is_least_positive() => "above 0".to_owned(),
        Included(low) => format!("at least {}", low.in_words()),
        Excluded(low) => format!("above {}", low.in_words()),
        Unbounded => String::new(),
    };
    let high = match range.end_bound() {
        Included(high) => format!("at most {}", high.in_words()),
        Excluded(high) => format!("below {}", high.in_words()),
        Unbounded => String::new(),
    };
    match (low.is_empty(), high.is_empty()) {
        (false, false) => format!("{low} and {high}"),
        (true, true) => "finite".to_owned(),
        _ => low + &high,
    }
}
