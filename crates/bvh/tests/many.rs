//! Batches of rays give the same hits as single rays, to the last bit: random, coherent and invalid
//! rays, and rays aimed at edges; in small and large trees, with user primitives and instances.

mod common;

use common::{ClosedMesh, PRESETS, Random, TIERS, closed_meshes};
use etendue_bvh::{
    BuildOptions, Bvh, GeometryView, Hit, NoPrimitives, PrimitiveHit, Primitives, TriangleMeshView,
};
use etendue_math::{Bounds3, Ray};
use glam::{Affine3A, Vec3};
use std::sync::Arc;

/// Traces the rays in batches of many sizes and singly. Returns the number of hits.
fn agree(bvh: &Bvh, rays: &[Ray], primitives: &impl Primitives) -> usize {
    let expected: Vec<Option<Hit>> =
        rays.iter().map(|ray| bvh.intersect(ray, primitives)).collect();
    let found: Vec<bool> = rays.iter().map(|ray| bvh.occluded(ray, primitives)).collect();
    let (mut first, mut size) = (0, 1);
    while first < rays.len() {
        let end = rays.len().min(first + size);
        let (mut hits, mut occluded) = (vec![None], vec![true]);
        bvh.intersect_many(&rays[first..end], primitives, &mut hits);
        bvh.occluded_many(&rays[first..end], primitives, &mut occluded);
        assert_eq!((hits.len(), occluded.len()), (1 + end - first, 1 + end - first));
        for (index, ray) in rays[first..end].iter().enumerate() {
            let (hit, alone) = (&hits[1 + index], &expected[first + index]);
            assert_eq!(bits(hit), bits(alone), "{:?} {ray:?}: {hit:?}, {alone:?}", bvh.tier());
            assert_eq!(occluded[1 + index], found[first + index], "{:?} {ray:?}", bvh.tier());
        }
        (first, size) = (end, size % 77 + 5);
    }
    expected.iter().flatten().count()
}

fn bits(hit: &Option<Hit>) -> Option<[u32; 6]> {
    hit.map(|hit| {
        let [t, u, v] = [hit.t, hit.u, hit.v].map(f32::to_bits);
        [t, u, v, hit.geometry, hit.primitive, hit.instance]
    })
}

fn in_every_tier(built: &Bvh, rays: &[Ray], primitives: &impl Primitives) -> usize {
    let hits = TIERS.map(|tier| agree(&built.clone().with_tier(tier), rays, primitives));
    assert!(hits[0] == hits[1] && hits[0] == hits[2], "{hits:?}");
    hits[0]
}

fn view(mesh: &ClosedMesh) -> GeometryView<'_> {
    let (positions, indices) = (&mesh.positions, &mesh.indices);
    GeometryView::Triangles(TriangleMeshView { positions, indices })
}

/// From one point to all points of a small square, row by row; then from points nearby to one point.
fn coherent_rays(random: &mut Random, reach: f32) -> Vec<Ray> {
    let mut rays = Vec::new();
    for _ in 0..40 {
        let (from, to) = (random.point() * reach, random.point() * reach);
        for place in 0..64 {
            let beside = Vec3::new((place % 8) as f32, (place / 8) as f32, 1.0) * (0.02 * reach);
            rays.push(Ray::new(from, to + beside - from));
        }
        for _ in 0..64 {
            let beside = to + random.point() * (0.02 * reach);
            rays.push(Ray::segment(beside, from - beside, random.unit() * 2.0));
        }
    }
    rays
}

#[test]
fn batches_hit_random_triangles_as_single_rays_do() {
    let mut random = Random::new(71);
    for (count, size) in [(1, 5.0), (9, 5.0), (40, 5.0), (300, 3.0), (3000, 1.0)] {
        let positions: Vec<Vec3> = (0..count)
            .flat_map(|_| {
                let center = random.point() * 10.0;
                [0; 3].map(|_| center + random.point() * size)
            })
            .collect();
        let indices: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMeshView { positions: &positions, indices: &indices };
        let mut rays = coherent_rays(&mut random, 10.0);
        rays.extend((0..4_000).map(|_| random.ray(10.0)));
        for preset in PRESETS {
            let bvh = Bvh::build(&[GeometryView::Triangles(mesh)], &preset).expect("valid");
            let hits = in_every_tier(&bvh, &rays, &NoPrimitives);
            assert!(count < 9 || hits > 500, "{count}: {hits}");
        }
    }
}

#[test]
fn batches_do_not_leave_a_closed_mesh() {
    let mut random = Random::new(72);
    let mut meshes = closed_meshes(&mut random);
    let closed = meshes.len();
    for scale in [1e-20_f32, 1e-3, 1.0, 1e4, 1e18, 1e36] {
        meshes.push(ClosedMesh::new(&mut random, 1, 0.3, scale, Vec3::ZERO));
    }
    for (index, mesh) in meshes.iter().enumerate() {
        let bvh = Bvh::build(&[view(mesh)], &BuildOptions::default()).expect("valid");
        let rays: Vec<Ray> = (0..3_000).map(|_| mesh.aimed_ray(&mut random)).collect();
        let hits = in_every_tier(&bvh, &rays, &NoPrimitives);
        assert!(index >= closed || hits == rays.len(), "scale {}", mesh.scale);
    }
}

