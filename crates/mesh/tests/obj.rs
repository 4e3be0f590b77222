//! OBJ files in practice: every form of face, and how missing data is filled in.

use etendue_mesh::{
    MeshErrorKind, ObjMesh, ObjOptions, ObjWarningKind, TriangleMesh, read_obj, write_obj,
};
use glam::{Vec2, Vec3};
use proptest::prelude::*;
use std::fmt::Write;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn read(text: &str) -> ObjMesh {
    let read = read_obj(text.as_bytes(), &ObjOptions::default()).expect("a valid file");
    assert_eq!(read.mesh.validate(), Ok(()));
    read
}

/// The kind, line and text of the error from reading.
fn error(text: &str) -> (MeshErrorKind, Option<u64>, String) {
    let error = read_obj(text.as_bytes(), &ObjOptions::default()).expect_err("not a valid file");
    (error.kind, error.line, error.message)
}

fn warnings(read: &ObjMesh) -> Vec<(ObjWarningKind, u64, u64)> {
    read.warnings.iter().map(|w| (w.kind, w.count, w.first_line)).collect()
}

#[test]
fn every_form_of_corner_is_read() {
    for (face, has_uvs, has_normals) in [
        ("f 1 2 3", false, false),
        ("f 1/ 2/ 3/", false, false),
        ("f 1// 2// 3//", false, false),
        ("f 1/1 2/2 3/1", true, false),
        ("f 1/1/ 2/2/ 3/1/", true, false),
        ("f 1//1 2//1 3//1", false, true),
        ("f 1/1/1 2/2/1 3/1/1", true, true),
        ("f -3/-2/-1 -2/-1/-1 -1/-2/-1", true, true),
        ("\tf  1/1/1\t2/2/1 \\\n 3/1/1  # face", true, true),
    ] {
        let mesh = read(&format!("{TRIANGLE}vt 0.25 0.5\nvt 1 0.75 9\nvn 0 0 2\n{face}\n")).mesh;
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y], "{face}");
        assert_eq!(mesh.indices, [[0, 1, 2]], "{face}");
        let uvs = [Vec2::new(0.25, 0.5), Vec2::new(1.0, 0.75), Vec2::new(0.25, 0.5)];
        assert_eq!(mesh.uvs, if has_uvs { &uvs[..] } else { &[] }, "{face}");
        let normals = [Vec3::Z * 2.0; 3];
        assert_eq!(mesh.normals, if has_normals { &normals[..] } else { &[] }, "{face}");
    }
}

#[test]
fn corners_with_equal_and_different_indices_are_read() {
    const COUNT: usize = 12_345;
    let mut text = String::new();
    for index in 0..COUNT {
        write!(text, "v {index} 0 0\nvt {index}.0 0\nvn {index}.00 0 1\n").expect("memory");
    }
    let mut expected = Vec::new();
    let mut random = 1_u64;
    for _ in 0..4_000 {
        text.push('f');
        for _ in 0..3 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let [v, wanted] = [random >> 33, random >> 20].map(|bits| bits as usize % COUNT + 1);
            // Some start with the same digits: 12/12/123.
            let longer = if v * 10 <= COUNT { v * 10 } else { wanted };
            let (vt, vn) = match random >> 60 {
                0..8 => (v, v),
                8..10 => (v, longer),
                10..12 => (longer, v),
                12..14 => (longer, longer),
                _ => (wanted, v),
            };
            write!(text, " {v}/{vt}/{vn}").expect("memory");
            expected.push([v, vt, vn].map(|index| (index - 1) as f32));
        }
        text.push('\n');
    }
    let mesh = read(&text).mesh;
    let corners = mesh.indices.as_flattened().iter().map(|&vertex| vertex as usize);
    let found = corners
        .map(|vertex| [mesh.positions[vertex].x, mesh.uvs[vertex].x, mesh.normals[vertex].x]);
    assert!(found.eq(expected));
}

