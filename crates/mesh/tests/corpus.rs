//! Files with one defect each, named after it: all are refused, for the right reason, at once.
#![allow(clippy::disallowed_methods, reason = "the corpus is read from files")]

use etendue_mesh::MeshErrorKind::{
    self, Limit, NonFinite, OutOfRange, Syntax, Truncated, Unsupported,
};
use etendue_mesh::{MeshError, ObjOptions, read_obj, read_ply, read_serialized};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Every file of `tests/corpus`, and what is wrong with it.
const EXPECTED: &[(&str, MeshErrorKind)] = &[("position_index_zero.obj", OutOfRange)];

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

/// The error that reading a file gives, by its extension.
fn error_of(name: &str, bytes: &[u8]) -> Option<MeshError> {
    match name.rsplit_once('.')?.1 {
        "obj" => read_obj(bytes, &ObjOptions::default()).err(),
        "ply" => read_ply(bytes).err(),
        _ => read_serialized(bytes, 0).err(),
    }
}

#[test]
fn every_file_is_refused_for_its_reason() {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(corpus()).expect("the corpus is here") {
        let path = entry.expect("the corpus can be listed").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let bytes = std::fs::read(&path).expect("the corpus can be read");
        let error = error_of(&name, &bytes);
        // Errors in text formats say where they are.
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
