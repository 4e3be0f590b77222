//! Checks that a document edited in code is still valid.

use crate::check::value_problem;
use crate::diagnostic::{Diagnostics, Fault};
use crate::document::Document;

/// The state of a node during the walk.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Visit {
    New,
    /// On the current path from the start.
    Open,
    Done,
}

impl Document {
    /// Checks that every walk along the children stays within the document and terminates, and that
    /// all values are usable. If not, the error says why. Documents from [`Document::build`] and
    /// readers of files always pass; an edit of [`Document::nodes`] may break anything.
    pub fn check(&self, diagnostics: &Diagnostics) -> bool {
        for parameter in self.nodes.iter().flat_map(|node| &node.parameters) {
            if let Some(problem) = value_problem(&parameter.name, &parameter.value) {
                diagnostics.error(Fault::BadValue, parameter.span, problem);
            }
        }
        self.check_children(diagnostics)
    }

    fn check_children(&self, diagnostics: &Diagnostics) -> bool {
        if self.root.index() >= self.nodes.len() {
            diagnostics.error(Fault::BadValue, None, "the document has no root");
            return false;
        }
        let mut visits = vec![Visit::New; self.nodes.len()];
        // The walk uses an explicit stack, because chains may be as long as the document.
        let mut path: Vec<(usize, usize)> = Vec::new();
        for start in 0..self.nodes.len() {
            if visits[start] == Visit::New {
                path.push((start, 0));
            }
            while let Some((index, next)) = path.last_mut() {
                visits[*index] = Visit::Open;
                let Some(child) = self.nodes[*index].children.get(*next) else {
                    visits[*index] = Visit::Done;
                    path.pop();
                    continue;
                };
                *next += 1;
                let span = self.nodes[*index].span;
                let problem = match visits.get(child.node.index()) {
                    None => "a child of this node is not in the document",
                    Some(Visit::Open) => "this node holds itself",
                    Some(Visit::Done) => continue,
                    Some(Visit::New) => {
                        path.push((child.node.index(), 0));
                        continue;
                    }
                };
                diagnostics.error(Fault::BadValue, span, problem);
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flatten::DocumentOptions;
    use crate::node::Node;
    use crate::span::NodeId;

    fn document() -> Document {
        let glass = Node::bsdf("dielectric").id("glass");
        let shape = || Node::shape("sphere").child(crate::node::reference("glass"));
        let scene = Node::scene().children([glass, shape(), shape()]);
        let diagnostics = Diagnostics::new();
        let document = Document::build(scene, &DocumentOptions::default(), &diagnostics);
        assert!(!diagnostics.has_errors());
        document
    }

    fn problem(change: impl FnOnce(&mut Document)) -> Option<String> {
        let (mut document, diagnostics) = (document(), Diagnostics::new());
        change(&mut document);
        document.check(&diagnostics);
        diagnostics.sorted().pop().map(|found| found.message)
    }

    #[test]
    fn shared_children_are_fine() {
        assert_eq!(problem(|_| ()), None);
    }

    #[test]
    fn values_are_checked_too() {
        let nowhere = |document: &mut Document| {
            let shape = document.nodes.iter().position(|node| node.plugin == "sphere").unwrap();
            document.set(NodeId(shape as u32), "radius", f64::NAN);
        };
        assert!(problem(nowhere).unwrap().contains("radius"));
    }

    #[test]
    fn cycles_and_lost_children_are_found() {
        let root_in_shape = |document: &mut Document| {
            let root = document.root;
            let shape = document.nodes.iter_mut().find(|node| node.plugin == "sphere").unwrap();
            shape.children[0].node = root;
        };
        assert_eq!(problem(root_in_shape).as_deref(), Some("this node holds itself"));
        let lost = |document: &mut Document| {
            let root = document.root.index();
            document.nodes[root].children[0].node = NodeId(1000);
        };
        let message = "a child of this node is not in the document";
        assert_eq!(problem(lost).as_deref(), Some(message));
        let message = problem(|document| document.nodes.clear());
        assert_eq!(message.as_deref(), Some("the document has no root"));
    }
}
