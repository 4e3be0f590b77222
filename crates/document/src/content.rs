//! Serialises a document's content for hashing.

use glam::DVec3;

use crate::document::Document;
use crate::name::Name;
use crate::value::{SpectrumValue, Value};

impl Document {
    /// Emits bytes that differ whenever two documents describe different scenes: classes, plugins,
    /// parameters and children of all nodes. Positions, comments, ids and the content of named
    /// files do not count. A buffer contributes its hash.
    pub fn for_each_byte(&self, mut take: impl FnMut(&[u8])) {
        let mut bytes = Bytes(Vec::with_capacity(2 * FULL));
        for node in &self.nodes {
            bytes.text(node.class.name());
            bytes.text(&node.plugin);
            bytes.count(node.parameters.len());
            for parameter in &node.parameters {
                bytes.text(&parameter.name);
                bytes.value(&parameter.value);
            }
            bytes.count(node.children.len());
            for child in &node.children {
                bytes.text(child.name.as_ref().map_or("", Name::as_str));
                bytes.0.extend_from_slice(&child.node.0.to_le_bytes());
            }
            if bytes.0.len() >= FULL {
                take(&bytes.0);
                bytes.0.clear();
            }
        }
        take(&bytes.0);
    }
}

impl Value {
    /// Appends bytes that differ whenever two values differ; for a buffer, its hash.
    pub fn append_bytes(&self, bytes: &mut Vec<u8>) {
        let mut all = Bytes(std::mem::take(bytes));
        all.value(self);
        *bytes = all.0;
    }
}

/// Bytes collected before they are passed on: a hash function is faster on large chunks.
const FULL: usize = 1 << 16;

struct Bytes(Vec<u8>);

impl Bytes {
    fn count(&mut self, count: usize) {
        self.0.extend_from_slice(&(count as u64).to_le_bytes());
    }

    /// The length prefix separates neighbouring texts.
    fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.extend_from_slice(text.as_bytes());
    }

    fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|number| self.0.extend_from_slice(&number.to_le_bytes()));
    }

    fn vector(&mut self, vector: &DVec3) {
        self.numbers(vector.to_array());
    }

    fn value(&mut self, value: &Value) {
        self.text(value.kind());
        match value {
            Value::Boolean(boolean) => self.0.push(u8::from(*boolean)),
            Value::Integer(integer) => self.0.extend_from_slice(&integer.to_le_bytes()),
            Value::Float(number) => self.numbers([*number]),
            Value::String(text) => self.text(text),
            Value::Point(vector) | Value::Vector(vector) | Value::Rgb(vector) => {
                self.vector(vector)
            }
            Value::Spectrum(SpectrumValue::Constant(constant)) => self.numbers([*constant]),
            Value::Spectrum(SpectrumValue::File(name)) => self.text(name),
            Value::Spectrum(SpectrumValue::Samples(samples)) => {
                self.count(samples.len());
                self.numbers(samples.iter().flat_map(|(wavelength, value)| [*wavelength, *value]));
            }
            Value::Blackbody { temperature, scale } => self.numbers([*temperature, *scale]),
            Value::Transform(affine) => self.numbers(affine.to_cols_array()),
            Value::Points(points) => {
                self.count(points.len());
                points.iter().for_each(|point| self.vector(point));
            }
            Value::Buffer(buffer) => {
                self.0.extend_from_slice(&buffer.content_hash().to_le_bytes());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::Diagnostics;
    use crate::document::Document;
    use crate::flatten::DocumentOptions;
    use crate::node::Node;

    fn bytes(scene: Node) -> Vec<u8> {
        let diagnostics = Diagnostics::new();
        let document = Document::build(scene, &DocumentOptions::default(), &diagnostics);
        assert!(!diagnostics.has_errors());
        let mut all = Vec::new();
        document.for_each_byte(|bytes| all.extend_from_slice(bytes));
        all
    }

    #[test]
    fn every_difference_of_meaning_shows_and_no_other() {
        let sphere = |radius: f64| Node::shape("sphere").with("radius", radius);
        let scene = |shape: Node| Node::scene().child(shape);
        let first = bytes(scene(sphere(1.0)));
        assert_eq!(first, bytes(scene(sphere(1.0).id("ball"))), "an id changes no picture");
        let buffer = |value: f32| Node::shape("mesh").with("positions", vec![[value; 3]]);
        let others = [
            scene(sphere(2.0)),
            scene(Node::shape("sphere").with("radius", 1)),
            scene(Node::shape("disk").with("radius", 1.0)),
            scene(sphere(1.0)).child(sphere(1.0)),
            scene(sphere(1.0).child(Node::bsdf("diffuse"))),
            scene(sphere(1.0).with("a", Node::bsdf("diffuse"))),
            scene(buffer(1.0)),
            scene(buffer(2.0)),
        ];
        let mut all: Vec<Vec<u8>> = others.into_iter().map(bytes).chain([first]).collect();
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
