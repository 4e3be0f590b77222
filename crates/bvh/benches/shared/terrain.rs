//! Generated hills, for benchmarks that have no scene.

use glam::Vec3;

/// Hills over the unit square with `side`² quads.
pub(crate) fn terrain(side: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let height = |x: f32, z: f32| {
        0.05 * (x * 9.0).sin() * (z * 7.0).cos() + 0.01 * (x * 61.0 + (z * 53.0).sin() * 3.0).sin()
    };
    let positions = (0..=side)
        .flat_map(|z| (0..=side).map(move |x| (x, z)))
        .map(|(x, z)| {
            let (x, z) = (x as f32 / side as f32, z as f32 / side as f32);
            Vec3::new(x, height(x, z), z)
        })
        .collect();
    (positions, grid(side, side))
}

/// Two triangles for every quad of a grid of vertices.
pub(crate) fn grid(width: u32, height: u32) -> Vec<[u32; 3]> {
    let quads = (0..height).flat_map(|y| (0..width).map(move |x| y * (width + 1) + x));
    quads.flat_map(|a| [[a, a + 1, a + width + 1], [a + 1, a + width + 2, a + width + 1]]).collect()
}
