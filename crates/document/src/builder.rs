//! Collects nodes and ids of a document under construction, and makes the checks that every
//! document passes.

use std::collections::{BTreeSet, HashMap};

use crate::class::Class;
use crate::diagnostic::{Diagnostic, Diagnostics, Fault};
use crate::document::{Child, Document, FlatNode};
use crate::graph;
use crate::limits::DocumentLimits;
use crate::name::{Name, NameInterner};
use crate::names::{list_names, near_names};
use crate::resolver::Resolver;
use crate::source::Sources;
use crate::span::{NodeId, Span};

/// What an id refers to.
#[derive(Clone, Debug)]
pub enum Target {
    /// An object.
    Node(NodeId),
    /// Another id.
    Alias(Name),
    /// An object that could not be read, which has been reported.
    Broken,
}

/// A child given by its id, unresolved until [`DocumentBuilder::finish`].
#[derive(Clone, Debug)]
pub struct Reference {
    /// The node that has the child.
    pub parent: NodeId,
    /// The id.
    pub id: Name,
    /// The span of the id.
    pub span: Span,
    /// The position among the parent's children.
    child: usize,
}

/// An id with its span.
#[derive(Clone, Debug)]
struct Named {
    target: Target,
    span: Span,
}

/// Similar ids are suggested for at most this many unknown ones, and only if there are few enough
/// ids to compare: the time grows with the product of both numbers.
const SUGGESTED: usize = 20;
const COMPARED_IDS: usize = 200_000;

/// An alias may refer to an alias, but long chains are not plausible.
const ALIAS_LIMIT: usize = 8;

/// Collects the nodes of a document. Readers of all formats use it, so that ids, references and
/// limits work the same everywhere. It reports errors and never panics.
#[derive(Debug)]
pub struct DocumentBuilder<'a> {
    limits: DocumentLimits,
    diagnostics: &'a Diagnostics,
    nodes: Vec<FlatNode>,
    names: NameInterner,
    ids: HashMap<Name, Named>,
    references: Vec<Reference>,
    incomplete: BTreeSet<NodeId>,
}

impl<'a> DocumentBuilder<'a> {
    /// An empty builder. Findings go to `diagnostics`.
    pub fn new(limits: DocumentLimits, diagnostics: &'a Diagnostics) -> Self {
        Self {
            limits,
            diagnostics,
            nodes: Vec::new(),
            names: NameInterner::default(),
            ids: HashMap::new(),
            references: Vec::new(),
            incomplete: BTreeSet::new(),
        }
    }

    /// Interns a name.
    pub fn name(&mut self, word: &str) -> Name {
        self.names.name(word)
    }

    /// Reserves room for nodes. Unused room costs nothing, but a growing vector fragments memory.
    pub fn reserve(&mut self, count: usize) {
        let room = self.limits.nodes.saturating_sub(self.nodes.len());
        self.nodes.reserve(count.min(room));
    }

    /// Adds a node without a parent; `None` after reporting that there are too many. The first node
    /// is the root.
    pub fn push(&mut self, node: FlatNode) -> Option<NodeId> {
        if self.nodes.len() >= self.limits.nodes.max(1) {
            let message = format!("more than {} objects", self.limits.nodes);
            self.diagnostics.error(Fault::Limit, node.span, message);
            return None;
        }
        self.nodes.push(node);
        Some(NodeId(self.nodes.len() as u32 - 1))
    }

    /// The nodes so far.
    pub fn nodes(&self) -> &[FlatNode] {
        &self.nodes
    }

    /// A node added earlier.
    ///
    /// # Panics
    ///
    /// If there is no such node.
    pub fn node_mut(&mut self, id: NodeId) -> &mut FlatNode {
        &mut self.nodes[id.index()]
    }

