//! Compares the hierarchy with a test of every triangle, on random and degenerate geometry, for
//! every preset and tier.

mod common;

use common::{PRESETS, Random, TIERS, brute_force};
use etendue_bvh::{BuildError, BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
use etendue_math::Ray;
use glam::Vec3;

fn soup(random: &mut Random, count: usize, size: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = random.point() * 10.0;
        positions.extend((0..3).map(|_| center + random.point() * size));
    }
    (positions, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

fn agree(positions: &[Vec3], indices: &[[u32; 3]], rays: &[Ray]) -> usize {
    let mesh = TriangleMeshView { positions, indices };
    let mut hits = 0;
    for preset in PRESETS {
        let built = Bvh::build(&[GeometryView::Triangles(mesh)], &preset).expect("valid geometry");
        built.validate().expect("a sound hierarchy");
        for tier in TIERS {
            let bvh = built.clone().with_tier(tier);
            for ray in rays {
                let expected = brute_force(positions, indices, ray);
                let hit = bvh.intersect(ray, &NoPrimitives);
                assert_eq!(bvh.occluded(ray, &NoPrimitives), hit.is_some(), "{ray:?}");
                match (hit, expected) {
                    (None, None) => {}
                    (Some(hit), Some((t, margin))) => {
                        hits += 1;
                        assert!(
                            (hit.t - t as f32).abs() <= 2e-6 * t as f32 + 1e-6,
                            "{ray:?} {hit:?} {t} {margin}"
                        );
                    }
                    (hit, expected) => {
                        let margin = expected.map_or(0.0, |(_, margin)| margin);
                        assert!(
                            margin < 1e-5,
                            "{tier:?} {preset:?} {ray:?}: {hit:?}, {expected:?}"
                        );
                    }
                }
            }
        }
    }
    hits
}

#[test]
fn random_triangles_are_hit_as_by_brute_force() {
    let mut random = Random::new(1);
    for (count, size) in [(1, 5.0), (7, 5.0), (9, 4.0), (100, 2.0), (2000, 1.0)] {
        let (positions, indices) = soup(&mut random, count, size);
        let rays: Vec<Ray> = (0..200).map(|_| random.ray(10.0)).collect();
        let hits = agree(&positions, &indices, &rays);
        assert!(count < 100 || hits > 100, "{count}: {hits}");
    }
}

#[test]
fn nothing_is_hit_in_an_empty_hierarchy() {
    let bvh = Bvh::build(&[], &BuildOptions::default()).expect("empty is valid");
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    assert!(bvh.intersect(&ray, &NoPrimitives).is_none() && !bvh.occluded(&ray, &NoPrimitives));
    assert!(bvh.bounds().is_empty());
    bvh.validate().expect("sound");
}

#[test]
fn invalid_input_is_rejected_with_its_location() {
    let build = |positions: &[Vec3], indices: &[[u32; 3]]| {
        let mesh = TriangleMeshView { positions, indices };
        let fine = TriangleMeshView { positions: &[], indices: &[] };
        let list = [GeometryView::Triangles(fine), GeometryView::Triangles(mesh)];
        Bvh::build(&list, &BuildOptions::default()).map(|_| ())
    };
    let fine = [Vec3::ZERO, Vec3::X, Vec3::Y];
    assert_eq!(
        build(&fine, &[[0, 1, 2], [0, 1, 3]]),
        Err(BuildError::IndexOutOfRange { geometry: 1, primitive: 1, index: 3, vertex_count: 3 })
    );
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(
            build(&[Vec3::ZERO, Vec3::X, Vec3::new(0.0, bad, 0.0)], &[[0, 1, 2]]),
            Err(BuildError::NonFiniteVertex { geometry: 1, primitive: 0 })
        );
    }
}
