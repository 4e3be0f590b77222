//! The walk over the elements, which makes nodes of them.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use etendue_document::{
    Child, Class, Diagnostic, Diagnostics, Document, Fault, List, Name, NameInterner, Node, NodeId,
    Parameter, Resolver, Resources, SourceId, Sources, Span, Value, list_names, near_names,
    normalise,
};

use crate::defines::Defines;
use crate::element::{Attribute, Element};
use crate::elements::{self, Kind};
use crate::include::OpenFile;
use crate::pieces::Origin;
use crate::resolve::{Named, Reference, Target};
use crate::upgrade::Versions;
use crate::{LoadOptions, resolve, upgrade};

/// Stands in a child until its reference is resolved.
pub(crate) const UNRESOLVED: NodeId = NodeId(u32::MAX);

/// A file with so many errors is not read to its end.
const ERROR_LIMIT: usize = 500;

/// Everything that is known while a scene is read.
pub(crate) struct Loader<'a> {
    pub(crate) resources: &'a dyn Resources,
    pub(crate) options: &'a LoadOptions,
    pub(crate) diagnostics: &'a Diagnostics,
    pub(crate) sources: Sources,
    pub(crate) resolver: Resolver,
    pub(crate) defines: Defines,
    /// The file that is being read.
    pub(crate) source: SourceId,
    /// Where in that file the parsed piece stands.
    pub(crate) origin: Origin,
    /// It and those that led to it.
    pub(crate) open_files: Vec<OpenFile>,
    pub(crate) include_count: usize,
    pub(crate) missing_includes: usize,
    pub(crate) total_bytes: usize,
    /// The names of plugins, parameters and roles.
    pub(crate) names: NameInterner,
    /// The major version that each file claims.
    versions: Versions,
    nodes: Vec<Node>,
    ids: HashMap<Name, Named>,
    references: Vec<Reference>,
    /// Nodes with a child that could not be read.
    incomplete: BTreeSet<NodeId>,
    depth: usize,
    /// A limit was reached: nothing more is read.
    stopped: bool,
}

impl<'a> Loader<'a> {
    pub(crate) fn new(
        resources: &'a dyn Resources,
        options: &'a LoadOptions,
        diagnostics: &'a Diagnostics,
    ) -> Self {
        let resolver = Resolver {
            search_paths: options.search_paths.clone(),
            working_directory: options.working_directory.clone(),
            ..Resolver::default()
        };
        Self {
            resources,
            options,
            diagnostics,
            sources: Sources::default(),
            resolver,
            defines: Defines::new(&options.defines, options.limits.expansion_bytes),
            source: SourceId::default(),
            origin: Origin::default(),
            names: NameInterner::default(),
            open_files: Vec::new(),
            include_count: 0,
            missing_includes: 0,
            total_bytes: 0,
            versions: Versions::new(),
            nodes: Vec::new(),
            ids: HashMap::new(),
            references: Vec::new(),
            incomplete: BTreeSet::new(),
            depth: 0,
            stopped: false,
        }
    }

    /// Reads the main file and all that follows from it; where it is no scene, the texts read.
    pub(crate) fn load_file(mut self, path: &Path) -> Result<Document, Sources> {
        let path = self.options.working_directory.join(path);
        self.open_files.push(OpenFile { path: normalise(&path), included_at: None });
        match self.read_source(&path, None) {
            Some(source) => self.load_source(source),
            None => Err(self.sources),
        }
    }

    /// The same for a text that is there already.
    pub(crate) fn load_text(mut self, name: &str, text: &str) -> Result<Document, Sources> {
        let source = self.add_source(name.to_owned(), text.to_owned(), None);
        self.load_source(source)
    }

    fn load_source(mut self, source: SourceId) -> Result<Document, Sources> {
        self.source = source;
        let mut root = None;
        self.for_each_piece(source, |loader, element, is_first| {
            if is_first {
                root = loader.scene(element);
            }
            if let Some(scene) = root {
                loader.visit_children(element, scene);
            }
        });
        let Some(root) = root else {
            return Err(self.sources);
        };
        self.report_unused_defines();
        let Self {
            mut nodes,
            mut sources,
            ids,
            references,
            diagnostics,
            options,
            mut incomplete,
            ..
        } = self;
        let limits = &options.limits;
        incomplete.append(&mut resolve::resolve(
            &mut nodes,
            &ids,
            &references,
            diagnostics,
            limits,
        ));
        upgrade::upgrade(&mut nodes, &sources, &self.versions, diagnostics);
        // From here on the texts are looked at only where something is wrong.
        sources.pack();
        Ok(Document { nodes, root, incomplete, sources, resolver: self.resolver })
    }

