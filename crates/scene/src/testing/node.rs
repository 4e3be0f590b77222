//! Scene documents of a few nodes for the tests of plugins.

use crate::builder::{Assets, BuildOptions, Builder};
use etendue_document::{
    Child, Class, Diagnostic, Diagnostics, Document, FlatNode, List, MemoryResources, NodeId,
    Parameter, Parameters, Resolver, SourceId, Sources, Span, Value,
};
use std::collections::BTreeSet;

/// A document whose root is the node of one plugin.
pub(crate) struct TestNode {
    document: Document,
    diagnostics: Diagnostics,
    resources: MemoryResources,
    source: SourceId,
}

impl TestNode {
    /// A node without parameters.
    pub(crate) fn new(class: Class, plugin: &str) -> Self {
        let mut sources = Sources::default();
        let source = sources.add("test.xml", " ".repeat(100));
        let nodes = vec![node(class, plugin, Span::new(source, 0..1))];
        let resolver = Resolver::default();
        let document =
            Document { nodes, root: NodeId(0), incomplete: BTreeSet::new(), sources, resolver };
        let resources = MemoryResources::default();
        Self { document, diagnostics: Diagnostics::new(), resources, source }
    }

    /// Adds a parameter.
    pub(crate) fn with(mut self, name: &str, value: Value) -> Self {
        let root = &mut self.document.nodes[0];
        let place = root.parameters.len() + 1;
        root.parameters.push(Parameter {
            name: name.into(),
            original_name: name.into(),
            value,
            span: Span::new(self.source, place..place + 1),
        });
        self
    }

    /// Adds a number.
    pub(crate) fn float(self, name: &str, value: f64) -> Self {
        self.with(name, Value::Float(value))
    }

    /// Adds a whole number.
    pub(crate) fn integer(self, name: &str, value: i64) -> Self {
        self.with(name, Value::Integer(value))
    }

    /// Adds a string.
    pub(crate) fn string(self, name: &str, value: &str) -> Self {
        self.with(name, Value::String(value.to_owned()))
    }

    /// Adds a child without parameters.
    pub(crate) fn child(mut self, class: Class, plugin: &str) -> Self {
        let id = NodeId(self.document.nodes.len() as u32);
        let span = Span::new(self.source, 50..51);
        self.document.nodes.push(node(class, plugin, span));
        self.document.nodes[0].children.push(Child { name: None, node: id, span });
        self
    }

    /// Adds a file.
    pub(crate) fn file(mut self, path: &str, bytes: Vec<u8>) -> Self {
        self.resources.insert(path, bytes);
        self
    }

    /// Builds something from the node, which must read every parameter.
    pub(crate) fn build<T>(&self, build: impl FnOnce(&mut Builder<'_>, &Parameters<'_>) -> T) -> T {
        let assets = Assets::new(&self.document, &self.resources, &self.diagnostics);
        let options = BuildOptions::default();
        let mut builder = Builder::new(&assets, &options);
        let parameters = self.document.parameters(self.document.root, &self.diagnostics);
        let built = build(&mut builder, &parameters);
        parameters.finish();
        assets.report_not_found();
        built
    }

    /// Builds something without errors or warnings.
    pub(crate) fn build_cleanly<T>(
        &self,
        build: impl FnOnce(&mut Builder<'_>, &Parameters<'_>) -> Option<T>,
    ) -> T {
        let built = self.build(build);
        assert_eq!(self.findings(), [], "nothing should be found");
        built.expect("no error was reported")
    }

    /// The diagnostics so far.
    pub(crate) fn findings(&self) -> Vec<Diagnostic> {
        self.diagnostics.sorted()
    }
}

fn node(class: Class, plugin: &str, span: Span) -> FlatNode {
    let plugin = plugin.into();
    FlatNode { class, plugin, id: None, span, parameters: List::new(), children: List::new() }
}
