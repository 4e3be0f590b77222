//! How fast OBJ files are read: `obj_rate FILE...` reads all of them, several times, on one thread.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a program, not the core")]

use etendue_mesh::{ObjOptions, read_obj};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The best of so many rounds is reported: the others were disturbed.
const ROUNDS: usize = 5;

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
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let mut counts = (0, 0);
        for (path, bytes) in &files {
            match read_obj(bytes, &ObjOptions::default()) {
                Ok(read) => {
                    counts.0 += read.mesh.positions.len();
                    counts.1 += read.mesh.indices.len();
                }
                Err(error) => println!("{path}: {error}"),
            }
        }
        best = best.min(start.elapsed());
        println!("{} vertices, {} triangles in {:?}", counts.0, counts.1, start.elapsed());
    }
    let megabytes = byte_count as f64 / 1e6;
    println!("{megabytes:.1} MB in {best:?}: {:.0} MB/s", megabytes / best.as_secs_f64());
    ExitCode::SUCCESS
}
