//! Rays compared with Mitsuba's, and properties of all sensors.

use super::{Sensor, orthographic, perspective, thinlens};
use crate::film::FilmSpec;
use crate::testing::node::TestNode;
use etendue_document::{Class, Diagnostic, Fault, Severity, Value};
use glam::{DMat4, DVec3, UVec2, Vec2, Vec2Swizzles, Vec3};

const MITSUBA_RAYS: &str = include_str!("mitsuba_rays.txt");

/// Camera to world of the recorded rays, after a scale.
fn to_world(scale: DVec3) -> DMat4 {
    let origin = DVec3::new(1.0, 2.0, 3.0);
    let view = (DVec3::new(-0.5, 0.3, 1.0) - origin).normalize();
    let left = DVec3::new(0.0, 1.0, 0.2).cross(view).normalize();
    let columns = [left, view.cross(left), view].map(|column| column.extend(0.0));
    let matrix = DMat4::from_cols(columns[0], columns[1], columns[2], origin.extend(1.0));
    matrix * DMat4::from_scale(scale)
}

fn build(node: &TestNode, plugin: &str, film: UVec2) -> Option<Sensor> {
    let film = FilmSpec::new(film);
    node.build(|builder, parameters| match plugin {
        "perspective" => perspective::build(builder, parameters, &film).map(Sensor::Perspective),
        "thinlens" => thinlens::build(builder, parameters, &film).map(Sensor::ThinLens),
        _ => orthographic::build(builder, parameters, &film).map(Sensor::Orthographic),
    })
}

fn node(plugin: &str, scale: DVec3) -> TestNode {
    let node = TestNode::new(Class::Sensor, plugin);
    node.with("to_world", Value::transform(to_world(scale)))
}

/// One recorded ray.
struct Record {
    line: &'static str,
    sensor: Sensor,
    film_position: Vec2,
    aperture: Vec2,
    origin: Vec3,
    direction: Vec3,
    length: f32,
}

fn records() -> Vec<Record> {
    MITSUBA_RAYS.lines().filter(|line| !line.starts_with('#')).map(record).collect()
}

fn record(line: &'static str) -> Record {
    let fields: Vec<&str> = line.split('|').map(str::trim).collect();
    let numbers = |index: usize| -> Vec<f32> {
        fields[index].split(' ').map(|number| number.parse().expect("a number")).collect()
    };
    let node = fields[2].split_whitespace().fold(
        node(fields[0], Vec3::from_slice(&numbers(3)).as_dvec3()),
        |node, parameter| {
            let (name, value) = parameter.split_once('=').expect("name=value");
            match value.parse() {
                Ok(number) => node.float(name, number),
                Err(_) => node.string(name, value),
            }
        },
    );
    let film = Vec2::from_slice(&numbers(1)).as_uvec2();
    let sensor = build(&node, fields[0], film).expect("the sensor can be built");
    Record {
        line,
        sensor,
        film_position: Vec2::from_slice(&numbers(4)),
        aperture: Vec2::from_slice(&numbers(5)),
        origin: Vec3::from_slice(&numbers(6)),
        direction: Vec3::from_slice(&numbers(7)),
        length: numbers(8)[0],
    }
}

#[test]
fn rays_are_those_of_mitsuba() {
    let records = records();
    assert!(records.len() > 40);
    for record in records {
        let ray = record.sensor.sample_ray(record.film_position, record.aperture).ray;
        // Mitsuba multiplies by a 4×4 matrix in single precision.
        let line = record.line;
        assert!((ray.origin - record.origin).length() < 3e-6, "{line}: {ray:?}");
        assert!((ray.direction - record.direction).length() < 6e-6, "{line}: {ray:?}");
        assert!((ray.t_max / record.length - 1.0).abs() < 2e-5, "{line}: {ray:?}");
    }
}

