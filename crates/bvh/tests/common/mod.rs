//! Shared by the integration tests: random numbers, rays, and the brute-force test.
#![allow(dead_code, reason = "each test binary uses a part")]

use etendue_bvh::{BuildOptions, Tier};
use etendue_math::Ray;
use glam::{DVec3, Vec3};

/// Every preset.
pub(crate) const PRESETS: [BuildOptions; 3] =
    [BuildOptions::FAST, BuildOptions::BALANCED, BuildOptions::SPATIAL];

/// Every tier; the machine's own tier replaces those that it does not support.
pub(crate) const TIERS: [Tier; 3] = [Tier::Portable, Tier::Avx2, Tier::Avx512];

/// A small generator (SplitMix64) with a fixed sequence.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    /// Uniform in [-1, 1)³.
    pub(crate) fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// A ray of any length and direction, from within `reach` of the origin.
    pub(crate) fn ray(&mut self, reach: f32) -> Ray {
        Ray::new(self.point() * reach, self.point())
    }
}

/// The nearest hit of all triangles in double precision, and its distance from the edge of the
/// triangle in barycentric coordinates.
pub(crate) fn brute_force(
    positions: &[Vec3],
    indices: &[[u32; 3]],
    ray: &Ray,
) -> Option<(f64, f64)> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let mut nearest: Option<(f64, f64)> = None;
    for triangle in indices {
        let [a, b, c] = triangle.map(|index| positions[index as usize].as_dvec3());
        let Some((t, margin)) = exact(origin, direction, [a, b, c]) else { continue };
        if t < f64::from(ray.t_max) && nearest.is_none_or(|(old, _)| t < old) {
            nearest = Some((t, margin));
        }
    }
    nearest
}

/// Möller and Trumbore's test in double precision.
fn exact(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, f64)> {
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = origin - a;
    let u = s.dot(p) / determinant;
    let q = s.cross(e1);
    let v = direction.dot(q) / determinant;
    let t = e2.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then(|| (t, u.min(v).min(1.0 - u - v)))
}

/// A closed mesh: a subdivided octahedron whose vertices are moved inwards by up to `roughness`,
/// scaled and translated.
pub(crate) struct ClosedMesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
    /// A point inside from which the whole surface is visible.
    pub(crate) inside: Vec3,
    /// The approximate distance from there to the surface.
    pub(crate) scale: f32,
}

impl ClosedMesh {
    pub(crate) fn new(
        random: &mut Random,
        levels: u32,
        roughness: f32,
        scale: f32,
        at: Vec3,
    ) -> Self {
        let mut positions = vec![Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let mut indices = vec![
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        for _ in 0..levels {
            indices = subdivide(&mut positions, &indices);
        }
        for position in &mut positions {
            let radius = 1.0 - roughness * random.unit();
            *position = position.normalize() * radius * scale + at;
        }
        Self { positions, indices, inside: at, scale }
    }

    /// A ray from near `inside` to an edge or vertex of the mesh, or close to one.
    pub(crate) fn aimed_ray(&self, random: &mut Random) -> Ray {
        let triangle = self.indices[random.bits() as usize % self.indices.len()];
        let [a, b, c] = triangle.map(|index| self.positions[index as usize]);
        let target = match random.bits() % 8 {
            0 | 1 => a,
            2 => (a + b) * 0.5,
            3..=6 => a.lerp(b, random.unit()),
            _ => a.lerp(b, random.unit()).lerp(c, 1e-6 * random.unit()),
        };
        let origin = match random.bits() % 3 {
            0 => self.inside,
            1 => self.inside + random.point() * (0.05 * self.scale),
            // Aligned with the target, for directions with zero components.
            _ => {
                let mut origin = self.inside;
                let axis = (random.bits() % 3) as usize;
                let near = (target[axis] - origin[axis]).abs() < 0.3 * self.scale;
                origin[axis] = if near { target[axis] } else { origin[axis] };
                origin
            }
        };
        let length = 2.0_f32.powi((random.bits() % 5) as i32 * 10 - 20);
        Ray::new(origin, (target - origin) / self.scale * length)
    }
}

fn subdivide(positions: &mut Vec<Vec3>, indices: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((positions[a as usize] + positions[b as usize]).normalize());
            positions.len() as u32 - 1
        })
    };
    let mut finer = Vec::new();
    for &[a, b, c] in indices {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    finer
}

/// The meshes for the tests of watertightness.
pub(crate) fn closed_meshes(random: &mut Random) -> Vec<ClosedMesh> {
    let mut meshes = Vec::new();
    for (scale, distance) in [
        (1.0, 0.0),
        (1.0, 1e2),
        (10.0, 1e5),
        (1000.0, 1e5),
        (1e-5, 0.0),
        (1e-3, 10.0),
        (1e5, 0.0),
        (1e12, 0.0),
        (1e-12, 0.0),
    ] {
        let at = Vec3::new(1.0, -0.7, 0.4) * distance;
        meshes.push(ClosedMesh::new(random, 3, 0.0, scale, at));
        meshes.push(ClosedMesh::new(random, 4, 0.4, scale, at));
    }
    meshes
}
