//! Curves: hits compared with Mitsuba's, closed forms, and spawned rays.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_testkit::TestRng;
use glam::{Vec2, Vec3};

const LINEAR: &str = "\
-1.0 0.1 0.1 0.3
1.0 0.4 0.2 0.5
1.5 1.0 0.0 0.1

0 -1 0 0.1
0.5 -1.5 0.2 0.1
";

const SPLINE: &str = "\
-2.0 0.1 0.1 0.1
-1.0 0.1 0.1 0.3
1.0 0.4 0.2 0.4
1.5 1.0 0.0 0.1
2.5 1.0 0.5 0.2

0 -1 0 0.1
0.5 -1.5 0.2 0.1
0.5 -1.5 0.9 0.3
1.5 -1.5 0.9 0.2
";

fn scene(plugin: &str, curves: &str) -> Scene {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default().with("curves.txt", curves.as_bytes().to_vec());
    let text = format!(
        r#"<scene><shape type="{plugin}"><string name="filename" value="curves.txt"/></shape></scene>"#
    );
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
        .unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

fn vec3(numbers: &[f32]) -> Vec3 {
    Vec3::from_slice(numbers)
}

/// `mitsuba_curves.txt` holds the results of `llvm_ad_rgb` in version 3.9.1. Each line is a ray:
/// the plugin, origin and direction, then t, u, v and the normal, or `miss`.
#[test]
fn rays_hit_where_they_do_in_mitsuba() {
    let scenes = [
        ("linearcurve", scene("linearcurve", LINEAR)),
        ("bsplinecurve", scene("bsplinecurve", SPLINE)),
    ];
    let (mut hits, mut differing) = (0, Vec::new());
    for line in include_str!("data/mitsuba_curves.txt").lines() {
        let (plugin, rest) = line.split_once(' ').expect("a name and numbers");
        let numbers: Vec<f32> = rest.split(' ').filter_map(|word| word.parse().ok()).collect();
        let (_, scene) = scenes.iter().find(|(name, _)| *name == plugin).expect("one of the two");
        let ray = Ray::new(vec3(&numbers[..3]), vec3(&numbers[3..6]));
        let found = scene.intersect(&ray);
        assert_eq!(found.is_some(), scene.occluded(&ray));
        let [t, u, v, ref normal @ ..] = numbers[6..] else {
            differing.extend(found.map(|found| (line, Some(found))));
            continue;
        };
        let Some(found) = found else {
            differing.push((line, None));
            continue;
        };
        hits += 1;
        // Embree's rounding shows where rays graze.
        let turn = (found.uv.x - u + 0.5).rem_euclid(1.0) - 0.5;
        let is_close = (found.t - t).abs() < 2e-3
            && Vec2::new(turn, found.uv.y - v).length() < 5e-3
            && found.normal.dot(vec3(normal)) > 0.999;
        if !is_close {
            differing.push((line, Some(found)));
        }
    }
    assert!(hits > 100 && differing.len() <= 2, "of {hits}: {differing:#?}");
}

#[test]
fn a_straight_spline_of_one_radius_is_a_cylinder() {
    let curve = scene("bsplinecurve", "0 -3 0 .25\n0 -1 0 .25\n0 1 0 .25\n0 3 0 .25\n");
    let mut random = TestRng::new(1);
    let mut hits = 0;
    for _ in 0..20_000 {
        let origin = random.unit_vector() * 4.0;
        let target = random.unit_vector() * 0.6;
        let ray = Ray::new(origin, (target - origin).normalize());
        let flat = |v: Vec3| Vec2::new(v.x, v.z).as_dvec2();
        let (p, v) = (flat(ray.origin), flat(ray.direction));
        let (a, b, c) = (v.length_squared(), p.dot(v), p.length_squared() - 0.0625);
        let discriminant = b * b - a * c;
        let t = (-b - discriminant.max(0.0).sqrt()) / a;
        let height = f64::from(ray.origin.y) + t * f64::from(ray.direction.y);
        let found = curve.intersect(&ray);
        if discriminant > 0.0 && height.abs() < 1.0 {
            let found = found.unwrap_or_else(|| panic!("{ray:?} misses"));
            assert!((f64::from(found.t) - t).abs() < 1e-6, "{found:?} {t}");
            assert!((f64::from(found.uv.y) - 0.5 * (height + 1.0)).abs() < 1e-5);
            assert!(found.normal.dot(Vec3::new(found.point.x, 0.0, found.point.z)) > 0.2499);
            hits += 1;
        } else {
            assert!(found.is_none(), "{ray:?}: {found:?}");
        }
    }
    assert!(hits > 5000, "{hits}");
}

/// The distance to the closest of the spheres that make up a linear segment.
fn distance_to_segments(point: Vec3) -> f64 {
    let points: Vec<Vec<f64>> = LINEAR
        .lines()
        .map(|line| line.split_whitespace().filter_map(|word| word.parse().ok()).collect())
        .collect();
    let mut least = f64::INFINITY;
    for pair in points.windows(2).filter(|pair| pair.iter().all(|point| !point.is_empty())) {
        for step in 0..=20_000 {
            let s = f64::from(step) / 20_000.0;
            let at: Vec<f64> = (0..4).map(|i| pair[0][i] * (1.0 - s) + pair[1][i] * s).collect();
            let center = glam::DVec3::from_slice(&at);
            least = least.min((point.as_dvec3() - center).length() - at[3]);
        }
    }
    least
}

#[test]
fn linear_curves_are_unions_of_spheres() {
    let curve = scene("linearcurve", LINEAR);
    let mut random = TestRng::new(2);
    let mut hits = 0;
    while hits < 200 {
        let origin = random.unit_vector() * 4.0;
        let target = random.unit_vector() * 1.5;
        let Some(found) = curve.intersect(&Ray::new(origin, (target - origin).normalize())) else {
            continue;
        };
        hits += 1;
        let distance = distance_to_segments(found.point);
        assert!(distance.abs() < 1e-6, "{found:?}: {distance}");
    }
}

#[test]
fn rays_that_leave_do_not_come_back_to_where_they_were() {
    let mut random = TestRng::new(3);
    // A straight tube is convex.
    for (plugin, curves) in [
        ("linearcurve", "0 0 0 .3\n1 2 3 .1\n"),
        ("bsplinecurve", "0 0 0 .3\n1 2 3 .3\n2 4 6 .3\n3 6 9 .3\n"),
        ("bsplinecurve", "100 0 0 1e-3\n101 2 3 1e-3\n102 4 6 1e-3\n103 6 9 1e-3\n"),
    ] {
        let scene = scene(plugin, curves);
        let (center, radius) = scene.bounds().bounding_sphere();
        let mut hits = 0;
        for _ in 0..3000 {
            let target = center + random.unit_vector() * radius * 0.2 * random.next_f32();
            let origin = center + random.unit_vector() * radius * 2.0;
            let ray = Ray::new(origin, (target - origin).normalize());
            let Some(surface) = scene.intersect(&ray) else { continue };
            hits += 1;
            for _ in 0..10 {
                let direction = random.unit_vector();
                let direction = direction * direction.dot(surface.normal).signum();
                let again = scene.intersect(&surface.spawn_ray(direction));
                assert!(again.is_none(), "{plugin}: left {surface:?}, met {again:?}");
            }
        }
        assert!(hits > 0, "{plugin}");
    }
}
