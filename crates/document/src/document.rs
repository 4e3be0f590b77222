//! Nodes, their parameters and children: a scene before anything is built from it.

use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::class::Class;
use crate::list::List;
use crate::name::Name;
use crate::resolver::{NotFound, Resolver};
use crate::resources::Resources;
use crate::source::Sources;
use crate::span::{NodeId, Span};
use crate::value::Value;

/// One object of the scene, with its children by id.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatNode {
    /// Its class.
    pub class: Class,
    /// The plugin within its class: the XML `type`, upgraded to this version's names.
    pub plugin: Name,
    /// The name other nodes refer to it by.
    pub id: Option<Name>,
    /// Its position: the opening tag, or the node itself.
    pub span: Span,
    /// In the order given.
    pub parameters: List<Parameter>,
    /// In the order given.
    pub children: List<Child>,
}

/// A named value of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// In this version's spelling (`to_world`).
    pub name: Name,
    /// As typed (`toWorld`).
    pub original_name: Name,
    /// The value.
    pub value: Value,
    /// Its position.
    pub span: Span,
}

/// A node inside another one, nested or by reference. A node may have several parents.
#[derive(Clone, Debug, PartialEq)]
pub struct Child {
    /// Its role in the parent, if any (`reflectance`, `interior`).
    pub name: Option<Name>,
    /// The node.
    pub node: NodeId,
    /// Where the parent mentions it: the nested opening tag, or the reference.
    pub span: Span,
}

/// A scene described by text or code: a flat list of nodes, their positions, and the folders in
/// which files are looked up.
///
/// [`Document::build`] makes one in code; [`DocumentBuilder`](crate::DocumentBuilder) is for
/// readers of files. References are resolved and never form a cycle, so a walk from the root
/// terminates. A node may have several parents, so code that builds something from a node caches
/// the result by [`NodeId`].
#[derive(Clone, Debug)]
pub struct Document {
    /// All nodes, indexed by [`NodeId`].
    pub nodes: Vec<FlatNode>,
    /// The root: the scene.
    pub root: NodeId,
    /// Nodes with a child that could not be read or found. That has been reported, so anything
    /// missing because of it is not reported again.
    pub incomplete: BTreeSet<NodeId>,
    /// Where the nodes come from.
    pub sources: Sources,
    /// Where the document's files are looked up.
    pub resolver: Resolver,
}

impl Document {
    /// The node with this id.
    ///
    /// # Panics
    ///
    /// If the id belongs to another document.
    pub fn node(&self, id: NodeId) -> &FlatNode {
        &self.nodes[id.index()]
    }

    /// The node with this `id` in the scene: `scene.find("teapot")`.
    pub fn find(&self, id: &str) -> Option<NodeId> {
        let position = self.nodes.iter().position(|node| node.id.as_deref() == Some(id))?;
        Some(NodeId(position as u32))
    }

    /// Edits the document: sets a parameter of a node, or adds it. The result is not checked until
    /// a scene is built from it.
    ///
    /// # Panics
    ///
    /// If the id belongs to another document.
    pub fn set(&mut self, id: NodeId, name: &str, value: impl Into<Value>) {
        let node = &mut self.nodes[id.index()];
        let value = value.into();
        match node.parameters.iter_mut().rfind(|parameter| parameter.name == name) {
            Some(parameter) => parameter.value = value,
            None => {
                let (name, span) = (Name::from(name), node.span);
                let original_name = name.clone();
                node.parameters.push(Parameter { name, original_name, value, span });
            }
        }
    }

    /// Drops everything except the sources, which the excerpts of findings need.
    pub fn into_sources(self) -> Sources {
        self.sources
    }

    /// Finds the file that `name`, written at `span`, refers to; the error lists where it was
    /// looked up.
    pub fn resolve(
        &self,
        name: &str,
        span: Span,
        resources: &dyn Resources,
    ) -> Result<PathBuf, NotFound> {
        self.resolver.resolve(name, span.source(), resources)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene of a million instances holds a million of these, matrices included.
    #[test]
    fn nodes_are_small() {
        assert!(size_of::<FlatNode>() <= 208, "{}", size_of::<FlatNode>());
        assert!(size_of::<Child>() <= 24, "{}", size_of::<Child>());
    }
}
