//! Broken mesh files.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

use crate::case::Case;

fn shape(kind: &str, file: &str, more: &str) -> String {
    format!("<shape type=\"{kind}\"><string name=\"filename\" value=\"{file}\"/>{more}</shape>")
}

/// Checks files of one kind: the defect, the bytes, and text that the error must contain.
fn check_all<const N: usize>(kind: &str, file: &'static str, rows: [(&str, Vec<u8>, &str); N]) {
    for (defect, bytes, message) in rows {
        Case::file(&shape(kind, file, ""), (file, bytes), defect, message).check();
    }
}

/// Deterministic noise.
fn noise(count: u32) -> Vec<u8> {
    (0..count).map(|index| (index.wrapping_mul(2_654_435_761) >> 13) as u8).collect()
}

#[test]
fn broken_obj_files_are_rejected() {
    let with = |faces: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}\n").into_bytes();
    let rows = [
        ("empty", Vec::new(), "is empty"),
        ("a web page", b"<html><body>404</body></html>".to_vec(), "not an OBJ file"),
        ("noise", noise(10_000), "m.obj"),
        ("index 0", with("f 0 1 2"), "indices start at 1"),
        ("index before the first", with("f -4 -1 -2"), "line 4"),
        ("index beyond 64 bits", with("f 1 2 99999999999999999999"), "expected an index"),
        ("three slashes", with("f 1///1 2 3"), "line 4"),
        ("infinite", with("v 1e999 0 0"), "not finite"),
        ("two coordinates", with("v 1 2"), "a coordinate of a position in column 6"),
        ("words", with("v a b c"), "a coordinate of a position in column 3"),
        (
            "a number of five million digits",
            format!("v {}", "1".repeat(5_000_000)).into(),
            "line 1",
        ),
    ];
    check_all("obj", "m.obj", rows);
}

/// The header of a PLY file with one triangle.
const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

/// The vertices of a triangle, in little endian.
fn corners() -> Vec<u8> {
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    corners.iter().flat_map(|number| number.to_le_bytes()).collect()
}

#[test]
fn broken_ply_files_are_rejected() {
    let changed = |from: &str, to: &str| HEADER.replace(from, to).into_bytes();
    let ascii = |body: &str| format!("{HEADER}{body}").into_bytes();
    let binary = |from: &str, to: &str, bytes: &[u8]| {
        let header = HEADER.replace("ascii", "binary_little_endian").replace(from, to);
        [header.as_bytes(), &corners(), bytes].concat()
    };
    let rows = [
        ("empty", Vec::new(), "is empty"),
        ("another format", b"plx\n".to_vec(), "starts with `ply`"),
        ("no end of the header", b"ply\nformat ascii 1.0\n".to_vec(), "no end"),
        ("unknown format", changed("ascii", "utf8"), "expected the format"),
        ("no format", changed("format ascii 1.0\n", ""), "no line `format`"),
        ("unknown type", changed("float x", "quux x"), "expected a type"),
        ("no z", [&changed("property float z\n", "")[..], &b"0 0 ".repeat(9)].concat(), "`z`"),
        (
            "no faces and no vertices",
            changed("element face 1\nproperty list uchar int vertex_indices\n", ""),
            "only 0 bytes",
        ),
        ("-3 vertices", changed("vertex 3", "vertex -3"), "number of elements"),
        (
            "10²³ vertices",
            changed("vertex 3", "vertex 99999999999999999999999"),
            "number of elements",
        ),
        ("4·10⁹ vertices", changed("vertex 3", "vertex 4000000000"), "only 0 bytes"),
        ("4·10⁹ faces", binary("face 1", "face 4000000000", b"\x03"), "4000000000"),
        ("a list of 2³¹", binary("uchar int", "int int", &[255, 255, 255, 127]), "2147483647"),
        ("a list of -1", binary("uchar int", "int int", &[255; 16]), "-1 entries"),
        ("a list of 0.5", binary("uchar int", "float int", &[0; 16]), "whole number"),
        ("the wrong endian", binary("", "", &[3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]), "16777216"),
        ("cut off", ascii("0 0 0\n1 0 0\n"), "ends within its data"),
        ("a word", ascii("x 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "in column 1"),
        ("not a number", ascii("nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "not finite"),
        ("an index too many", ascii("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "index 3"),
        ("an index below zero", ascii("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "index -1"),
        ("a line of 5 MB", format!("ply\nformat {}", "a".repeat(5_000_000)).into(), "line 2"),
    ];
    check_all("ply", "m.ply", rows);
}

/// A serialized file of one shape, whose inflated bytes are given.
fn serialized(version: u16, shape: &[u8], offset: u64, count: u32) -> Vec<u8> {
    let mut file = [0x041c_u16.to_le_bytes(), version.to_le_bytes()].concat();
    let mut encoder = ZlibEncoder::new(&mut file, Compression::fast());
    encoder.write_all(shape).and_then(|()| encoder.try_finish()).unwrap();
    drop(encoder);
    file.extend(offset.to_le_bytes());
    file.extend(count.to_le_bytes());
    file
}

/// What stands at the start of a shape: flags, the name `a`, and two counts.
fn announcement(vertices: u64, triangles: u64) -> Vec<u8> {
    let flags = 0x1000_u32.to_le_bytes();
    [&flags[..], b"a\0", &vertices.to_le_bytes(), &triangles.to_le_bytes()].concat()
}

#[test]
fn broken_serialized_files_are_rejected() {
    let indices = |last: u32| [0, 1, last].map(u32::to_le_bytes).concat();
    let triangle = |last| [announcement(3, 1), corners(), indices(last)].concat();
    let bomb = [announcement(300_000_000, 1), vec![0; 50_000_000]].concat();
    let name = [0x1000_u32.to_le_bytes().to_vec(), vec![b'a'; 50_000_000]].concat();
    let whole = serialized(4, &triangle(2), 0, 1);
    let rows = [
        ("empty", Vec::new(), "is empty"),
        ("zeros", vec![0; 32], "starts with 0x041c"),
        ("cut off", whole[..30].to_vec(), "the shape ends early"),
        ("version 9", serialized(9, &triangle(2), 0, 1), "version 9"),
        ("2⁶⁰ vertices", serialized(4, &announcement(1 << 60, 1), 0, 1), "exceed the limit"),
        ("a zip bomb of zeros", serialized(4, &bomb, 0, 1), "cannot hold"),
        ("a zip bomb in the name", serialized(4, &name, 0, 1), "name"),
        ("an index too many", serialized(4, &triangle(7), 0, 1), "[0, 1, 7]"),
        (
            "data that is not compressed",
            [&whole[..4], &noise(100), &whole[whole.len() - 12..]].concat(),
            "corrupt",
        ),
    ];
    check_all("serialized", "m.serialized", rows);
    let index = r#"<integer name="shape_index" value="5"/>"#;
    let content = shape("serialized", "m.serialized", index);
    Case::file(&content, ("m.serialized", whole), "shape 5", "no shape 5").check();
}
