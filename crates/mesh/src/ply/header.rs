//! The header of a PLY file: its elements, and the properties of each.

use super::scalar::{ByteOrder, ScalarType};
use crate::error::{MeshError, MeshErrorKind};
use crate::text::TextCursor;

/// The maximum number of elements, and of properties of one element. More are considered an attack,
/// because they cost memory and time per row.
const MAX_ENTRIES: usize = 1024;

/// The encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

/// One column of an element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the number, or of each entry of a list.
    pub(super) value: ScalarType,
    /// The type of the number of entries, for a list.
    pub(super) list_count: Option<ScalarType>,
}

/// A table with a value or list per row and property.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) row_count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    pub(super) fn is_vertices(&self) -> bool {
        self.name == "vertex"
    }

    pub(super) fn is_faces(&self) -> bool {
        self.name == "face"
    }

    /// The index of the number with this name among the properties.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.properties
            .iter()
            .position(|property| property.name == name && property.list_count.is_none())
    }

    /// Whether all rows have the same size in a binary file.
    pub(super) fn is_fixed(&self) -> bool {
        self.properties.iter().all(|property| property.list_count.is_none())
    }

    /// The minimum size of a row in a binary file, where all lists are empty. The exact size if
    /// [`Element::is_fixed`].
    pub(super) fn min_row_size(&self) -> usize {
        let size = |property: &Property| property.list_count.unwrap_or(property.value).size();
        self.properties.iter().map(size).sum()
    }
}

/// The contents of the header.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

impl Header {
    /// Reads the header and leaves the cursor at the first byte of the data.
    pub(super) fn read(cursor: &mut TextCursor<'_>) -> Result<Self, MeshError> {
        if cursor.rest_of_line().trim_ascii() != b"ply" {
            return Err(cursor.error(MeshErrorKind::Syntax, "a PLY file starts with `ply`"));
        }
        let mut encoding = None;
        let mut elements = Vec::new();
        loop {
            cursor.take_line_end();
            if cursor.is_at_end() {
                return Err(cursor.error(MeshErrorKind::Truncated, "the header has no end"));
            }
            let line = String::from_utf8_lossy(cursor.rest_of_line());
            let words: Vec<&str> = line.split_ascii_whitespace().take(6).collect();
            match words[..] {
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, _] => encoding = Some(read_encoding(cursor, name)?),
                ["element", name, count] => {
                    elements.push(read_element(cursor, name, count)?);
                    check_entries(cursor, elements.len(), "elements")?;
                }
                ["property", ref description @ ..] => {
                    let Some(element) = elements.last_mut() else {
                        return Err(
                            cursor.error(MeshErrorKind::Syntax, "a property before any element")
                        );
                    };
                    element.properties.push(read_property(cursor, description)?);
                    check_entries(cursor, element.properties.len(), "properties")?;
                }
                ["end_header"] => break,
                _ => return Err(malformed(cursor)),
            }
        }
        let Some(encoding) = encoding else {
            return Err(cursor.error(MeshErrorKind::Syntax, "the header has no line `format`"));
        };
        cursor.take_line_end();
        Ok(Self { encoding, elements })
    }

    /// The announced number of vertices.
    pub(super) fn vertex_count(&self) -> u64 {
        self.elements.iter().find(|element| element.is_vertices()).map_or(0, |e| e.row_count)
    }
}

fn read_encoding(cursor: &TextCursor<'_>, name: &str) -> Result<Encoding, MeshError> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::Binary(ByteOrder::Little)),
        "binary_big_endian" => Ok(Encoding::Binary(ByteOrder::Big)),
        _ => Err(cursor.error(
            MeshErrorKind::Unsupported,
            "expected the format `ascii`, `binary_little_endian` or `binary_big_endian`",
        )),
    }
}

fn read_element(cursor: &TextCursor<'_>, name: &str, count: &str) -> Result<Element, MeshError> {
    match count.parse() {
        Ok(row_count) => Ok(Element { name: name.to_owned(), row_count, properties: Vec::new() }),
        Err(_) => {
            let message = "expected the number of elements after their name";
            Err(cursor.error(MeshErrorKind::Syntax, message))
        }
    }
}

/// Reads the words after `property`.
fn read_property(cursor: &TextCursor<'_>, words: &[&str]) -> Result<Property, MeshError> {
    let scalar = |name: &str| {
        ScalarType::from_name(name).ok_or_else(|| {
            let message = "expected a type such as `float`, `uchar` or `int`";
            cursor.error(MeshErrorKind::Syntax, message)
        })
    };
    let integer = |name: &str| match scalar(name)? {
        kind if kind.is_integer() => Ok(kind),
        _ => {
            Err(cursor.error(MeshErrorKind::Syntax, "the length of a list must be a whole number"))
        }
    };
    match *words {
        ["list", count, value, name] => Ok(Property {
            name: name.to_owned(),
            value: scalar(value)?,
            list_count: Some(integer(count)?),
        }),
        [value, name] => {
            Ok(Property { name: name.to_owned(), value: scalar(value)?, list_count: None })
        }
        _ => Err(malformed(cursor)),
    }
}

fn check_entries(cursor: &TextCursor<'_>, count: usize, what: &str) -> Result<(), MeshError> {
    if count <= MAX_ENTRIES {
        return Ok(());
    }
    Err(cursor.error(MeshErrorKind::Limit, format!("there are more than {MAX_ENTRIES} {what}")))
}

/// The error for a line that is none of a header. It does not quote the line, which may be that of
/// another kind of file.
fn malformed(cursor: &TextCursor<'_>) -> MeshError {
    let message = "expected `format`, `element`, `property`, `comment` or `end_header`";
    cursor.error(MeshErrorKind::Syntax, message)
}
