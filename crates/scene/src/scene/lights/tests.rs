//! Light samples in lanes equal single light samples bit by bit.

use super::*;
use crate::emitter::Target;
use crate::testing::emitter_cases::{extreme, hittable, leaving, scene};
use crate::{SurfaceInteraction, SurfaceLanes};
use etendue_math::lanes::{
    Frame3, LaneArray, LaneMask, Lanes, Level, MAX_LANES, Mask, Simd, Vector2, Vector3, baseline,
};
use etendue_math::{Frame, RayLanes, with_lanes};
use etendue_spectrum::Spectrum;
use etendue_testkit::TestRng;
use glam::{Vec2, Vec3};

/// A light in the plane z = 0 that shines upwards.
const PANEL: &str = r#"<shape type="rectangle"><emitter type="area"><rgb name="radiance" value="9, 5, 2"/></emitter></shape>"#;
/// A slanted one that shines downwards.
const SLANTED: &str = r#"<shape type="rectangle"><boolean name="flip_normals" value="true"/>
    <transform name="to_world"><scale x="0.3" y="2"/><rotate x="1" y="2" angle="37"/><translate x="3" y="-1" z="4"/></transform>
    <emitter type="area"><rgb name="radiance" value="0.1, 0.2, 0.3"/><float name="sampling_weight" value="3"/></emitter></shape>"#;
/// One emitter for each other kind of result: a point without a normal, a curved surface, infinity,
/// none, textured.
const OTHERS: &str = r#"
    <emitter type="point"><point name="position" x="1" y="2" z="3"/></emitter>
    <shape type="sphere"><point name="center" x="3" y="1" z="0"/><emitter type="area"/></shape>
    <emitter type="constant"><rgb name="radiance" value="0.1, 0.5, 0.2"/></emitter>
    <emitter type="directional"><vector name="direction" x="1" y="0.3" z="-2"/></emitter>
    <shape type="disk"><emitter type="directionalarea"/></shape>
    <shape type="rectangle"><transform name="to_world"><translate x="-2"/></transform>
        <emitter type="area"><texture type="checkerboard" name="radiance"/></emitter></shape>
    <shape type="cube"><emitter type="area"/></shape>"#;

/// Emitting meshes: smooth; faceted and facing the other way; and with thousands of triangles.
const MESHES: [&str; 3] = [
    r#"<shape type="obj"><string name="filename" value="roof.obj"/>
        <emitter type="area"><rgb name="radiance" value="2, 3, 4"/></emitter></shape>"#,
    r#"<shape type="obj"><string name="filename" value="roof.obj"/>
        <boolean name="face_normals" value="true"/><boolean name="flip_normals" value="true"/>
        <transform name="to_world"><rotate y="1" angle="70"/><translate x="-1" y="0.5" z="3"/></transform>
        <emitter type="area"><rgb name="radiance" value="7, 1, 1"/></emitter></shape>"#,
    r#"<shape type="obj"><string name="filename" value="field.obj"/>
        <boolean name="face_normals" value="true"/>
        <emitter type="area"/></shape>"#,
];

