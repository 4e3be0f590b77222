//! Tests of the surface of revolution against closed forms and a fine mesh. `tests/splines.rs`
//! counts missed and spurious crossings.

use super::*;
use crate::models::profile::{from_b_spline, from_bezier};
use etendue_bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
use etendue_math::{offset_ray_origin, polynomial::quadratic_roots};
use etendue_testkit::TestRng;
use glam::DQuat;

/// Control points that approximate quarter circles (error 2.7·10⁻⁴ of the radius).
const KAPPA: f64 = 0.552_284_749_830_793_4;

fn chain(points: &[(f64, f64)]) -> Vec<Segment> {
    let points: Vec<DVec2> = points.iter().map(|(x, y)| DVec2::new(*x, *y)).collect();
    from_bezier(&points).expect("a chain has 3n + 1 points")
}

fn line(from: (f64, f64), to: (f64, f64)) -> Vec<Segment> {
    let at = |s: f64| (from.0 + (to.0 - from.0) * s, from.1 + (to.1 - from.1) * s);
    chain(&[from, at(1.0 / 3.0), at(2.0 / 3.0), to])
}

fn ball() -> Vec<Segment> {
    let k = KAPPA;
    chain(&[(0.0, -1.0), (k, -1.0), (1.0, -k), (1.0, 0.0), (1.0, k), (k, 1.0), (0.0, 1.0)])
}

fn torus() -> Vec<Segment> {
    let k = 0.4 * KAPPA;
    chain(&[
        (1.4, 0.0),
        (1.4, k),
        (1.0 + k, 0.4),
        (1.0, 0.4),
        (1.0 - k, 0.4),
        (0.6, k),
        (0.6, 0.0),
        (0.6, -k),
        (1.0 - k, -0.4),
        (1.0, -0.4),
        (1.0 + k, -0.4),
        (1.4, -k),
        (1.4, 0.0),
    ])
}

/// A closed glass with a thin wall and a nearly flat foot. Its ends are triple points on the axis.
fn glass() -> Vec<Segment> {
    let points = [
        (0.0, -0.459543),
        (0.0, -0.459544),
        (0.0, -0.459545),
        (-0.351882, -0.426747),
        (-1.112097, 0.084005),
        (-1.164785, 1.105511),
        (-1.029301, 2.50336),
        (-1.0888, 2.3456),
        (-1.278, 1.1628),
        (-1.2148, 0.0552),
        (-0.3804, -0.622),
        (-0.0968, -1.48),
        (-0.3172, -2.2028),
        (-1.2148, -2.3232),
        (-1.0576, -2.4588),
        (-0.7112, -2.4588),
        (0.0, -2.4588),
        (0.0, -2.458801),
        (0.0, -2.458802),
    ];
    from_b_spline(&points.map(|(x, y)| DVec2::new(x, y)))
}

fn surface(segments: &[Segment]) -> RevSurface {
    RevSurface::new(segments, DAffine3::IDENTITY, false).expect("the profile is off the axis")
}

fn random_ray(random: &mut TestRng, reach: f32) -> Ray {
    let origin = random.unit_vector() * (3.0 * reach);
    let target = random.unit_vector() * (reach * random.next_f32());
    Ray::new(origin, (target - origin).normalize())
}

/// (x² + z²) = (radius + slope·y)² along the ray, for y in [0, 1].
fn cone_crossings(ray: &Ray, radius: f64, slope: f64) -> Vec<f64> {
    let (p, v) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (at, per_t) = (radius + slope * p.y, slope * v.y);
    let a = v.x * v.x + v.z * v.z - per_t * per_t;
    let b = 2.0 * (p.x * v.x + p.z * v.z - at * per_t);
    let roots = quadratic_roots(a, b, p.x * p.x + p.z * p.z - at * at);
    let mut found: Vec<f64> = roots.map_or(Vec::new(), |(low, high)| vec![low, high]);
    found.retain(|t| (0.0..=1.0).contains(&(p.y + t * v.y)));
    found
}

