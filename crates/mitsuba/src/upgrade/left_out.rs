//! Plugins of version 0.6 that have no counterpart here and are left out.

use std::collections::HashSet;

use etendue_document::{Class, FlatNode, NodeId};

use super::approximation::Approximations;

/// What is left out, and why.
static LEFT_OUT: &[(Class, &str, &str)] = &[
    (Class::Emitter, "collimated", "a beam without width meets no point that is seen"),
    (Class::Shape, "deformable", "shapes do not move here"),
    (Class::Sensor, "fluencemeter", "no sensor here measures a point"),
];

/// Why a plugin is left out, if it is.
pub(super) fn reason(class: Class, plugin: &str) -> Option<&'static str> {
    let row = LEFT_OUT.iter().find(|(of, name, _)| *of == class && *name == plugin);
    row.map(|(.., reason)| *reason)
}

/// Removes the nodes that are left out from all others. They get an empty name, which marks nodes
/// that are not built.
pub(super) fn remove(nodes: &mut [FlatNode], approximations: &mut Approximations) {
    let mut removed = HashSet::new();
    for (index, node) in nodes.iter_mut().enumerate() {
        if let Some(reason) = reason(node.class, &node.plugin) {
            let message =
                format!("the {} `{}` is left out: {reason}", node.class.name(), node.plugin);
            approximations.add(message, node.span);
            node.plugin = "".into();
            node.parameters.clear();
            node.children.clear();
            removed.insert(NodeId(index as u32));
        }
    }
    if removed.is_empty() {
        return;
    }
    for node in nodes {
        node.children.retain(|child| !removed.contains(&child.node));
    }
}