fn scenes() -> Vec<(&'static str, Scene)> {
    let many = PANEL.repeat(40);
    let surroundings =
        r#"<emitter type="constant"><rgb name="radiance" value="0.1, 0.5, 0.2"/></emitter>"#;
    let weighted =
        r#"<emitter type="constant"><float name="sampling_weight" value="0.2"/></emitter>"#;
    vec![
        ("none", scene("")),
        ("a panel", scene(PANEL)),
        ("a panel turned around", scene(SLANTED)),
        ("surroundings", scene(surroundings)),
        ("a panel and surroundings", scene(&format!("{PANEL}{surroundings}"))),
        ("one of another kind", scene(r#"<emitter type="point"/>"#)),
        ("panels alone", scene(&many)),
        ("panels and others", scene(&format!("{PANEL}{OTHERS}"))),
        ("others alone", scene(OTHERS)),
        ("weights", scene(&format!("{PANEL}{SLANTED}{weighted}{PANEL}"))),
        ("a smooth mesh", scene(MESHES[0])),
        ("a faceted mesh", scene(MESHES[1])),
        ("a mesh of many triangles", scene(MESHES[2])),
        ("meshes alone", scene(&MESHES.concat())),
        ("meshes, panels and surroundings", {
            scene(&format!("{PANEL}{}{surroundings}{}", MESHES[0], MESHES[1]))
        }),
        ("meshes, weights and others", {
            scene(&format!("{}{SLANTED}{OTHERS}{}{PANEL}{}", MESHES[1], MESHES[0], MESHES[2]))
        }),
        ("weights and others", scene(&format!("{SLANTED}{OTHERS}{PANEL}"))),
    ]
}

/// The points that light is sampled for, and their random numbers.
#[derive(Clone, Copy)]
struct Question {
    reference: Vec3,
    error: Vec3,
    normal: Vec3,
    random: Vec2,
}

/// Points of all kinds: anywhere, in the plane of the parallelogram, on it, below it, close to it,
/// far away, and with infinite coordinates.
fn questions(count: usize) -> Vec<Question> {
    let mut rng = TestRng::new(5);
    let number = |rng: &mut TestRng| rng.next_f32() * 2.0 - 1.0;
    (0..count)
        .map(|index| {
            let anywhere = Vec3::new(number(&mut rng), number(&mut rng), number(&mut rng)) * 5.0;
            let reference = match index % 16 {
                0 => anywhere.with_z(0.0),
                1 => (anywhere * 0.2).with_z(0.0),
                2 => anywhere.with_z(-anywhere.z.abs()),
                3 => (anywhere * 0.2).with_z(1e-30),
                4 => anywhere * 1e18,
                5 => anywhere * 1e38,
                6 => anywhere.with_x(f32::INFINITY),
                7 => anywhere.with_y(f32::NAN),
                8 => Vec3::ZERO,
                _ => anywhere,
            };
            let random = match index % 7 {
                0 => Vec2::new(0.0, 1.0 - f32::EPSILON / 2.0),
                1 => Vec2::new(1.0 - f32::EPSILON / 2.0, 0.0),
                // The centre of the parallelogram, if it is the only light.
                2 => Vec2::splat(0.5),
                _ => Vec2::new(rng.next_f32(), rng.next_f32()),
            };
            let normal = anywhere.cross(Vec3::new(0.3, 0.2, -0.9)).normalize_or_zero();
            Question { reference, error: anywhere.abs() * 1e-6, normal, random }
        })
        .collect()
}

/// The results of the lanes, one by one.
struct Answer {
    light: Option<DirectionSample>,
    shadow_ray: etendue_math::Ray,
}

#[inline(always)]
fn ask<S: Simd>(simd: S, scene: &Scene, questions: &[Question], wanted: u32) -> Vec<Answer> {
    let mut answers = Vec::new();
    for first in (0..questions.len()).step_by(Lanes::<S>::COUNT) {
        let chunk = &questions[first..questions.len().min(first + Lanes::<S>::COUNT)];
        let (mut reference, mut error, mut normal) =
            ([LaneArray::ZERO; 3], [LaneArray::ZERO; 3], [LaneArray::ZERO; 3]);
        let mut random = [LaneArray::ZERO; 2];
        for (lane, question) in chunk.iter().enumerate() {
            Vector3::from(question.reference).put(&mut reference, lane);
            Vector3::from(question.error).put(&mut error, lane);
            Vector3::from(question.normal).put(&mut normal, lane);
            Vector2::from(question.random).put(&mut random, lane);
        }
        let random = Vector2::load(simd, &random, 0);
        let surface = SurfaceLanes {
            point: Vector3::load(simd, &reference, 0),
            error: Vector3::load(simd, &error, 0),
            normal: Vector3::load(simd, &normal, 0),
            shading: Frame3::from_normal(Vector3::load(simd, &normal, 0)),
            uv: random,
            dp_du: Vector3::load(simd, &error, 0),
            dp_dv: Vector3::load(simd, &error, 0),
            wi: Vector3::load(simd, &normal, 0),
        };
        let wanted = LaneMask::from_bits(simd, wanted >> first);
        let light = scene.sample_lights(simd, surface.point, random, wanted);
        let rays = light.shadow_rays(&surface);
        answers.extend((0..chunk.len()).map(|lane| answer(&light, &rays, lane)));
    }
    answers
}

#[inline(always)]
fn answer<S: Simd>(light: &LightLanes<Lanes<S>>, rays: &RayLanes<Lanes<S>>, lane: usize) -> Answer {
    let target = &light.target;
    let target = if target.afar.bits() >> lane & 1 == 1 {
        Target::Afar
    } else {
        Target::Point {
            point: target.point.lane(lane),
            error: target.error.lane(lane),
            normal: target.normal.lane(lane),
        }
    };
    let mut radiance = [LaneArray::ZERO; Spectrum::LANES];
    light.radiance.store(&mut radiance, 0);
    let sample = DirectionSample {
        direction: light.direction.lane(lane),
        radiance: Spectrum::from(radiance.map(|component| component.0[lane])),
        pdf: light.pdf.lane(lane),
        delta: light.delta.bits() >> lane & 1 == 1,
        target,
    };
    let exists = light.exists.bits() >> lane & 1 == 1;
    Answer { light: exists.then_some(sample), shadow_ray: rays.lane(lane) }
}

/// All bits of the light and of the shadow ray.
fn bits(light: &DirectionSample, ray: &etendue_math::Ray) -> Vec<u32> {
    let mut numbers = vec![light.pdf, ray.t_max, f32::from(u8::from(light.delta))];
    numbers.extend((0..Spectrum::LANES).map(|component| light.radiance[component]));
    let mut vectors = vec![light.direction, ray.origin, ray.direction];
    match light.target {
        Target::Afar => numbers.push(1.0),
        Target::Point { point, error, normal } => vectors.extend([point, error, normal]),
    }
    numbers.extend(vectors.into_iter().flat_map(|vector| vector.to_array()));
    numbers.into_iter().map(f32::to_bits).collect()
}

fn compare(name: &str, scene: &Scene, questions: &[Question], wanted: u32) -> usize {
    let mut found = 0;
    for level in [baseline(), Level::new()] {
        let answers = with_lanes!(level, simd => ask(simd, scene, questions, wanted));
        for (index, (question, answer)) in questions.iter().zip(&answers).enumerate() {
            let frame = Frame::from_normal(Vec3::Z);
            let surface = SurfaceInteraction {
                point: question.reference,
                error: question.error,
                normal: question.normal,
                ..SurfaceInteraction::at_uv(Vec2::ZERO, frame)
            };
            let expected = scene
                .sample_light(question.reference, question.random)
                .filter(|_| wanted >> index & 1 == 1)
                .map(|light| bits(&light, &light.shadow_ray(&surface)));
            let lane = answer.light.map(|light| bits(&light, &answer.shadow_ray));
            assert_eq!(lane, expected, "{name}, {level:?}, {}", question.reference);
            found += usize::from(lane.is_some());
        }
    }
    found
}

#[test]
fn lanes_choose_what_single_paths_choose() {
    for (name, scene) in scenes() {
        let mut found = 0;
        for block in questions(40 * MAX_LANES).chunks(MAX_LANES) {
            found += compare(name, &scene, block, u32::MAX);
        }
        assert_eq!(found == 0, name == "none", "{name}: {found}");
    }
}

#[test]
fn lanes_choose_the_light_of_every_plugin() {
    for xml in hittable().chain(leaving()).chain(extreme()) {
        for block in questions(4 * MAX_LANES).chunks(MAX_LANES) {
            compare(xml, &scene(xml), block, u32::MAX);
        }
    }
}

#[test]
fn lanes_that_are_not_wanted_have_no_light() {
    for (name, scene) in scenes() {
        let block = &questions(2 * MAX_LANES)[7..][..MAX_LANES];
        for wanted in [0, 1, 0b1010_0000_0000_0110, 0xff00, 0x8000] {
            compare(name, &scene, block, wanted);
        }
    }
}
