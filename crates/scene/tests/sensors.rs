//! Sensors that are not cameras: rays compared with the manual pages.

use etendue_document::{Diagnostics, MemoryResources, Severity};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::sensor::SensorRay;
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_testkit::TestRng;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The film of sensors that measure a single number.
const PIXEL: &str = r#"<film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>"#;

/// A scene of the given elements, with a sphere of radius 2 around (1, 0, 0). It must build without
/// diagnostics.
fn scene(elements: &str) -> Scene {
    let diagnostics = Diagnostics::new();
    let files = MemoryResources::default();
    let text = format!(
        "<scene version=\"3.0.0\">{elements}<shape type=\"sphere\">
        <point name=\"center\" x=\"1\" y=\"0\" z=\"0\"/><float name=\"radius\" value=\"2\"/></shape></scene>"
    );
    let scene =
        read_text(&text, &files, &LoadOptions::default(), &diagnostics).ok().and_then(|document| {
            build_scene(&document, &files, &diagnostics, &BuildOptions::default())
        });
    assert!(diagnostics.sorted().is_empty(), "{:?}", diagnostics.sorted());
    scene.expect("a scene without findings")
}

/// The rays of a scene's first sensor.
fn rays(scene: &Scene) -> impl Iterator<Item = SensorRay> {
    let mut random = TestRng::new(9);
    let mut next = move || Vec2::new(random.next_f32(), random.next_f32());
    let sensor = &scene.sensors()[0].sensor;
    (0..2000).map(move |_| sensor.sample_ray(next(), next()))
}

