//! The texts a document was read from, and positions in them.

use std::borrow::Cow;
use std::sync::Arc;

use crate::node_path::NodePaths;
use crate::packed::Packed;
use crate::span::{Location, SourceId, Span};

/// One text with its name.
#[derive(Clone, Debug)]
pub struct Source {
    name: String,
    text: Text,
    line_starts: Vec<u32>,
    /// Whether messages must not quote the text.
    is_withheld: bool,
}

#[derive(Clone, Debug)]
enum Text {
    Whole(Arc<str>),
    Packed(Packed),
}

impl Source {
    /// The name given when the text was added.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text; see [`Sources::pack`].
    pub fn text(&self) -> Arc<str> {
        match &self.text {
            Text::Whole(text) => text.clone(),
            Text::Packed(packed) => packed.unpack().into(),
        }
    }

    /// The bytes of the text in order; a packed text is not unpacked as a whole.
    pub fn pieces(&self) -> impl Iterator<Item = Cow<'_, [u8]>> {
        let (whole, packed) = match &self.text {
            Text::Whole(text) => (Some(Cow::Borrowed(text.as_bytes())), None),
            Text::Packed(packed) => (None, Some(packed.pieces().map(Cow::Owned))),
        };
        whole.into_iter().chain(packed.into_iter().flatten())
    }

    /// Whether messages must not quote the text.
    pub(crate) fn is_withheld(&self) -> bool {
        self.is_withheld
    }

    /// The length of the text in bytes.
    fn length(&self) -> usize {
        match &self.text {
            Text::Whole(text) => text.len(),
            Text::Packed(packed) => packed.length(),
        }
    }

    /// The index of the line (from 0) that contains a byte offset.
    pub(crate) fn line_index(&self, offset: usize) -> usize {
        self.line_starts.partition_point(|&start| start as usize <= offset).saturating_sub(1)
    }

    /// The bytes of a line of `text`, which is this source's text, without its line break.
    pub(crate) fn line_range(&self, line_index: usize, text: &str) -> std::ops::Range<usize> {
        let start = self.line_starts.get(line_index).map_or(text.len(), |&s| s as usize);
        let end = self.line_starts.get(line_index + 1).map_or(text.len(), |&s| s as usize);
        let line = &text[start..end];
        start..start + line.trim_end_matches(['\n', '\r']).len()
    }
}

/// The last character boundary at or before a byte offset, clamped to the text.
pub(crate) fn floor_boundary(text: &str, offset: usize) -> usize {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}

/// Smaller texts are not worth packing. Only scenes with hundreds of thousands of objects are
/// larger.
const LARGE: usize = 16 << 20;

/// Where the nodes of a document come from: the texts that were read for it, and the paths of nodes
/// built in code.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    sources: Vec<Source>,
    node_paths: NodePaths,
}

impl Sources {
    /// No texts: the paths of nodes built in code.
    pub(crate) fn of_nodes(node_paths: NodePaths) -> Self {
        Self { sources: Vec::new(), node_paths }
    }

