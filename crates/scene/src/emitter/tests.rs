//! Tests of all emitters: samples, the densities of directions found by tracing rays, and total
//! power.

use super::Emitter;
use crate::testing::emitter_cases::{PLUGINS, extreme, hittable, leaving, scene};
use crate::{EmitterId, Scene, ShapeId, SurfaceInteraction};
use etendue_math::{Frame, Ray};
use etendue_testkit::{Accumulator, ChiSquare, TestRng, welch};
use glam::Vec3;

const REFERENCE: Vec3 = Vec3::new(0.3, -0.2, 0.1);

/// The density with which the scene's only emitter samples the direction, found by tracing a ray.
fn traced_pdf(scene: &Scene, direction: Vec3) -> f32 {
    let emitter = scene.emitter(EmitterId(0));
    let found = scene.intersect(&Ray::new(REFERENCE, direction));
    match &found {
        // Sampling also chooses points on the back of an emitting shape, which contribute nothing.
        Some(surface) if surface.wi.z <= 0.0 => 0.0,
        _ => emitter.pdf_direction(scene, REFERENCE, direction, found.as_ref()),
    }
}

#[test]
fn directions_are_sampled_with_the_density_that_a_ray_finds() {
    for name in hittable() {
        let scene = scene(name);
        let emitter = scene.emitter(EmitterId(0));
        let sample = |random: &mut TestRng| {
            let sample = emitter.sample_direction(&scene, REFERENCE, random.next_vec2())?;
            Some(sample.direction)
        };
        let outcome = ChiSquare::one_of(hittable().count() as u32)
            .sphere(sample, |direction| traced_pdf(&scene, direction));
        assert!(outcome.accepted(), "{name}: {outcome:?}");
    }
}

#[test]
fn the_density_of_a_sample_is_that_of_its_direction() {
    let mut random = TestRng::new(3);
    for name in hittable() {
        let scene = scene(name);
        let emitter = scene.emitter(EmitterId(0));
        let mut differing = 0;
        for _ in 0..2000 {
            let Some(sample) = emitter.sample_direction(&scene, REFERENCE, random.next_vec2())
            else {
                continue;
            };
            let pdf = traced_pdf(&scene, sample.direction);
            differing += u32::from((pdf / sample.pdf - 1.0).abs() > 5e-3);
        }
        // A direction that grazes an edge of a shape or of a texel may be traced to the other side
        // of the edge.
        assert!(differing <= 4, "{name}: {differing} of 2000");
    }
}

/// ∫ L dω over all directions, by sampling the emitter and by tracing uniform directions.
#[test]
fn sampling_and_tracing_find_the_same_light() {
    let mut random = TestRng::new(11);
    for name in hittable() {
        let scene = scene(name);
        let emitter = scene.emitter(EmitterId(0));
        let (mut sampled, mut traced) = (Accumulator::default(), Accumulator::default());
        for _ in 0..40_000 {
            let sample = emitter.sample_direction(&scene, REFERENCE, random.next_vec2());
            sampled.add(sample.map_or(0.0, |s| f64::from(s.radiance.luminance() / s.pdf)));
            let direction = random.unit_vector();
            let radiance = match scene.intersect(&Ray::new(REFERENCE, direction)) {
                Some(surface) => emitter.surface_radiance(&scene, &surface),
                None => emitter.distant_radiance(direction),
            };
            traced.add(f64::from(radiance.luminance()) * 4.0 * std::f64::consts::PI);
        }
        // Estimates of a constant emitter vary only by rounding.
        let close = (sampled.mean() / traced.mean() - 1.0).abs() < 1e-4;
        let outcome = welch(&sampled, &traced);
        assert!(close || outcome.accepts(1e-4), "{name}: {} and {}", sampled.mean(), traced.mean());
    }
}

/// Emitters are chosen in proportion to their weights; the third has weight zero.
#[test]
fn sampling_weights_say_how_often() {
    let light = |weight: f32| {
        format!(
            r#"<emitter type="point"><float name="sampling_weight" value="{weight}"/></emitter>"#
        )
    };
    let scene = scene(&format!(
        "{}{}<emitter type=\"constant\"><float name=\"sampling_weight\" value=\"0\"/></emitter>",
        light(1.0),
        light(3.0)
    ));
    let mut random = TestRng::new(1);
    let mut counts = [0_u32; 3];
    for _ in 0..10_000 {
        let mut number = random.next_f32();
        let choice = scene.choose_emitter(&mut number).expect("there are emitters");
        assert_eq!(choice.probability, scene.emitter_probability(choice.emitter));
        assert!((0.0..1.0).contains(&number));
        counts[choice.emitter.0 as usize] += 1;
    }
    // The standard deviation of the first count is √(10,000 · ¼ · ¾) = 43.
    assert!(counts[0].abs_diff(2500) < 4 * 43 && counts[2] == 0, "{counts:?}");
    assert_eq!(
        [0, 1, 2].map(|index| scene.emitter_probability(EmitterId(index))),
        [0.25, 0.75, 0.0]
    );
}

