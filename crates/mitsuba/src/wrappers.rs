//! Materials whose id belongs to what they wrap.
//!
//! Real scenes wrap a material in a bump map and give the id to the inner material. Nothing could
//! ever refer to the bump map, so a reference to the material means the wrapper.

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

/// The wrappers, indexed by the BSDF with an id inside them.
pub(crate) struct Wrappers(HashMap<NodeId, Wrapper>);

impl Wrappers {
    /// Finds top-level wrappers. Only nested nodes count, not references.
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

    /// The wrapper of a node, if it has one and the reference does not come from inside it.
    pub(crate) fn redirect(
        &self,
        node: NodeId,
        reference: &Reference,
        diagnostics: &Diagnostics,
    ) -> NodeId {
        let Some(wrapper) = self.0.get(&node) else {
            return node;
        };
        // Nodes are numbered in file order: those between the wrapper and the wrapped node are
        // inside the wrapper.
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

/// An existing node; `None` for an unresolved reference.
fn node(nodes: &[FlatNode], id: NodeId) -> Option<&FlatNode> {
    nodes.get(id.index())
}

/// The first BSDF with an id along the chain of single nested BSDFs.
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
