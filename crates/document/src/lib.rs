//! The scene document: typed parameters, positions, diagnostics, resources.
//!
//! Every reader of scene files (Mitsuba XML first) produces the same [`Document`]: a flat list of
//! nodes, each with its class, plugin name, typed parameters and children, and every item knows
//! the place in the file it came from. Plugins read their node through [`Parameters`], which
//! remembers what was asked, so that a parameter nobody knows is reported with the names that
//! exist. Nothing here reads files or prints: bytes come through [`Resources`], and findings are
//! collected in [`Diagnostics`].
#![forbid(unsafe_code)]

mod diagnostic;
mod document;
mod excerpt;
mod list;
mod name;
mod names;
mod packed;
mod parameters;
mod resolver;
mod resources;
mod source;
mod value;

pub use diagnostic::{Diagnostic, Diagnostics, Fault, Related, Severity};
pub use document::{Child, Class, Document, Node, NodeId, Parameter};
pub use excerpt::render_diagnostic;
pub use list::List;
pub use name::{Name, NameInterner};
pub use names::{list_names, near_names};
pub use parameters::{Entry, Parameters};
pub use resolver::{NotFound, Resolver, normalise};
pub use resources::{MemoryResources, ResourceError, Resources};
pub use source::{Location, Source, SourceId, Sources, Span};
pub use value::{SpectrumValue, Value};
