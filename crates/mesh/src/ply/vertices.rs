//! The element `vertex` of a PLY file.

use super::attributes::Column;
use super::header::Element;
use super::scalar::ByteOrder;
use super::source::Source;
use crate::error::{MeshError, MeshErrorKind};
use crate::triangle_mesh::{AttributeDomain, TriangleMesh};
use glam::{Vec2, Vec3};

/// The names of texture coordinates.
const UV_NAMES: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];

/// The roles of the properties.
struct Layout {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    uv: Option<[usize; 2]>,
    columns: Vec<Column>,
}

impl Layout {
    fn of(element: &Element) -> Option<Self> {
        let position = find_all(element, ["x", "y", "z"])?;
        let normal = find_all(element, ["nx", "ny", "nz"]);
        let uv = UV_NAMES.iter().find_map(|&names| find_all(element, names));
        let taken =
            [&position[..], normal.as_ref().map_or(&[], |n| n), uv.as_ref().map_or(&[], |n| n)];
        let columns = Column::all(element, AttributeDomain::Vertex, &taken.concat());
        Some(Self { position, normal, uv, columns })
    }
}

fn find_all<const N: usize>(element: &Element, names: [&str; N]) -> Option<[usize; N]> {
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(names) {
        *place = element.find(name)?;
    }
    Some(places)
}

/// Reads all rows of `element`, whose number has been checked against the size of the file.
pub(super) fn read_vertices(
    element: &Element,
    source: &mut impl Source,
    mesh: &mut TriangleMesh,
) -> Result<(), MeshError> {
    let Some(mut layout) = Layout::of(element) else {
        return Err(source.error(
            MeshErrorKind::Unsupported,
            "the vertices have no properties `x`, `y` and `z`".to_owned(),
        ));
    };
    if let Some((rows, order)) = source.take_rows(element) {
        decode_rows(element, Rows { bytes: rows, order }, &mut layout, mesh);
    } else {
        read_row_by_row(element, source, &mut layout, mesh)?;
    }
    mesh.attributes.extend(layout.columns.into_iter().map(Column::finish));
    Ok(())
}

/// Binary rows of equal size.
#[derive(Clone, Copy)]
struct Rows<'a> {
    bytes: &'a [u8],
    order: ByteOrder,
}

/// Decodes one column after another, so that each loop is uniform.
fn decode_rows(element: &Element, rows: Rows<'_>, layout: &mut Layout, mesh: &mut TriangleMesh) {
    let mut offset = 0;
    let mut offsets = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        offsets.push(offset);
        offset += property.value.size();
    }
    let row_size = offset;
    let value = |row: &[u8], property: usize| {
        let kind = element.properties[property].value;
        // Every property is within its row.
        row.get(offsets[property]..)
            .and_then(|bytes| kind.read_float(bytes, rows.order))
            .unwrap_or_default()
    };
    let each_row = || rows.bytes.chunks_exact(row_size);
    let vector = |places: [usize; 3]| {
        move |row: &[u8]| Vec3::from_array(places.map(|place| value(row, place)))
    };
    mesh.positions = each_row().map(vector(layout.position)).collect();
    if let Some(places) = layout.normal {
        mesh.normals = each_row().map(vector(places)).collect();
    }
    if let Some(places) = layout.uv {
        let uv = |row| Vec2::from_array(places.map(|place| value(row, place)));
        mesh.uvs = each_row().map(uv).collect();
    }
    for column in &mut layout.columns {
        column.reserve(mesh.positions.len());
        for row in each_row() {
            column.append(|property| value(row, property));
        }
    }
}

fn read_row_by_row(
    element: &Element,
    source: &mut impl Source,
    layout: &mut Layout,
    mesh: &mut TriangleMesh,
) -> Result<(), MeshError> {
    let row_count = element.row_count as usize;
    mesh.positions.reserve_exact(row_count);
    mesh.normals.reserve_exact(layout.normal.map_or(0, |_| row_count));
    mesh.uvs.reserve_exact(layout.uv.map_or(0, |_| row_count));
    for column in &mut layout.columns {
        column.reserve(row_count);
    }
    let mut row = vec![0.0; element.properties.len()];
    for _ in 0..row_count {
        for (value, property) in row.iter_mut().zip(&element.properties) {
            match property.list_count {
                None => *value = source.number(property.value)?,
                Some(count) => source.skip_list(property, count)?,
            }
        }
        mesh.positions.push(Vec3::from_array(layout.position.map(|place| row[place])));
        if let Some(places) = layout.normal {
            mesh.normals.push(Vec3::from_array(places.map(|place| row[place])));
        }
        if let Some(places) = layout.uv {
            mesh.uvs.push(Vec2::from_array(places.map(|place| row[place])));
        }
        for column in &mut layout.columns {
            column.append(|property| row[property]);
        }
    }
    Ok(())
}