    /// Assigns an id; reports duplicates.
    pub fn define(&mut self, id: Name, target: Target, span: Span) {
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

    /// Adds a child that is defined elsewhere, before or after: the child's role and span, and the
    /// id and its span.
    pub fn refer(&mut self, parent: NodeId, role: (Option<Name>, Span), id: (&str, Span)) {
        let ((name, span), (id, id_span)) = (role, id);
        let known = self.known_shape(id);
        let children = &mut self.nodes[parent.index()].children;
        let child = children.len();
        children.push(Child { name, node: known.unwrap_or(graph::UNRESOLVED), span });
        if known.is_none() {
            let id = self.names.name(id);
            self.references.push(Reference { parent, id, span: id_span, child });
        }
    }

    /// The shape of an id that is already defined, for which no reference needs to be kept. (Only
    /// shapes: readers may redirect references to a material once everything is known.)
    fn known_shape(&self, id: &str) -> Option<NodeId> {
        match self.ids.get(id)?.target {
            Target::Node(node) if self.nodes[node.index()].class == Class::Shape => Some(node),
            _ => None,
        }
    }

    /// Records that a child of a node could not be read, which has been reported.
    pub fn mark_incomplete(&mut self, node: NodeId) {
        self.incomplete.insert(node);
    }

    /// Resolves all references. In the finished document, children form an acyclic graph of bounded
    /// depth and size.
    ///
    /// # Panics
    ///
    /// If no node was added.
    pub fn finish(self, sources: Sources, resolver: Resolver) -> Document {
        self.finish_with(sources, resolver, |node, _| node)
    }

    /// Like [`Self::finish`], but `redirect` may choose another node for a reference than the one
    /// its id names.
    ///
    /// # Panics
    ///
    /// If no node was added.
    pub fn finish_with(
        mut self,
        sources: Sources,
        resolver: Resolver,
        redirect: impl Fn(NodeId, &Reference) -> NodeId,
    ) -> Document {
        assert!(!self.nodes.is_empty(), "a document has a root");
        self.check_aliases();
        let mut unknown = 0;
        for reference in &self.references {
            if let Some(node) = self.follow(&reference.id) {
                let child = &mut self.nodes[reference.parent.index()].children[reference.child];
                child.node = redirect(node, reference);
            } else if !self.ids.contains_key(&reference.id) {
                unknown += 1;
                self.report_unknown(reference, unknown <= SUGGESTED);
            }
        }
        let Self { mut nodes, mut incomplete, limits, diagnostics, .. } = self;
        incomplete.append(&mut graph::make_acyclic(&mut nodes, diagnostics, &limits));
        Document { nodes, root: NodeId(0), incomplete, sources, resolver }
    }

    /// The object that an id refers to after following all aliases, if there is one.
    fn follow(&self, id: &str) -> Option<NodeId> {
        let mut target = &self.ids.get(id)?.target;
        for _ in 0..=ALIAS_LIMIT {
            match target {
                Target::Alias(next) => target = &self.ids.get(next)?.target,
                Target::Node(node) => return Some(*node),
                Target::Broken => return None,
            }
        }
        None
    }

    /// Reports aliases that refer to nothing.
    fn check_aliases(&self) {
        for named in self.ids.values() {
            let Target::Alias(id) = &named.target else {
                continue;
            };
            if self.diagnostics.is_full() {
                return;
            }
            let fault = match self.ids.get(id).map(|next| &next.target) {
                None => format!("there is no object with the id `{id}` for this alias"),
                Some(Target::Alias(_)) if self.follow(id).is_none() => {
                    format!("the alias for `{id}` leads to no object")
                }
                Some(_) => continue,
            };
            self.diagnostics.error(Fault::BadValue, named.span, fault);
        }
    }

    fn report_unknown(&self, reference: &Reference, suggest: bool) {
        let message = format!("there is no object with the id `{}`", reference.id);
        let mut diagnostic = Diagnostic::error(Fault::BadValue, reference.span, message);
        let compared = if suggest && self.ids.len() <= COMPARED_IDS { self.ids.len() } else { 0 };
        let known = self.ids.keys().map(Name::as_str).take(compared);
        let near = near_names(&reference.id, known);
        if !near.is_empty() {
            diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
        }
        self.diagnostics.push(diagnostic);
    }
}
