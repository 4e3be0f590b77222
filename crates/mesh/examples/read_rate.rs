//! How fast meshes are read: `read_rate FILE...` reads all of them, several times, on one thread.
//!
//! Files are told apart by their extension: `.obj`, `.ply`, and everything else is serialized.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a program, not the core")]

use etendue_mesh::{
    MeshError, ObjOptions, TriangleMesh, read_obj, read_ply, read_serialized,
    serialized_shape_count,
};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The best of so many rounds is reported: the others were disturbed.
const ROUNDS: usize = 7;

fn main() -> ExitCode {
    let mut files = Vec::new();
    for path in std::env::args().skip(1) {
        match std::fs::read(&path) {
            Ok(bytes) => files.push((path, bytes)),
            Err(error) => {
                eprintln!("{path}: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    let byte_count: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    let mut best = Duration::MAX;
    let mut counts = (0, 0);
    for _ in 0..ROUNDS {
        let start = Instant::now();
        counts = (0, 0);
        for (path, bytes) in &files {
            match read(path, bytes) {
                Ok(meshes) => {
                    counts.0 += meshes.iter().map(|mesh| mesh.positions.len()).sum::<usize>();
                    counts.1 += meshes.iter().map(|mesh| mesh.indices.len()).sum::<usize>();
                }
                Err(error) => println!("{path}: {error}"),
            }
        }
        best = best.min(start.elapsed());
    }
    let megabytes = byte_count as f64 / 1e6;
    println!("{} vertices and {} triangles of {} files", counts.0, counts.1, files.len());
    println!("{megabytes:.1} MB in {best:?}: {:.0} MB/s", megabytes / best.as_secs_f64());
    ExitCode::SUCCESS
}

fn read(path: &str, bytes: &[u8]) -> Result<Vec<TriangleMesh>, MeshError> {
    if path.ends_with(".obj") {
        return read_obj(bytes, &ObjOptions::default()).map(|read| vec![read.mesh]);
    }
    if path.ends_with(".ply") {
        return read_ply(bytes).map(|mesh| vec![mesh]);
    }
    (0..serialized_shape_count(bytes)?).map(|index| read_serialized(bytes, index)).collect()
}
