//! The scalar loop of `path` is bit-identical to its wavefront: on every plugin's sample, on the
//! gallery, and on the seed scenes if they are present.
#![allow(
    clippy::disallowed_methods,
    reason = "tests read the scenes of the repository, which the core never does"
)]

use etendue_document::{Class, Diagnostics, Document, MemoryResources, ResourceError, Resources};
use etendue_integrators::{
    CameraRay, Integrator, IntegratorOptions, Radiance, Start, Watch, build_integrator,
};
use etendue_mitsuba::{LoadOptions, read_file, read_text};
use etendue_scene::sensor::SensorRay;
use etendue_scene::{BuildOptions, Scene, build_scene, registry};
use glam::{UVec2, Vec2};
use std::fs;
use std::path::{Path, PathBuf};

/// Files on disk.
struct Files;

impl Resources for Files {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ResourceError> {
        fs::read(path).map_err(|error| ResourceError::Other(error.to_string()))
    }

    fn exists(&self, path: &Path) -> bool {
        path.is_file()
    }
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

struct Setup {
    scene: Scene,
    integrator: Box<dyn Integrator>,
}

/// The scene of a document, rendered by `path` with the parameters of the document's integrator.
fn setup(
    document: Option<Document>,
    resources: &dyn Resources,
    options: &IntegratorOptions,
    diagnostics: &Diagnostics,
) -> Setup {
    document
        .and_then(|document| {
            let build = BuildOptions::default();
            let scene = build_scene(&document, resources, diagnostics, &build)?;
            let integrator = build_integrator(&document, options, diagnostics)?;
            Some(Setup { scene, integrator })
        })
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

fn path() -> IntegratorOptions {
    IntegratorOptions { name: Some("path".to_owned()), ..IntegratorOptions::default() }
}

impl Setup {
    /// Camera rays over the whole film, `columns` × `columns` pixels with two samples each.
    fn rays(&self, columns: u32) -> Vec<CameraRay> {
        let setup = &self.scene.sensors()[0];
        let pixels = (0..columns).flat_map(|y| (0..columns).map(move |x| UVec2::new(x, y)));
        pixels
            .flat_map(|pixel| (0..2).map(move |index| (pixel, index)))
            .map(|(pixel, index)| {
                let mut sampler = setup.sampler.start(pixel, index);
                let film_position = (pixel.as_vec2() + sampler.next_2d()) / columns as f32;
                let aperture: Vec2 = sampler.next_2d();
                let SensorRay { ray, .. } = setup.sensor.sample_ray(film_position, aperture);
                CameraRay { start: Start { ray, medium: setup.medium }, sampler }
            })
            .collect()
    }

    /// Renders both ways; returns the fraction of rays that found light.
    fn assert_same(&self, what: &str, columns: u32) -> f32 {
        let watch = Watch::patient();
        let mut wavefront = Vec::new();
        let mut rays = self.rays(columns);
        self.integrator.sample_batch(&self.scene, &mut rays, &mut [], &watch, &mut wavefront);
        let scalar: Vec<Radiance> = self
            .rays(columns)
            .iter_mut()
            .map(|CameraRay { start, sampler }| {
                self.integrator.sample(&self.scene, start, sampler, &mut [], &watch)
            })
            .collect();
        assert_eq!(wavefront.len(), scalar.len(), "{what}");
        for (index, (wavefront, scalar)) in wavefront.iter().zip(&scalar).enumerate() {
            assert_eq!(wavefront, scalar, "{what}, ray {index}");
        }
        let lit = scalar.iter().filter(|radiance| !radiance.color.is_black()).count();
        lit as f32 / scalar.len() as f32
    }
}

/// The files that the manual's samples read.
fn sample_files() -> MemoryResources {
    let file = |path: &str| fs::read(repository().join(path)).expect(path);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
               property float z\nproperty float r\nproperty float g\nproperty float b\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n\
               0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n";
    MemoryResources::default()
        .with("sample.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .with("sample.ply", ply)
        .with("curves.txt", "0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1\n")
        .with("ellipsoids.ply", file("crates/scene/tests/data/ellipsoids.ply"))
        .with("sample.bsdf", file("crates/scene/src/bsdf/measured/isotropic.bsdf"))
        .with("sample.serialized", file("crates/scene/tests/data/triangle.serialized"))
        .with("distance.vol", file("crates/scene/tests/data/distance.vol"))
        .with("smoke.vol", file("scenes/smoke/smoke.vol"))
        .with("wood.png", file("scenes/textures/wood.png"))
}

/// Parameters of `path` that exercise its different branches.
const PARAMETERS: &[&str] = &[
    r#"<integer name="max_depth" value="8"/>"#,
    r#"<integer name="max_depth" value="6"/><integer name="rr_depth" value="1"/>"#,
    r#"<integer name="max_depth" value="5"/><boolean name="strict_normals" value="true"/>
       <boolean name="hide_emitters" value="true"/>"#,
    r#"<integer name="max_depth" value="1"/>"#,
    r#"<float name="clamp_indirect" value="0.2"/>"#,
];

const CAMERA: &str = r#"<sensor type="perspective"><transform name="to_world">
    <lookat origin="1.5, 2, 3.6" target="0, 0.2, 0" up="0, 1, 0"/></transform></sensor>"#;

/// An emitting sphere.
const LAMP: &str = r#"<shape type="sphere"><point name="center" x="-2" y="2" z="-1"/>
    <emitter type="area"><rgb name="radiance" value="5, 6, 7"/></emitter></shape>"#;

/// A closed room around everything.
const ROOM: &str = r#"<shape type="cube"><boolean name="flip_normals" value="true"/>
    <transform name="to_world"><scale value="4"/></transform>
    <bsdf type="twosided"><bsdf type="roughplastic"/></bsdf></shape>"#;

/// Shapes with a material: smooth and flat triangles, which are shaded in lanes, a sphere, and a thin
/// box.
fn shapes_of(bsdf: &str) -> String {
    let shapes = [
        ("cube", r#"<scale value="0.6"/><translate x="1.2"/>"#),
        ("sphere", r#"<scale value="0.7"/><translate x="-1"/>"#),
        ("cube", r#"<scale x="0.8" y="0.8" z="0.00001"/><translate z="1.4"/>"#),
        ("rectangle", r#"<scale value="3"/><rotate x="1" angle="-90"/><translate y="-1"/>"#),
    ];
    shapes
        .map(|(shape, transform)| {
            format!(
                r#"<shape type="{shape}"><transform name="to_world">{transform}</transform>{bsdf}</shape>"#
            )
        })
        .concat()
}

fn assert_same_light(what: &str, body: &str) {
    let resources = sample_files();
    let mut lit = 0.0;
    for parameters in PARAMETERS {
        for emitter_sampling in [true, false] {
            let text = format!(
                r#"<scene version="3.0.0"><integrator type="path">{parameters}</integrator>{CAMERA}{body}</scene>"#
            );
            let diagnostics = Diagnostics::new();
            let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics).ok();
            let options = IntegratorOptions { emitter_sampling, ..IntegratorOptions::default() };
            let setup = setup(document, &resources, &options, &diagnostics);
            lit += setup.assert_same(&format!("{what}, {parameters}, {emitter_sampling}"), 16);
        }
    }
    assert!(lit > 0.1, "{what}: hardly any light");
}

/// The samples in the manual of a class, by plugin. All picture formats are read alike.
fn samples(class: Class) -> impl Iterator<Item = (&'static str, String)> {
    registry::plugins()
        .into_iter()
        .filter(move |(of, ..)| *of == class)
        .map(|(_, name, manual)| (name, manual.sample.replace("sample.exr", "wood.png")))
}

#[test]
fn every_material_looks_the_same() {
    for (name, bsdf) in samples(Class::Bsdf) {
        assert_same_light(name, &format!("{ROOM}{LAMP}{}", shapes_of(&bsdf)));
    }
}

/// Null transmission: sheets, cut-outs, emitting masks, and medium interfaces, which `path`
/// ignores.
#[test]
fn null_transmission_looks_the_same() {
    let diffuse = r#"<bsdf type="diffuse"/>"#;
    let masked =
        format!(r#"<bsdf type="mask"><float name="opacity" value="0.4"/>{diffuse}</bsdf>"#);
    let glowing = format!(r#"{masked}<emitter type="area"/>"#);
    let boundary = r#"<bsdf type="null"/><medium name="interior" type="homogeneous"/>"#;
    let open = r#"<emitter type="constant"/>"#;
    let panes = r#"<bsdf type="thindielectric"/>"#;
    for body in [masked.as_str(), &glowing, boundary, panes] {
        assert_same_light(body, &format!("{ROOM}{LAMP}{}", shapes_of(body)));
        assert_same_light(body, &format!("{open}{}", shapes_of(body)));
    }
}

#[test]
fn every_emitter_looks_the_same() {
    for (name, emitter) in samples(Class::Emitter) {
        let shapes = shapes_of(r#"<bsdf type="plastic"/>"#);
        assert_same_light(name, &format!("{LAMP}{emitter}{shapes}"));
    }
}

#[test]
fn every_shape_looks_the_same() {
    for (name, shape) in samples(Class::Shape) {
        let shape = shape.replace("<scene>", "").replace("</scene>", "");
        assert_same_light(name, &format!("{ROOM}{LAMP}{shape}"));
    }
}

fn assert_same_scene(path_of_scene: &Path, columns: u32) {
    let diagnostics = Diagnostics::new();
    let document = read_file(path_of_scene, &Files, &LoadOptions::default(), &diagnostics).ok();
    let setup = setup(document, &Files, &path(), &diagnostics);
    let lit = setup.assert_same(&path_of_scene.display().to_string(), columns);
    assert!(lit > 0.1, "{}: hardly any light", path_of_scene.display());
}

/// Triangles of any size, whose normals leave the range of single precision on the way.
#[test]
fn huge_and_tiny_triangles_look_the_same() {
    for exponent in [-15, -12, -10, -6, 6, 9, 10, 12] {
        let text = r#"<scene version="3.0.0"><integrator type="path"/><sensor type="perspective">
            <float name="near_clip" value="0"/><float name="far_clip" value="1e17"/><transform name="to_world">
            <lookat origin="1.5, 2, 3.6" target="0, 0.2, 0" up="0, 1, 0"/><scale value="SCALE"/></transform></sensor>
            <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate y="3"/>
            <scale value="SCALE"/></transform><emitter type="area"/></shape>
            <shape type="cube"><transform name="to_world"><scale value="0.6"/><rotate x="1" y="1" angle="30"/>
            <scale value="SCALE"/></transform></shape>
            <shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/>
            <translate y="-1"/><scale value="SCALE"/></transform></shape></scene>"#
        .replace("SCALE", &format!("1e{exponent}"));
        let diagnostics = Diagnostics::new();
        let resources = MemoryResources::default();
        let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics).ok();
        let setup = setup(document, &resources, &path(), &diagnostics);
        let lit = setup.assert_same(&format!("1e{exponent}"), 16);
        assert!(lit > 0.2, "1e{exponent}: {lit}");
    }
}

#[test]
fn the_gallery_looks_the_same() {
    let folders = fs::read_dir(repository().join("scenes")).expect("the gallery");
    let (mut count, mut left_out) = (0, Vec::new());
    for folder in folders {
        let scene = folder.expect("a folder").path().join("scene.xml");
        // `cargo xtask assets` makes large files, which are not committed.
        if fs::read_to_string(&scene).expect("a scene").contains("\"generated/") {
            left_out.push(scene);
            continue;
        }
        assert_same_scene(&scene, 32);
        count += 1;
    }
    assert!(count > 5, "{count} scenes; left out: {left_out:?}");
}

/// Scenes next to the repository.
#[test]
fn the_seed_scenes_look_the_same() {
    let folder = repository().join("../shared/seed-scenes/testcases");
    for scene in [
        "cornellbox1.xml",
        "cornellbox2.xml",
        "smallpt.xml",
        "spline.xml",
        "coffee/scene.xml",
        "spaceship/scene.xml",
        "kitchen/scene.xml",
    ] {
        let path = folder.join(scene);
        if path.is_file() {
            assert_same_scene(&path, 32);
        }
    }
}
