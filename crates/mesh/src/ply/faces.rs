//! The element `face` of a PLY file.

use super::attributes::Column;
use super::header::{Element, Property};
use super::scalar::ScalarType;
use super::source::Source;
use crate::error::{MeshError, MeshErrorKind};
use crate::polygon::triangulate;
use crate::triangle_mesh::{AttributeDomain, TriangleMesh};

/// The maximum number of attribute values per byte of the file. A face with many corners passes its
/// values on to as many triangles; a malicious file turns this into thousands per byte.
const MAX_VALUES_PER_BYTE: usize = 16;

/// Reads all rows of `element` into `mesh`. The positions are known unless the faces come first.
pub(super) fn read_faces(
    element: &Element,
    source: &mut impl Source,
    vertex_count: u64,
    mesh: &mut TriangleMesh,
) -> Result<(), MeshError> {
    let corners = find_corners(element, source)?;
    let mut columns = Column::all(element, AttributeDomain::Face, &[]);
    let max_triangles =
        source.bytes_left().saturating_mul(MAX_VALUES_PER_BYTE) / element.properties.len();
    reserve(element, source, &mut columns, mesh);
    let mut row = vec![0.0; element.properties.len()];
    let mut polygon: Vec<u32> = Vec::new();
    for _ in 0..element.row_count {
        polygon.clear();
        for (index, (value, property)) in row.iter_mut().zip(&element.properties).enumerate() {
            match property.list_count {
                None => *value = source.number(property.value)?,
                Some(count) if index == corners => {
                    read_corners(property, count, source, vertex_count, &mut polygon)?;
                }
                Some(count) => source.skip_list(property, count)?,
            }
        }
        let before = mesh.indices.len();
        if polygon.len() > 3 && before + polygon.len() > max_triangles {
            return Err(source.error(
                MeshErrorKind::Limit,
                "the attribute values of the faces are many times the size of the file".to_owned(),
            ));
        }
        let positions = &mesh.positions;
        let position_of = |vertex: u32| positions.get(vertex as usize).copied();
        triangulate(&polygon, position_of, &mut mesh.indices);
        for column in &mut columns {
            for _ in before..mesh.indices.len() {
                column.append(|property| row[property]);
            }
        }
    }
    mesh.attributes.extend(columns.into_iter().map(Column::finish));
    Ok(())
}

/// The index of the property that holds the corners.
fn find_corners(element: &Element, source: &impl Source) -> Result<usize, MeshError> {
    let is_corners = |property: &Property| {
        property.list_count.is_some()
            && property.value.is_integer()
            && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    };
    element.properties.iter().position(is_corners).ok_or_else(|| {
        source.error(
            MeshErrorKind::Unsupported,
            "the faces have no list `vertex_indices` of integers".to_owned(),
        )
    })
}

/// Reserves memory for the announced triangles, at most as many as the rest of the file can hold.
fn reserve<S: Source>(
    element: &Element,
    source: &S,
    columns: &mut [Column],
    mesh: &mut TriangleMesh,
) {
    // A triangle takes at least four numbers.
    let triangle_size = |property: &Property| match property.list_count {
        Some(count) => S::min_size(count) + 3 * S::min_size(property.value),
        None => S::min_size(property.value),
    };
    let row_size = element.properties.iter().map(triangle_size).max().unwrap_or(1);
    let at_most = source.bytes_left() / row_size;
    let count = usize::try_from(element.row_count).map_or(at_most, |count| count.min(at_most));
    mesh.indices.reserve_exact(count);
    for column in columns {
        column.reserve(count);
    }
}

/// Reads the corners of one face.
#[inline]
fn read_corners(
    property: &Property,
    count: ScalarType,
    source: &mut impl Source,
    vertex_count: u64,
    polygon: &mut Vec<u32>,
) -> Result<(), MeshError> {
    let length = source.list_length(property, count)?;
    for _ in 0..length {
        let index = source.integer(property.value)?;
        if u64::try_from(index).map_or(true, |index| index >= vertex_count) {
            return Err(source.error(
                MeshErrorKind::OutOfRange,
                format!("vertex index {index} is out of range: there are {vertex_count} vertices"),
            ));
        }
        polygon.push(index as u32);
    }
    Ok(())
}
