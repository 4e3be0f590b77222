//! Paths shaded together in SIMD lanes are bit-identical to the same paths shaded alone.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_integrators::{
    CameraRay, Integrator, IntegratorOptions, Radiance, Start, Watch, build_integrator,
};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_sampling::{SamplerKind, SamplerSpec};
use etendue_scene::{BuildOptions, Scene, Tier, build_scene};
use glam::{UVec2, Vec3};

/// A tetrahedron with normals and texture coordinates; one face has neither.
const TETRAHEDRON: &str = "v 0 0 1\nv 1 0 -0.4\nv -0.5 0.9 -0.4\nv -0.5 -0.9 -0.4\n\
     vn 0 0 1\nvn 0.9 0 -0.4\nvn -0.5 0.8 -0.3\nvn -0.5 -0.8 -0.3\n\
     vt 0 0\nvt 1 0\nvt 0 1\nvt 0.7 0.7\n\
     f 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/4\nf 1/1/1 4/4/4 2/2/2\nf 2/1/2 4/1/4 3/1/3\n";

/// One of each material that is shaded in lanes, textured if it can be.
const MATERIALS: &[&str] = &[
    r#"<bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf>"#,
    r#"<bsdf type="conductor"><string name="material" value="Cu"/></bsdf>"#,
    r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.4"/></bsdf>"#,
    r#"<bsdf type="roughconductor"><string name="material" value="Al"/><float name="alpha" value="0.3"/></bsdf>"#,
    r#"<bsdf type="dielectric"/>"#,
    r#"<bsdf type="thindielectric"/>"#,
    r#"<bsdf type="roughdielectric"><float name="alpha" value="0.2"/></bsdf>"#,
    r#"<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.1, 0.5, 0.7"/></bsdf>"#,
    r#"<bsdf type="roughplastic"><boolean name="nonlinear" value="true"/></bsdf>"#,
    r#"<bsdf type="roughplastic"><string name="distribution" value="ggx"/><texture type="checkerboard" name="diffuse_reflectance"/></bsdf>"#,
];

/// Materials that cannot be nested in `twosided`.
fn transmits(material: &str) -> bool {
    material.contains("dielectric")
}

struct Setup {
    scene: Scene,
    integrator: Box<dyn Integrator>,
}

fn setup(integrator: &str, material: &str, tier: Option<Tier>) -> Setup {
    let text = format!(
        r#"<scene>{integrator}
        <shape type="cube"><transform name="to_world"><scale value="4"/></transform>
            <boolean name="flip_normals" value="true"/>
            <bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.6, 0.5"/></bsdf></shape>
        <shape type="obj"><string name="filename" value="tetrahedron.obj"/>{material}</shape>
        <shape type="obj"><string name="filename" value="tetrahedron.obj"/>
            <boolean name="face_normals" value="true"/>
            <transform name="to_world"><translate x="1.5" y="1" z="-1"/></transform>{material}</shape>
        <shape type="sphere"><point name="center" x="-2" y="1" z="0.5"/>{material}</shape>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="180"/>
            <translate z="3.5"/></transform>
            <emitter type="area"><rgb name="radiance" value="9, 8, 7"/></emitter></shape>
        <shape type="sphere"><point name="center" x="2" y="-2" z="1"/><float name="radius" value="0.3"/>
            <emitter type="area"><rgb name="radiance" value="5, 6, 7"/></emitter></shape>
        <emitter type="point"><point name="position" x="-3" y="-3" z="2"/></emitter>
        <sensor type="perspective"/></scene>"#
    );
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default().with("tetrahedron.obj", TETRAHEDRON);
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
        .unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    let options = BuildOptions { tier, ..BuildOptions::default() };
    let scene = build_scene(&document, &resources, &diagnostics, &options)
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()));
    let integrator = build_integrator(&document, &IntegratorOptions::default(), &diagnostics)
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()));
    Setup { scene, integrator }
}

/// Rays from a corner of the room in all directions into it.
fn rays() -> Vec<CameraRay> {
    let plan = SamplerSpec::new(SamplerKind::Sobol, 4, 7);
    let samples = (0..12).flat_map(|x| (0..8).map(move |y| UVec2::new(x, y)));
    samples
        .flat_map(|pixel| (0..4).map(move |index| (pixel, index)))
        .map(|(pixel, index)| {
            let mut sampler = plan.start(pixel, index);
            let place = (pixel.as_vec2() + sampler.next_2d()) / 10.0 - 0.5;
            let towards = Vec3::new(1.0 - 0.5 * place.x, 0.6 + place.x, 0.4 - place.y);
            let ray = Ray::new(Vec3::new(-3.0, -2.0, -0.5), towards.normalize());
            CameraRay { start: Start { ray, medium: None }, sampler }
        })
        .collect()
}

impl Setup {
    fn together(&self) -> Vec<Radiance> {
        let mut radiance = Vec::new();
        self.integrator.sample_batch(
            &self.scene,
            &mut rays(),
            &mut [],
            &Watch::patient(),
            &mut radiance,
        );
        radiance
    }

    fn alone(&self) -> Vec<Radiance> {
        let watch = Watch::patient();
        let sample = |mut ray: CameraRay| {
            self.integrator.sample(&self.scene, &ray.start, &mut ray.sampler, &mut [], &watch)
        };
        rays().into_iter().map(sample).collect()
    }
}

fn assert_same(what: &str, found: &[Radiance], expected: &[Radiance]) {
    let lit = expected.iter().filter(|radiance| !radiance.color.is_black()).count();
    assert!(lit > expected.len() / 4, "{what}: hardly any light");
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(found, expected, "{what}, ray {index}");
    }
}

const PATH: &str = r#"<integrator type="path"><integer name="rr_depth" value="3"/>
    <integer name="max_depth" value="12"/></integrator>"#;

/// An opaque mask changes nothing, but its materials are shaded one by one.
#[test]
fn lanes_give_the_light_of_single_paths() {
    for material in MATERIALS {
        let two_sided = format!(r#"<bsdf type="twosided">{material}</bsdf>"#);
        let materials = [Some((*material).to_owned()), (!transmits(material)).then_some(two_sided)];
        for material in materials.into_iter().flatten() {
            let masked =
                format!(r#"<bsdf type="mask"><float name="opacity" value="1"/>{material}</bsdf>"#);
            let expected = setup(PATH, &masked, None).together();
            let setup = setup(PATH, &material, None);
            assert_same(&material, &setup.together(), &expected);
            assert_same(&material, &setup.alone(), &expected);
        }
    }
}

#[test]
fn the_light_does_not_depend_on_the_instructions() {
    for material in MATERIALS {
        let best = setup(PATH, material, None).together();
        for tier in [Tier::Portable, Tier::Avx2] {
            assert_same(material, &setup(PATH, material, Some(tier)).together(), &best);
        }
    }
}

#[test]
fn normals_are_as_strict_in_lanes() {
    let path = r#"<integrator type="path"><boolean name="strict_normals" value="true"/>
        <integer name="max_depth" value="6"/></integrator>"#;
    for material in [MATERIALS[0], MATERIALS[6]] {
        let masked =
            format!(r#"<bsdf type="mask"><float name="opacity" value="1"/>{material}</bsdf>"#);
        let expected = setup(path, &masked, None).together();
        assert_same(material, &setup(path, material, None).together(), &expected);
    }
}
