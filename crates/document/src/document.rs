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
    /// What it is.
    pub class: Class,
    /// Which kind of its class: the XML `type`, upgraded to this version's names.
    pub plugin: Name,
    /// The name other nodes refer to it by.
    pub id: Option<Name>,
    /// Its place: the opening tag, or the node itself.
    pub span: Span,
    /// In the order in which they were given.
    pub parameters: List<Parameter>,
    /// In the order in which they were given.
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
    /// Its place.
    pub span: Span,
}

/// A node inside another one, nested or referred to. A node may have several parents.
#[derive(Clone, Debug, PartialEq)]
pub struct Child {
    /// The role in the parent, if it has one (`reflectance`, `interior`).
    pub name: Option<Name>,
    /// The node.
    pub node: NodeId,
    /// Where the parent names it: the nested opening tag, or the reference.
    pub span: Span,
}

/// A scene as text or code describes it: nodes in one flat list, their places, and the folders in
/// which files are looked for.
///
/// [`Document::build`] makes one in code; [`DocumentBuilder`](crate::DocumentBuilder) is for readers of
/// files. References are resolved and never form a cycle, so a walk from the root ends. A node may
/// have several parents: code that builds something from a node keeps the result by [`NodeId`].
#[derive(Clone, Debug)]
pub struct Document {
    /// Every node; [`NodeId`] is the position here.
    pub nodes: Vec<FlatNode>,
    /// The scene.
    pub root: NodeId,
    /// Nodes with a child that could not be read or found. That has been reported, so what they lack
    /// because of it is no further mistake.
    pub incomplete: BTreeSet<NodeId>,
    /// Where the nodes come from.
    pub sources: Sources,
    /// Where the files it names are looked for.
    pub resolver: Resolver,
}

impl Document {
    /// The node behind an id.
    ///
    /// # Panics
    ///
    /// If the id belongs to another document.
    pub fn node(&self, id: NodeId) -> &FlatNode {
        &self.nodes[id.index()]
    }

    /// The node that carries an id in the scene: `scene.find("teapot")`.
    pub fn find(&self, id: &str) -> Option<NodeId> {
        let position = self.nodes.iter().position(|node| node.id.as_deref() == Some(id))?;
        Some(NodeId(position as u32))
    }

    /// Gives a parameter of a node another value, or a node a further parameter: an edit. The result
    /// is not checked before a scene is built from it.
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

    /// Drops everything except the sources, from which the excerpts of findings are cut.
    pub fn into_sources(self) -> Sources {
        self.sources
    }

    /// Finds the file that `name`, written at `span`, means; the error lists where it was sought.
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

    /// A scene of a million instances is a million of these, matrices included.
    #[test]
    fn nodes_are_small() {
        assert!(size_of::<FlatNode>() <= 208, "{}", size_of::<FlatNode>());
        assert!(size_of::<Child>() <= 24, "{}", size_of::<Child>());
    }
}
