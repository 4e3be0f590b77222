//! References by id become children, and what cannot be is reported and cut.

use std::collections::{BTreeSet, HashMap};

use etendue_document::{
    Class, Diagnostic, Diagnostics, Fault, Name, Node, NodeId, Severity, Span, list_names,
    near_names,
};

use crate::Limits;
use crate::loader::UNRESOLVED;

/// What an id stands for.
#[derive(Clone, Debug)]
pub(crate) enum Target {
    /// An object.
    Node(NodeId),
    /// Another id.
    Alias(Name),
    /// An object that could not be read, which has been reported.
    Broken,
}

/// An id with its place.
#[derive(Clone, Debug)]
pub(crate) struct Named {
    pub(crate) target: Target,
    pub(crate) span: Span,
}

/// A child that is still to be found.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    pub(crate) parent: NodeId,
    /// The position among the parent's children.
    pub(crate) child: usize,
    pub(crate) id: Name,
    /// Of the id in the file.
    pub(crate) span: Span,
}

/// Near ids are sought for this many unknown ones, unless there are too many ids to compare
/// with: that costs time with the number of both.
const SUGGESTED: usize = 20;
const COMPARED_IDS: usize = 200_000;

/// Resolves every reference; afterwards the children form a graph without cycles, of bounded
/// depth and size. Returns the nodes that lost a child by that.
pub(crate) fn resolve(
    nodes: &mut [Node],
    ids: &HashMap<Name, Named>,
    references: &[Reference],
    diagnostics: &Diagnostics,
    limits: &Limits,
) -> BTreeSet<NodeId> {
    check_aliases(ids, diagnostics);
    let wrappers = find_wrappers(nodes);
    let mut unknown = 0;
    for reference in references {
        if let Some(node) = follow(ids, &reference.id) {
            let node = redirect(node, reference, &wrappers, nodes, diagnostics);
            nodes[reference.parent.index()].children[reference.child].node = node;
        } else if !ids.contains_key(&reference.id) {
            unknown += 1;
            let suggest = unknown <= SUGGESTED && ids.len() <= COMPARED_IDS;
            report_unknown(reference, ids, suggest, diagnostics);
        }
    }
    let mut incomplete = remove_unresolved(nodes);
    cut_cycles(nodes, diagnostics, limits);
    incomplete.append(&mut remove_unresolved(nodes));
    incomplete
}

/// An alias may stand for an alias, but hardly for a long line of them.
const ALIAS_LIMIT: usize = 8;

/// The object that an id stands for at the end of its aliases, if there is one.
fn follow(ids: &HashMap<Name, Named>, id: &str) -> Option<NodeId> {
    let mut target = &ids.get(id)?.target;
    for _ in 0..=ALIAS_LIMIT {
        match target {
            Target::Alias(next) => target = &ids.get(next)?.target,
            Target::Node(node) => return Some(*node),
            Target::Broken => return None,
        }
    }
    None
}

/// Reports aliases that lead to nothing.
fn check_aliases(ids: &HashMap<Name, Named>, diagnostics: &Diagnostics) {
    for named in ids.values() {
        let Target::Alias(id) = &named.target else {
            continue;
        };
        if diagnostics.is_full() {
            return;
        }
        let fault = match ids.get(id).map(|next| &next.target) {
            None => format!("there is no object with the id `{id}` for this alias"),
            Some(Target::Alias(_)) if follow(ids, id).is_none() => {
                format!("the alias for `{id}` leads to no object")
            }
            Some(_) => continue,
        };
        diagnostics.error(Fault::BadValue, named.span, fault);
    }
}

fn report_unknown(
    reference: &Reference,
    ids: &HashMap<Name, Named>,
    suggest: bool,
    diagnostics: &Diagnostics,
) {
    let message = format!("there is no object with the id `{}`", reference.id);
    let mut diagnostic = Diagnostic::error(Fault::BadValue, reference.span, message);
    let known = ids.keys().map(Name::as_str).take(if suggest { ids.len() } else { 0 });
    let near = near_names(&reference.id, known);
    if !near.is_empty() {
        diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
    }
    diagnostics.push(diagnostic);
}

/// Removes the children that were not found; returns the nodes that had one.
fn remove_unresolved(nodes: &mut [Node]) -> BTreeSet<NodeId> {
    let mut incomplete = BTreeSet::new();
    for (index, node) in nodes.iter_mut().enumerate() {
        let count = node.children.len();
        node.children.retain(|child| child.node != UNRESOLVED);
        if node.children.len() < count {
            incomplete.insert(NodeId(index as u32));
        }
    }
    incomplete
}

/// BSDFs with an id inside a top-level BSDF without one, with that wrapper.
///
/// Real scenes wrap a material in a bump map and give the id to the material; nothing could ever
/// refer to the bump map, so a reference to the material means the wrapper.
fn find_wrappers(nodes: &[Node]) -> HashMap<NodeId, NodeId> {
    let mut wrappers = HashMap::new();
    let Some(scene) = nodes.first() else {
        return wrappers;
    };
    for child in scene.children.iter().filter(|child| child.node != UNRESOLVED) {
        let wrapper = &nodes[child.node.index()];
        if wrapper.class == Class::Bsdf
            && wrapper.id.is_none()
            && let Some(inner) = only_named_bsdf(nodes, wrapper)
        {
            wrappers.insert(inner, child.node);
        }
    }
    wrappers
}

