//! No ray leaves a closed mesh: rays are aimed from inside at edges and vertices, at many scales and
//! distances from the origin.

mod common;

use common::{ClosedMesh, PRESETS, Random, TIERS, closed_meshes};
use etendue_bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
use rayon::prelude::*;

fn build(mesh: &ClosedMesh, options: &BuildOptions) -> Bvh {
    let (positions, indices) = (&mesh.positions, &mesh.indices);
    let view = GeometryView::Triangles(TriangleMeshView { positions, indices });
    Bvh::build(&[view], options).expect("the mesh is valid")
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mut random = Random::new(11);
    for mesh in closed_meshes(&mut random) {
        for preset in PRESETS {
            let built = build(&mesh, &preset);
            for tier in TIERS {
                let bvh = built.clone().with_tier(tier);
                for _ in 0..5_000 {
                    let ray = mesh.aimed_ray(&mut random);
                    let hit = bvh.intersect(&ray, &NoPrimitives);
                    assert!(hit.is_some(), "{tier:?} {preset:?} scale {}: {ray:?}", mesh.scale);
                    assert!(bvh.occluded(&ray, &NoPrimitives), "{tier:?} {preset:?}: {ray:?}");
                }
            }
        }
    }
}

/// The same with a hundred million rays, which takes about a minute on two cores.
#[test]
#[ignore = "slow; `cargo test -- --include-ignored` runs it"]
fn no_ray_of_a_hundred_million_leaves_a_closed_mesh() {
    const RAYS: u64 = 100_000_000;
    const RAYS_PER_SEED: u64 = 10_000;
    let meshes = closed_meshes(&mut Random::new(1));
    let trees: Vec<Bvh> = meshes.iter().map(|mesh| build(mesh, &BuildOptions::default())).collect();
    let leaks = (0..RAYS / RAYS_PER_SEED).into_par_iter().filter_map(|seed| {
        let mut random = Random::new(seed);
        let index = seed as usize % meshes.len();
        (0..RAYS_PER_SEED).find_map(|_| {
            let ray = meshes[index].aimed_ray(&mut random);
            let leaves = trees[index].intersect(&ray, &NoPrimitives).is_none();
            leaves.then_some((meshes[index].scale, ray))
        })
    });
    let leaks: Vec<_> = leaks.collect();
    assert!(leaks.is_empty(), "rays that leave, with the scale of their mesh: {leaks:?}");
}

#[test]
fn all_tiers_and_presets_find_the_same_hit_to_the_last_bit() {
    let mut random = Random::new(12);
    for mesh in closed_meshes(&mut random) {
        let reference = build(&mesh, &BuildOptions::FAST).with_tier(etendue_bvh::Tier::Portable);
        for preset in PRESETS {
            let built = build(&mesh, &preset);
            for tier in TIERS {
                let bvh = built.clone().with_tier(tier);
                for _ in 0..1_000 {
                    let ray = mesh.aimed_ray(&mut random);
                    let expected = reference.intersect(&ray, &NoPrimitives);
                    assert_eq!(bvh.intersect(&ray, &NoPrimitives), expected, "{ray:?}");
                }
            }
        }
    }
}

#[test]
fn hits_lie_at_their_barycentric_coordinates() {
    let mut random = Random::new(13);
    for mesh in closed_meshes(&mut random) {
        let bvh = build(&mesh, &BuildOptions::default());
        let reach = mesh.inside.abs().max_element() + mesh.scale;
        for _ in 0..2_000 {
            let ray = mesh.aimed_ray(&mut random);
            let hit = bvh.intersect(&ray, &NoPrimitives).expect("closed");
            assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0 + 1e-6, "{hit:?}");
            let [a, b, c] = mesh.indices[hit.primitive as usize]
                .map(|index| mesh.positions[index as usize].as_dvec3());
            let (u, v) = (f64::from(hit.u), f64::from(hit.v));
            let by_barycentrics = a * (1.0 - u - v) + b * u + c * v;
            let along = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t);
            let distance = (by_barycentrics - along).abs().max_element();
            // Twenty roundings of the greatest coordinate, as in the module `error_bounds`.
            let allowed = 20.5 / 16_777_216.0 * f64::from(reach) * 2.0;
            assert!(distance <= allowed, "scale {}: {distance:e} > {allowed:e}", mesh.scale);
        }
    }
}
