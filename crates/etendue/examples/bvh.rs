//! The bounding volume hierarchy on its own: builds a tree over a sphere of triangles and traces
//! rays.
#![allow(clippy::disallowed_macros, reason = "an example prints")]

use std::error::Error;
use std::f32::consts::{PI, TAU};

use etendue::bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
use etendue::math::Ray;
use etendue::math::glam::Vec3;

/// Rings of vertices from pole to pole, with two triangles for each quad between them.
fn sphere(rings: u32, columns: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let vertex = |ring: u32, column: u32| {
        let (polar, azimuth) =
            (PI * ring as f32 / rings as f32, TAU * column as f32 / columns as f32);
        Vec3::new(polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin())
    };
    let positions =
        (0..=rings).flat_map(|ring| (0..columns).map(move |column| vertex(ring, column)));
    let squares = (0..rings).flat_map(|ring| (0..columns).map(move |column| (ring, column)));
    let triangles = squares.flat_map(|(ring, column)| {
        let (left, right) = (ring * columns + column, ring * columns + (column + 1) % columns);
        [[left, right, left + columns], [right, right + columns, left + columns]]
    });
    (positions.collect(), triangles.collect())
}

fn main() -> Result<(), Box<dyn Error>> {
    let (positions, indices) = sphere(64, 128);
    let mesh = TriangleMeshView { positions: &positions, indices: &indices };
    // The tree copies what it needs, so the mesh can be dropped.
    let bvh = Bvh::build(&[GeometryView::Triangles(mesh)], &BuildOptions::default())?;

    // All primitives are triangles, so no callback for other shapes is needed.
    let towards = Ray::new(Vec3::new(0.1, 0.2, -3.0), Vec3::Z);
    let hit = bvh.intersect(&towards, &NoPrimitives).ok_or("the ray points at the sphere")?;
    println!(
        "triangle {} at distance {:.4}, barycentric ({:.3}, {:.3})",
        hit.primitive, hit.t, hit.u, hit.v
    );

    let past = Ray::new(Vec3::new(0.0, 1.5, -3.0), Vec3::Z);
    println!("a ray past the sphere is occluded: {}", bvh.occluded(&past, &NoPrimitives));

    // Tracing many rays at once is faster if they are coherent.
    let rays: Vec<Ray> = (0..10_000)
        .map(|index| {
            let (x, y) = ((index % 100) as f32, (index / 100) as f32);
            Ray::new(Vec3::new(x / 50.0 - 1.0, y / 50.0 - 1.0, -3.0), Vec3::Z)
        })
        .collect();
    let mut hits = Vec::new();
    bvh.intersect_many(&rays, &NoPrimitives, &mut hits);
    let share = hits.iter().flatten().count() as f32 / rays.len() as f32;
    println!("{share:.3} of a square is covered by a disk; π/4 is {:.3}", PI / 4.0);
    Ok(())
}
