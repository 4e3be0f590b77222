//! Files with one defect each, which their name states. All are rejected quickly, for the right
//! reason.
#![allow(clippy::disallowed_methods, reason = "the corpus is read from files")]

use etendue_mesh::MeshErrorKind::{
    self, Limit, NonFinite, OutOfRange, Syntax, Truncated, Unsupported,
};
use etendue_mesh::{MeshError, ObjOptions, read_obj, read_ply, read_serialized};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Every file of `tests/corpus`, and the error it gives.
const EXPECTED: &[(&str, MeshErrorKind)] = &[
    ("continuation_at_end_of_file.obj", Syntax),
    ("decimal_comma.obj", Syntax),
    ("exponent_of_forty_digits.obj", NonFinite),
    ("exponent_without_digits.obj", Syntax),
    ("face_with_three_slashes.obj", Syntax),
    ("index_of_twenty_digits.obj", Syntax),
    ("index_wraps_32_bits.obj", OutOfRange),
    ("negative_index_before_start.obj", OutOfRange),
    ("not_text_at_all.obj", Syntax),
    ("position_index_beyond_end.obj", OutOfRange),
    ("position_index_zero.obj", OutOfRange),
    ("position_not_a_number.obj", NonFinite),
    ("position_of_two_numbers.obj", Syntax),
    ("position_overflows_single_precision.obj", NonFinite),
    ("corner_beyond_last_vertex.ply", OutOfRange),
    ("corner_count_negative.ply", Syntax),
    ("corner_count_of_two_billion.ply", Truncated),
    ("corner_negative.ply", OutOfRange),
    ("corners_are_reals.ply", Unsupported),
    ("data_cut_in_a_face.ply", Truncated),
    ("data_cut_in_a_vertex.ply", Truncated),
    ("element_count_negative.ply", Syntax),
    ("element_count_of_thirty_digits.ply", Syntax),
    ("face_values_multiplied_by_corners.ply", Limit),
    ("faces_without_corners.ply", Unsupported),
    ("format_unknown.ply", Unsupported),
    ("four_billion_vertices.ply", Truncated),
    ("four_billion_vertices_in_text.ply", Truncated),
    ("header_without_end.ply", Truncated),
    ("header_without_format.ply", Syntax),
    ("list_of_other_element_never_ends.ply", Truncated),
    ("magic_missing.ply", Syntax),
    ("more_vertices_than_an_index_counts.ply", Limit),
    ("position_infinite.ply", NonFinite),
    ("property_before_element.ply", Syntax),
    ("property_list_of_real_length.ply", Syntax),
    ("property_of_unknown_type.ply", Syntax),
    ("row_count_times_size_overflows.ply", Truncated),
    ("ten_to_the_18_faces.ply", Truncated),
    ("two_thousand_elements.ply", Limit),
    ("vertex_is_a_word.ply", Syntax),
    ("vertices_without_z.ply", Unsupported),
    ("checksum_wrong.serialized", Syntax),
    ("corner_beyond_last_vertex.serialized", OutOfRange),
    ("identifier_wrong.serialized", Syntax),
    ("inflates_to_less_than_announced.serialized", Truncated),
    ("more_vertices_than_an_index_counts.serialized", Limit),
    ("name_of_a_megabyte.serialized", Limit),
    ("not_zlib.serialized", Syntax),
    ("position_not_a_number.serialized", NonFinite),
    ("stream_cut.serialized", Truncated),
    ("version_of_the_future.serialized", Unsupported),
    ("zip_bomb_of_four_billion_vertices.serialized", Truncated),
    ("zip_bomb_of_two_to_the_64_triangles.serialized", Truncated),
];

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

/// The error from reading a file, by its extension.
fn error_of(name: &str, bytes: &[u8]) -> Option<MeshError> {
    match name.rsplit_once('.')?.1 {
        "obj" => read_obj(bytes, &ObjOptions::default()).err(),
        "ply" => read_ply(bytes).err(),
        _ => read_serialized(bytes, 0).err(),
    }
}

#[test]
fn every_file_is_rejected_for_its_defect() {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(corpus()).expect("the corpus is here") {
        let path = entry.expect("the corpus can be listed").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let bytes = std::fs::read(&path).expect("the corpus can be read");
        let error = error_of(&name, &bytes);
        // Errors in text formats have a line.
        if let Some(error) = &error
            && name.ends_with(".obj")
            && name != "not_text_at_all.obj"
        {
            assert!(error.line.is_some(), "{name}: {error}");
        }
        found.insert(name, error.map(|error| error.kind));
    }
    let expected = EXPECTED.iter().map(|&(name, kind)| (name.to_owned(), Some(kind)));
    assert_eq!(found, expected.collect());
}
