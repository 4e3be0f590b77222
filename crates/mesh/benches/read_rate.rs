//! How fast mesh files are read, on one thread:
//!
//! ```text
//! cargo bench -p etendue-mesh --bench read_rate -- [FILE...]
//! ```
//!
//! Files are told apart by their extension: `.obj`, `.ply`, and everything else is serialized.
//! Without files, a generated OBJ file of a hundred thousand triangles is read.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a program, not the core")]

use etendue_mesh::{
    MeshError, ObjOptions, TriangleMesh, read_obj, read_ply, read_serialized,
    serialized_shape_count,
};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The best of this many rounds is reported; the others were disturbed.
const ROUNDS: usize = 7;

fn main() -> ExitCode {
    let mut files = Vec::new();
    // Cargo passes `--bench` to every benchmark.
    for path in std::env::args().skip(1).filter(|argument| argument != "--bench") {
        match std::fs::read(&path) {
            Ok(bytes) => files.push((path, bytes)),
            Err(error) => {
                eprintln!("{path}: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    if files.is_empty() {
        files.push(("generated.obj".to_owned(), generated_obj(224).into_bytes()));
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
    println!("{} vertices and {} triangles in {} files", counts.0, counts.1, files.len());
    println!("{megabytes:.1} MB in {best:?}: {:.0} MB/s", megabytes / best.as_secs_f64());
    ExitCode::SUCCESS
}

/// A wavy square with `side`² quads.
fn generated_obj(side: u32) -> String {
    let mut text = String::new();
    for index in 0..(side + 1) * (side + 1) {
        let [x, z] = [index % (side + 1), index / (side + 1)].map(|k| k as f32 / side as f32);
        let y = 0.05 * (x * 9.0).sin() * (z * 7.0).cos();
        text += &format!("v {x} {y} {z}\nvt {x} {z}\nvn 0 1 0\n");
    }
    for quad in 0..side * side {
        let first = quad / side * (side + 1) + quad % side + 1;
        let corners = [first, first + 1, first + side + 2, first + side + 1];
        let [a, b, c, d] = corners.map(|corner| format!("{corner}/{corner}/{corner}"));
        text += &format!("f {a} {b} {c} {d}\n");
    }
    text
}

fn read(path: &str, bytes: &[u8]) -> Result<Vec<TriangleMesh>, MeshError> {
    if path.ends_with(".obj") {
        return read_obj(bytes, &ObjOptions::default()).map(|read| vec![read.mesh]);
    }
    if path.ends_with(".ply") {
        return read_ply(bytes).map(|read| vec![read.mesh]);
    }
    (0..serialized_shape_count(bytes)?).map(|index| read_serialized(bytes, index)).collect()
}
