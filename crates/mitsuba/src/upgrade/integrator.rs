//! Integrators that only wrap another one.

use etendue_document::{Class, FlatNode, Parameter, Value};

use super::approximation::Approximations;
use super::entries::{find, take};

/// Wrappers of version 0.6 that change the sample distribution or caching but not the converged
/// picture of the nested integrator; and version 3's Stokes vectors, whose first component is that
/// picture.
const WRAPPERS: &[&str] = &["adaptive", "irrcache", "stokes"];

/// Upgrades an integrator whose children have been upgraded.
pub(super) fn upgrade(nodes: &mut [FlatNode], index: usize, approximations: &mut Approximations) {
    drop_strict_normals(&mut nodes[index], approximations);
    unwrap(nodes, index, approximations);
}

/// Version 0.6's `strictNormals` removes light that arrives on different sides of the geometric and
/// the shading normal. Version 3 has no such parameter and drops it when it converts scenes. Meshes
/// without normals are smooth there and lose much light with it. We therefore render old scenes as
/// version 3 does; `strict_normals` still enables the rule.
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
