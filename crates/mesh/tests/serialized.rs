//! Serialized files of both versions, generated here, valid and corrupt.

use etendue_mesh::{
    AttributeDomain, MeshErrorKind, TriangleMesh, has_shape_list, read_serialized,
    serialized_shape_count,
};
use flate2::{Compression, write::ZlibEncoder};
use glam::{Vec2, Vec3};
use proptest::prelude::*;
use std::io::Write;

const NORMALS: u32 = 0x0001;
const UVS: u32 = 0x0002;
const COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const SINGLE: u32 = 0x1000;
const DOUBLE: u32 = 0x2000;

/// What a shape claims to contain, which may be false.
#[derive(Clone)]
struct Shape {
    flags: u32,
    vertex_count: u64,
    triangle_count: u64,
    numbers: Vec<f64>,
    indices: Vec<u32>,
}

/// Two triangles over a folded square, with every array that the flags announce.
fn shape(flags: u32) -> Shape {
    let mut numbers = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0];
    let mut add = |bit: u32, values: Vec<f64>| {
        if flags & bit != 0 {
            numbers.extend(values);
        }
    };
    add(NORMALS, [0.0, 0.0, -1.0].repeat(4));
    add(UVS, (0..8).map(|value| f64::from(value) / 8.0).collect());
    add(COLORS, (0..12).map(f64::from).collect());
    Shape { flags, vertex_count: 4, triangle_count: 2, numbers, indices: vec![0, 1, 2, 0, 2, 3] }
}

fn payload(shape: &Shape, version: u16) -> Vec<u8> {
    let mut data = shape.flags.to_le_bytes().to_vec();
    if version == 4 {
        data.extend("Tür\0".bytes());
    }
    data.extend(shape.vertex_count.to_le_bytes());
    data.extend(shape.triangle_count.to_le_bytes());
    for number in &shape.numbers {
        if shape.flags & DOUBLE != 0 {
            data.extend(number.to_le_bytes());
        } else {
            data.extend((*number as f32).to_le_bytes());
        }
    }
    data.extend(shape.indices.iter().flat_map(|index| index.to_le_bytes()));
    data
}

fn file(version: u16, payloads: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut offsets = Vec::new();
    for payload in payloads {
        offsets.push(bytes.len() as u64);
        bytes.extend(0x041C_u16.to_le_bytes());
        bytes.extend(version.to_le_bytes());
        let mut encoder = ZlibEncoder::new(bytes, Compression::fast());
        encoder.write_all(payload).expect("memory takes everything");
        bytes = encoder.finish().expect("memory takes everything");
    }
    for offset in offsets {
        match version {
            3 => bytes.extend((offset as u32).to_le_bytes()),
            _ => bytes.extend(offset.to_le_bytes()),
        }
    }
    bytes.extend((payloads.len() as u32).to_le_bytes());
    bytes
}

fn file_of(version: u16, shape: &Shape) -> Vec<u8> {
    file(version, &[payload(shape, version)])
}

fn kind(bytes: &[u8], index: u32) -> Option<MeshErrorKind> {
    read_serialized(bytes, index).err().map(|error| error.kind)
}

#[test]
fn every_combination_of_version_precision_and_arrays_is_read() {
    for version in [3, 4] {
        for precision in [SINGLE, DOUBLE] {
            for arrays in 0..16 {
                let flags = precision | (arrays & 3) | (arrays & 4) << 1;
                let mesh = read_serialized(&file_of(version, &shape(flags)), 0).expect("valid");
                assert_eq!(mesh.name, if version == 4 { "Tür" } else { "" });
                assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y]);
                assert_eq!(mesh.indices, [[0, 1, 2], [0, 2, 3]]);
                let has = |bit: u32, count: usize| if flags & bit != 0 { count } else { 0 };
                assert_eq!(mesh.normals, vec![Vec3::NEG_Z; has(NORMALS, 4)]);
                assert_eq!(mesh.uvs.len(), has(UVS, 4));
                assert_eq!(
                    mesh.uvs.get(1).copied().unwrap_or(Vec2::new(0.25, 0.375)),
                    Vec2::new(0.25, 0.375)
                );
                assert_eq!(mesh.attributes.len(), has(COLORS, 1));
                for attribute in &mesh.attributes {
                    assert_eq!((attribute.name.as_str(), attribute.channels), ("vertex_color", 3));
                    assert_eq!(attribute.domain, AttributeDomain::Vertex);
                    assert_eq!(attribute.values, (0..12).map(|v| v as f32).collect::<Vec<_>>());
                }
            }
        }
    }
}

