//! Walks over the elements and creates nodes.

use std::path::Path;

use etendue_document::{
    Child, Class, Diagnostic, Document, Fault, FlatNode, List, Name, NodeId, Parameter, SourceId,
    Sources, Span, Target, Value, list_names, near_names, normalise,
};

use crate::element::{Attribute, Element};
use crate::elements::{self, Kind};
use crate::include;
use crate::loader::{Loader, OpenFile};
use crate::pieces::after_comments;
use crate::upgrade;
use crate::wrappers::Wrappers;

/// Reading stops after this many errors in a file.
const ERROR_LIMIT: usize = 500;

impl Loader<'_> {
    /// Reads the main file and everything it includes; if it is not a scene, returns the texts
    /// read.
    pub(crate) fn load_file(mut self, path: &Path) -> Result<Document, Sources> {
        let path = self.options.working_directory.join(path);
        self.open_files.push(OpenFile { path: normalise(&path), included_at: None });
        match self.read_source(&path, None) {
            Some(source) => self.load_source(source),
            None => Err(self.sources),
        }
    }

    /// Like [`Self::load_file`], for a text in memory.
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
        if root.is_none() {
            return Err(self.sources);
        }
        self.report_unused_defines();
        let Self { builder, mut sources, resolver, versions, diagnostics, .. } = self;
        let wrappers = Wrappers::find(builder.nodes());
        // From here on, the texts are needed only for excerpts of errors.
        sources.pack();
        let redirect = |node, reference: &_| wrappers.redirect(node, reference, diagnostics);
        let mut document = builder.finish_with(sources, resolver, redirect);
        upgrade::upgrade(&mut document.nodes, &document.sources, &versions, diagnostics);
        Ok(document)
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
        self.builder.push(FlatNode {
            class: Class::Scene,
            plugin: "scene".into(),
            id: None,
            span: element.span,
            parameters: List::new(),
            children: List::new(),
        })
    }

    /// Checks the attributes of a `<scene>`. All versions are read alike.
    fn scene_attributes(&mut self, node: roxmltree::Node<'_, '_>) {
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

    /// Reads the content of an element.
    fn visit_children(&mut self, node: roxmltree::Node<'_, '_>, parent: NodeId) {
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
    fn visit(&mut self, node: roxmltree::Node<'_, '_>, parent: NodeId) {
        let element = self.open(node);
        if self.depth > self.options.limits.document.depth {
            let limit = self.options.limits.document.depth;
            let message = format!("elements nest more than {limit} deep");
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
            Some(Kind::Include { attributes }) => {
                element.check_attributes(attributes, self.diagnostics);
                self.forbid_children(&element);
                self.include(&element, parent);
            }
            None => self.report_unknown_element(&element),
        }
    }

    /// Reads the content of an `<include>`.
    fn include(&mut self, element: &Element<'_>, parent: NodeId) {
        let Some(source) = include::open(self, element) else {
            return;
        };
        if !self.is_part_of_scene(source) {
            self.report_foreign(source, element.span);
            include::close(self);
            return;
        }
        // Files that state no version are of that of the file that includes them.
        if let Some(version) = self.versions.get(&self.source).copied() {
            self.versions.insert(source, version);
        }
        let outer = std::mem::replace(&mut self.source, source);
        self.for_each_piece(source, |loader, root, is_first| {
            if !root.has_tag_name("scene") {
                loader.visit(root, parent);
                return;
            }
            if is_first {
                loader.scene_attributes(root);
            }
            loader.visit_children(root, parent);
        });
        self.source = outer;
        include::close(self);
    }

    fn object(&mut self, element: &Element<'_>, class: Class, parent: NodeId) {
        element.check_attributes(&["type", "id", "name", "version"], self.diagnostics);
        let plugin = element.required("type", self.diagnostics);
        let plugin = plugin.filter(|plugin| self.is_named(plugin));
        let id = element.value("id").filter(|id| !id.is_empty()).map(Name::from);
        let name = element.value("name").filter(|name| !name.is_empty());
        let name = name.map(|name| self.builder.name(name));
        let plugin_name = self.builder.name(plugin.map_or("", |plugin| plugin.value.trim()));
        let Some(node) = self.builder.push(FlatNode {
            class,
            plugin: plugin_name,
            id: id.clone(),
            span: element.span,
            parameters: List::new(),
            children: List::new(),
        }) else {
            self.stopped = true;
            return;
        };
        if let (Some(name), Some(id)) = (id, element.attribute("id")) {
            // An element without a type cannot be built; references to it are dropped silently.
            let target = if plugin.is_some() { Target::Node(node) } else { Target::Broken };
            self.builder.define(name, target, id.span);
        }
        if plugin.is_some() {
            let child = Child { name, node, span: element.span };
            self.builder.node_mut(parent).children.push(child);
        } else {
            self.builder.mark_incomplete(parent);
        }
        self.visit_children(element.node, node);
    }

    /// Whether a `type` is not empty; reports it if it is.
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
        let name = name.map(|attribute| self.builder.name(attribute.value.trim()));
        let value = read(self, element);
        let (Some(name), Some(value), false) = (name, value, element.broken) else {
            return;
        };
        let parameter =
            Parameter { name: name.clone(), original_name: name, value, span: element.span };
        self.builder.node_mut(parent).parameters.push(parameter);
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

    /// Whether the first element of an included text is one that may stand in a scene.
    fn is_part_of_scene(&self, source: SourceId) -> bool {
        let text = self.sources.get(source).map(etendue_document::Source::text);
        let text = text.as_deref().map(after_comments).unwrap_or_default();
        let name = text.strip_prefix('<').unwrap_or_default();
        let end = name.find(|letter: char| !letter.is_alphanumeric()).unwrap_or(name.len());
        name[..end] == *"scene" || elements::names().any(|known| known == &name[..end])
    }

    /// Reports an included file of another kind. Nothing of it is shown, because a scene may name
    /// any file of the machine.
    fn report_foreign(&mut self, source: SourceId, span: Span) {
        self.sources.withhold(source);
        let message = "this is no part of a scene: it starts with neither `<scene>` nor an element \
                       that may stand in one";
        self.diagnostics.push(
            Diagnostic::error(Fault::Syntax, Span::new(source, 0..1), message)
                .related(span, "included here"),
        );
    }

    fn report_unknown_element(&self, element: &Element<'_>) {
        let name = element.name();
        let message = match name {
            "scene" => "a `<scene>` cannot stand inside another one".to_owned(),
            _ => format!("there is no element `<{name}>`"),
        };
        let mut diagnostic = Diagnostic::error(Fault::Syntax, element.span, message);
        if let Some(advice) = elements::advice(name) {
            self.diagnostics.push(diagnostic.help(advice));
            return;
        }
        let near = near_names(name, elements::names());
        if !near.is_empty() {
            diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
        }
        self.diagnostics.push(diagnostic);
    }

    /// Otherwise a misspelt name on the command line would go unnoticed.
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