/// The first BSDF with an id down the only line of nested BSDFs.
fn only_named_bsdf(nodes: &[Node], wrapper: &Node) -> Option<NodeId> {
    let mut outer = wrapper;
    loop {
        let nested = outer.children.iter().map(|child| child.node);
        let mut bsdfs =
            nested.filter(|node| *node != UNRESOLVED && nodes[node.index()].class == Class::Bsdf);
        let inner = bsdfs.next()?;
        if bsdfs.next().is_some() {
            return None;
        }
        if nodes[inner.index()].id.is_some() {
            return Some(inner);
        }
        outer = &nodes[inner.index()];
    }
}

/// The wrapper of a node, where it has one and the reference does not come from inside it.
fn redirect(
    node: NodeId,
    reference: &Reference,
    wrappers: &HashMap<NodeId, NodeId>,
    nodes: &[Node],
    diagnostics: &Diagnostics,
) -> NodeId {
    let Some(&wrapper) = wrappers.get(&node) else {
        return node;
    };
    // Nodes are numbered in the order of the file: what is inside comes after the wrapper and
    // up to the wrapped node, or is the wrapped node's own content.
    if (wrapper..=node).contains(&reference.parent) {
        return node;
    }
    let Node { plugin, span, .. } = &nodes[wrapper.index()];
    let message = format!(
        "references to `{}` get the `{plugin}` around it, which has no id of its own",
        reference.id
    );
    diagnostics.push(
        Diagnostic::new(Severity::Note, Fault::Approximation, *span, message)
            .help(format!("give the id to the `{plugin}` to say so")),
    );
    wrapper
}

/// How far the walk has come with a node.
#[derive(Clone, Copy, Debug)]
enum Visit {
    New,
    /// On the way from the start to where the walk is.
    Open,
    /// Walked, with the depth of what is below it and the number of objects that it comes to
    /// when every reference is followed.
    Done {
        depth: u32,
        size: u64,
    },
}

/// Cuts references that lead back to an object that holds them, and what is too deep or too
/// large. The walk keeps its own stack: chains may be as long as the scene.
fn cut_cycles(nodes: &mut [Node], diagnostics: &Diagnostics, limits: &Limits) {
    let mut visits = vec![Visit::New; nodes.len()];
    let mut path: Vec<(usize, usize)> = Vec::new();
    for start in 0..nodes.len() {
        if matches!(visits[start], Visit::New) {
            path.push((start, 0));
        }
        while let Some((node, child)) = path.last_mut() {
            visits[*node] = Visit::Open;
            let (index, position) = (*node, *child);
            let Some(next) = nodes[index].children.get(position).map(|child| child.node) else {
                visits[index] = finish(nodes, index, &visits, diagnostics, limits);
                path.pop();
                continue;
            };
            *child += 1;
            if next == UNRESOLVED {
                continue;
            }
            match visits[next.index()] {
                Visit::New => path.push((next.index(), 0)),
                Visit::Done { .. } => {}
                Visit::Open => {
                    report_cycle(nodes, &path, next, diagnostics);
                    nodes[index].children[position].node = UNRESOLVED;
                }
            }
        }
    }
}

/// Sums up a node whose children have all been walked; cuts them off where they are too much.
fn finish(
    nodes: &mut [Node],
    index: usize,
    visits: &[Visit],
    diagnostics: &Diagnostics,
    limits: &Limits,
) -> Visit {
    let (mut depth, mut size) = (0u32, 1u64);
    for child in nodes[index].children.iter().filter(|child| child.node != UNRESOLVED) {
        if let Visit::Done { depth: below, size: more } = visits[child.node.index()] {
            depth = depth.max(below + 1);
            size = size.saturating_add(more);
        }
    }
    let is_scene = index == 0;
    let message = if depth as usize > limits.depth {
        format!("objects hold each other more than {} deep", limits.depth)
    } else if size > limits.expanded_nodes && !is_scene {
        format!(
            "with every reference followed, this is more than {} objects",
            limits.expanded_nodes
        )
    } else {
        return Visit::Done { depth, size };
    };
    diagnostics.error(Fault::Limit, nodes[index].span, message);
    nodes[index].children.iter_mut().for_each(|child| child.node = UNRESOLVED);
    Visit::Done { depth: 0, size: 1 }
}

/// Shows the way from an object back to itself.
fn report_cycle(
    nodes: &[Node],
    path: &[(usize, usize)],
    back_to: NodeId,
    diagnostics: &Diagnostics,
) {
    let start = path.iter().position(|(node, _)| *node == back_to.index()).unwrap_or_default();
    let cycle = &path[start..];
    let name = |index: usize| {
        let node = &nodes[index];
        let id = node.id.as_ref().map(Name::to_string);
        id.unwrap_or_else(|| format!("<{}>", node.class.name()))
    };
    let mut names: Vec<String> = cycle.iter().take(8).map(|(node, _)| name(*node)).collect();
    if cycle.len() > names.len() {
        names.push("…".to_owned());
    }
    names.push(name(back_to.index()));
    let message = format!("objects hold each other in a circle: {}", names.join(" → "));
    // The position on the path has already moved on to the next child.
    let place = |(node, next): &(usize, usize)| nodes[*node].children[next - 1].span;
    let Some(last) = path.last() else {
        return;
    };
    let mut diagnostic = Diagnostic::error(Fault::BadValue, place(last), message);
    for step in cycle[..cycle.len() - 1].iter().take(8) {
        let message = format!("`{}` holds it here", name(step.0));
        diagnostic = diagnostic.related(place(step), message);
    }
    diagnostics.push(diagnostic);
}
