//! Maps offsets in a parsed piece to positions in the file.

use std::ops::Range;

use etendue_document::{SourceId, Span};

/// Where the parsed text comes from in its file.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Origin {
    pub(crate) source: SourceId,
    /// The bytes of the opening tag at the front.
    pub(crate) wrapper: usize,
    /// The offset of that tag in the file.
    pub(crate) root: usize,
    /// The offset of the rest in the file.
    pub(crate) start: usize,
}

impl Origin {
    /// The position in the file of something the parser found.
    pub(crate) fn span(&self, range: Range<usize>) -> Span {
        let place = |offset: usize| match offset.checked_sub(self.wrapper) {
            Some(offset) => self.start + offset,
            None => self.root + offset,
        };
        Span::new(self.source, place(range.start)..place(range.end))
    }
}
