//! Scenes built in code from nested nodes.

use crate::class::Class;
use crate::name::Name;
use crate::value::Value;

/// An object of a scene, with everything inside it.
///
/// Hosts describe scenes in code with it: [`Document::build`](crate::Document::build) turns the
/// root into a document. Nothing is checked before that.
///
/// ```
/// use etendue_document::{Diagnostics, Document, DocumentOptions, Node, reference, rgb};
///
/// let plastic = Node::bsdf("plastic")
///     .id("red")
///     .with("int_ior", 1.5)
///     .with("diffuse_reflectance", rgb([0.6, 0.1, 0.1]));
/// let scene = Node::scene()
///     .child(plastic)
///     .child(Node::shape("sphere").with("radius", 2.0).with("bsdf", reference("red")))
///     .child(Node::shape("sphere").with("radius", -1.0).child(reference("blue")));
///
/// let diagnostics = Diagnostics::new();
/// let document = Document::build(scene, &DocumentOptions::default(), &diagnostics);
/// let found = &diagnostics.sorted()[0];
/// assert_eq!(found.message, "there is no object with the id `blue`");
/// let place = document.sources.locate(found.span.unwrap());
/// assert_eq!(place.to_string(), "scene.shapes[1]");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub(crate) class: Class,
    pub(crate) plugin: Name,
    pub(crate) id: Option<Name>,
    pub(crate) entries: Vec<Entry>,
    /// The number of levels of nodes inside.
    height: u32,
    /// Whether a child was dropped because of the nesting limit.
    pub(crate) lost_a_child: bool,
}

/// A named or unnamed entry of a node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) name: Option<Name>,
    pub(crate) item: Item,
}

/// What [`Node::with`] accepts: a value, a node, or a reference to a node.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A parameter's value.
    Value(Value),
    /// A nested node.
    Node(Node),
    /// The id of a node that is defined elsewhere in the scene.
    Reference(Name),
}

/// What [`Node::child`] accepts: a node, or a reference to one.
#[derive(Clone, Debug, PartialEq)]
pub struct ChildItem(Item);

/// Refers by id to a node defined elsewhere in the scene, before or after.
pub fn reference(id: &str) -> ChildItem {
    ChildItem(Item::Reference(id.into()))
}

/// The maximum nesting depth of nodes, far beyond the limits of a document. It bounds the recursion
/// of functions that walk over nodes.
pub(crate) const HEIGHT_LIMIT: u32 = 128;

impl Node {
    /// An object of a class; `plugin` is its type.
    pub fn new(class: Class, plugin: &str) -> Self {
        Self {
            class,
            plugin: plugin.into(),
            id: None,
            entries: Vec::new(),
            height: 0,
            lost_a_child: false,
        }
    }

    /// Sets the name by which [`reference`](reference())s refer to the node.
    #[must_use]
    pub fn id(mut self, id: &str) -> Self {
        self.id = Some(id.into());
        self
    }

    /// Adds a parameter or a named child: `.with("alpha", 0.1)`, `.with("interior",
    /// Node::medium("homogeneous"))`, `.with("bsdf", reference("red"))`.
    #[must_use]
    pub fn with(mut self, name: &str, item: impl Into<Item>) -> Self {
        self.push(Some(name.into()), item.into());
        self
    }

    /// Adds a child without a role, such as the BSDF of a shape or a shape of the scene.
    #[must_use]
    pub fn child(mut self, child: impl Into<ChildItem>) -> Self {
        self.push(None, child.into().0);
        self
    }

    /// Adds children without roles.
    #[must_use]
    pub fn children(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        children.into_iter().for_each(|child| self.push(None, Item::Node(child)));
        self
    }

    fn push(&mut self, name: Option<Name>, item: Item) {
        if let Item::Node(node) = &item {
            if node.height + 1 > HEIGHT_LIMIT {
                self.lost_a_child = true;
                return;
            }
            self.height = self.height.max(node.height + 1);
        }
        self.entries.push(Entry { name, item });
    }
}

/// One constructor for each class.
macro_rules! constructors {
    ($($(#[$documentation:meta])* $name:ident => $class:ident),+ $(,)?) => {
        impl Node {$(
            $(#[$documentation])*
            pub fn $name(plugin: &str) -> Self {
                Self::new(Class::$class, plugin)
            }
        )+}
    };
}

constructors! {
    /// A light transport algorithm.
    integrator => Integrator,
    /// A camera.
    sensor => Sensor,
    /// What records a camera's picture.
    film => Film,
    /// A source of random numbers.
    sampler => Sampler,
    /// A film's pixel filter.
    reconstruction_filter => ReconstructionFilter,
    /// A surface.
    shape => Shape,
    /// How a surface scatters light.
    bsdf => Bsdf,
    /// A value that varies over a surface.
    texture => Texture,
    /// A light.
    emitter => Emitter,
    /// What fills a volume.
    medium => Medium,
    /// How a medium scatters light.
    phase => Phase,
    /// A value that varies in space.
    volume => Volume,
}

impl Node {
    /// The root of a document.
    pub fn scene() -> Self {
        Self::new(Class::Scene, "scene")
    }
}

impl<T: Into<Value>> From<T> for Item {
    fn from(value: T) -> Self {
        Self::Value(value.into())
    }
}

impl From<Node> for Item {
    fn from(node: Node) -> Self {
        Self::Node(node)
    }
}

impl From<ChildItem> for Item {
    fn from(child: ChildItem) -> Self {
        child.0
    }
}

impl From<Node> for ChildItem {
    fn from(node: Node) -> Self {
        Self(Item::Node(node))
    }
}