#[test]
fn every_shape_of_a_file_can_be_read() {
    for version in [3, 4] {
        let mut second = shape(SINGLE | UVS);
        second.numbers[0] = 7.0;
        let payloads = [payload(&shape(SINGLE), version), payload(&second, version)];
        let bytes = file(version, &payloads);
        assert_eq!(serialized_shape_count(&bytes), Ok(2));
        let first_x = |index| read_serialized(&bytes, index).map(|mesh| mesh.positions[0].x);
        assert_eq!((first_x(0), first_x(1)), (Ok(0.0), Ok(7.0)));
        assert_eq!(kind(&bytes, 2), Some(MeshErrorKind::OutOfRange));
        assert_eq!(kind(&bytes, u32::MAX), Some(MeshErrorKind::OutOfRange));
    }
}

/// Some tools write no list of shapes, or that of the other version.
#[test]
fn files_with_another_list_or_none_give_their_shapes() {
    let whole = file_of(4, &shape(SINGLE));
    assert_eq!(has_shape_list(&whole), Ok(true));
    let cut = &whole[..whole.len() - 12];
    assert_eq!((has_shape_list(cut), serialized_shape_count(cut)), (Ok(false), Ok(1)));
    assert_eq!(read_serialized(cut, 0), read_serialized(&whole, 0));
    assert_eq!(kind(cut, 1), Some(MeshErrorKind::OutOfRange));

    let two = file(4, &[payload(&shape(SINGLE), 4), payload(&shape(SINGLE | UVS), 4)]);
    let list = two.len() - 20;
    let offset = |index: usize| two[list + 8 * index..list + 8 * index + 4].to_vec();
    let narrow =
        [two[..list].to_vec(), offset(0), offset(1), two[two.len() - 4..].to_vec()].concat();
    assert_eq!((has_shape_list(&narrow), serialized_shape_count(&narrow)), (Ok(true), Ok(2)));
    assert_eq!(read_serialized(&narrow, 1), read_serialized(&two, 1));
}

#[test]
fn flat_shapes_have_face_normals() {
    let shape = shape(SINGLE | NORMALS | UVS | COLORS | FACE_NORMALS);
    let mesh = read_serialized(&file_of(4, &shape), 0).expect("valid");
    assert_eq!(mesh.validate(), Ok(()));
    assert_eq!(mesh.positions.len(), 6);
    for face in 0..2 {
        let [a, b, c] = mesh.corners(face);
        for index in mesh.indices[face] {
            let normal = mesh.normals[index as usize];
            assert!((normal - (b - a).cross(c - a).normalize()).length() < 1e-6);
        }
    }
}

