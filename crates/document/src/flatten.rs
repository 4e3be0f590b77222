//! Converts nested nodes to a document.

use std::collections::HashMap;

use crate::builder::{DocumentBuilder, Target};
use crate::check::value_problem;
use crate::class::{CLASS_COUNT, Class};
use crate::diagnostic::{Diagnostics, Fault};
use crate::document::{Child, Document, FlatNode, Parameter};
use crate::limits::DocumentLimits;
use crate::list::List;
use crate::name::Name;
use crate::node::{Entry, HEIGHT_LIMIT, Item, Node};
use crate::node_path::{NodePaths, Step};
use crate::resolver::Resolver;
use crate::source::Sources;
use crate::span::{NodeId, Span};
use crate::value::Value;

/// Options of a document built in code.
#[derive(Clone, Debug, Default)]
pub struct DocumentOptions {
    /// Where the files that it names are looked up.
    pub resolver: Resolver,
    /// Limits on its size.
    pub limits: DocumentLimits,
}

impl Document {
    /// Builds a document from a scene described in code.
    ///
    /// Ids, references, values and limits are checked as in a file. Findings go to `diagnostics`,
    /// with paths of nodes as positions. A document is returned even after errors, so that errors
    /// of the plugins show in the same run.
    pub fn build(scene: Node, options: &DocumentOptions, diagnostics: &Diagnostics) -> Self {
        let mut flattener = Flattener {
            builder: DocumentBuilder::new(options.limits.clone(), diagnostics),
            diagnostics,
            paths: NodePaths::default(),
            name_positions: HashMap::new(),
            is_full: false,
        };
        let class = scene.class;
        let root = Step { parent: None, class, name: None, position: None };
        let root = flattener.add(scene, root);
        if let (Some(root), true) = (root, class != Class::Scene) {
            let message = format!("the root is a {}, not a scene", class.name());
            diagnostics.error(Fault::Syntax, Span::of_node(root), message);
        }
        let sources = Sources::of_nodes(flattener.paths);
        flattener.builder.finish(sources, options.resolver.clone())
    }
}

struct Flattener<'a> {
    builder: DocumentBuilder<'a>,
    diagnostics: &'a Diagnostics,
    paths: NodePaths,
    /// The index of each name that spans refer to.
    name_positions: HashMap<Name, u32>,
    /// There are too many nodes; further ones are ignored.
    is_full: bool,
}

impl Flattener<'_> {
    /// Adds a node with everything in it. Nodes, and so these calls, nest at most [`HEIGHT_LIMIT`]
    /// deep.
    fn add(&mut self, node: Node, step: Step) -> Option<NodeId> {
        let Node { class, plugin, id, entries, lost_a_child, .. } = node;
        let span = Span::of_node(NodeId(self.builder.nodes().len() as u32));
        let plugin_name = self.builder.name(plugin.trim());
        let id = id.filter(|id| !id.is_empty());
        let Some(added) = self.builder.push(FlatNode {
            class,
            plugin: plugin_name,
            id: id.clone(),
            span,
            parameters: List::new(),
            children: List::new(),
        }) else {
            self.is_full = true;
            return None;
        };
        self.paths.push(step);
        if let Some(id) = id {
            self.builder.define(id, Target::Node(added), span);
        }
        if plugin.trim().is_empty() {
            let message = format!("this {} names no plugin", class.name());
            self.diagnostics.error(Fault::MissingParameter, span, message);
        }
        if lost_a_child {
            let message = format!("nodes nest more than {HEIGHT_LIMIT} deep");
            self.diagnostics.error(Fault::Limit, span, message);
            self.builder.mark_incomplete(added);
        }
        self.add_entries(added, entries);
        Some(added)
    }

    fn add_entries(&mut self, parent: NodeId, mut entries: Vec<Entry>) {
        self.drop_replaced(parent, &mut entries);
        let mut counter = ClassCounter::new(&entries);
        for Entry { name, item } in entries {
            if self.is_full {
                self.builder.mark_incomplete(parent);
                return;
            }
            let span = self.entry_span(parent, name.as_ref());
            let name = name.map(|name| self.builder.name(&name));
            match (item, name) {
                (Item::Value(value), Some(name)) => self.add_parameter(parent, name, value, span),
                // A value without a name is not an entry.
                (Item::Value(_), None) => {}
                (Item::Reference(id), name) => {
                    self.builder.refer(parent, (name, span), (&id, span));
                }
                (Item::Node(node), name) => {
                    let position = counter.next(&node, name.as_ref());
                    let class = node.class;
                    let step = Step { parent: Some(parent), class, name: name.clone(), position };
                    if let Some(node) = self.add(node, step) {
                        let span = Span::of_node(node);
                        let child = Child { name, node, span };
                        self.builder.node_mut(parent).children.push(child);
                    }
                }
            }
        }
    }

    fn add_parameter(&mut self, parent: NodeId, name: Name, value: Value, span: Span) {
        if name.is_empty() {
            self.diagnostics.error(Fault::BadValue, span, "a parameter needs a name");
            return;
        }
        if let Some(problem) = value_problem(&name, &value) {
            self.diagnostics.error(Fault::BadValue, span, problem);
            return;
        }
        let parameter = Parameter { name: name.clone(), original_name: name, value, span };
        self.builder.node_mut(parent).parameters.push(parameter);
    }

    /// The last of several entries with the same name wins.
    fn drop_replaced(&mut self, parent: NodeId, entries: &mut Vec<Entry>) {
        let mut last = HashMap::new();
        for (index, entry) in entries.iter().enumerate() {
            if let Some(name) = &entry.name {
                last.insert(name.clone(), index);
            }
        }
        let named = entries.iter().filter(|entry| entry.name.is_some()).count();
        if named == last.len() {
            return;
        }
        let mut index = 0;
        entries.retain(|entry| {
            let is_last = entry.name.as_ref().is_none_or(|name| last.get(name) == Some(&index));
            index += 1;
            if let (Some(name), false) = (&entry.name, is_last) {
                let span = self.entry_span(parent, Some(name));
                let message = format!("`{name}` is given twice; the last one counts");
                self.diagnostics.warning(Fault::BadValue, span, message);
            }
            is_last
        });
    }

    /// The position of an entry: the node and the name, or the node alone.
    fn entry_span(&mut self, parent: NodeId, name: Option<&Name>) -> Span {
        let Some(name) = name else {
            return Span::of_node(parent);
        };
        let position = match self.name_positions.get(name) {
            Some(position) => *position,
            None => {
                let position = self.paths.push_name(name.clone());
                self.name_positions.insert(name.clone(), position);
                position
            }
        };
        Span::of_entry(parent, position)
    }
}

/// Numbers the children without a role within their class.
struct ClassCounter {
    totals: [u32; CLASS_COUNT],
    seen: [u32; CLASS_COUNT],
}

impl ClassCounter {
    fn new(entries: &[Entry]) -> Self {
        let mut totals = [0; CLASS_COUNT];
        for entry in entries {
            if let (None, Item::Node(node)) = (&entry.name, &entry.item) {
                totals[node.class as usize] += 1;
            }
        }
        Self { totals, seen: [0; CLASS_COUNT] }
    }

    /// The index of the next node; `None` if it needs no number.
    fn next(&mut self, node: &Node, name: Option<&Name>) -> Option<u32> {
        let class = node.class as usize;
        if name.is_some() || self.totals[class] == 1 {
            return None;
        }
        self.seen[class] += 1;
        Some(self.seen[class] - 1)
    }
}

#[cfg(test)]
mod tests;
