//! Emitters and sensors of shapes that stand beside the shapes, which refer to them.

use super::Builder;
use crate::emitter::{EMITTERS, SHAPE_EMITTERS};
use crate::sensor::SHAPE_SENSORS;
use etendue_document::{Class, Diagnostic, Document, Fault, NodeId, Parameters};
use std::collections::HashSet;

impl Builder<'_> {
    /// Whether a top-level emitter or sensor is one of shapes, which build it where they refer to
    /// it. Warns if no shape does.
    pub(super) fn is_left_to_shapes(&mut self, parameters: &Parameters<'_>) -> bool {
        let plugin = parameters.plugin();
        let of_shapes = match parameters.class() {
            Class::Emitter => SHAPE_EMITTERS.iter().any(|entry| entry.name == plugin),
            Class::Sensor => SHAPE_SENSORS.iter().any(|entry| entry.name == plugin),
            _ => false,
        };
        if !of_shapes {
            return false;
        }
        let document = self.assets.document;
        let attached = self.attached_to_shapes.get_or_insert_with(|| attached_to_shapes(document));
        if !attached.contains(&parameters.node()) {
            let class = parameters.class().name();
            let message = format!("`{plugin}` belongs in a shape: alone it does nothing");
            let advice = match parameters.id() {
                Some(id) => format!("write `<ref id=\"{id}\"/>` inside a `<shape>`"),
                None => format!("put it inside a `<shape>`, as `<{class} type=\"{plugin}\">`"),
            };
            let found = Diagnostic::warning(Fault::BadValue, parameters.span(), message);
            self.assets.diagnostics.push(found.help(advice));
        }
        true
    }
}

/// What sensors, films and integrators hold or refer to.
const PARTS_OF_SENSORS: [Class; 3] = [Class::Film, Class::Sampler, Class::ReconstructionFilter];

impl Builder<'_> {
    /// Warns of top-level films, samplers and filters that nothing refers to.
    pub(super) fn unused_parts_of_sensors(&self, root: &Parameters<'_>) {
        let parts: Vec<_> =
            PARTS_OF_SENSORS.iter().flat_map(|class| root.children_of(*class)).collect();
        if parts.is_empty() {
            return;
        }
        let document = self.assets.document;
        let others = document.nodes.iter().filter(|node| node.class != Class::Scene);
        let children = others.flat_map(|node| node.children.iter().map(|child| child.node));
        let used: HashSet<NodeId> = children.collect();
        for part in parts.iter().filter(|part| !used.contains(&part.node)) {
            let class = document.node(part.node).class.name();
            let message = format!("no sensor has this {class}: it is left out");
            self.assets.diagnostics.warning(Fault::UnknownParameter, part.span, message);
        }
    }
}

/// Reports an emitter inside a shape that belongs beside it; returns whether it is one.
pub(super) fn is_outside_shapes(parameters: &Parameters<'_>) -> bool {
    let plugin = parameters.plugin();
    let is_free = EMITTERS.iter().any(|entry| entry.name == plugin);
    if is_free {
        let message = format!("`{plugin}` stands in the scene, not in a shape");
        let found = Diagnostic::error(Fault::BadValue, parameters.span(), message);
        let advice = "move it out of the `<shape>`; a shape emits light by an `area` emitter";
        parameters.diagnostics().push(found.help(advice));
    }
    is_free
}

/// The emitters and sensors that shapes hold or refer to.
fn attached_to_shapes(document: &Document) -> HashSet<NodeId> {
    let shapes = document.nodes.iter().filter(|node| node.class == Class::Shape);
    let children = shapes.flat_map(|shape| shape.children.iter().map(|child| child.node));
    let is_attached =
        |id: &NodeId| matches!(document.node(*id).class, Class::Emitter | Class::Sensor);
    children.filter(is_attached).collect()
}
