//! Spectra: version 3 writes them as nested plugins; here they are values, and the parameter
//! determines whether they are emission or reflectance.

use etendue_document::{Class, FlatNode, NodeId, Parameter, SpectrumValue, Value};
use glam::DVec3;

use super::entries::{find, number};

/// Turns the spectra inside a node into values.
pub(super) fn inline(nodes: &mut [FlatNode], index: usize) {
    if !nodes[index].children.iter().any(|child| value(nodes, child.node).is_some()) {
        return;
    }
    let children = std::mem::take(&mut nodes[index].children);
    let (spectra, others): (Vec<_>, Vec<_>) =
        children.into_iter().partition(|child| value(nodes, child.node).is_some());
    for child in spectra {
        // Unnamed ones exist only as targets of references.
        if let (Some(name), Some(value)) = (child.name, value(nodes, child.node)) {
            let (original_name, span) = (name.clone(), child.span);
            nodes[index].parameters.push(Parameter { name, original_name, value, span });
        }
    }
    nodes[index].children = others.into();
}

/// The value of a spectrum; `None` for anything else and for incomplete ones.
fn value(nodes: &[FlatNode], node: NodeId) -> Option<Value> {
    let node = &nodes[node.index()];
    if node.class != Class::Texture {
        return None;
    }
    match node.plugin.as_str() {
        // A plain number, because `uniform` is grey even as emission; the short form of a constant
        // would be equal-energy white there.
        "uniform" => {
            let constant = find(node, "value").map_or(Some(1.0), |value| number(&value.value))?;
            Some(Value::Float(constant))
        }
        "srgb" => match find(node, "color")?.value {
            Value::Rgb(color) => Some(Value::Rgb(color)),
            _ => None,
        },
        // The colour is relative to white.
        "d65" => {
            let scale = find(node, "scale").map_or(Some(1.0), |scale| number(&scale.value))?;
            match find(node, "color").map(|color| &color.value) {
                Some(Value::Rgb(color)) => Some(Value::Rgb(*color * scale)),
                Some(_) => None,
                None => Some(Value::Rgb(DVec3::splat(scale))),
            }
        }
        "blackbody" => {
            let temperature = number(&find(node, "temperature")?.value)?;
            Some(Value::Blackbody { temperature, scale: 1.0 })
        }
        "regular" => regular(node),
        "irregular" => samples(numbers(node, "wavelengths")?, numbers(node, "values")?),
        _ => None,
    }
}

/// Values at equal steps from one wavelength to another.
fn regular(node: &FlatNode) -> Option<Value> {
    let values = numbers(node, "values")?;
    let bound = |name| number(&find(node, name)?.value);
    let (low, high) = (bound("wavelength_min")?, bound("wavelength_max")?);
    let steps = values.len().checked_sub(1).filter(|steps| *steps > 0)? as f64;
    let wavelengths =
        (0..values.len()).map(|index| low + (high - low) * index as f64 / steps).collect();
    samples(wavelengths, values)
}

fn samples(wavelengths: Vec<f64>, values: Vec<f64>) -> Option<Value> {
    let is_whole = wavelengths.len() == values.len();
    let samples = wavelengths.into_iter().zip(values).collect();
    is_whole.then_some(Value::Spectrum(SpectrumValue::Samples(samples)))
}

/// A list of numbers in a text, separated by commas or spaces.
fn numbers(node: &FlatNode, name: &str) -> Option<Vec<f64>> {
    let Value::String(text) = &find(node, name)?.value else { return None };
    let words = text.split(|letter: char| letter == ',' || letter.is_whitespace());
    words.filter(|word| !word.is_empty()).map(|word| word.parse().ok()).collect()
}