    /// The root element of the main file.
    fn scene(&mut self, root: roxmltree::Node<'_, '_>) -> Option<NodeId> {
        let element = self.open(root);
        if element.name() != "scene" {
            let message = format!("the root element is `<{}>`, not `<scene>`", element.name());
            self.diagnostics.error(Fault::Syntax, element.span, message);
            return None;
        }
        self.scene_attributes(root);
        self.nodes.push(Node {
            class: Class::Scene,
            plugin: "scene".into(),
            id: None,
            span: element.span,
            parameters: List::new(),
            children: List::new(),
        });
        Some(NodeId(0))
    }

    /// Checks the attributes of a `<scene>`: any version is read alike.
    pub(crate) fn scene_attributes(&mut self, node: roxmltree::Node<'_, '_>) {
        let element = self.open(node);
        element.check_attributes(&["version", "type", "id", "name"], self.diagnostics);
        let Some(version) = element.attribute("version") else {
            return;
        };
        let major = version.value.trim().split('.').next().and_then(|m| m.parse::<u32>().ok());
        if let Some(major) = major {
            self.versions.insert(self.source, major);
        }
        let fault = match major {
            Some(0..=3) => return,
            Some(_) => (Fault::Unsupported, "this version is newer than the ones known, up to 3"),
            None => (Fault::BadValue, "this is not a version such as 3.0.0"),
        };
        self.diagnostics.warning(fault.0, version.span, fault.1);
    }

    /// Reads what stands inside an element.
    pub(crate) fn visit_children(&mut self, node: roxmltree::Node<'_, '_>, parent: NodeId) {
        self.depth += 1;
        for child in node.children() {
            if self.stopped || self.diagnostics.error_count() >= ERROR_LIMIT {
                break;
            }
            if child.is_element() {
                self.visit(child, parent);
            } else if child.is_text() {
                self.warn_of_text(child);
            }
        }
        self.depth -= 1;
    }

    /// Reads one element inside an object.
    pub(crate) fn visit(&mut self, node: roxmltree::Node<'_, '_>, parent: NodeId) {
        let element = self.open(node);
        if self.depth > self.options.limits.depth {
            let message = format!("elements nest more than {} deep", self.options.limits.depth);
            self.diagnostics.error(Fault::Limit, element.span, message);
            return;
        }
        match elements::kind(&element) {
            Some(Kind::Object(class)) => self.object(&element, *class, parent),
            Some(Kind::Value { read, attributes, nested }) => {
                element.check_attributes(attributes, self.diagnostics);
                self.parameter(&element, *read, parent);
                if !nested {
                    self.forbid_children(&element);
                }
            }
            Some(Kind::Directive { run, attributes }) => {
                element.check_attributes(attributes, self.diagnostics);
                self.forbid_children(&element);
                run(self, &element, parent);
            }
            None => self.report_unknown_element(&element),
        }
    }

    /// Expands an element's attributes.
    pub(crate) fn open<'b>(&mut self, node: roxmltree::Node<'b, 'b>) -> Element<'b> {
        let element = Element::open(node, &self.origin, &mut self.defines, self.diagnostics);
        self.stopped |= self.defines.exhausted;
        element
    }

    /// Makes room for the objects of a long text at once. What is not used costs nothing, but a vector
    /// that grows leaves holes behind that nothing else fits into.
    pub(crate) fn reserve(&mut self, elements: usize) {
        // Few objects say less than an instance: a reference and a transform of two operations.
        let room = self.options.limits.nodes.saturating_sub(self.nodes.len());
        self.nodes.reserve((elements / 4).min(room));
    }

    /// A node that has been made.
    pub(crate) fn node_mut(&mut self, id: NodeId) -> &mut Node {
        &mut self.nodes[id.index()]
    }

    /// Remembers that a child is to be found by its id.
    pub(crate) fn add_reference(&mut self, parent: NodeId, child: usize, id: &str, span: Span) {
        let id = self.names.name(id);
        self.references.push(Reference { parent, child, id, span });
    }

    /// The shape of an id that has been given already, for which no reference need be kept. (Shapes
    /// alone: a reference to a material may mean what is around it, which the end of the file tells.)
    pub(crate) fn known_shape(&self, id: &str) -> Option<NodeId> {
        match self.ids.get(id)?.target {
            Target::Node(node) if self.nodes[node.index()].class == Class::Shape => Some(node),
            _ => None,
        }
    }

    /// Gives something an id; reports where it was given before.
    pub(crate) fn register(&mut self, id: Name, target: Target, span: Span) {
        if let Some(earlier) = self.ids.get(&id) {
            let message = format!("the id `{id}` is given twice");
            self.diagnostics.push(
                Diagnostic::error(Fault::BadValue, span, message)
                    .related(earlier.span, "given here before"),
            );
            return;
        }
        self.ids.insert(id, Named { target, span });
    }

