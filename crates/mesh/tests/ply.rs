//! PLY files in every encoding, with properties in every order.

use etendue_mesh::{
    Attribute, AttributeDomain, MeshErrorKind, PlyMesh, PlyWarning, TriangleMesh, read_ply,
    read_ply_points, write_ply,
};
use glam::{Vec2, Vec3};
use proptest::prelude::*;

/// A number in a body, with its type.
#[derive(Clone, Copy)]
enum Number {
    Char(i8),
    Uchar(u8),
    Short(i16),
    Ushort(u16),
    Int(i32),
    Uint(u32),
    Float(f32),
    Double(f64),
}
use Number::{Char, Double, Float, Int, Short, Uchar, Uint, Ushort};

impl Number {
    fn text(self) -> String {
        match self {
            Char(value) => value.to_string(),
            Uchar(value) => value.to_string(),
            Short(value) => value.to_string(),
            Ushort(value) => value.to_string(),
            Int(value) => value.to_string(),
            Uint(value) => value.to_string(),
            Float(value) => value.to_string(),
            Double(value) => value.to_string(),
        }
    }

    fn little(self) -> Vec<u8> {
        match self {
            Char(value) => value.to_le_bytes().to_vec(),
            Uchar(value) => vec![value],
            Short(value) => value.to_le_bytes().to_vec(),
            Ushort(value) => value.to_le_bytes().to_vec(),
            Int(value) => value.to_le_bytes().to_vec(),
            Uint(value) => value.to_le_bytes().to_vec(),
            Float(value) => value.to_le_bytes().to_vec(),
            Double(value) => value.to_le_bytes().to_vec(),
        }
    }
}

/// Reads the same file in all three encodings, which must give the same result.
fn read(header: &str, body: &[Number]) -> Result<TriangleMesh, MeshErrorKind> {
    let start =
        |format: &str| format!("ply\nformat {format} 1.0\n{header}end_header\n").into_bytes();
    let mut ascii = start("ascii");
    let mut little = start("binary_little_endian");
    let mut big = start("binary_big_endian");
    for number in body {
        ascii.extend(number.text().bytes().chain(*b"\r\n"));
        little.extend(number.little());
        big.extend(number.little().into_iter().rev());
    }
    let results = [ascii, little, big]
        .map(|bytes| read_ply(&bytes).map(|read| read.mesh).map_err(|error| error.kind));
    assert_eq!(results[0], results[1]);
    assert_eq!(results[1], results[2]);
    let [result, ..] = results;
    result
}

const POSITIONS: &str = "property float x\nproperty float y\nproperty float z\n";
const CORNERS: &str = "property list uchar int vertex_indices\n";

fn positions(places: &[(f32, f32)]) -> Vec<Number> {
    places.iter().flat_map(|&(x, y)| [Float(x), Float(y), Float(0.0)]).collect()
}

