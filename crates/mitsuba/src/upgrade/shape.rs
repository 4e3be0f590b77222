//! Shapes: version 3's `merge` only saves memory and does not change the picture; version 0.6's
//! `hair` has one radius.

use etendue_document::{Child, Class, FlatNode, Value};

use super::entries::{find, new_parameter};

/// Replaces a `merge` by the shapes inside it.
pub(super) fn dissolve_merges(nodes: &mut [FlatNode], index: usize) {
    let is_merge = |child: &Child| {
        let node = &nodes[child.node.index()];
        node.class == Class::Shape && node.plugin == "merge"
    };
    if !nodes[index].children.iter().any(is_merge) {
        return;
    }
    let mut children = Vec::new();
    for child in &nodes[index].children {
        if is_merge(child) {
            let inner = &nodes[child.node.index()].children;
            let shapes = |inner: &&Child| nodes[inner.node.index()].class == Class::Shape;
            children.extend(inner.iter().filter(shapes).cloned());
        } else {
            children.push(child.clone());
        }
    }
    nodes[index].children = children.into();
}

/// The radius of version 0.6's `hair` where a scene gives none.
const HAIR_RADIUS: f64 = 0.025;

/// States the default radius of hair, which no other shape has.
pub(super) fn hair_radius(node: &mut FlatNode) {
    if node.class == Class::Shape && node.plugin == "hair" && find(node, "radius").is_none() {
        let radius = new_parameter(node, "radius", Value::Float(HAIR_RADIUS));
        node.parameters.push(radius);
    }
}
