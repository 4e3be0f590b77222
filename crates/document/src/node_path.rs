//! Paths of nodes built in code: diagnostics show them instead of lines and columns.

use crate::class::Class;
use crate::name::Name;
use crate::span::{NodeId, Span};

/// How each node of a document built in code is reached from the root, stored as one step per node.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodePaths {
    steps: Vec<Step>,
    /// The names of parameters and roles; spans refer to them by index.
    names: Vec<Name>,
}

/// The last step of the path to a node.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// `None` for the root.
    pub(crate) parent: Option<NodeId>,
    /// The class of the node.
    pub(crate) class: Class,
    /// Its role in the parent.
    pub(crate) name: Option<Name>,
    /// Its index among the parent's children of the same class; `None` if it is the only one.
    pub(crate) position: Option<u32>,
}

/// Bounds the length of a path: it cannot exceed the nesting depth unless a reader is broken.
const STEP_LIMIT: usize = 1000;

impl NodePaths {
    /// Adds the step to the next node.
    pub(crate) fn push(&mut self, step: Step) {
        self.steps.push(step);
    }

    /// Adds a name that spans refer to; returns its index.
    pub(crate) fn push_name(&mut self, name: Name) -> u32 {
        self.names.push(name);
        (self.names.len() - 1) as u32
    }

    /// The path of a span: `scene.shapes[3].bsdf.alpha`; `None` for a span in a text.
    pub(crate) fn path(&self, span: Span) -> Option<String> {
        let node = span.node()?;
        let mut words = Vec::new();
        if let Some(name) = span.entry().and_then(|entry| self.names.get(entry as usize)) {
            words.push(name.to_string());
        }
        let mut next = Some(node);
        while let Some(step) = next.and_then(|node| self.steps.get(node.index())) {
            words.push(step.word());
            next = step.parent.filter(|_| words.len() < STEP_LIMIT);
        }
        words.reverse();
        Some(words.join("."))
    }
}

impl Step {
    fn word(&self) -> String {
        match (&self.name, self.position) {
            (Some(name), _) => name.to_string(),
            (None, Some(position)) => format!("{}[{position}]", self.class.plural()),
            (None, None) => self.class.name().to_owned(),
        }
    }
}
