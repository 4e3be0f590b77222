//! The five kinds of rays, and the clock.

use etendue_bvh::{Bvh, NoPrimitives};
use etendue_math::{Ray, coordinate_system};
use glam::{Mat4, Vec3};

/// What rays are for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// A pinhole camera's, 1920 × 1080, line by line.
    Primary,
    /// One from each primary hit, distributed by the cosine.
    Bounce,
    /// From anywhere in the bounds in any direction.
    Random,
    /// From each primary hit to a point light.
    Shadow,
    /// Between two points anywhere in the bounds.
    Segments,
}

impl Kind {
    pub(crate) const ALL: [Self; 5] =
        [Self::Primary, Self::Bounce, Self::Random, Self::Shadow, Self::Segments];

    /// Whether any hit will do.
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
    /// The rays through the scene of `bvh`, which finds the primary hits.
    pub(crate) fn new(bvh: &Bvh) -> Self {
        let primary = primary_rays();
        let bounds = bvh.bounds();
        let light = bounds.center() + Vec3::Y * bounds.extent().y * 0.3;
        let mut random = Random(7);
        let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
        for ray in &primary {
            let Some(hit) = bvh.intersect(ray, &NoPrimitives) else { continue };
            // The surface's side that faces the camera; which normal exactly does not matter to
            // the work, so the direction towards the camera stands in for it.
            let normal = -ray.direction.normalize();
            let origin = ray.at(hit.t) + normal * 1e-3;
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

fn primary_rays() -> Vec<Ray> {
    let to_world = Mat4::from_cols_array(&[
        -0.89874, -0.0182716, -0.4381, 1.211, 0.0, 0.999131, -0.0416703, 1.80475, 0.438481,
        -0.0374507, -0.89796, 3.85239, 0.0, 0.0, 0.0, 1.0,
    ])
    .transpose();
    let half_width = 30_f32.to_radians().tan();
    let step = 2.0 * half_width / WIDTH as f32;
    let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let right = half_width - (x as f32 + 0.5) * step;
            let up = (HEIGHT as f32 * 0.5 - (y as f32 + 0.5)) * step;
            let direction = to_world.transform_vector3(Vec3::new(right, up, 1.0)).normalize();
            Ray::new(to_world.transform_point3(Vec3::ZERO), direction)
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

/// The processor time of this thread.
pub(crate) fn thread_seconds() -> f64 {
    #[repr(C)]
    struct Time {
        seconds: i64,
        nanoseconds: i64,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut Time) -> i32;
    }
    const THREAD_CPU_TIME: i32 = 3;
    let mut time = Time { seconds: 0, nanoseconds: 0 };
    // SAFETY: the C library of 64-bit Linux has this function, and `time` is a timespec there.
    unsafe { clock_gettime(THREAD_CPU_TIME, &mut time) };
    time.seconds as f64 + time.nanoseconds as f64 * 1e-9
}
