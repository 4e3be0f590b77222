//! Integrators that only steer another one.

use etendue_document::{Class, Node};

use super::approximation::Approximations;

/// Wrappers of version 0.6 that change where samples go or what is cached, not the picture that
/// the integrator inside them converges to; and version 3's Stokes vectors, whose first component
/// is that picture.
const WRAPPERS: &[&str] = &["adaptive", "irrcache", "stokes"];

/// Puts the nested integrator, which has been upgraded, in the place of its wrapper.
pub(super) fn upgrade(nodes: &mut [Node], index: usize, approximations: &mut Approximations) {
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
    let Node { plugin, parameters, children, .. } = inner.clone();
    let outer = &mut nodes[index];
    (outer.plugin, outer.parameters, outer.children) = (plugin, parameters, children);
}