    /// Keeps a text, with the folder in which the files it names are.
    pub(crate) fn add_source(
        &mut self,
        name: String,
        text: String,
        folder: Option<&Path>,
    ) -> SourceId {
        let folder = folder.unwrap_or(&self.options.working_directory);
        self.resolver.source_folders.push(folder.to_path_buf());
        self.sources.add(name, text)
    }

    /// The folder of the file that is being read.
    pub(crate) fn source_folder(&self) -> &Path {
        &self.resolver.source_folders[self.source.index()]
    }

    fn object(&mut self, element: &Element<'_>, class: Class, parent: NodeId) {
        element.check_attributes(&["type", "id", "name", "version"], self.diagnostics);
        if self.nodes.len() >= self.options.limits.nodes {
            let message = format!("more than {} objects", self.options.limits.nodes);
            self.diagnostics.error(Fault::Limit, element.span, message);
            self.stopped = true;
            return;
        }
        let plugin = element.required("type", self.diagnostics);
        let plugin = plugin.filter(|plugin| self.is_named(plugin));
        let node = NodeId(self.nodes.len() as u32);
        let id = element.value("id").filter(|id| !id.is_empty()).map(Name::from);
        let name = element.value("name").filter(|name| !name.is_empty());
        let name = name.map(|name| self.names.name(name));
        let plugin_name = plugin.map_or("", |plugin| plugin.value.trim());
        self.nodes.push(Node {
            class,
            plugin: self.names.name(plugin_name),
            id: id.clone(),
            span: element.span,
            parameters: List::new(),
            children: List::new(),
        });
        if let (Some(name), Some(id)) = (id, element.attribute("id")) {
            // What has no type cannot be built: references to it are dropped without a word.
            let target = if plugin.is_some() { Target::Node(node) } else { Target::Broken };
            self.register(name, target, id.span);
        }
        if plugin.is_some() {
            let child = Child { name, node, span: element.span };
            self.node_mut(parent).children.push(child);
        } else {
            self.incomplete.insert(parent);
        }
        self.visit_children(element.node, node);
    }

    /// Whether a `type` says anything; reports where it does not.
    fn is_named(&self, plugin: &Attribute<'_>) -> bool {
        let is_named = !plugin.value.trim().is_empty();
        if !is_named {
            self.diagnostics.error(Fault::MissingParameter, plugin.span, "the type is empty");
        }
        is_named
    }

    fn parameter(
        &mut self,
        element: &Element<'_>,
        read: fn(&mut Loader<'_>, &Element<'_>) -> Option<Value>,
        parent: NodeId,
    ) {
        let name = element.required("name", self.diagnostics);
        let name = name.map(|attribute| self.names.name(attribute.value.trim()));
        let value = read(self, element);
        let (Some(name), Some(value), false) = (name, value, element.broken) else {
            return;
        };
        let parameter =
            Parameter { name: name.clone(), original_name: name, value, span: element.span };
        self.node_mut(parent).parameters.push(parameter);
    }

    fn forbid_children(&mut self, element: &Element<'_>) {
        for child in element.node.children().filter(roxmltree::Node::is_element) {
            let child = self.open(child);
            let message = format!("`<{}>` cannot hold `<{}>`", element.name(), child.name());
            self.diagnostics.error(Fault::Syntax, child.span, message);
        }
    }

    fn warn_of_text(&self, node: roxmltree::Node<'_, '_>) {
        let text = node.text().unwrap_or_default();
        let start = node.range().start + (text.len() - text.trim_start().len());
        let length = text.trim().len();
        if length > 0 {
            let span = self.origin.span(start..start + length);
            let message = "text between elements has no meaning and is ignored";
            self.diagnostics.warning(Fault::Syntax, span, message);
        }
    }

    fn report_unknown_element(&self, element: &Element<'_>) {
        let name = element.name();
        let message = match name {
            "scene" => "a `<scene>` cannot stand inside another one".to_owned(),
            _ => format!("there is no element `<{name}>`"),
        };
        let mut diagnostic = Diagnostic::error(Fault::Syntax, element.span, message);
        let near = near_names(name, elements::names());
        if !near.is_empty() {
            diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
        }
        self.diagnostics.push(diagnostic);
    }

    /// A misspelt name on the command line would otherwise go unnoticed.
    fn report_unused_defines(&self) {
        let (unused, known) = self.defines.unused();
        for name in unused {
            let message = format!("the scene does not use `${name}`");
            let diagnostic = Diagnostic::warning(Fault::UnknownParameter, None, message);
            self.diagnostics.push(if known.is_empty() {
                diagnostic.help("it uses no `$names`")
            } else {
                diagnostic.help(format!("it uses {}", list_names(known.iter().copied())))
            });
        }
    }
}
