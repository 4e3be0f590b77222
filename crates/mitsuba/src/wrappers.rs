//! Materials whose id stands on what they wrap.
//!
//! Real scenes put a material into a bump map and give the id to the material. Nothing could ever refer
//! to the bump map, so a reference to the material means the wrapper.

use std::collections::HashMap;

use etendue_document::{
    Class, Diagnostic, Diagnostics, Fault, FlatNode, Name, NodeId, Reference, Severity, Span,
};

/// A top-level BSDF without an id.
struct Wrapper {
    node: NodeId,
    plugin: Name,
    span: Span,
}

/// The wrappers by the BSDF with an id inside them.
pub(crate) struct Wrappers(HashMap<NodeId, Wrapper>);

impl Wrappers {
    /// Looks for wrappers right inside the scene. Nested nodes alone count, not references.
    pub(crate) fn find(nodes: &[FlatNode]) -> Self {
        let mut wrappers = HashMap::new();
        let children = nodes.first().map(|scene| &*scene.children).unwrap_or_default();
        for child in children {
            let Some(wrapper) = node(nodes, child.node) else {
                continue;
            };
            if wrapper.class == Class::Bsdf
                && wrapper.id.is_none()
                && let Some(inner) = only_named_bsdf(nodes, wrapper)
            {
                let (plugin, span) = (wrapper.plugin.clone(), wrapper.span);
                wrappers.insert(inner, Wrapper { node: child.node, plugin, span });
            }
        }
        Self(wrappers)
    }

    /// The wrapper of a node, where it has one and the reference does not come from inside it.
    pub(crate) fn redirect(
        &self,
        node: NodeId,
        reference: &Reference,
        diagnostics: &Diagnostics,
    ) -> NodeId {
        let Some(wrapper) = self.0.get(&node) else {
            return node;
        };
        // Nodes are numbered in the order of the file: those between the wrapper and the wrapped node
        // are inside the wrapper.
        if (wrapper.node..=node).contains(&reference.parent) {
            return node;
        }
        let Wrapper { plugin, span, .. } = wrapper;
        let message = format!(
            "references to `{}` get the `{plugin}` around it, which has no id of its own",
            reference.id
        );
        diagnostics.push(
            Diagnostic::new(Severity::Note, Fault::Approximation, *span, message)
                .help(format!("give the id to the `{plugin}` to say so")),
        );
        wrapper.node
    }
}

/// A node that is there already; `None` for a reference that is not resolved yet.
fn node(nodes: &[FlatNode], id: NodeId) -> Option<&FlatNode> {
    nodes.get(id.index())
}

/// The first BSDF with an id down the only line of nested BSDFs.
fn only_named_bsdf(nodes: &[FlatNode], wrapper: &FlatNode) -> Option<NodeId> {
    let mut outer = wrapper;
    loop {
        let nested = outer.children.iter().map(|child| child.node);
        let is_bsdf = |id: &NodeId| node(nodes, *id).is_some_and(|node| node.class == Class::Bsdf);
        let mut bsdfs = nested.filter(is_bsdf);
        let inner = bsdfs.next()?;
        if bsdfs.next().is_some() {
            return None;
        }
        if nodes[inner.index()].id.is_some() {
            return Some(inner);
        }
        outer = &nodes[inner.index()];
    }
}