fn triangle() -> Vec<Number> {
    positions(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
}

#[test]
fn properties_of_any_order_and_type_are_read() {
    let header = "comment made by hand\nobj_info none\nelement vertex 3\n\
        property double z\nproperty uchar v\nproperty short y\nproperty ushort u\n\
        property char x\nproperty int nz\nproperty uint nx\nproperty float ny\n\
        element face 1\nproperty list ushort uchar vertex_index\n";
    let mut body = Vec::new();
    for vertex in 0..3_u8 {
        let sign = i16::from(vertex) - 1;
        body.extend([
            Double(0.5),
            Uchar(vertex),
            Short(-300 * sign),
            Ushort(60000),
            Char(-5 * sign as i8),
        ]);
        body.extend([Int(-1), Uint(2), Float(0.25)]);
    }
    body.extend([Ushort(3), Uchar(2), Uchar(1), Uchar(0)]);
    let mesh = read(header, &body).expect("valid");
    assert_eq!(mesh.positions[0], Vec3::new(5.0, 300.0, 0.5));
    assert_eq!(mesh.positions[2], Vec3::new(-5.0, -300.0, 0.5));
    assert_eq!(mesh.normals, [Vec3::new(2.0, 0.25, -1.0); 3]);
    assert_eq!(mesh.uvs[2], Vec2::new(60000.0, 2.0));
    assert_eq!(mesh.indices, [[2, 1, 0]]);
    assert_eq!(mesh.attributes, []);
}

#[test]
fn texture_coordinates_have_three_names() {
    for (u, v) in [("u", "v"), ("s", "t"), ("texture_u", "texture_v")] {
        let header = format!(
            "element vertex 3\nproperty float {v}\n{POSITIONS}property float {u}\n\
             element face 0\n{CORNERS}"
        );
        let row = [Float(0.25), Float(1.0), Float(2.0), Float(3.0), Float(0.75)];
        let mesh = read(&header, &row.repeat(3)).expect("valid");
        assert_eq!(mesh.uvs, [Vec2::new(0.75, 0.25); 3]);
        assert_eq!(mesh.attributes, []);
    }
}

#[test]
fn polygons_are_split_and_their_triangles_inherit_the_values() {
    let header = format!(
        "element vertex 5\n{POSITIONS}element face 4\nproperty uchar red\n{CORNERS}\
         property uchar green\nproperty uchar blue\nproperty float weight_0\nproperty list uchar float ignored\n"
    );
    let arrow = [(0.0, 2.0), (-1.5, -1.0), (0.0, 0.0), (1.5, -1.0), (5.0, 5.0)];
    let mut body = positions(&arrow);
    for (color, corners) in
        [(255, &[0, 1, 2, 3][..]), (51, &[0, 3, 4]), (7, &[1, 2]), (0, &[0, 3, 4])]
    {
        body.extend([Uchar(color), Uchar(corners.len() as u8)]);
        body.extend(corners.iter().map(|&corner| Int(corner)));
        body.extend([
            Uchar(0),
            Uchar(0),
            Float(f32::from(color)),
            Uchar(2),
            Float(8.0),
            Float(9.0),
        ]);
    }
    let mesh = read(&header, &body).expect("valid");
    assert_eq!(mesh.indices.len(), 4);
    let arrowhead = TriangleMesh { indices: mesh.indices[..2].to_vec(), ..mesh.clone() };
    // A fan from corner 0 would give the same area; one from corner 1 would give more.
    assert_eq!(arrowhead.surface_area(), 3.0);
    let values = |name: &str| {
        let attribute = mesh.attributes.iter().find(|attribute| attribute.name == name);
        attribute.map(|attribute| attribute.values.clone()).unwrap_or_default()
    };
    assert_eq!(values("face_weight"), [255.0, 255.0, 51.0, 0.0]);
    // The list between red and the other colours separates them.
    assert_eq!(values("face_color"), [1.0, 1.0, 0.2, 0.0]);
    assert_eq!(values("face_green"), [0.0; 4]);
}

#[test]
fn colors_are_grouped_and_scaled_by_their_type() {
    for (kind, one) in [("uchar", Uchar(255)), ("ushort", Ushort(65535)), ("float", Float(1.0))] {
        for names in [["red", "green", "blue"], ["r", "g", "b"], ["color_0", "color_1", "color_2"]]
        {
            let properties = names.map(|name| format!("property {kind} {name}\n")).concat();
            let header =
                format!("element vertex 1\n{properties}{POSITIONS}element face 0\n{CORNERS}");
            let body = [one, one, one, Float(0.0), Float(0.0), Float(0.0)];
            let mesh = read(&header, &body).expect("valid");
            let expected = Attribute {
                name: "vertex_color".into(),
                domain: AttributeDomain::Vertex,
                channels: 3,
                values: vec![1.0; 3],
            };
            assert_eq!(mesh.attributes, [expected]);
        }
    }
}

#[test]
fn other_elements_and_lists_are_skipped() {
    let header = format!(
        "element camera 2\nproperty float a\nproperty list uchar short b\n\
         element nothing 1000000000000000000\n\
         element vertex 3\n{POSITIONS}property list char double extra\n\
         element grid 1\nproperty double c\n\
         element face 1\n{CORNERS}element tail 1\nproperty int d\n"
    );
    let mut body = vec![Float(1.0), Uchar(0), Float(2.0), Uchar(2), Short(1), Short(2)];
    for vertex in triangle().chunks(3) {
        body.extend(vertex.iter().chain(&[Char(1), Double(0.0)]));
    }
    body.extend([Double(0.0), Uchar(3), Int(0), Int(1), Int(2), Int(9)]);
    let mesh = read(&header, &body).expect("valid");
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.indices, [[0, 1, 2]]);
    // Data after the vertices and faces is optional.
    body.pop();
    assert_eq!(read(&header, &body), Ok(mesh));
    body.pop();
    assert_eq!(read(&header, &body), Err(MeshErrorKind::Truncated));
}

#[test]
fn faces_may_come_before_vertices() {
    let header = format!("element face 1\n{CORNERS}element vertex 3\n{POSITIONS}");
    let mut body = vec![Uchar(3), Int(2), Int(0), Int(1)];
    body.extend(triangle());
    assert_eq!(read(&header, &body).map(|mesh| mesh.indices), Ok(vec![[2, 0, 1]]));
    body[1] = Int(3);
    assert_eq!(read(&header, &body), Err(MeshErrorKind::OutOfRange));
}

