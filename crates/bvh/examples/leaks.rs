//! Looks for rays that slip between triangles: `leaks [COUNT]` aims that many rays (a million, if
//! not given) from inside of closed meshes at their edges and vertices and counts those that leave.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "a program on the command line"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Random, closed_meshes};
use etendue_bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let count: usize = std::env::args().nth(1).map_or(Ok(1_000_000), |count| count.parse())?;
    let mut random = Random::new(1);
    let meshes = closed_meshes(&mut random);
    let (mut rays, mut leaks) = (0_usize, 0_usize);
    for mesh in &meshes {
        let (positions, indices) = (&mesh.positions, &mesh.indices);
        let view = GeometryView::Triangles(TriangleMeshView { positions, indices });
        let bvh = Bvh::build(&[view], &BuildOptions::default())?;
        for _ in 0..count.div_ceil(meshes.len()) {
            let ray = mesh.aimed_ray(&mut random);
            rays += 1;
            if bvh.intersect(&ray, &NoPrimitives).is_none() {
                leaks += 1;
                println!("leak at scale {}: {ray:?}", mesh.scale);
            }
        }
    }
    println!("{rays} rays, {leaks} leaks");
    if leaks == 0 { Ok(()) } else { Err("rays leaked".into()) }
}
