//! Shapes: version 3's `merge` says how meshes are kept in memory, and nothing of the picture.

use etendue_document::{Child, Class, FlatNode};

/// Puts the shapes inside a `merge`, which have been dissolved themselves, in its place.
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