#[test]
fn points_need_no_faces() {
    let bytes = |header: &str, body: &str| {
        format!("ply\nformat ascii 1.0\n{header}end_header\n{body}").into_bytes()
    };
    let header = format!("element vertex 2\n{POSITIONS}property float weight\n");
    let cloud = read_ply_points(&bytes(&header, "0 1 0 7\n2 3 0 8\n")).expect("two points");
    assert_eq!(cloud.positions, [Vec3::new(0.0, 1.0, 0.0), Vec3::new(2.0, 3.0, 0.0)]);
    assert_eq!(cloud.attributes[0].values, [7.0, 8.0]);
    // Faces are ignored, before or after the vertices, even if they are invalid.
    let before = format!("element face 1\n{CORNERS}element vertex 1\n{POSITIONS}");
    let cloud = read_ply_points(&bytes(&before, "3 0 1 9\n1 2 3\n")).expect("a point");
    assert_eq!((cloud.positions.len(), cloud.indices.len()), (1, 0));
    let after = format!("element vertex 1\n{POSITIONS}element face 1\n{CORNERS}");
    let cloud = read_ply_points(&bytes(&after, "1 2 3\n3 0 1 9\n")).expect("a point");
    assert_eq!((cloud.positions.len(), cloud.indices.len()), (1, 0));
    let faces = format!("element face 1\n{CORNERS}");
    let error = read_ply_points(&bytes(&faces, "3 0 1 9\n")).expect_err("no points");
    assert_eq!(error.kind, MeshErrorKind::Unsupported);
}

#[test]
fn errors_have_a_location() {
    let header = format!("element vertex 3\n{POSITIONS}element face 1\n{CORNERS}end_header\n");
    let text = format!("ply\nformat ascii 1.0\n{header}0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
    let error = read_ply(text.as_bytes()).expect_err("there is no vertex 7");
    assert_eq!(error.to_string(), "line 13: vertex index 7 is out of range: there are 3 vertices");
    let mut bytes = format!("ply\nformat binary_little_endian 1.0\n{header}").into_bytes();
    let body_start = bytes.len();
    bytes.extend([0; 36]);
    bytes.extend([3, 0, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0]);
    let error = read_ply(&bytes).expect_err("there is no vertex 9");
    assert_eq!(error.offset, Some(body_start as u64 + 36 + 9));
}

/// Three vertices with normals and texture coordinates, and one face.
const DRESSED: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
    property float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
    property float u\nproperty float v\n";

#[test]
fn normals_and_coordinates_that_are_not_finite_are_replaced() {
    let header = format!("{DRESSED}element face 1\n{CORNERS}end_header\n");
    let body = "0 0 0 nan nan nan 0 0\n1 0 0 0 0 1 inf 0\n0 1 0 0 0 1 0 1\n3 0 1 2\n";
    let read = read_ply(format!("{header}{body}").as_bytes()).expect("the rest is usable");
    assert_eq!(read.mesh.normals, [Vec3::Z; 3], "computed from the face");
    assert_eq!(read.mesh.uvs[1], Vec2::ZERO);
    let warnings = [PlyWarning::UnusableNormals(1), PlyWarning::UnusableUvs(1)];
    assert_eq!(read.warnings, warnings);
    assert!(warnings[0].to_string().contains("1 normals"), "{}", warnings[0]);
}

#[test]
fn attributes_of_points_must_be_finite() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float q\n";
    let body = "0 0 0 nan\n1 0 0 2\n0 1 0 inf\n";
    let points = format!("{header}end_header\n{body}");
    let error = read_ply_points(points.as_bytes()).expect_err("a point may be anywhere");
    assert_eq!(error.kind, MeshErrorKind::NonFinite);
}

#[test]
fn attributes_that_are_not_finite_are_replaced() {
    let header = DRESSED.replace("property float u", "property float q");
    let body = "0 0 0 0 0 1 -nan(ind) 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 1.#INF 1\n3 0 1 2\n";
    let text = format!("{header}element face 1\n{CORNERS}end_header\n{body}");
    let read = read_ply(text.as_bytes()).expect("the rest is usable");
    assert_eq!(read.mesh.attributes[0].values, [0.0, 1.0, 0.0]);
    assert_eq!(read.warnings, [PlyWarning::UnusableValues(2)]);
}

