//! Rays that leave a surface do not hit it again, and do not miss objects on it.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_testkit::TestRng;
use glam::Vec3;

fn scene(elements: &str) -> Scene {
    let (diagnostics, resources) = (Diagnostics::new(), MemoryResources::default());
    let document = read_text(
        &format!("<scene>{elements}</scene>"),
        &resources,
        &LoadOptions::default(),
        &diagnostics,
    )
    .unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

/// Convex shapes, each rotated so that coordinates are both tiny and large.
const SHAPES: [&str; 5] = ["rectangle", "disk", "sphere", "cube", "cylinder"];
const TURNS: [&str; 3] = [
    r#"<rotate x="1" angle="-90"/>"#,
    r#"<rotate y="1" angle="90"/>"#,
    r#"<rotate x="1" y="2" z="-0.5" angle="37"/>"#,
];

/// A floor in the plane y = 0 used to hit its own rays: the error bound of its points is zero, but
/// the triangle test rounds in proportion to the triangle's size.
#[test]
fn outward_rays_never_meet_a_convex_shape_again() {
    let mut random = TestRng::new(1);
    for shape in SHAPES {
        for turn in TURNS {
            for (scale, offset) in [(1e-6, 0.0), (1.0, 0.0), (1.0, 100.0), (1e6, 0.0), (1e6, 1e4)] {
                let scene = scene(&format!(
                    r#"<shape type="{shape}"><transform name="to_world"><scale value="{scale}"/>{turn}<translate x="{offset}"/></transform></shape>"#
                ));
                assert_leaves(&scene, &mut random, &format!("{shape} {turn} {scale} {offset}"));
            }
        }
    }
}

fn assert_leaves(scene: &Scene, random: &mut TestRng, name: &str) {
    let (center, radius) = scene.bounds().bounding_sphere();
    let mut hits = 0;
    for _ in 0..300 {
        let origin = center + random.unit_vector() * radius * 2.0;
        let target = center + random.unit_vector() * radius * random.next_f32();
        let Some(surface) = scene.intersect(&Ray::new(origin, (target - origin).normalize()))
        else {
            continue;
        };
        hits += 1;
        let outward = if surface.normal.dot(origin - surface.point) < 0.0 {
            -surface.normal
        } else {
            surface.normal
        };
        for _ in 0..20 {
            let direction = random.unit_vector();
            let direction = if direction.dot(outward) < 0.0 { -direction } else { direction };
            // The inside of a tube faces itself; only its outside is convex.
            let inside = name.starts_with("cylinder") && outward != surface.normal;
            if !inside && direction.dot(outward) > 1e-4 {
                let again = scene.intersect(&surface.spawn_ray(direction));
                assert!(
                    again.is_none(),
                    "{name}: left {surface:?} along {direction}, met {again:?}"
                );
            }
        }
    }
    assert!(hits > 30, "{name}: {hits} hits");
}

/// Rays that leave a large floor right in front of a small step still hit the step.
#[test]
fn rays_do_not_pass_over_what_stands_on_the_floor() {
    let scene = scene(
        r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="10"/></transform></shape>
           <shape type="cube"><transform name="to_world"><scale value="0.001"/><translate y="0.001"/></transform></shape>"#,
    );
    let down = Ray::new(Vec3::new(-0.002, 1.0, 0.0), Vec3::NEG_Y);
    let floor = scene.intersect(&down).expect("the floor is below");
    for height in [0.01, 0.1, 0.5] {
        let wall = scene.intersect(&floor.spawn_ray(Vec3::new(1.0, height, 0.0).normalize()));
        let wall = wall.expect("the step is in the way");
        assert!((wall.point.x + 0.001).abs() < 1e-5, "{height}: {wall:?}");
    }
}
