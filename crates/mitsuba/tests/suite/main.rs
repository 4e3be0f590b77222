//! Scenes of every dialect and every defect through the public interface.

mod corpus;
mod elements;
mod files;
mod media;
mod mutation;
mod references;
mod transforms;
mod upgrades;
mod wild;

use etendue_document::{
    Diagnostics, Document, Fault, FlatNode, MemoryResources, NodeId, Resources, Severity, Value,
};
use etendue_mitsuba::{LoadOptions, read_text};

/// A document and what was found on the way to it.
struct Loaded {
    document: Document,
    diagnostics: Diagnostics,
}

/// Loads the content of a scene, which starts on line 2.
fn load(content: &str) -> Loaded {
    load_with(content, &MemoryResources::default(), &LoadOptions::default())
}

/// Loads the content of a scene of version 0.6, which starts on line 2.
fn load_old(content: &str) -> Loaded {
    let text = format!("<scene version=\"0.6.0\">\n{content}\n</scene>");
    let diagnostics = Diagnostics::new();
    let (resources, options) = (MemoryResources::default(), LoadOptions::default());
    let document = read_text(&text, &resources, &options, &diagnostics).expect("it is a scene");
    Loaded { document, diagnostics }
}

fn load_with(content: &str, resources: &dyn Resources, options: &LoadOptions) -> Loaded {
    let text = format!("<scene version=\"3.0.0\">\n{content}\n</scene>");
    let diagnostics = Diagnostics::new();
    let document = read_text(&text, resources, options, &diagnostics).expect("it is a scene");
    Loaded { document, diagnostics }
}

/// The same, where nothing may be found wrong.
fn clean(content: &str) -> Document {
    let loaded = load(content);
    assert_eq!(loaded.findings(), [], "{}", loaded.shown());
    loaded.document
}

impl Loaded {
    /// Severity, fault and line of every finding; line 0 is for no place.
    fn findings(&self) -> Vec<(Severity, Fault, usize)> {
        let place = |span| self.document.sources.locate(span).line().unwrap_or_default();
        let found = self.diagnostics.sorted().into_iter();
        found.map(|found| (found.severity, found.fault, found.span.map_or(0, place))).collect()
    }

    fn messages(&self) -> Vec<String> {
        self.diagnostics.sorted().into_iter().map(|found| found.message).collect()
    }

    /// Everything as a user would see it.
    fn shown(&self) -> String {
        let found = self.diagnostics.sorted().into_iter();
        let render = |found| {
            etendue_document::render_diagnostic(
                &found,
                &self.document.sources,
                etendue_document::ExcerptStyle::default(),
            )
        };
        found.map(render).collect()
    }
}

/// The child of the scene at a position.
fn object(document: &Document, position: usize) -> &FlatNode {
    let scene = document.node(document.root);
    document.node(scene.children[position].node)
}

/// The node inside another one at a position.
fn nested<'a>(document: &'a Document, node: &FlatNode, position: usize) -> &'a FlatNode {
    document.node(node.children[position].node)
}

fn child_ids(node: &FlatNode) -> Vec<NodeId> {
    node.children.iter().map(|child| child.node).collect()
}

/// The parameter of that name, of which there must be one.
fn value<'a>(node: &'a FlatNode, name: &str) -> &'a Value {
    let mut found = node.parameters.iter().filter(|parameter| parameter.name == name);
    let parameter = found.next().unwrap_or_else(|| panic!("no `{name}` in {node:?}"));
    assert!(found.next().is_none(), "two of `{name}`");
    &parameter.value
}

/// The names of all parameters, in order.
fn names(node: &FlatNode) -> Vec<&str> {
    node.parameters.iter().map(|parameter| parameter.name.as_str()).collect()
}
