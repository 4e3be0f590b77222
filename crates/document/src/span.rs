//! Positions that diagnostics point at: in a text, or at a node of a document built in code.

use std::ops::Range;

/// Identifies one text of a [`Sources`](crate::Sources) collection. The default is the first one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId(pub(crate) u32);

impl SourceId {
    /// The index of this source, in the order in which the texts were added.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Identifies one node of a [`Document`](crate::Document).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

impl NodeId {
    /// The index in [`Document::nodes`](crate::Document::nodes).
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A position: a byte range of a text, or a node built in code, which has no text.
///
/// Twelve bytes, because in a document of a million instances each node holds three spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// The text, or [`IN_CODE`].
    source: u32,
    /// The first byte, or the node.
    start: u32,
    /// One past the last byte, or the entry of the node: 0 for the node itself.
    end: u32,
}

/// The source of nodes that come from no text.
const IN_CODE: u32 = u32::MAX;

impl Span {
    /// The span of a byte range; offsets beyond four gigabytes are clamped.
    pub fn new(source: SourceId, range: Range<usize>) -> Self {
        let clamp = |offset: usize| u32::try_from(offset).unwrap_or(u32::MAX);
        Self { source: source.0, start: clamp(range.start), end: clamp(range.end) }
    }

    /// The position of a node built in code.
    pub(crate) fn of_node(node: NodeId) -> Self {
        Self { source: IN_CODE, start: node.0, end: 0 }
    }

    /// The position of an entry of such a node; `name` is its index among the names of the
    /// document.
    pub(crate) fn of_entry(node: NodeId, name: u32) -> Self {
        Self { source: IN_CODE, start: node.0, end: name.saturating_add(1) }
    }

    /// The text; `None` for a node built in code.
    pub fn source(self) -> Option<SourceId> {
        (self.source != IN_CODE).then_some(SourceId(self.source))
    }

    /// The bytes of the text; empty for a node built in code.
    pub fn range(self) -> Range<usize> {
        match self.source() {
            Some(_) => self.start as usize..self.end as usize,
            None => 0..0,
        }
    }

    /// The node built in code; `None` for a position in a text.
    pub fn node(self) -> Option<NodeId> {
        (self.source == IN_CODE).then_some(NodeId(self.start))
    }

    /// The name index of the entry of [`Self::node`]; `None` if the position is a whole node.
    pub(crate) fn entry(self) -> Option<u32> {
        self.node()?;
        self.end.checked_sub(1)
    }
}

/// A position in readable form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Location {
    /// In a text.
    Text {
        /// The name of the text, usually a file name.
        name: String,
        /// Counted from 1.
        line: usize,
        /// In characters, counted from 1.
        column: usize,
    },
    /// At a node built in code.
    Node {
        /// The path from the root to the node and its entry: `scene.shapes[3].bsdf.alpha`.
        path: String,
    },
}

impl Location {
    /// The line in a text, counted from 1; `None` for a node.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Text { line, .. } => Some(*line),
            Self::Node { .. } => None,
        }
    }
}

/// `file:line:column`, or the path of a node.
impl std::fmt::Display for Location {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text { name, line, column } => write!(formatter, "{name}:{line}:{column}"),
            Self::Node { path } => formatter.write_str(path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_is_in_a_text_or_at_a_node() {
        let text = Span::new(SourceId(2), 3..7);
        assert_eq!((text.source(), text.range(), text.node()), (Some(SourceId(2)), 3..7, None));
        let node = Span::of_node(NodeId(5));
        assert_eq!((node.source(), node.range(), node.node()), (None, 0..0, Some(NodeId(5))));
        assert_eq!((node.entry(), Span::of_entry(NodeId(5), 0).entry()), (None, Some(0)));
        assert_eq!(text.entry(), None);
        assert_eq!(size_of::<Span>(), 12);
    }
}
