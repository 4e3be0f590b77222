//! The graph of children: removes cycles and whatever exceeds the limits.

use std::collections::BTreeSet;

use crate::diagnostic::{Diagnostic, Diagnostics, Fault};
use crate::document::FlatNode;
use crate::limits::DocumentLimits;
use crate::name::Name;
use crate::span::NodeId;

/// A child's node id before its reference is resolved, or if that fails.
pub(crate) const UNRESOLVED: NodeId = NodeId(u32::MAX);

/// Removes children that were not found, that form cycles or that exceed the limits; returns the
/// nodes that lost a child.
pub(crate) fn make_acyclic(
    nodes: &mut [FlatNode],
    diagnostics: &Diagnostics,
    limits: &DocumentLimits,
) -> BTreeSet<NodeId> {
    let mut incomplete = remove_unresolved(nodes);
    cut_cycles(nodes, diagnostics, limits);
    incomplete.append(&mut remove_unresolved(nodes));
    incomplete
}

/// Removes the children that were not found; returns the nodes that had any.
fn remove_unresolved(nodes: &mut [FlatNode]) -> BTreeSet<NodeId> {
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

/// The state of a node during the walk.
#[derive(Clone, Copy, Debug)]
enum Visit {
    New,
    /// On the current path from the start.
    Open,
    /// Finished, with the depth below it and the number of objects it expands to if every reference
    /// is followed.
    Done {
        depth: u32,
        size: u64,
    },
}

/// Cuts references that lead back to an object that holds them, and those that exceed the limits.
/// The walk uses an explicit stack, because chains may be as long as the scene.
fn cut_cycles(nodes: &mut [FlatNode], diagnostics: &Diagnostics, limits: &DocumentLimits) {
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

/// Sums up a node whose children are finished; cuts them off if they exceed the limits.
fn finish(
    nodes: &mut [FlatNode],
    index: usize,
    visits: &[Visit],
    diagnostics: &Diagnostics,
    limits: &DocumentLimits,
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

/// Describes the cycle from an object back to itself.
fn report_cycle(
    nodes: &[FlatNode],
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
    // The index on the path has already moved on to the next child.
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
