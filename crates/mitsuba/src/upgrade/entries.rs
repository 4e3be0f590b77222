//! Parameters of a node that is being upgraded.

use etendue_document::{FlatNode, Parameter, SpectrumValue, Value};
use glam::DVec3;

/// Removes the parameters of that name and returns the last, which is the one that counts.
pub(super) fn take(node: &mut FlatNode, name: &str) -> Option<Parameter> {
    let mut taken = None;
    node.parameters.retain(|parameter| {
        let wanted = parameter.name == name;
        if wanted {
            taken = Some(parameter.clone());
        }
        !wanted
    });
    taken
}

/// The last parameter of that name, which is the one that counts.
pub(super) fn find<'a>(node: &'a FlatNode, name: &str) -> Option<&'a Parameter> {
    node.parameters.iter().rfind(|parameter| parameter.name == name)
}

/// A value given as one number.
pub(super) fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

/// A colour that is constant over wavelengths or given in RGB.
pub(super) fn color(value: &Value) -> Option<DVec3> {
    match value {
        Value::Rgb(color) => Some(*color),
        Value::Spectrum(SpectrumValue::Constant(value)) => Some(DVec3::splat(*value)),
        value => number(value).map(DVec3::splat),
    }
}

/// A new parameter at the position of the node that it is made from.
pub(super) fn new_parameter(origin: &FlatNode, name: &str, value: Value) -> Parameter {
    Parameter { name: name.into(), original_name: name.into(), value, span: origin.span }
}
