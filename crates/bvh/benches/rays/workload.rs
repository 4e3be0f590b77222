//! The five kinds of rays.

use crate::triangles::{Camera, Mesh};
use etendue_bvh::{Bvh, NoPrimitives};
use etendue_math::{Ray, coordinate_system};
use glam::Vec3;

/// The kinds of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// From a pinhole camera, 1920 × 1080, row by row.
    Primary,
    /// One from each primary hit, with a cosine distribution.
    Bounce,
    /// From uniform points in the bounds, in uniform directions.
    Random,
    /// From each primary hit to a point light.
    Shadow,
    /// Between two uniform points in the bounds.
    Segments,
}

impl Kind {
    pub(crate) const ALL: [Self; 5] =
        [Self::Primary, Self::Bounce, Self::Random, Self::Shadow, Self::Segments];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Random => "random",
            Self::Shadow => "shadow",
            Self::Segments => "segments",
        }
    }

    /// Whether the query is for any hit.
    pub(crate) fn is_any_hit(self) -> bool {
        matches!(self, Self::Shadow | Self::Segments)
    }
}

/// The rays of every kind.
pub(crate) struct Workload([Vec<Ray>; Kind::ALL.len()]);

const WIDTH: usize = 1920;
const HEIGHT: usize = 1080;
const RANDOM: usize = 2_000_000;

impl Workload {
    /// Generates the rays through a scene; `bvh` finds the primary hits.
    pub(crate) fn new(camera: &Camera, meshes: &[Mesh], bvh: &Bvh) -> Self {
        let primary = primary_rays(camera);
        let bounds = bvh.bounds();
        let light = bounds.center() + Vec3::Y * bounds.extent().y * 0.3;
        let mut random = Random(7);
        let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
        for ray in &primary {
            let Some(hit) = bvh.intersect(ray, &NoPrimitives) else { continue };
            let mesh = &meshes[hit.geometry as usize];
            let [a, b, c] =
                mesh.indices[hit.primitive as usize].map(|index| mesh.positions[index as usize]);
            let normal = (b - a).cross(c - a).normalize_or(Vec3::Z);
            let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
            // Far enough for the rounding of either tracer.
            let origin = ray.at(hit.t) + normal * (1e-4 * bounds.extent().max_element());
            bounce.push(Ray::new(origin, random.cosine(normal)));
            shadow.push(Ray::segment(origin, light - origin, 1.0));
        }
        let mut inside = || bounds.min + bounds.extent() * random.point();
        let between: Vec<(Vec3, Vec3)> = (0..RANDOM).map(|_| (inside(), inside())).collect();
        let mut directions = Random(8);
        let anywhere = between.iter().map(|pair| Ray::new(pair.0, directions.sphere())).collect();
        let segments =
            between.iter().map(|pair| Ray::segment(pair.0, pair.1 - pair.0, 1.0)).collect();
        Self([primary, bounce, anywhere, shadow, segments])
    }

    pub(crate) fn rays(&self, kind: Kind) -> &[Ray] {
        &self.0[kind as usize]
    }
}

fn primary_rays(camera: &Camera) -> Vec<Ray> {
    let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let [x, y] = [(x as f32 + 0.5) / WIDTH as f32, (y as f32 + 0.5) / HEIGHT as f32];
            let [origin, direction] = camera.ray(x, y);
            Ray::new(origin, direction)
        })
        .collect()
}

/// A small generator (SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / 16_777_216.0
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }

    fn sphere(&mut self) -> Vec3 {
        let (z, angle) = (1.0 - 2.0 * self.unit(), self.unit() * std::f32::consts::TAU);
        let radius = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
    }

    fn cosine(&mut self, normal: Vec3) -> Vec3 {
        let (radius, angle) = (self.unit().sqrt(), self.unit() * std::f32::consts::TAU);
        let (s, t) = coordinate_system(normal);
        let up = (1.0 - radius * radius).max(0.0).sqrt();
        (s * angle.cos() + t * angle.sin()) * radius + normal * up
    }
}