#[test]
fn delta_emitters_give_what_their_formulas_say() {
    let point = scene(
        r#"<emitter type="point"><point name="position" x="0.3" y="-0.2" z="2.1"/><rgb name="intensity" value="8"/></emitter>"#,
    );
    let sample = |scene: &Scene| {
        let emitter: &Emitter = scene.emitter(EmitterId(0));
        emitter.sample_direction(scene, REFERENCE, glam::Vec2::ZERO)
    };
    // 8 / 2².
    let light = sample(&point).expect("the point shines everywhere");
    assert!((light.radiance.luminance() - 2.0).abs() < 1e-5 && light.delta && light.pdf == 1.0);
    assert!((light.direction - Vec3::Z).length() < 1e-6);

    let directional = scene(
        r#"<emitter type="directional"><vector name="direction" x="0" y="-3" z="0"/></emitter>"#,
    );
    let light = sample(&directional).expect("it shines everywhere");
    assert!((light.direction - Vec3::Y).length() < 1e-6);
    assert!((light.radiance.luminance() - 1.0).abs() < 1e-6);

    // From (0.3, −0.2, 2.1) straight down: the reference lies on the axis, at distance 2.
    let spot = |target: &str| {
        scene(&format!(
            r#"<emitter type="spot"><transform name="to_world"><lookat origin="0.3, -0.2, 2.1" target="{target}" up="0, 1, 0"/></transform><float name="cutoff_angle" value="30"/><float name="beam_width" value="10"/></emitter>"#
        ))
    };
    let light = sample(&spot("0.3, -0.2, 0")).expect("on the axis");
    assert!((light.radiance.luminance() - 0.25).abs() < 1e-5);
    // 2·tan 20° off the axis, halfway down the falloff.
    let light = sample(&spot("1.027940, -0.2, 0.1")).expect("within the cone");
    assert!((light.radiance.luminance() - 0.125).abs() < 1e-4, "{light:?}");
    assert!(sample(&spot("3, -0.2, 0.1")).is_none(), "beyond the cone");
}

/// Values from Mitsuba 3.9.1 for the same lights and points.
#[test]
fn projected_pictures_fall_where_mitsuba_throws_them() {
    let placement = r#"<transform name="to_world"><lookat origin="0.3, 1, 2" target="0.1, 0, 0" up="0, 1, 0"/></transform>"#;
    let picture = r#"type="bitmap"><string name="filename" value="slide.exr"/><string name="filter_type" value="nearest"/><boolean name="raw" value="true"/></texture>"#;
    let projector = format!(
        r#"<emitter type="projector"><texture name="irradiance" {picture}<float name="fov" value="60"/><float name="scale" value="2"/>{placement}</emitter>"#
    );
    let spot = format!(
        r#"<emitter type="spot"><rgb name="intensity" value="3, 2, 1"/><texture name="texture" {picture}<float name="cutoff_angle" value="35"/>{placement}</emitter>"#
    );
    let points = [
        [0.0, 0.0, 0.0],
        [0.4, 0.2, 0.1],
        [-0.5, 0.3, -0.2],
        [0.1, -0.6, 0.3],
        [0.9, 0.9, 0.0],
        [0.5, -0.3, 0.0],
    ];
    let expected = [
        (
            projector,
            [
                [0.0, 1.238_035_2, 0.0],
                [0.0, 0.0, 1.527_333_9],
                [0.0, 1.193_591, 0.0],
                [0.0; 3],
                [0.0; 3],
                [1.169_353_2, 0.0, 1.169_353_2],
            ],
        ),
        (
            spot,
            [
                [0.589_391, 0.0, 0.196_463_67],
                [0.0, 0.469_483_55, 0.234_741_78],
                [0.502_512_7, 0.0, 0.167_504_22],
                [0.0, 0.0, 0.182_149_35],
                [0.117_740_57, 0.078_493_71, 0.039_246_86],
                [0.0, 0.349_040_15, 0.0],
            ],
        ),
    ];
    for (light, expected) in expected {
        let scene = scene(&light);
        for (point, expected) in points.into_iter().zip(expected) {
            let emitter = scene.emitter(EmitterId(0));
            let sample = emitter.sample_direction(&scene, Vec3::from(point), glam::Vec2::ZERO);
            let found = sample.map_or([0.0; 3], |sample| sample.radiance.rgb());
            let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4);
            assert!(close, "{light} at {point:?}: {found:?} instead of {expected:?}");
        }
    }
}

