//! The scene document: readers and hosts produce it, and scenes are built from it.
//!
//! A [`Document`] is a flat list of nodes, each with its class, plugin name, typed parameters and
//! children. Every item knows its position: the lines of a file, or the path of a node built in
//! code.
//!
//! - Hosts build scenes in code from [`Node`]s and [`Buffer`]s; [`Document::build`] checks them.
//! - Readers of files add nodes to a [`DocumentBuilder`], which resolves references and enforces
//!   limits.
//! - Plugins read their node through [`Parameters`], which records the names asked for, so that an
//!   unknown parameter is reported with the names that exist.
//!
//! This crate neither reads files nor prints: bytes come through [`Resources`], and findings are
//! collected in [`Diagnostics`].
#![forbid(unsafe_code)]

mod buffer;
mod builder;
mod check;
mod class;
mod content;
mod diagnostic;
mod document;
mod excerpt;
mod flatten;
mod graph;
mod limits;
mod list;
mod name;
mod names;
mod node;
mod node_path;
mod packed;
mod parameters;
mod printable;
mod resolver;
mod resources;
mod soundness;
mod source;
mod span;
mod transform;
mod value;

pub use buffer::{Buffer, BufferData, Elements, ShapeError};
pub use builder::{DocumentBuilder, Reference, Target};
pub use class::Class;
pub use diagnostic::{Diagnostic, Diagnostics, Fault, Related, Severity};
pub use document::{Child, Document, FlatNode, Parameter};
pub use excerpt::{ExcerptStyle, render_diagnostic};
pub use flatten::DocumentOptions;
pub use limits::DocumentLimits;
pub use list::List;
pub use name::{Name, NameInterner};
pub use names::{list_names, list_some, near_names};
pub use node::{ChildItem, Item, Node, reference};
pub use parameters::{Entry, Parameters, Reading};
pub use printable::{printable, printable_lines};
pub use resolver::{NotFound, Resolver};
pub use resources::{MemoryResources, ResourceError, Resources, normalise};
pub use source::{Source, Sources};
pub use span::{Location, NodeId, SourceId, Span};
pub use transform::{look_at_matrix, thickened, transform_problem};
pub use value::{SpectrumValue, Value, look_at, point, rgb, vector};