#[test]
fn straight_profiles_are_cylinders_and_cones() {
    let mut random = TestRng::new(1);
    for (radius, slope) in [(0.7, 0.0), (0.7, -0.7), (1.0, -0.4), (0.5, -1.0), (-0.5, 0.2)] {
        let shape = surface(&line((radius, 0.0), (radius + slope, 1.0)));
        let mut hits = 0;
        for _ in 0..20_000 {
            let ray = random_ray(&mut random, 1.0);
            let expected = cone_crossings(&ray, radius, slope);
            let found = shape.crossings(&ray);
            assert_eq!(found.len(), expected.len(), "{ray:?}: {found:?}, {expected:?}");
            for (found, t) in found.iter().zip(&expected) {
                assert!((found.t - t).abs() < 1e-9, "{ray:?}: {found:?}, {t}");
                let height = f64::from(ray.origin.y) + t * f64::from(ray.direction.y);
                assert!((found.v - height).abs() < 1e-9);
            }
            hits += found.len();
        }
        assert!(hits > 2000, "{radius} {slope}: {hits}");
    }
}

#[test]
fn quarter_circles_are_a_sphere_within_their_error() {
    let (shape, mut random) = (surface(&ball()), TestRng::new(2));
    for _ in 0..20_000 {
        let ray = random_ray(&mut random, 1.0);
        let distance = ray.origin.cross(ray.direction).length();
        let Some((t, place)) = shape.intersect(&ray) else {
            assert!(distance > 0.9999, "{ray:?}");
            continue;
        };
        assert!(distance < 1.0003);
        let at = shape.surface_point(&ray, t, place);
        let radius = at.point.length();
        assert!((0.999_999..1.000_275).contains(&radius), "{radius}");
        // The profile runs upwards on the right, so its left is inside.
        assert!(at.normal.dot(-at.point) > 0.999_999 * radius, "{at:?}");
        assert!((at.point - ray.at(t)).length() < 2e-6);
    }
}

#[test]
fn a_fine_mesh_is_hit_at_the_same_places() {
    let segments = glass();
    let shape = surface(&segments);
    let (around, along) = (1024_u32, 64_u32);
    let mut positions = Vec::new();
    for ring in 0..=along * segments.len() as u32 {
        let segment = (ring / along).min(segments.len() as u32 - 1);
        let s = f64::from(ring - segment * along) / f64::from(along);
        let p = profile::point(&segments[segment as usize], s);
        positions.extend((0..around).map(|step| {
            let (sin, cos) = (TAU * f64::from(step) / f64::from(around)).sin_cos();
            DVec3::new(p.x * cos, p.y, p.x * sin).as_vec3()
        }));
    }
    let mut indices = Vec::new();
    for ring in 0..along * segments.len() as u32 {
        for step in 0..around {
            let next = (step + 1) % around;
            let at = |ring: u32, step: u32| ring * around + step;
            indices.push([at(ring, step), at(ring, next), at(ring + 1, step)]);
            indices.push([at(ring, next), at(ring + 1, next), at(ring + 1, step)]);
        }
    }
    let view = TriangleMeshView { positions: &positions, indices: &indices };
    let mesh = Bvh::build(&[GeometryView::Triangles(view)], &BuildOptions::default())
        .expect("the mesh is well formed");
    let mut random = TestRng::new(3);
    let (mut differing, mut hits) = (0, 0);
    for _ in 0..50_000 {
        let ray = random_ray(&mut random, 2.5);
        let facet = mesh.intersect(&ray, &NoPrimitives);
        let exact = shape.intersect(&ray);
        hits += u32::from(exact.is_some());
        let is_same = match (facet, exact) {
            (Some(facet), Some((t, _))) => (facet.t - t).abs() < 1e-3,
            (None, None) => true,
            _ => false,
        };
        differing += u32::from(!is_same);
    }
    // Facets are up to 10⁻⁵ inside the surface; only grazing rays notice it.
    assert!(hits > 10_000 && differing < 50, "{differing} of {hits}");
}