#[test]
fn an_index_triple_must_be_valid_in_all_three_lists() {
    let text =
        format!("{TRIANGLE}vt 0 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/2 3/3/3 # comment behind\n");
    let read = read(&text);
    // The third coordinate, the second and the third normal.
    assert_eq!(warnings(&read), [(ObjWarningKind::DanglingIndex, 3, 7)]);
    assert_eq!(read.mesh.uvs, [Vec2::ZERO, Vec2::Y, Vec2::ZERO]);
}

#[test]
fn each_distinct_triple_becomes_one_vertex() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\n";
    let shared = read(&format!("{square}f 1/1 2/1 3/1\nf 1/1 3/1 4/1\n")).mesh;
    assert_eq!((shared.positions.len(), shared.indices[1]), (4, [0, 2, 3]));
    let seam = read(&format!("{square}f 1/1 2/1 3/1\nf 1/2 3/1 4/1\n")).mesh;
    assert_eq!((seam.positions.len(), seam.indices[1]), (5, [3, 2, 4]));
    assert_eq!(seam.positions[3], seam.positions[0]);
    assert_eq!((seam.uvs[0], seam.uvs[3]), (Vec2::ZERO, Vec2::ONE));
}

#[test]
fn corners_without_coordinates_do_not_affect_the_others() {
    let text = format!("{TRIANGLE}v 1 1 0\nvt 0.5 0.5\nvn 0 0 -1\nf 1 2 3\nf 2/1/1 4/1/1 3/1/1\n");
    let mesh = read(&text).mesh;
    assert_eq!(mesh.positions.len(), 6);
    for (face, uv, normal) in [(0, Vec2::ZERO, Vec3::Z), (1, Vec2::splat(0.5), Vec3::NEG_Z)] {
        for index in mesh.indices[face] {
            assert_eq!(mesh.uvs[index as usize], uv);
            // The normals of the first face are computed from its winding.
            assert!((mesh.normals[index as usize] - normal).length() < 1e-6);
        }
    }
}

#[test]
fn flipping_affects_only_coordinates_in_the_file() {
    let text = format!("{TRIANGLE}vt 0.25 0.125\nf 1/1 2/1 3\n");
    let options = ObjOptions { flip_texture_coordinates: true };
    let mesh = read_obj(text.as_bytes(), &options).expect("a valid file").mesh;
    let flipped = Vec2::new(0.25, 0.875);
    assert_eq!(mesh.uvs, [flipped, flipped, Vec2::ZERO]);
}

#[test]
fn faces_may_come_before_their_vertices() {
    let ahead = read("o early\nf 2 3 4\nv 9 9 9\nv 0 0 0\nf -1 -2 3\nv 1 0 0\nv 0 1 0\n").mesh;
    assert_eq!(ahead.name, "early");
    assert_eq!(ahead.indices, [[0, 1, 2], [0, 3, 1]]);
    assert_eq!(ahead.positions, [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(9.0)]);
    let (kind, line, message) = error("v 0 0 0\nf 2 3 4\nv 1 0 0\nv 0 0 1\n");
    assert_eq!((kind, line), (MeshErrorKind::OutOfRange, Some(2)));
    assert_eq!(message, "position index 4 is out of range: there are 3 positions");
}

#[test]
fn indices_out_of_range_are_reported_with_line_and_count() {
    for (face, expected) in [
        ("f 1 2 0", "position index 0 is not valid: indices start at 1"),
        ("f 1 2 -4", "position index -4 is out of range: 3 positions come before it"),
        ("f 1 2 4", "position index 4 is out of range: there are 3 positions"),
        (
            "f 1 2 9223372036854775807",
            "position index 9223372036854775807 is out of range: there are 3 positions",
        ),
    ] {
        let (kind, line, message) = error(&format!("{TRIANGLE}vt 0 0\r\n{face}\n"));
        assert_eq!((kind, line, message.as_str()), (MeshErrorKind::OutOfRange, Some(5), expected));
    }
}