#[test]
fn a_point_cloud_is_a_mesh_without_triangles() {
    let body = "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 0 0\n0 1 0 0 0 1 0 1\n";
    let read = read_ply(format!("{DRESSED}end_header\n{body}").as_bytes()).expect("points");
    assert_eq!((read.mesh.positions.len(), read.mesh.indices.len()), (3, 0));
    assert_eq!(read.warnings, [PlyWarning::NoFaces]);
    let strips = format!("{DRESSED}element tristrips 1\n{CORNERS}end_header\n{body}3 0 1 2\n");
    let error = read_ply(strips.as_bytes()).expect_err("strips are not read");
    assert_eq!(error.kind, MeshErrorKind::Unsupported);
}

/// A scene may name any file of the machine, so no message quotes one.
#[test]
fn messages_quote_nothing_of_the_file() {
    for text in [
        "SECRET",
        "ply\nSECRET x",
        "ply\nformat SECRET 1.0\n",
        "ply\nelement x SECRET\n",
        "ply\nelement x 1\nproperty SECRET x\n",
        "ply\nelement x 1\nproperty list SECRET int x\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
         property float z\nelement face 0\nproperty list int int vertex_index\nend_header\nSECRET",
    ] {
        let message = read_ply(text.as_bytes()).expect_err(text).to_string();
        assert!(!message.contains("SECRET"), "{message}");
    }
}

fn any_mesh() -> impl Strategy<Value = TriangleMesh> {
    let number = any::<f32>().prop_filter("finite", |value| value.is_finite());
    let counts = (1_usize..20, 0_usize..20, any::<[bool; 4]>(), 1_usize..5);
    counts.prop_flat_map(move |(vertices, faces, has, channels)| {
        let numbers = |count| prop::collection::vec(number.clone(), count);
        let count = |present: bool, count: usize| if present { count } else { 0 };
        let indices = prop::collection::vec(
            [0..vertices as u32, 0..vertices as u32, 0..vertices as u32],
            faces,
        );
        let arrays = (
            numbers(3 * vertices),
            numbers(count(has[0], 3 * vertices)),
            numbers(count(has[1], 2 * vertices)),
            numbers(count(has[2], channels * vertices)),
            numbers(count(has[3], channels * faces)),
        );
        (arrays, indices).prop_map(move |((positions, normals, uvs, vertex, face), indices)| {
            let vectors = |values: Vec<f32>| values.chunks(3).map(Vec3::from_slice).collect();
            let attribute = |prefix: &str, domain, values| Attribute {
                name: format!("{prefix}thing"),
                domain,
                channels: channels as u32,
                values,
            };
            let mut mesh = TriangleMesh {
                positions: vectors(positions),
                normals: vectors(normals),
                uvs: uvs.chunks(2).map(Vec2::from_slice).collect(),
                indices,
                ..TriangleMesh::default()
            };
            if has[2] {
                mesh.attributes.push(attribute("vertex_", AttributeDomain::Vertex, vertex));
            }
            if has[3] {
                mesh.attributes.push(attribute("face_", AttributeDomain::Face, face));
            }
            mesh
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn written_files_are_read_back(mesh in any_mesh()) {
        prop_assert_eq!(read_ply(&write_ply(&mesh)).map(|read| read.mesh), Ok(mesh));
    }

    #[test]
    fn truncated_or_corrupt_files_never_panic(
        mesh in any_mesh(),
        cut in any::<prop::sample::Index>(),
        place in any::<prop::sample::Index>(),
        byte in any::<u8>(),
    ) {
        let mut bytes = write_ply(&mesh);
        prop_assert!(read_ply(&bytes[..cut.index(bytes.len())]).is_err());
        let place = place.index(bytes.len());
        bytes[place] = byte;
        let valid = |read: PlyMesh| read.mesh.validate();
        prop_assert!(read_ply(&bytes).map_or(Ok(()), valid).is_ok());
    }

    #[test]
    fn noise_never_panics(
        format in prop::sample::select(vec!["ascii", "binary_little_endian", "binary_big_endian"]),
        kind in prop::sample::select(vec!["char", "uchar", "int", "uint", "float", "double"]),
        body in prop::collection::vec(any::<u8>(), 0..200),
        digits in "[0-9. -]{0,60}",
    ) {
        let count_kind = if kind == "float" || kind == "double" { "char" } else { kind };
        for body in [&body, digits.as_bytes()] {
            let mut bytes = format!(
                "ply\nformat {format} 1.0\nelement vertex 3\n{POSITIONS}\
                 property list {count_kind} {kind} a\nelement face 2\n\
                 property {kind} b\n{CORNERS}end_header\n"
            ).into_bytes();
            bytes.extend(body);
            let valid = |read: PlyMesh| read.mesh.validate();
            prop_assert!(read_ply(&bytes).map_or(Ok(()), valid).is_ok());
        }
    }
}