/// The power that arrives on a disk, by tracing rays from the light and by sampling the light from
/// points on the disk.
#[test]
fn light_that_leaves_arrives() {
    let receiver = r#"<shape type="disk"><transform name="to_world"><scale x="0.7" y="0.5"/><rotate x="1" angle="20"/><translate z="-1"/></transform></shape>"#;
    let mut random = TestRng::new(5);
    for light in leaving() {
        let scene = scene(&format!("{receiver}{light}"));
        let emitter = scene.emitter(EmitterId(0));
        let (mut traced, mut sampled) = (Accumulator::default(), Accumulator::default());
        for _ in 0..60_000 {
            let leaving = emitter.sample_ray(&scene, random.next_vec2(), random.next_vec2());
            let arrived = leaving.filter(|leaving| {
                let hit = scene.intersect(&leaving.ray);
                hit.is_some_and(|surface| surface.shape == ShapeId(0))
            });
            traced.add(arrived.map_or(0.0, |leaving| f64::from(leaving.power.luminance())));
            let Some(point) = scene.shape(ShapeId(0)).sample_area(random.next_vec2()) else {
                continue;
            };
            let from = SurfaceInteraction {
                point: point.point,
                error: point.error,
                ..SurfaceInteraction::at_uv(point.uv, Frame::from_normal(point.normal))
            };
            let light = emitter.sample_direction(&scene, point.point, random.next_vec2());
            let light = light.filter(|light| !scene.occluded(&light.shadow_ray(&from)));
            sampled.add(light.map_or(0.0, |light| {
                let cosine = light.direction.dot(point.normal).abs();
                f64::from(light.radiance.luminance() * cosine / (light.pdf * point.pdf))
            }));
        }
        let outcome = welch(&traced, &sampled);
        assert!(outcome.accepts(1e-4), "{light}: {} and {}", traced.mean(), sampled.mean());
        assert!(traced.mean() > 0.0, "{light}");
    }
}

#[test]
fn every_plugin_has_its_cases() {
    for (name, cases) in PLUGINS {
        let names_itself = |xml: &&str| xml.contains(&format!("<emitter type=\"{name}\""));
        assert!(cases.extreme.iter().any(names_itself), "`{name}` has no extreme case");
        let samples: Vec<_> = cases
            .extreme
            .iter()
            .chain(cases.leaving)
            .filter_map(|xml| {
                let scene = scene(xml);
                let reference = Vec3::new(0.01, 0.02, -1.0);
                let light = scene.emitter(EmitterId(0));
                light.sample_direction(&scene, reference, glam::Vec2::splat(0.3))
            })
            .collect();
        let leaves = cases.leaving.iter().any(names_itself);
        assert_eq!(leaves, !samples.is_empty(), "the cases of light that leaves `{name}`");
        let is_hittable = cases.hittable.iter().any(names_itself);
        let is_spread = samples.iter().any(|sample| !sample.delta);
        assert_eq!(is_hittable, is_spread, "the cases of rays that find `{name}`");
    }
}

/// Points of all kinds: on the light, far away and close together.
#[test]
fn extreme_lights_stay_finite() {
    let mut random = TestRng::new(8);
    for xml in hittable().chain(leaving()).chain(extreme()) {
        let scene = scene(xml);
        let emitter = scene.emitter(EmitterId(0));
        for round in 0..2000 {
            let scale = [0.0, 1e-20, 1e-6, 1.0, 1e6][round % 5];
            let reference = random.unit_vector() * scale;
            let light = emitter.sample_direction(&scene, reference, random.next_vec2());
            let sound = light.is_none_or(|light| {
                let radiance = light.radiance;
                light.pdf > 0.0
                    && light.pdf.is_finite()
                    && (light.direction.length() - 1.0).abs() < 1e-4
                    && !radiance.has_negative()
                    && radiance.rgb().iter().all(|component| !component.is_nan())
            });
            assert!(sound, "{xml} from {reference}: {light:?}");
            let ray = emitter.sample_ray(&scene, random.next_vec2(), random.next_vec2());
            let sound = ray.is_none_or(|leaving| {
                let power = leaving.power;
                power.is_finite() && !power.has_negative() && leaving.ray.origin.is_finite()
            });
            assert!(sound, "{xml}: {ray:?}");
        }
    }
}