#[test]
fn the_matrices_lead_back_to_the_film() {
    for record in records() {
        // A lens has a single projection only at the focus; through its centre it is a pinhole.
        let ray = record.sensor.sample_ray(record.film_position, Vec2::splat(0.5)).ray;
        let matrices = record.sensor.camera_matrices();
        let project = |distance: f32| {
            let projected = matrices.world_to_ndc * ray.at(distance).extend(1.0);
            projected / projected.w
        };
        for distance in [0.0, 5.0] {
            let place = project(distance);
            let error = (place.truncate().truncate() - record.film_position).length();
            // A near plane at a hundredth of the distance to the origin costs two digits.
            assert!(error < 1e-4, "{}: {place}", record.line);
        }
        assert!(project(0.0).z.abs() < 1e-3, "the near plane: {}", record.line);
        assert!((project(ray.t_max).z - 1.0).abs() < 1e-3, "the far plane: {}", record.line);
    }
}

#[test]
fn the_camera_space_of_headers_has_x_to_the_right_and_y_up() {
    let sensor = build(&node("perspective", DVec3::ONE), "perspective", UVec2::new(3, 2));
    let sensor = sensor.expect("the sensor can be built");
    let camera = |film_position: Vec2| {
        let ray = sensor.sample_ray(film_position, Vec2::ZERO).ray;
        sensor.camera_matrices().world_to_camera.transform_point3(ray.at(1.0))
    };
    let (left_upper, right_lower) = (camera(Vec2::ZERO), camera(Vec2::ONE));
    assert!(left_upper.x < -0.1 && left_upper.y > 0.1, "{left_upper}");
    assert!(right_lower.x > 0.1 && right_lower.y < -0.1, "{right_lower}");
}

#[test]
fn a_uniform_scale_changes_distances_alone() {
    for scale in [1e-12, 1e-3, 2.0, 1e12] {
        for plugin in ["perspective", "thinlens"] {
            let sensor = |scale: f64| {
                let node = node(plugin, DVec3::splat(scale)).float("fov", 40.0);
                let node = node.float("near_clip", 0.5).float("far_clip", 20.0);
                let node = match plugin {
                    "thinlens" => node.float("aperture_radius", 0.0).float("focus_distance", 3.0),
                    _ => node,
                };
                let sensor = build(&node, plugin, UVec2::new(3, 2));
                assert_eq!(node.findings(), [], "{plugin} {scale}");
                sensor.expect("the sensor can be built")
            };
            let ray = |scale| sensor(scale).sample_ray(Vec2::new(0.2, 0.7), Vec2::ONE * 0.3).ray;
            let (plain, scaled) = (ray(1.0), ray(scale));
            assert!((plain.direction - scaled.direction).length() < 1e-6, "{plugin} {scale}");
            assert!((scaled.t_max / plain.t_max / scale as f32 - 1.0).abs() < 1e-5);
        }
    }
}

#[test]
fn rays_of_a_lens_meet_at_the_focus_and_start_on_the_aperture() {
    let node = node("thinlens", DVec3::ONE).float("aperture_radius", 0.25);
    let node = node.float("focus_distance", 3.0).float("fov", 45.0).float("near_clip", 0.0);
    let sensor = build(&node, "thinlens", UVec2::new(3, 2)).expect("the sensor can be built");
    let centre = Vec3::new(1.0, 2.0, 3.0);
    let view = to_world(DVec3::ONE).z_axis.truncate().as_vec3();
    let at_focus = |aperture: Vec2| {
        let ray = sensor.sample_ray(Vec2::new(0.2, 0.7), aperture).ray;
        assert!((ray.origin - centre).length() <= 0.250_001, "{ray:?}");
        assert!((ray.origin - centre).dot(view).abs() < 1e-6, "{ray:?}");
        assert!((ray.direction.length() - 1.0).abs() < 1e-6);
        ray.at((3.0 - (ray.origin - centre).dot(view)) / ray.direction.dot(view))
    };
    let expected = at_focus(Vec2::splat(0.5));
    for index in 0..100 {
        let aperture = Vec2::new(index as f32 / 100.0, (index * 37 % 100) as f32 / 100.0);
        assert!((at_focus(aperture) - expected).length() < 2e-6, "{aperture}");
    }
}

