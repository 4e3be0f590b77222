//! Nodes, their parameters and children: a scene before anything is built from it.

use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::{
    Diagnostics, List, Name, NotFound, Parameters, Resolver, Resources, Sources, Span, Value,
};

/// NameInterner one node of a [`Document`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

impl NodeId {
    /// The position in [`Document::nodes`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a node is, whatever its plugin: the name of its element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Class {
    /// The root.
    Scene,
    /// How light is computed.
    Integrator,
    /// A camera.
    Sensor,
    /// What the camera's image is kept on.
    Film,
    /// Where random numbers come from.
    Sampler,
    /// The pixel filter.
    ReconstructionFilter,
    /// A surface.
    Shape,
    /// How a surface scatters light.
    Bsdf,
    /// A value that varies over a surface.
    Texture,
    /// A light.
    Emitter,
    /// What fills a volume.
    Medium,
    /// How a medium scatters light.
    Phase,
    /// A value that varies in space.
    Volume,
    /// Subsurface scattering (version 0.6 and before).
    Subsurface,
    /// The profile of a surface of revolution.
    Curve,
}

impl Class {
    /// The name of the class's element in the files, such as `bsdf`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Integrator => "integrator",
            Self::Sensor => "sensor",
            Self::Film => "film",
            Self::Sampler => "sampler",
            Self::ReconstructionFilter => "rfilter",
            Self::Shape => "shape",
            Self::Bsdf => "bsdf",
            Self::Texture => "texture",
            Self::Emitter => "emitter",
            Self::Medium => "medium",
            Self::Phase => "phase",
            Self::Volume => "volume",
            Self::Subsurface => "subsurface",
            Self::Curve => "curve",
        }
    }
}

/// One object of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// What it is.
    pub class: Class,
    /// Which kind of its class: the XML `type`, upgraded to this version's names.
    pub plugin: Name,
    /// The name other nodes refer to it by.
    pub id: Option<Name>,
    /// Where it starts: the opening tag.
    pub span: Span,
    /// In the order of the file.
    pub parameters: List<Parameter>,
    /// In the order of the file.
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
    /// Where it stands.
    pub span: Span,
}

/// A node inside another one, nested or referred to. A node may have several parents.
#[derive(Clone, Debug, PartialEq)]
pub struct Child {
    /// The role in the parent where the file gives one (`reflectance`, `interior`).
    pub name: Option<Name>,
    /// The node.
    pub node: NodeId,
    /// Where the parent names it: the nested opening tag, or the reference.
    pub span: Span,
}

/// A scene as text says it: nodes in one flat list, places, and where files are looked for.
///
/// References are resolved and never form a cycle, so a walk from the root ends. A node may have
/// several parents: who builds something from it keeps the result by [`NodeId`].
#[derive(Clone, Debug)]
pub struct Document {
    /// Every node; [`NodeId`] is the position here.
    pub nodes: Vec<Node>,
    /// The scene.
    pub root: NodeId,
    /// Nodes with a child that could not be read or found, which has been reported: what they lack
    /// because of it is no further mistake.
    pub incomplete: BTreeSet<NodeId>,
    /// The texts the nodes came from.
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
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The reader from which a plugin is built.
    pub fn parameters<'a>(&'a self, node: NodeId, diagnostics: &'a Diagnostics) -> Parameters<'a> {
        Parameters::new(self, node, diagnostics)
    }

    /// Lets go of everything but the texts, of which findings show excerpts.
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
        self.resolver.resolve(name, span.source, resources)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene of a million instances is a million of these, matrices included.
    #[test]
    fn nodes_are_small() {
        assert!(size_of::<Node>() <= 208, "{}", size_of::<Node>());
        assert!(size_of::<Child>() <= 24, "{}", size_of::<Child>());
    }
}
