//! From offsets in a parsed piece to places in the file.

use std::ops::Range;

use etendue_document::{SourceId, Span};

/// Where the text that the parser was given stands in its file.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Origin {
    pub(crate) source: SourceId,
    /// Bytes of the opening tag in front.
    pub(crate) wrapper: usize,
    /// Where that tag stands in the file.
    pub(crate) root: usize,
    /// Where the rest starts in the file.
    pub(crate) start: usize,
}

impl Origin {
    /// The place in the file of what the parser has found.
    pub(crate) fn span(&self, range: Range<usize>) -> Span {
        let place = |offset: usize| match offset.checked_sub(self.wrapper) {
            Some(offset) => self.start + offset,
            None => self.root + offset,
        };
        Span::new(self.source, place(range.start)..place(range.end))
    }
}
