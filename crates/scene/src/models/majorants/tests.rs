//! Collisions follow the majorants, and the majorants bound the extinction.

use super::*;
use crate::volume::gridvolume::tests::random_grid;
use etendue_math::Transform;
use etendue_spectrum::Spectrum;
use etendue_testkit::{Accumulator, ChiSquare, TestRng, z_test};
use glam::{DMat4, DQuat, DVec3};
use std::sync::Arc;

/// A grid of random values, rotated and scaled in the world.
fn volume(size: [i32; 3]) -> Volume {
    let matrix = DMat4::from_scale_rotation_translation(
        DVec3::new(2.0, 1.0, 3.0),
        DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(-0.7),
        DVec3::new(-1.0, 0.5, 2.0),
    );
    let to_world = Transform::from_matrix(&matrix).expect("an inverse");
    Volume::Grid(Arc::new(random_grid(size, to_world)))
}

fn random_ray(random: &mut TestRng, bounds: &Bounds3) -> Ray {
    let point = |random: &mut TestRng| {
        let share = Vec3::new(random.next_f32(), random.next_f32(), random.next_f32());
        bounds.min + share * bounds.extent()
    };
    let (from, to) = (point(random), point(random));
    let direction = (to - from).normalize();
    Ray::new(from - direction * 7.0 * random.next_f32(), direction)
}

#[test]
fn nowhere_is_the_extinction_above_its_bound() {
    let mut random = TestRng::new(3);
    for size in [[1, 1, 1], [5, 9, 2], [31, 17, 12]] {
        let volume = volume(size);
        let majorants = Majorants::new(&volume, 2.0);
        let mut collisions = 0;
        for _ in 0..2000 {
            let ray = random_ray(&mut random, &volume.bounds());
            let mut tracker = majorants.track(&ray);
            while let Some(found) = tracker.advance(0.4 * random.next_f32()) {
                let extinction = 2.0 * volume.eval_scalar(ray.at(found.t));
                assert!(extinction <= found.majorant * 1.001 + 1e-5, "{extinction} {found:?}");
                assert!(found.majorant <= majorants.greatest());
                collisions += 1;
            }
        }
        assert!(collisions > 1000);
    }
}

/// Delta tracking's mean transmittance is exp(−∫ σt).
#[test]
fn as_many_rays_pass_as_should() {
    let mut random = TestRng::new(4);
    let volume = volume([13, 7, 10]);
    let majorants = Majorants::new(&volume, 1.5);
    for _ in 0..20 {
        let ray = random_ray(&mut random, &volume.bounds());
        let (start, end) = crossing(&volume.bounds(), &ray);
        let steps = 40_000;
        let length = f64::from(end - start) / f64::from(steps);
        let depth: f64 = (0..steps)
            .map(|step| {
                let t = f64::from(start) + (f64::from(step) + 0.5) * length;
                1.5 * f64::from(volume.eval_scalar(ray.at(t as f32))) * length
            })
            .sum();
        let mut passed = Accumulator::default();
        for _ in 0..20_000 {
            let mut tracker = majorants.track(&ray);
            let through = loop {
                let Some(found) = tracker.advance(-(1.0 - random.next_f32()).ln()) else {
                    break true;
                };
                let extinction = 1.5 * volume.eval_scalar(ray.at(found.t));
                if random.next_f32() * found.majorant < extinction {
                    break false;
                }
            };
            passed.add(if through { 1.0 } else { 0.0 });
        }
        let expected = (-depth).exp();
        let outcome = z_test(&passed, expected, expected * (1.0 - expected));
        assert!(outcome.accepts(1e-4), "{} instead of {expected}", passed.mean());
    }
}

/// In a homogeneous medium the distances to collisions are exponential.
#[test]
fn distances_follow_the_exponential_law() {
    let volume = Volume::Constant(crate::volume::constvolume::ConstVolume::new(
        Spectrum::splat(2.0),
        &Transform::IDENTITY,
    ));
    let majorants = Majorants::new(&volume, 0.9);
    let ray = Ray::new(Vec3::new(0.5, 0.5, -1.0), Vec3::Z);
    ChiSquare::default()
        .line(
            (1.0, 2.0),
            |random| {
                let depth = -(1.0 - random.next_f32()).ln();
                majorants.track(&ray).advance(depth).map(|found| found.t)
            },
            |t| 1.8 * (-1.8 * (t - 1.0)).exp(),
        )
        .assert();
}

#[test]
fn rays_that_miss_or_end_before_meet_nothing() {
    let majorants = Majorants::new(&Volume::constant(Spectrum::ONE), 1e3);
    let cases = [
        Ray::new(Vec3::new(0.5, 0.5, 2.0), Vec3::Z),
        Ray::new(Vec3::new(1.5, 0.5, -1.0), Vec3::Z),
        Ray::segment(Vec3::new(0.5, 0.5, -1.0), Vec3::Z, 0.9),
        Ray::new(Vec3::splat(f32::NAN), Vec3::Z),
    ];
    for ray in cases {
        assert_eq!(majorants.track(&ray).advance(0.1), None, "{ray:?}");
    }
    let empty = Majorants::new(&Volume::constant(Spectrum::ZERO), 1.0);
    assert_eq!(empty.track(&Ray::new(Vec3::splat(0.5), Vec3::X)).advance(0.0), None);
}

#[test]
fn limited_bounds_are_the_lesser_ones() {
    let volume = volume([5, 9, 2]);
    let (majorants, limited) =
        (Majorants::new(&volume, 2.0), Majorants::new(&volume, 2.0).limited(0.7));
    assert!(majorants.greatest() > 0.7);
    assert_eq!(limited.greatest(), 0.7);
    let blocks = |majorants: &Majorants| majorants.blocks.clone().expect("a grid").values;
    for (value, limited) in blocks(&majorants).into_iter().zip(blocks(&limited)) {
        assert_eq!(limited, value.min(0.7));
    }
}
