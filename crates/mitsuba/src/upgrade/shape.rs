//! Shapes: version 3's `merge` only saves memory and does not change the picture.

use etendue_document::{Child, Class, FlatNode};

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
