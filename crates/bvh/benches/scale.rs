//! Build time, ray rate and memory by scene size: one row of `cargo xtask bench scale`.
//!
//! ```text
//! cargo bench -p etendue-bvh --bench scale -- triangles|instances COUNT THREADS
//! ```
//!
//! builds a generated scene with that many triangles, or that many instances of a group of ten
//! thousand triangles, and traces rays on all threads. The row holds build seconds, millions of rays
//! per second, megabytes of the tree, peak megabytes of the process, and hits. Without arguments it
//! measures a hundred thousand triangles on one thread.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "a program on the command line"
)]

#[path = "shared/terrain.rs"]
mod terrain;

use etendue_bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
use etendue_math::Ray;
use glam::{Affine3A, Quat, Vec3};
use rayon::prelude::*;
use std::error::Error;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;
use std::time::Instant;
use terrain::{grid, terrain};

/// The number of rays per measurement, and the number of measurements.
const RAYS: u32 = 1 << 20;
const ROUNDS: usize = 3;

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    // Cargo passes `--bench` to every benchmark.
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (kind, count, threads) = match arguments.as_slice() {
        [] => ("triangles", 100_000, 1),
        [kind, count, threads] => (*kind, count.parse()?, threads.parse()?),
        _ => return Err("usage: scale [triangles|instances COUNT THREADS]".into()),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    pool.install(|| match kind {
        "triangles" => triangles(count),
        "instances" => instances(count),
        _ => Err(format!("`{kind}` is neither triangles nor instances").into()),
    })
}

fn triangles(count: usize) -> Result<(), Box<dyn Error + Send + Sync>> {
    let (positions, indices) = terrain(((count / 2) as f64).sqrt().round().max(1.0) as u32);
    let start = Instant::now();
    let bvh = Bvh::build(&[view(&positions, &indices)], &BuildOptions::default())?;
    report(&bvh, bvh.memory_bytes(), start.elapsed().as_secs_f64());
    Ok(())
}

fn instances(count: usize) -> Result<(), Box<dyn Error + Send + Sync>> {
    let (positions, indices) = ball();
    let start = Instant::now();
    let group = Arc::new(Bvh::build(&[view(&positions, &indices)], &BuildOptions::default())?);
    let side = (count as f64).sqrt().ceil() as usize;
    let views: Vec<GeometryView<'_>> = (0..count)
        .map(|index| {
            let place = Vec3::new((index % side) as f32, 0.0, (index / side) as f32) * 2.0;
            let turn = Quat::from_rotation_y(noise(index as u32) * TAU);
            let to_world = Affine3A::from_rotation_translation(turn, place);
            GeometryView::Instance { group: Arc::clone(&group), to_world }
        })
        .collect();
    let bvh = Bvh::build(&views, &BuildOptions::default())?;
    drop(views);
    let bytes = bvh.memory_bytes() + group.memory_bytes();
    report(&bvh, bytes, start.elapsed().as_secs_f64());
    Ok(())
}

fn view<'a>(positions: &'a [Vec3], indices: &'a [[u32; 3]]) -> GeometryView<'a> {
    GeometryView::Triangles(TriangleMeshView { positions, indices })
}

/// A bumpy ball of ten thousand triangles.
fn ball() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (around, along) = (100, 50);
    let positions = (0..=along)
        .flat_map(|v| (0..=around).map(move |u| (u, v)))
        .map(|(u, v)| {
            let (phi, theta) = (u as f32 / around as f32 * TAU, v as f32 / along as f32 * PI);
            let radius = 0.8 + 0.1 * (5.0 * phi).sin() * theta.sin();
            radius * Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
        })
        .collect();
    (positions, grid(around, along))
}

/// A pseudorandom number in [0, 1) for each index.
fn noise(index: u32) -> f32 {
    let mut bits = index.wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
    for _ in 0..2 {
        bits = (bits ^ bits >> 15).wrapping_mul(0x2c1b_3c6d);
    }
    (bits >> 8) as f32 / 16_777_216.0
}

/// Traces slanted rays from above and prints the row.
fn report(bvh: &Bvh, bytes: usize, build_seconds: f64) {
    let bounds = bvh.bounds();
    let (low, size) = (bounds.min, bounds.extent());
    let reach = size.max_element();
    let ray = |index: u32| {
        let at = |k: u32| noise(5 * index + k);
        let target = low + size * Vec3::new(at(0), at(1), at(2));
        let (phi, height) = (at(3) * TAU, 0.2 + 0.8 * at(4));
        let across = (1.0 - height * height).sqrt();
        let direction = -Vec3::new(across * phi.cos(), height, across * phi.sin());
        Ray::new(target - direction * reach, direction)
    };
    let (mut best, mut hits) = (f64::INFINITY, 0);
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let hit = |&index: &u32| bvh.intersect(&ray(index), &NoPrimitives).is_some();
        hits = (0..RAYS).into_par_iter().with_min_len(4096).filter(hit).count();
        best = best.min(start.elapsed().as_secs_f64());
    }
    let rate = f64::from(RAYS) * 1e-6 / best;
    let (bytes, peak) = (bytes as f64 * 1e-6, peak_megabytes());
    println!("{build_seconds:.4} {rate:.3} {bytes:.1} {peak:.1} {hits}");
}

/// The peak resident set of this process; NaN on systems other than Linux.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes =
        line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes * 1.024e-3)
}