#[test]
fn a_radiancemeter_is_one_ray() {
    let by_parameters =
        r#"<point name="origin" x="1" y="2" z="3"/><vector name="direction" x="0" y="-2" z="0"/>"#;
    let by_placement = r#"<transform name="to_world"><lookat origin="1, 2, 3" target="1, 0, 3" up="0, 0, 1"/></transform>"#;
    for placement in [by_parameters, by_placement] {
        let scene = scene(&format!("<sensor type=\"radiancemeter\">{placement}{PIXEL}</sensor>"));
        for found in rays(&scene).take(3) {
            assert!((found.ray.origin - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-6);
            assert!((found.ray.direction - Vec3::NEG_Y).length() < 1e-6);
            assert_eq!(found.weight, 1.0);
        }
    }
}

/// The rows are latitudes from +y down, the columns longitudes from −z by +x.
#[test]
fn a_spherical_sensor_sees_all_around() {
    let scene = scene("<sensor type=\"spherical\"/>");
    let sensor = &scene.sensors()[0].sensor;
    for (place, expected) in [
        (Vec2::new(0.0, 0.5), Vec3::NEG_Z),
        (Vec2::new(0.25, 0.5), Vec3::X),
        (Vec2::new(0.5, 0.5), Vec3::Z),
        (Vec2::new(0.3, 0.0), Vec3::Y),
        (Vec2::new(0.3, 1.0), Vec3::NEG_Y),
    ] {
        let found = sensor.sample_ray(place, Vec2::ZERO);
        assert!((found.ray.direction - expected).length() < 1e-6, "{place}: {found:?}");
        assert_eq!((found.ray.origin, found.weight), (Vec3::ZERO, 1.0));
    }
}

/// E[cos θ] of cosine-weighted directions is 2/3, with a standard deviation of √(1/18).
#[test]
fn an_irradiancemeter_counts_what_arrives_on_its_front() {
    let meter = format!("<sensor type=\"irradiancemeter\">{PIXEL}</sensor>");
    let scene = scene(&format!(
        "<shape type=\"rectangle\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"-90\"/>
         <translate y=\"5\"/></transform>{meter}</shape>"
    ));
    let (mut sum, mut mean_place) = (0.0, Vec3::ZERO);
    for found in rays(&scene) {
        assert!((found.weight / PI - 1.0).abs() < 1e-5, "{found:?}");
        assert!((found.ray.origin.y - 5.0).abs() < 1e-4 && found.ray.direction.y >= 0.0);
        sum += found.ray.direction.y;
        mean_place += found.ray.origin / 2000.0;
    }
    let standard_error = (1.0_f32 / 18.0 / 2000.0).sqrt();
    assert!((sum / 2000.0 - 2.0 / 3.0).abs() < 4.0 * standard_error, "{sum}");
    // Uniform in [−1, 1].
    let standard_error = (1.0_f32 / 3.0 / 2000.0).sqrt();
    assert!(mean_place.x.abs().max(mean_place.z.abs()) < 4.0 * standard_error, "{mean_place}");
}

#[test]
fn a_distant_sensor_looks_from_outside_at_its_target() {
    let sensor = |target: &str| {
        format!(
            "<sensor type=\"distant\"><vector name=\"direction\" x=\"0\" y=\"-3\" z=\"0\"/>{target}{PIXEL}</sensor>"
        )
    };
    let all = scene(&sensor(""));
    let (centre, radius) = all.bounds().bounding_sphere();
    let mut second_moment = 0.0;
    for found in rays(&all) {
        assert!((found.ray.direction - Vec3::NEG_Y).length() < 1e-6 && found.weight == 1.0);
        assert!(found.ray.origin.y >= 2.0, "outside of the scene");
        let aside = found.ray.origin - centre;
        second_moment += aside.x.hypot(aside.z).powi(2) / radius.powi(2) / 2000.0;
    }
    // r² is uniform in [0, 1] on a disk: mean 1/2, standard deviation √(1/12).
    assert!((second_moment - 0.5).abs() < 4.0 * (1.0_f32 / 12.0 / 2000.0).sqrt());

    let point = scene(&sensor(r#"<point name="target" x="0.3" y="1" z="-0.5"/>"#));
    let found = rays(&point).next().expect("a ray");
    assert!(found.ray.origin.y > 2.0);
    assert!((found.ray.origin.x - 0.3).abs() < 1e-5 && (found.ray.origin.z + 0.5).abs() < 1e-5);

    let shape = r#"<shape name="target" type="rectangle"><transform name="to_world"><scale value="0.5"/><rotate x="1" angle="-90"/><translate x="1"/></transform></shape>"#;
    let shape = scene(&sensor(shape));
    assert_eq!(shape.statistics().shapes, 1, "the target is no part of the scene");
    for found in rays(&shape) {
        let aside = (found.ray.origin - Vec3::X) * Vec3::new(1.0, 0.0, 1.0);
        assert!(aside.abs().max_element() <= 0.5 + 1e-5, "{found:?}");
        assert!((found.weight - 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_batch_shows_its_sensors_side_by_side() {
    let film = r#"<film type="hdrfilm"><integer name="width" value="2"/><integer name="height" value="1"/></film>"#;
    let scene = scene(&format!(
        r#"<sensor type="batch">
        <sensor type="orthographic"/>
        <sensor type="radiancemeter"><point name="origin" x="0" y="9" z="0"/>
            <vector name="direction" x="0" y="-1" z="0"/>{PIXEL}</sensor>{film}</sensor>"#
    ));
    let sensor = &scene.sensors()[0].sensor;
    let at = |x: f32, y: f32| sensor.sample_ray(Vec2::new(x, y), Vec2::splat(0.5)).ray;
    assert!((at(0.25, 0.5).origin.truncate()).length() < 1e-6, "the middle of the first");
    assert!((at(0.0, 0.5).origin.x - 1.0).abs() < 1e-6, "its left edge");
    assert!((at(0.499, 0.5).origin.x + 0.996).abs() < 1e-5, "its right edge");
    assert_eq!(at(0.75, 0.3).direction, Vec3::NEG_Y);
}

#[test]
fn what_cannot_be_is_reported() {
    for (text, severity) in [
        ("<sensor type=\"batch\"/>".to_owned(), Severity::Error),
        (
            "<sensor type=\"batch\"><sensor type=\"perspective\"/><sensor type=\"perspective\"/>
            <film type=\"hdrfilm\"><integer name=\"width\" value=\"7\"/></film></sensor>"
                .to_owned(),
            Severity::Error,
        ),
        ("<sensor type=\"distant\"/>".to_owned(), Severity::Warning),
        (
            format!(
                "<sensor type=\"radiancemeter\"><vector name=\"direction\" x=\"0\" y=\"0\" z=\"0\"/>{PIXEL}</sensor>"
            ),
            Severity::Error,
        ),
        (format!("<sensor type=\"irradiancemeter\">{PIXEL}</sensor>"), Severity::Warning),
    ] {
        let diagnostics = Diagnostics::new();
        let files = MemoryResources::default();
        let whole = format!("<scene version=\"3.0.0\">{text}<shape type=\"sphere\"/></scene>");
        let document = read_text(&whole, &files, &LoadOptions::default(), &diagnostics);
        let document = document.expect("the text can be read");
        let _ = build_scene(&document, &files, &diagnostics, &BuildOptions::default());
        let found = diagnostics.sorted();
        assert!(found.iter().any(|finding| finding.severity == severity), "{text}: {found:?}");
    }
}