    /// Adds a text with a name. Offsets are 32 bits, so positions beyond four gigabytes cannot be
    /// expressed.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> SourceId {
        let text = text.into();
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let starts = breaks.filter_map(|(offset, _)| u32::try_from(offset + 1).ok());
        let line_starts = std::iter::once(0).chain(starts).collect();
        self.sources.push(Source {
            name: name.into(),
            text: Text::Whole(text),
            line_starts,
            is_withheld: false,
        });
        SourceId(u32::try_from(self.sources.len() - 1).unwrap_or(u32::MAX))
    }

    /// Lets messages name places in a text, but quote nothing of it: the text is no part of the
    /// scene, and may be private.
    pub fn withhold(&mut self, id: SourceId) {
        if let Some(source) = self.sources.get_mut(id.index()) {
            source.is_withheld = true;
        }
    }

    /// The text with this id; `None` for the id of another collection.
    pub fn get(&self, id: SourceId) -> Option<&Source> {
        self.sources.get(id.index())
    }

    /// The texts in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = &Source> {
        self.sources.iter()
    }

    /// File, line and column of the start of a span, or the path of a node.
    pub fn locate(&self, span: Span) -> Location {
        if let Some(path) = self.node_paths.path(span) {
            return Location::Node { path };
        }
        let Some(source) = span.source().and_then(|id| self.get(id)) else {
            return Location::Text { name: "<unknown>".to_owned(), line: 1, column: 1 };
        };
        let text = source.text();
        let offset = floor_boundary(&text, span.range().start);
        let line_index = source.line_index(offset);
        let line_start = source.line_range(line_index, &text).start;
        let column = text[line_start..offset].chars().count() + 1;
        Location::Text { name: source.name.clone(), line: line_index + 1, column }
    }

    /// The text of a span; empty if the span is out of bounds or the text is withheld.
    pub fn excerpt(&self, span: Span) -> String {
        let source = span.source().and_then(|id| self.get(id));
        let text = source.filter(|source| !source.is_withheld).map(Source::text);
        text.as_deref().and_then(|text| text.get(span.range())).unwrap_or_default().to_owned()
    }

    /// Compresses large texts, which are needed again only for excerpts. Callers see no difference,
    /// except that [`Source::text`] then takes a second for each 300 MB.
    pub fn pack(&mut self) {
        for source in self.sources.iter_mut().filter(|source| source.length() >= LARGE) {
            if let Text::Whole(text) = &source.text
                && let Some(packed) = Packed::new(text)
            {
                source.text = Text::Packed(packed);
            }
        }
    }

    /// Undoes [`Self::pack`] for one text, before many positions in it are looked up.
    pub fn unpack(&mut self, id: SourceId) {
        if let Some(source) = self.sources.get_mut(id.index())
            && let Text::Packed(packed) = &source.text
        {
            source.text = Text::Whole(packed.unpack().into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line_and_column(location: &Location) -> (usize, usize) {
        match location {
            Location::Text { line, column, .. } => (*line, *column),
            Location::Node { path } => panic!("no text: {path}"),
        }
    }

    #[test]
    fn places_are_counted_from_one_in_characters() {
        let mut sources = Sources::default();
        let id = sources.add("scene.xml", "one\nzwölf x\r\n\nend");
        let place =
            |start: usize| line_and_column(&sources.locate(Span::new(id, start..start + 1)));
        assert_eq!(place(0), (1, 1));
        assert_eq!(place(4), (2, 1));
        assert_eq!(place(11), (2, 7), "two bytes of ö count once");
        assert_eq!(place(14), (3, 1));
        assert_eq!(place(17), (4, 3));
        assert_eq!(place(999), (4, 4), "past the end is the end");
        let source = sources.get(id).unwrap();
        assert_eq!(source.line_range(1, &source.text()), 4..12, "without the line break");
    }

    #[test]
    fn a_span_in_the_middle_of_a_character_does_not_panic() {
        let mut sources = Sources::default();
        let id = sources.add("scene.xml", "ö");
        assert_eq!(line_and_column(&sources.locate(Span::new(id, 1..2))), (1, 1));
        assert_eq!(sources.excerpt(Span::new(id, 1..2)), "");
        assert_eq!(sources.excerpt(Span::new(id, 0..2)), "ö");
    }

    #[test]
    fn a_packed_text_tells_the_same() {
        let mut sources = Sources::default();
        let line = "<shape type=\"größe\"/>\n";
        let id = sources.add("large.xml", line.repeat(LARGE / line.len() + 1));
        let small = sources.add("small.xml", "<scene/>");
        let span = Span::new(id, line.len() * 1000 + 13..line.len() * 1000 + 20);
        let told = |sources: &Sources| {
            let bytes: Vec<u8> =
                sources.iter().flat_map(|s| s.pieces().collect::<Vec<_>>().concat()).collect();
            (sources.locate(span), sources.excerpt(span), bytes)
        };
        let before = told(&sources);
        assert_eq!(line_and_column(&before.0), (1001, 14));
        assert_eq!(before.1, "größe");
        sources.pack();
        assert!(matches!(sources.get(id).unwrap().text, Text::Packed(_)));
        assert!(matches!(sources.get(small).unwrap().text, Text::Whole(_)));
        assert!(told(&sources) == before);
        sources.unpack(id);
        assert!(matches!(sources.get(id).unwrap().text, Text::Whole(_)));
        assert!(told(&sources) == before);
    }
}