/// The diagnostics of building a sensor.
fn findings(node: &TestNode, plugin: &str) -> Vec<(Severity, Fault)> {
    build(node, plugin, UVec2::new(3, 2));
    let of = |found: &Diagnostic| (found.severity, found.fault);
    node.findings().iter().map(of).collect()
}

#[test]
fn hostile_values_are_errors() {
    let unit = |plugin| node(plugin, DVec3::ONE);
    let cases = [
        ("perspective", unit("perspective").float("near_clip", -1.0)),
        ("perspective", unit("perspective").float("near_clip", 5.0).float("far_clip", 4.0)),
        ("orthographic", unit("orthographic").float("far_clip", f64::NAN)),
        ("orthographic", unit("orthographic").float("shutter_open", 1.0)),
        ("orthographic", node("orthographic", DVec3::new(1.0, 0.0, 1.0))),
        ("perspective", node("perspective", DVec3::splat(f64::NAN))),
        ("perspective", unit("perspective").float("principal_point_offset_x", f64::INFINITY)),
        ("thinlens", unit("thinlens").float("aperture_radius", -0.1)),
        ("thinlens", unit("thinlens").float("aperture_radius", 0.1).float("focus_distance", 0.0)),
        ("thinlens", unit("thinlens").float("aperture_radius", 0.1).float("focus_distance", 1e-60)),
    ];
    for (plugin, node) in cases {
        let found = findings(&node, plugin);
        assert_eq!(found, [(Severity::Error, Fault::BadValue)], "{:?}", node.findings());
    }
    let missing = findings(&unit("thinlens"), "thinlens");
    assert_eq!(missing, [(Severity::Error, Fault::MissingParameter)]);
}

#[test]
fn the_ends_of_all_ranges_give_rays_of_unit_direction() {
    let extremes = |plugin: &str, large: f64| match plugin {
        "thinlens" if large > 1.0 => node(plugin, DVec3::splat(1e12))
            .float("aperture_radius", 1e18)
            .float("focus_distance", 1e12)
            .float("far_clip", 1e18)
            .float("fov", 179.999_999),
        "thinlens" => node(plugin, DVec3::splat(1e-12))
            .float("aperture_radius", 1e-60)
            .float("focus_distance", 1e-66)
            .float("near_clip", 0.0)
            .float("fov", 1e-5),
        _ if large > 1.0 => node(plugin, DVec3::splat(1e12)).float("far_clip", 1e18),
        _ => node(plugin, DVec3::splat(1e-12)).float("near_clip", 0.0).float("far_clip", 1e-30),
    };
    for (plugin, large) in ["perspective", "thinlens", "orthographic"]
        .into_iter()
        .flat_map(|plugin| [(plugin, 2.0), (plugin, 0.5)])
    {
        let node = extremes(plugin, large);
        let sensor = build(&node, plugin, UVec2::new(100_000, 1)).expect("values within range");
        for place in [Vec2::ZERO, Vec2::splat(0.5), Vec2::ONE] {
            let ray = sensor.sample_ray(place, place.yx()).ray;
            assert!((ray.direction.length() - 1.0).abs() < 1e-5, "{plugin}: {ray:?}");
            assert!(ray.origin.is_finite() && ray.t_max > 0.0, "{plugin}: {ray:?}");
        }
    }
}

#[test]
fn unequal_scales_are_reported_where_they_stretch() {
    let stretched = DVec3::new(2.0, 1.0, 1.0);
    let found = findings(&node("perspective", stretched), "perspective");
    assert_eq!(found, [(Severity::Warning, Fault::BadValue)]);
    assert_eq!(findings(&node("orthographic", stretched), "orthographic"), [], "its way to zoom");
    assert_eq!(findings(&node("perspective", DVec3::new(-1.0, 1.0, 1.0)), "perspective"), []);
}