#[test]
fn the_axis_is_hit_and_its_normal_is_the_axis() {
    let shape = surface(&ball());
    for (from, to) in [(3.0, 1.0), (-3.0, -1.0)] {
        let ray = Ray::new(Vec3::new(0.0, from, 0.0), Vec3::new(0.0, -to, 0.0));
        let (t, place) = shape.intersect(&ray).expect("the pole is there");
        assert_eq!(t, 2.0);
        let at = shape.surface_point(&ray, t, place);
        assert!((at.point - Vec3::new(0.0, to, 0.0)).length() < 1e-9);
        assert!((at.normal - Vec3::new(0.0, -to, 0.0)).length() < 1e-6);
        assert!(at.dp_du.is_finite() && at.dp_dv.is_finite());
        assert_eq!(shape.crossings(&ray).len(), 2);
    }
    // At an angle through a pole, and through the tip of a cone that continues beyond it.
    let slanting = Ray::new(Vec3::new(2.0, 3.0, 0.0), Vec3::new(-2.0, -2.0, 0.0));
    assert_eq!(shape.crossings(&slanting).len(), 2);
    let cones = surface(&line((-1.0, -1.0), (1.0, 1.0)));
    for direction in [Vec3::new(0.3, -1.0, 0.1), Vec3::new(1.0, -0.25, 0.0), Vec3::X] {
        let ray = Ray::new(-direction * 4.0, direction);
        assert_eq!(cones.crossings(&ray).len() % 2, 0, "{direction}");
    }
}