#[test]
fn false_counts_are_detected() {
    for version in [3, 4] {
        for (change, expected) in [
            ((|shape| shape.vertex_count = 5) as fn(&mut Shape), MeshErrorKind::Truncated),
            (|shape| shape.triangle_count = 3, MeshErrorKind::Truncated),
            (|shape| shape.vertex_count = 4_000_000_000, MeshErrorKind::Truncated),
            (|shape| shape.triangle_count = u64::MAX, MeshErrorKind::Truncated),
            (|shape| shape.vertex_count = 1 << 32, MeshErrorKind::Limit),
            (|shape| shape.vertex_count = u64::MAX, MeshErrorKind::Limit),
            (|shape| shape.flags |= NORMALS, MeshErrorKind::Truncated),
            (|shape| shape.flags |= DOUBLE, MeshErrorKind::Truncated),
            (|shape| shape.indices[4] = 4, MeshErrorKind::OutOfRange),
            (|shape| shape.numbers[3] = f64::NAN, MeshErrorKind::NonFinite),
            (|shape| shape.numbers[3] = 1e39, MeshErrorKind::NonFinite),
        ] {
            let mut shape = shape(SINGLE);
            change(&mut shape);
            // The data stays in single precision, even if the flags announce double precision.
            let flags = shape.flags.to_le_bytes();
            shape.flags = SINGLE;
            let mut payload = payload(&shape, version);
            payload[..4].copy_from_slice(&flags);
            assert_eq!(kind(&file(version, &[payload]), 0), Some(expected), "{version}");
        }
    }
}

#[test]
fn excess_data_in_the_stream_is_not_inflated() {
    let mut payload = payload(&shape(SINGLE), 4);
    payload.extend(vec![0; 64 << 20]);
    let mesh = read_serialized(&file(4, &[payload]), 0);
    assert_eq!(mesh.map(|mesh| mesh.positions.len()), Ok(4));
}

#[test]
fn unterminated_names_are_limited() {
    let mut payload = SINGLE.to_le_bytes().to_vec();
    payload.extend(vec![b'x'; 1 << 20]);
    assert_eq!(kind(&file(4, &[payload]), 0), Some(MeshErrorKind::Limit));
}

#[test]
fn corrupt_files_give_distinct_errors() {
    let good = file_of(4, &shape(SINGLE | UVS));
    let changed = |place: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[place] = byte;
        kind(&bytes, 0)
    };
    let end = good.len();
    // The checksum of the stream is right before the dictionary.
    assert_eq!(changed(end - 13, good[end - 13] ^ 1), Some(MeshErrorKind::Syntax));
    assert_eq!(changed(0, 0), Some(MeshErrorKind::Syntax));
    assert_eq!(changed(2, 5), Some(MeshErrorKind::Unsupported));
    assert_eq!(changed(4, 0), Some(MeshErrorKind::Syntax));
    // With a corrupt list of shapes, the first one is still known.
    for place in [end - 1, end - 4, end - 12, end - 5] {
        let mut bytes = good.clone();
        bytes[place] ^= 0x41;
        assert_eq!(kind(&bytes, 0), None, "{place}");
    }
    for empty in [&b""[..], b"\x1c", b"\x1c\x04\x04\x00"] {
        assert_eq!(kind(empty, 0), Some(MeshErrorKind::Truncated));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn truncated_or_corrupt_files_never_panic(
        version in 3_u16..5,
        flags in 0_u32..32,
        cut in any::<prop::sample::Index>(),
        place in any::<prop::sample::Index>(),
        byte in any::<u8>(),
    ) {
        let mut bytes = file_of(version, &shape(SINGLE | flags));
        let cut = cut.index(bytes.len());
        // The shape may be whole, without the list behind it.
        let whole = read_serialized(&bytes, 0);
        prop_assert!(read_serialized(&bytes[..cut], 0).is_err() || read_serialized(&bytes[..cut], 0) == whole);
        let place = place.index(bytes.len());
        bytes[place] = byte;
        let valid = |mesh: TriangleMesh| mesh.validate();
        prop_assert!(read_serialized(&bytes, 0).map_or(Ok(()), valid).is_ok());
    }

    #[test]
    fn noise_never_panics(
        noise in prop::collection::vec(any::<u8>(), 0..300),
        index in any::<u32>(),
    ) {
        let mut bytes = vec![0x1C, 0x04, 0x04, 0x00];
        bytes.extend(noise);
        prop_assert!(read_serialized(&bytes, index).is_err());
    }
}