#[test]
fn malformed_statements_are_syntax_errors_with_a_line() {
    for bad in [
        "v 1 2",
        "v 1 2 x",
        "v 1 2 3 red",
        "vn 1 2",
        "vt",
        "vt x",
        "f 1 2 x",
        "f 1///4 1 1",
        "f 1, 2, 3",
        "f 1.5 2 3",
        "v 1 2 3e",
        "v 1,0 2 3",
        "vn 0 0 1 1",
        "vt 0 0 0 0",
    ] {
        let (kind, line, _) = error(&format!("{TRIANGLE}# fine\n{bad}\nv 0 0 0\n"));
        assert_eq!((kind, line), (MeshErrorKind::Syntax, Some(5)), "{bad}");
    }
    assert_eq!(error("\u{89}PNG\r\n1 2 3").0, MeshErrorKind::Syntax);
}

#[test]
fn non_finite_positions_are_rejected_and_normals_replaced() {
    for bad in ["v 1e39 0 0", "v 0 nan 0", "v 0 0 -inf"] {
        let (kind, line, _) = error(&format!("{TRIANGLE}{bad}\n"));
        assert_eq!((kind, line), (MeshErrorKind::NonFinite, Some(4)), "{bad}");
    }
    let read = read(&format!("{TRIANGLE}vn nan nan nan\nvn 0 0 0\nvn 1 0 0\nf 1//1 2//2 3//3\n"));
    assert_eq!(warnings(&read), [(ObjWarningKind::UnusableNormal, 2, 4)]);
    assert!((read.mesh.normals[0] - Vec3::Z).length() < 1e-6);
    assert!((read.mesh.normals[1] - Vec3::Z).length() < 1e-6);
    assert_eq!(read.mesh.normals[2], Vec3::X);
}

#[test]
fn ignored_statements_are_counted() {
    let read = read(&format!(
        "mtllib a.mtl\r\no Küche\r\no second\r\ng x y\r\ns off\r\nusemtl a\r\n{TRIANGLE}\
         v 1 1 1 0.5 0.5 0.5\nf 1 2 3\nusemtl b\nl 1 2 \\\n 3\np 1\nf 1 2\n\
         zorro 7 \\\n8\ncstype bezier\n"
    ));
    assert_eq!(read.mesh.name, "Küche");
    assert_eq!(read.mesh.indices.len(), 1);
    assert_eq!(
        warnings(&read),
        [
            (ObjWarningKind::PointOrLine, 2, 13),
            (ObjWarningKind::FreeForm, 1, 19),
            (ObjWarningKind::VertexColor, 1, 10),
            (ObjWarningKind::DegenerateFace, 1, 16),
            (ObjWarningKind::SeveralMaterials, 2, 6),
            (ObjWarningKind::UnknownStatement, 1, 17),
        ]
    );
    assert_eq!(warnings(&self::read(&format!("usemtl a\n{TRIANGLE}"))), []);
}

#[test]
fn polygons_are_split_and_concave_ones_stay_inside_their_outline() {
    let arrow = "v 0 2 0\nv -1.5 -1 0\nv 0 0 0\nv 1.5 -1 0\n";
    for face in ["f 1 2 3 4", "f 2 3 4 1", "f 4 3 2 1"] {
        let mesh = read(&format!("{arrow}{face}\n")).mesh;
        assert_eq!((mesh.indices.len(), mesh.surface_area()), (2, 3.0), "{face}");
    }
}

#[test]
fn line_ends_byte_order_marks_and_empty_files_are_accepted() {
    let plain = read(&format!("{TRIANGLE}f 1 2 3")).mesh;
    for end in ["\n", "\r\n", "\r", "  \t\n", " # x\n", "\n\n#\n"] {
        let text = format!("\u{feff}{TRIANGLE}f 1 2 3\n").replace('\n', end);
        assert_eq!(read(&text).mesh, plain, "{end:?}");
    }
    assert_eq!(read("").mesh, TriangleMesh::default());
    assert_eq!(read("# nothing\ng a").mesh, TriangleMesh::default());
}

