//! Integrators that only wrap another one.

use etendue_document::{Class, FlatNode, Parameter, Value};

use super::approximation::Approximations;
use super::entries::{find, take};

/// Wrappers of version 0.6 that change where samples go or what is cached, not the picture that
/// the integrator inside them converges to; and version 3's Stokes vectors, whose first component
/// is that picture.
const WRAPPERS: &[&str] = &["adaptive", "irrcache", "stokes"];

/// Upgrades an integrator whose children have been upgraded.
pub(super) fn upgrade(nodes: &mut [FlatNode], index: usize, approximations: &mut Approximations) {
    drop_strict_normals(&mut nodes[index], approximations);
    unwrap(nodes, index, approximations);
}

/// Version 0.6's `strictNormals` cuts off light whose sides differ by the geometric and the shading
/// normal. Version 3 has no such parameter and drops it from the scenes that it converts; meshes
/// without normals are smooth there, and lose much light by it. Scenes written in the old way are
/// rendered as version 3 renders them; `strict_normals` still asks for it.
fn drop_strict_normals(node: &mut FlatNode, approximations: &mut Approximations) {
    let old = find(node, "strict_normals").filter(|old| old.original_name == "strictNormals");
    let Some(Parameter { value: Value::Boolean(wanted), span, .. }) = old.cloned() else { return };
    take(node, "strict_normals");
    if wanted {
        let message = "`strictNormals` is dropped, as in version 3: `strict_normals` asks for it";
        approximations.add(message, span);
    }
}

/// Replaces a wrapper by the nested integrator, which has been upgraded.
fn unwrap(nodes: &mut [FlatNode], index: usize, approximations: &mut Approximations) {
    let wrapper = &nodes[index];
    if !WRAPPERS.contains(&wrapper.plugin.as_str()) {
        return;
    }
    let mut nested = wrapper.children.iter().map(|child| &nodes[child.node.index()]);
    let Some(inner) = nested.find(|inner| inner.class == Class::Integrator) else {
        return;
    };
    let message = format!("`{}` is left out around `{}`", wrapper.plugin, inner.plugin);
    approximations.add(message, wrapper.span);
    let FlatNode { plugin, parameters, children, .. } = inner.clone();
    let outer = &mut nodes[index];
    (outer.plugin, outer.parameters, outer.children) = (plugin, parameters, children);
}
