//! Shared by the integration tests: random numbers, rays, and the oracle.
#![allow(dead_code, reason = "each test binary uses a part")]

use etendue_bvh::{BuildOptions, Tier};
use etendue_math::Ray;
use glam::{DVec3, Vec3};

/// Every preset.
pub const PRESETS: [BuildOptions; 3] =
    [BuildOptions::FAST, BuildOptions::BALANCED, BuildOptions::SPATIAL];

/// Every tier; those that the machine lacks fall back to the one that it has.
pub const TIERS: [Tier; 2] = [Tier::Portable, Tier::Avx2];

/// A small generator (SplitMix64), so that the tests repeat.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    /// Uniform in [-1, 1)³.
    pub fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// From anywhere within `reach` of the origin, in any direction, of any length.
    pub fn ray(&mut self, reach: f32) -> Ray {
        Ray::new(self.point() * reach, self.point())
    }
}

/// The nearest hit of all triangles by double precision, and how far inside the triangle it is in
/// units of its barycentric coordinates.
pub fn brute_force(positions: &[Vec3], indices: &[[u32; 3]], ray: &Ray) -> Option<(f64, f64)> {
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