#[test]
fn level_rays_are_the_limit_of_nearly_level_ones() {
    let shape = surface(&glass());
    for (y, x) in [(0.5, 0.2), (2.2, 0.0), (-1.5, 0.01), (-2.4, 0.3)] {
        let level = shape.crossings(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z));
        assert!(level.len() >= 2 && level.len().is_multiple_of(2), "{level:?}");
        for exponent in 3..40 {
            let rise = 10.0_f32.powi(-exponent);
            let ray = Ray::new(Vec3::new(x, y, 5.0), Vec3::new(0.0, rise, -1.0));
            let near = shape.crossings(&ray);
            assert_eq!(near.len(), level.len(), "{y} {exponent}");
            for (a, b) in near.iter().zip(&level) {
                assert!((a.t - b.t).abs() < 300.0 * f64::from(rise) + 1e-9, "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn grazing_rays_cross_twice_or_not_at_all() {
    // These lines touch cylinders all along, spheres and tori at one point.
    let straight = surface(&line((1.0, -2.0), (1.0, 2.0)));
    for shape in [&straight, &surface(&ball()), &surface(&torus())] {
        let touching = if shape.bounds().max.x > 1.2 { 1.4 } else { 1.0 };
        for step in -20_i32..=20 {
            let x = touching + (step as f32) * f32::EPSILON;
            for rise in [0.0, 1e-7, 1e-3, 0.3, 2.0] {
                let ray = Ray::new(Vec3::new(x, -4.0 * rise, 4.0), Vec3::new(0.0, rise, -1.0));
                let count = shape.crossings(&ray).len();
                assert!(count.is_multiple_of(2), "{ray:?}: {count}");
                if rise < 1e-3 {
                    let expected = if step < 0 { 2 } else { 0 };
                    assert!(count == expected || step.abs() <= 1, "{step} {rise}: {count}");
                }
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_the_point_and_the_front_is_on_the_left() {
    let turn = DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(-0.4);
    for scale in [DVec3::ONE, DVec3::new(1.0, 2.0, 0.5), DVec3::new(-1.0, 1.0, 1.0)] {
        let to_world =
            DAffine3::from_scale_rotation_translation(scale, turn, DVec3::new(0.3, 2.0, -1.0));
        for flip in [false, true] {
            let shape = RevSurface::new(&glass(), to_world, flip).expect("it is off the axis");
            for (piece, s, azimuth) in [(3, 0.5, 0.3), (10, 0.2, 2.0), (17, 0.9, 5.0)] {
                let at = shape.at(piece, s, azimuth);
                let h = 1e-3;
                let ahead = [shape.at(piece, s + h, azimuth), shape.at(piece, s, azimuth + h)];
                let dv = (ahead[0].point - at.point) / (ahead[0].uv.y - at.uv.y);
                let du = (ahead[1].point - at.point) / (ahead[1].uv.x - at.uv.x);
                assert!((dv - at.dp_dv).length() < 0.02 * dv.length(), "{dv} {at:?}");
                assert!((du - at.dp_du).length() < 0.02 * du.length(), "{du} {at:?}");
                // For x > 0, u leads towards +z from the profile's plane. Upwards along the
                // profile, the left is u × v = z × y = −x.
                let side = if scale.x < 0.0 { -1.0 } else { 1.0 } * if flip { -1.0 } else { 1.0 };
                let left = at.dp_du.cross(at.dp_dv).normalize() * side;
                let left = if shape.pieces[piece].control()[0].x < 0.0 { -left } else { left };
                assert!(left.dot(at.normal) > 0.9999, "{left} {at:?}");
            }
        }
    }
}

#[test]
fn rays_come_out_of_closed_glass_again() {
    let mut random = TestRng::new(5);
    for segments in [ball(), torus(), glass()] {
        for (scale, offset) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1000.0)] {
            let to_world = DAffine3::from_scale_rotation_translation(
                DVec3::splat(scale),
                DQuat::from_rotation_z(0.3),
                DVec3::splat(offset),
            );
            let shape = RevSurface::new(&segments, to_world, true).expect("it is off the axis");
            let (center, radius) = shape.bounds().bounding_sphere();
            for _ in 0..3000 {
                let mut ray = random_ray(&mut random, radius);
                ray.origin += center;
                let mut is_inside = false;
                for _ in 0..20 {
                    let Some((t, place)) = shape.intersect(&ray) else { break };
                    let at = shape.surface_point(&ray, t, place);
                    let origin = offset_ray_origin(at.point, at.error, at.normal, ray.direction);
                    ray = Ray::new(origin, ray.direction);
                    is_inside = !is_inside;
                }
                assert!(!is_inside, "{scale} {offset}: lost along {ray:?}");
            }
        }
    }
}

#[test]
fn areas_are_those_of_closed_forms() {
    let area = |segments: &[Segment]| f64::from(surface(segments).area());
    let tube = area(&line((0.5, 0.0), (0.5, 3.0)));
    assert!((tube / (TAU * 0.5 * 3.0) - 1.0).abs() < 1e-5);
    let cone = area(&line((0.0, 0.0), (1.0, 1.0)));
    assert!((cone / (0.5 * TAU * 2.0_f64.sqrt()) - 1.0).abs() < 1e-5);
    let ball = area(&ball());
    assert!((ball / (2.0 * TAU) - 1.0).abs() < 1e-3, "{ball}");
}

#[test]
fn profiles_without_a_surface_are_refused() {
    assert!(RevSurface::new(&line((0.0, 0.0), (0.0, 1.0)), DAffine3::IDENTITY, false).is_none());
    assert!(RevSurface::new(&line((0.0, 0.0), (0.0, 0.0)), DAffine3::IDENTITY, false).is_none());
    assert!(RevSurface::new(&[], DAffine3::IDENTITY, false).is_none());
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    assert!(RevSurface::new(&ball(), flat, false).is_none());
}

#[test]
fn rays_without_a_direction_hit_nothing() {
    let shape = surface(&ball());
    for direction in [Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)] {
        let ray = Ray::new(Vec3::new(0.1, 0.2, 0.3), direction);
        assert!(shape.intersect(&ray).is_none() && !shape.occludes(&ray));
    }
}
