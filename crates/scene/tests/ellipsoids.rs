//! Clouds of ellipsoids: hits compared with Mitsuba's, spawned rays, and rejected files.

use etendue_document::{Diagnostic, Diagnostics, MemoryResources};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_testkit::TestRng;
use glam::Vec3;

/// Three ellipsoids with opacities of 0.5, 0.9 and 0.05.
const FILE: &[u8] = include_bytes!("data/ellipsoids.ply");

fn build(plugin: &str, parameters: &str, file: &[u8]) -> (Option<Scene>, Vec<Diagnostic>) {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default().with("cloud.ply", file.to_vec());
    let text = format!(
        r#"<scene><shape type="{plugin}"><string name="filename" value="cloud.ply"/>{parameters}
           </shape></scene>"#
    );
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics);
    let document = document.unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    let scene = build_scene(&document, &resources, &diagnostics, &BuildOptions::default());
    (scene, diagnostics.sorted())
}

fn scene(plugin: &str, parameters: &str) -> Scene {
    let (scene, found) = build(plugin, parameters, FILE);
    // The file has no sensor.
    scene.unwrap_or_else(|| panic!("{found:?}"))
}

/// `mitsuba_ellipsoids.txt` holds the results of `scalar_rgb` in version 3.9.1. Each line is a ray:
/// the name of the scene, origin and direction, then t and the normal, or `miss`.
#[test]
fn rays_hit_where_they_do_in_mitsuba() {
    let scenes = [
        ("ellipsoids", "ellipsoids", ""),
        ("adaptive", "ellipsoids", r#"<boolean name="extent_adaptive_clamping" value="true"/>"#),
        (
            "placed",
            "ellipsoids",
            r#"<float name="extent" value="2"/><float name="scale_factor" value="1.2"/>
            <transform name="to_world"><scale x="1" y="1.5" z="0.7"/><rotate y="1" angle="30"/>
            <translate x="0.2"/></transform>"#,
        ),
        ("box", "ellipsoidsmesh", r#"<string name="shell" value="box"/>"#),
        ("ico_sphere", "ellipsoidsmesh", ""),
        ("uv_sphere", "ellipsoidsmesh", r#"<string name="shell" value="uv_sphere"/>"#),
        (
            "nested",
            "ellipsoidsmesh",
            r#"<shape type="cube" name="shell"><transform name="to_world">
            <scale x="1" y="2" z="1.5"/></transform></shape>"#,
        ),
    ];
    let scenes = scenes.map(|(name, plugin, parameters)| (name, scene(plugin, parameters)));
    let mut differing = Vec::new();
    for line in include_str!("data/mitsuba_ellipsoids.txt").lines() {
        let (name, rest) = line.split_once(' ').expect("a name and numbers");
        let numbers: Vec<f32> = rest.split(' ').filter_map(|word| word.parse().ok()).collect();
        let (_, scene) = scenes.iter().find(|(known, _)| *known == name).expect("a scene");
        let ray = Ray::new(Vec3::from_slice(&numbers[..3]), Vec3::from_slice(&numbers[3..6]));
        let found = scene.intersect(&ray);
        assert_eq!(found.is_some(), scene.occluded(&ray));
        let agree = match (&found, &numbers[6..]) {
            (None, []) => true,
            (Some(found), [t, normal @ ..]) => {
                // Mitsuba's rounding error reaches 3.4e-4 here, measured against the exact root in
                // doubled precision.
                (found.t - t).abs() < 5e-4 && found.normal.dot(Vec3::from_slice(normal)) > 0.9999
            }
            _ => false,
        };
        if !agree {
            differing.push((line, found));
        }
    }
    assert!(differing.is_empty(), "{differing:#?}");
}

#[test]
fn rays_that_leave_an_ellipsoid_do_not_meet_it_again() {
    // A single flat ellipsoid far from the origin: a ray ahead could only hit its own surface.
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\nproperty float scale_0\nproperty float scale_1\nproperty float scale_2\n\
        property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n\
        end_header\n700 -300 90 0 -1 -8 0.5 0.1 -0.3 0.7\n";
    for plugin in ["ellipsoids", "ellipsoidsmesh"] {
        let scene = build(plugin, "", text.as_bytes()).0.expect("one ellipsoid");
        let mut random = TestRng::new(3);
        let mut hits = 0;
        for _ in 0..5000 {
            let target = Vec3::new(700.0, -300.0, 90.0) + random.unit_vector();
            let origin = Vec3::new(700.0, -300.0, 90.0) + random.unit_vector() * 30.0;
            let ray = Ray::new(origin, (target - origin).normalize());
            let Some(found) = scene.intersect(&ray) else { continue };
            hits += 1;
            let direction = random.unit_vector();
            let direction = direction * direction.dot(found.normal).signum();
            let leaving = found.spawn_ray(direction);
            assert!(!scene.occluded(&leaving), "{plugin}: {found:?} {direction}");
            // Rays that enter leave without a hit.
            let entering = found.spawn_ray(-direction);
            assert!(!scene.occluded(&entering), "{plugin}: {found:?} {direction}");
        }
        assert!(hits > 500, "{plugin}: {hits}");
    }
}

#[test]
fn files_without_ellipsoids_are_refused() {
    let header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\n";
    let scales = "property float scale_0\nproperty float scale_1\nproperty float scale_2\n";
    let rotations = "property float rot_0\nproperty float rot_1\nproperty float rot_2\n\
        property float rot_3\n";
    let cases = [
        (format!("{header}end_header\n0 0 0\n"), "no properties `scale_0`"),
        (format!("{header}{scales}end_header\n0 0 0 1 1 1\n"), "no properties `rot_0`"),
        (
            format!("{header}{scales}{rotations}end_header\n0 0 0 1 1 1 0 0 0 0\n"),
            "the quaternion of ellipsoid 0 is zero",
        ),
        (
            format!("{header}{scales}{rotations}end_header\n0 0 0 1 1 900 1 0 0 0\n"),
            "beyond what single precision can hold",
        ),
        ("ply\nformat ascii 1.0\nend_header\n".to_owned(), "no element `vertex`"),
    ];
    for (text, words) in cases {
        for plugin in ["ellipsoids", "ellipsoidsmesh"] {
            let (scene, found) = build(plugin, "", text.as_bytes());
            assert!(scene.is_none(), "{text}");
            assert!(found.iter().any(|found| found.message.contains(words)), "{found:?}");
        }
    }
    let nested = r#"<shape type="sphere" name="shell"/>"#;
    let (scene, found) = build("ellipsoidsmesh", nested, FILE);
    assert!(scene.is_none());
    assert!(found.iter().any(|found| found.message.contains("has no triangles")), "{found:?}");
}

#[test]
fn the_opacities_of_splats_are_behind_a_sigmoid_and_the_faintest_are_left_out() {
    let splat = |opacity: f32| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
             property float z\nproperty float f_dc_0\nproperty float f_dc_1\n\
             property float f_dc_2\nproperty float opacity\nproperty float scale_0\n\
             property float scale_1\nproperty float scale_2\nproperty float rot_0\n\
             property float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n\
             0 0 0 1 2 3 {opacity} 0 0 0 1 0 0 0\n"
        )
    };
    let adaptive = r#"<boolean name="extent_adaptive_clamping" value="true"/>"#;
    let hit = |opacity: f32| {
        let (scene, found) = build("ellipsoids", adaptive, splat(opacity).as_bytes());
        let scene = scene.unwrap_or_else(|| panic!("{found:?}"));
        scene.intersect(&Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z)).map(|found| found.t)
    };
    let radius = (2.0 * (0.598_687_66_f32 / 0.01).ln()).sqrt();
    let found = hit(0.4).expect("a splat");
    assert!((found - (5.0 - radius)).abs() < 1e-5, "{found}");
    assert_eq!(hit(-5.0), None);
}