/// These files would take hours if looking up a corner, splitting a polygon, or referring to later
/// vertices took quadratic time.
#[test]
fn malicious_files_do_not_take_quadratic_time() {
    const COUNT: usize = 300_000;
    let mut one_position = TRIANGLE.to_owned();
    let mut one_polygon = String::from("f");
    let mut all_ahead = String::new();
    for number in 1..=COUNT {
        one_position.push_str(&format!("vn 0 {number} 1\nf 1//{number} 2 3\n"));
        one_polygon.push_str(&format!(" {}", number % 3 + 1));
        all_ahead.push_str("f 1 2 3\n");
    }
    one_polygon.insert_str(0, TRIANGLE);
    all_ahead.push_str(TRIANGLE);
    let counts = |text: &str| {
        let mesh = read(text).mesh;
        (mesh.positions.len(), mesh.indices.len())
    };
    assert_eq!(counts(&one_position), (COUNT + 2, COUNT));
    assert_eq!(counts(&one_polygon), (3, COUNT - 2));
    assert_eq!(counts(&all_ahead), (3, COUNT));
}

fn any_mesh() -> impl Strategy<Value = TriangleMesh> {
    let finite = any::<f32>().prop_filter("finite", |value| value.is_finite());
    let number = prop_oneof![finite, -2.0_f32..2.0, Just(-0.0)];
    (1_usize..20, any::<[bool; 2]>()).prop_flat_map(move |(count, [has_uvs, has_normals])| {
        let vectors =
            prop::collection::vec([number.clone(), number.clone(), number.clone()], count);
        let uvs = prop::collection::vec([number.clone(), number.clone()], count);
        let normals = prop::collection::vec([0.5_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0], count);
        let index = 0..count as u32;
        let faces = prop::collection::vec([index.clone(), index.clone(), index], 1..30);
        (vectors, uvs, normals, faces).prop_map(move |(positions, uvs, normals, mut indices)| {
            // Makes the order of first use that of the vertices, as in the reader.
            indices.splice(0..0, (0..count as u32).map(|vertex| [vertex; 3]));
            TriangleMesh {
                positions: positions.into_iter().map(Vec3::from_array).collect(),
                uvs: uvs.into_iter().filter(|_| has_uvs).map(Vec2::from_array).collect(),
                normals: normals
                    .into_iter()
                    .filter(|_| has_normals)
                    .map(Vec3::from_array)
                    .collect(),
                indices,
                ..TriangleMesh::default()
            }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn written_files_are_read_back(mesh in any_mesh()) {
        let read = read_obj(&write_obj(&mesh), &ObjOptions::default());
        prop_assert_eq!(read.map(|read| read.mesh), Ok(mesh));
    }

    #[test]
    fn truncated_or_corrupt_files_never_panic(
        mesh in any_mesh(),
        place in any::<prop::sample::Index>(),
        byte in any::<u8>(),
    ) {
        let mut bytes = write_obj(&mesh);
        let place = place.index(bytes.len());
        let cut = read_obj(&bytes[..place], &ObjOptions::default());
        bytes[place] = byte;
        let corrupt = read_obj(&bytes, &ObjOptions::default());
        for read in [cut, corrupt].into_iter().flatten() {
            prop_assert_eq!(read.mesh.validate(), Ok(()));
        }
    }

    #[test]
    fn noise_never_panics(
        text in "([vfnto/ 0-9e.\\\\\\r\\n#-]|v |f |vn |vt ){0,200}",
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        for noise in [text.as_bytes(), &bytes] {
            if let Ok(read) = read_obj(noise, &ObjOptions::default()) {
                prop_assert_eq!(read.mesh.validate(), Ok(()));
            }
        }
    }
}

#[test]
fn what_is_broken_in_texture_coordinates_and_normals_is_left_out() {
    let positions = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let read = |rest: &str| {
        let text = format!("{positions}{rest}");
        let read = read_obj(text.as_bytes(), &ObjOptions::default()).expect(rest);
        assert_eq!(read.mesh.indices, [[0, 1, 2]], "{rest}");
        (read.mesh, read.warnings.iter().map(|found| (found.kind, found.count)).collect::<Vec<_>>())
    };
    let (mesh, warnings) = read("vt nan 0\nvt 1 -inf\nvt 0 1\nf 1/1 2/2 3/3\n");
    assert_eq!(mesh.uvs, [Vec2::ZERO, Vec2::ZERO, Vec2::Y]);
    assert_eq!(warnings, [(ObjWarningKind::UnusableUv, 2)]);

    let (mesh, warnings) =
        read("vt -1.#IND -nan(ind)\nvt 1 1 # comment\nvt 1.#INF 0\nf 1/1 2/2 3/3\n");
    assert_eq!(mesh.uvs, [Vec2::ZERO, Vec2::ONE, Vec2::ZERO]);
    assert_eq!(warnings, [(ObjWarningKind::UnusableUv, 2)]);

    // Zero, beyond the list, and before its start; in files that refer ahead or not.
    for corners in ["1/0 2/1 3/1", "1/1 2/9 3/1", "1/1 2/-5 3/1"] {
        for text in [format!("vt 0.5 0.5\nf {corners}\n"), format!("f {corners}\nvt 0.5 0.5\n")] {
            let (mesh, warnings) = read(&text);
            let missing = mesh.uvs.iter().filter(|uv| **uv == Vec2::ZERO).count();
            assert_eq!(missing, 1, "{text}");
            assert_eq!(warnings, [(ObjWarningKind::DanglingIndex, 1)], "{text}");
        }
    }
    let (mesh, warnings) = read("f 1/1/7 2/1/7 3/1/7\n");
    assert!(mesh.uvs.is_empty() && mesh.normals.is_empty());
    assert_eq!(warnings, [(ObjWarningKind::DanglingIndex, 6)]);
    let (mesh, warnings) = read("vn 0 0 1\nf 1//1 2//0 3//1\n");
    assert_eq!(mesh.normals, [Vec3::Z; 3], "computed where it is missing");
    assert_eq!(warnings, [(ObjWarningKind::DanglingIndex, 1)]);
}

#[test]
fn a_backslash_at_the_end_of_a_name_swallows_nothing() {
    for statement in ["usemtl wood\\", "mtllib C:\\scenes\\", "g part\\", "o thing\\"] {
        for line_end in ["\n", "\r\n"] {
            let text =
                ["v 0 0 0", statement, "v 1 0 0", "v 0 1 0", statement, "f 1 2 3"].join(line_end);
            let read = read_obj(text.as_bytes(), &ObjOptions::default()).expect(statement);
            assert_eq!(read.mesh.positions.len(), 3, "{statement}");
            assert_eq!(read.mesh.indices.len(), 1, "{statement}");
        }
    }
    let continued = "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 3";
    let read = read_obj(continued.as_bytes(), &ObjOptions::default()).expect("numbers go on");
    assert_eq!(read.mesh.indices.len(), 1);
}

/// A scene may name any file of the machine, so no message quotes one.
#[test]
fn messages_quote_nothing_of_the_file() {
    for text in ["v SECRET", "v 0 0 SECRET", "vt SECRET", "f SECRET", "v 0 0 0\nf 1SECRET 1 1"] {
        let error = read_obj(text.as_bytes(), &ObjOptions::default()).expect_err(text);
        let message = error.to_string();
        assert!(!message.contains("SECRET") && message.contains("column"), "{message}");
    }
}