/// Coincident squares, each of two triangles that share an edge.
#[test]
fn the_lowest_primitive_wins_at_equal_distances() {
    let mut random = Random::new(73);
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for square in 0..30 {
        let first = 4 * square;
        let z = (square % 3) as f32;
        positions.extend(
            [[0, 0], [1, 0], [1, 1], [0, 1]]
                .map(|[x, y]| Vec3::new(x as f32 * 4.0 - 2.0, y as f32 * 4.0 - 2.0, z)),
        );
        indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    for count in [12, 60] {
        let mesh = TriangleMeshView { positions: &positions, indices: &indices[..count] };
        let views = [GeometryView::Triangles(mesh), GeometryView::Triangles(mesh)];
        let bvh = Bvh::build(&views, &BuildOptions::default()).expect("valid");
        let rays: Vec<Ray> = (0..2_000)
            .map(|index| {
                let x = random.unit() * 4.0 - 2.0;
                let y = if index % 2 == 0 { x } else { random.unit() * 4.0 - 2.0 };
                let z = if index % 3 == 0 { -1.0 } else { 5.0 };
                Ray::segment(
                    Vec3::new(x, y, z),
                    Vec3::Z * -z,
                    if index % 5 == 0 { 0.6 } else { 9.0 },
                )
            })
            .collect();
        let hits = in_every_tier(&bvh, &rays, &NoPrimitives);
        assert!(hits > 1_500, "{hits}");
    }
}

/// Squares parallel to the xy plane; some coincide with triangles.
struct Squares(Vec<f32>);

impl Squares {
    fn bounds(&self) -> Vec<Bounds3> {
        let square = |&z: &f32| Bounds3::new(Vec3::new(-2.0, -2.0, z), Vec3::new(2.0, 2.0, z));
        self.0.iter().map(square).collect()
    }
}

impl Primitives for Squares {
    fn intersect(&self, _geometry: u32, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let t = (self.0[primitive as usize] - ray.origin.z) / ray.direction.z;
        let at = ray.at(t);
        let inside = at.x.abs() <= 2.0 && at.y.abs() <= 2.0;
        (inside && t > 0.0 && t < ray.t_max).then_some(PrimitiveHit { t, u: at.x, v: at.y })
    }
}

#[test]
fn batches_hit_primitives_and_instances_as_single_rays_do() {
    let mut random = Random::new(74);
    let corners = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
    let positions: Vec<Vec3> = (0..40)
        .map(|index| Vec3::from((corners[index % 4][0], corners[index % 4][1], (index / 4) as f32)))
        .collect();
    let indices: Vec<[u32; 3]> = (0..10)
        .flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]])
        .collect();
    let mesh = TriangleMeshView { positions: &positions, indices: &indices };
    let squares = Squares(vec![0.0, 1.0, 1.5, 3.0, 3.0, 4.0]);
    let boxes = squares.bounds();
    let group = [GeometryView::Triangles(mesh), GeometryView::User(&boxes)];
    let group = Arc::new(Bvh::build(&group, &BuildOptions::default()).expect("valid"));
    let placed = |z: f32| GeometryView::Instance {
        group: group.clone(),
        to_world: Affine3A::from_translation(Vec3::Z * z),
    };
    let triangles = GeometryView::Triangles(mesh);
    let lists = [
        vec![GeometryView::User(&boxes), triangles.clone()],
        vec![triangles.clone(), GeometryView::User(&boxes), triangles.clone()],
        vec![placed(0.0), triangles.clone(), placed(20.0), GeometryView::User(&boxes)],
        vec![placed(0.0), placed(0.0)],
    ];
    let rays: Vec<Ray> = (0..1_500)
        .map(|index| {
            let from = Vec3::new(random.unit(), random.unit(), -1.0 + 6.0 * random.unit());
            let aside = if index % 2 == 0 { Vec3::ZERO } else { random.point() };
            let z = (random.bits() % 2) as f32 * 2.0 - 1.0;
            Ray::segment(from.round(), Vec3::Z * z + aside, random.unit() * 10.0)
        })
        .collect();
    for list in &lists {
        let bvh = Bvh::build(list, &BuildOptions::default()).expect("valid");
        let hits = in_every_tier(&bvh, &rays, &squares);
        assert!(hits > 500, "{hits}");
    }
}

#[test]
fn invalid_rays_in_a_batch_hit_nothing() {
    let mut random = Random::new(75);
    for levels in [0, 4] {
        let mesh = ClosedMesh::new(&mut random, levels, 0.2, 2.0, Vec3::ZERO);
        let bvh = Bvh::build(&[view(&mesh)], &BuildOptions::default()).expect("valid");
        let odd = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            0.0,
            -0.0,
            1e-40,
            -1e-38,
            1e-30,
            1e19,
            3e38,
            -3e38,
        ];
        let rays: Vec<Ray> = (0..4_000)
            .map(|index| {
                let mut ray = random.ray(1.0);
                let number = odd[random.bits() as usize % odd.len()];
                match index % 8 {
                    0 => ray.origin[random.bits() as usize % 3] = number,
                    1 | 2 => ray.direction[random.bits() as usize % 3] = number,
                    3 => ray.t_max = number,
                    4 => ray.direction = Vec3::splat(number),
                    _ => {}
                }
                ray
            })
            .collect();
        let hits = in_every_tier(&bvh, &rays, &NoPrimitives);
        assert!(hits > 1_000, "{hits}");
    }
    let empty = Bvh::build(&[], &BuildOptions::default()).expect("empty is valid");
    let rays: Vec<Ray> = (0..100).map(|_| random.ray(1.0)).collect();
    assert_eq!(in_every_tier(&empty, &rays, &NoPrimitives), 0);
}
