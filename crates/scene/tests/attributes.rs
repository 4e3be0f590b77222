//! Mesh attributes, from a PLY file to the material at a hit.

use etendue_document::{Diagnostics, MemoryResources, Severity};
use etendue_math::Ray;
use etendue_mesh::{Attribute, AttributeDomain, TriangleMesh, write_ply};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use glam::Vec3;

/// Two triangles in the plane z = 0: red above the diagonal, blue below it.
fn square() -> TriangleMesh {
    TriangleMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        attributes: vec![
            Attribute {
                name: "face_color".into(),
                domain: AttributeDomain::Face,
                channels: 3,
                values: vec![0.0, 0.0, 1.0, 1.0, 0.0, 0.0],
            },
            Attribute {
                name: "vertex_pair".into(),
                domain: AttributeDomain::Vertex,
                channels: 2,
                values: vec![0.0; 8],
            },
        ],
        ..TriangleMesh::default()
    }
}

/// Builds a scene, or returns its error messages.
fn build(shapes: &str) -> Result<Scene, String> {
    let resources = MemoryResources::default().with("square.ply", write_ply(&square()));
    let diagnostics = Diagnostics::new();
    let text = format!("<scene version='3.0.0'><sensor type='perspective'/>{shapes}</scene>");
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics).ok();
    let options = BuildOptions::default();
    let scene =
        document.and_then(|document| build_scene(&document, &resources, &diagnostics, &options));
    let errors = diagnostics.sorted().into_iter().filter(|found| found.severity == Severity::Error);
    scene.ok_or_else(|| errors.map(|error| error.message).collect::<Vec<_>>().join("; "))
}

fn diffuse(attribute: &str) -> String {
    format!(
        "<bsdf type='diffuse'><texture name='reflectance' type='mesh_attribute'>\
         <string name='name' value='{attribute}'/></texture></bsdf>"
    )
}

fn ply(nested: &str) -> String {
    format!("<shape type='ply'><string name='filename' value='square.ply'/>{nested}</shape>")
}

/// The albedo at the hit of a ray straight down at (x, y).
fn color(scene: &Scene, x: f32, y: f32) -> [f32; 3] {
    let surface = scene.intersect(&Ray::new(Vec3::new(x, y, 5.0), -Vec3::Z)).expect("a hit");
    scene.prepare_bsdf(&surface).albedo(surface.wi).rgb()
}

#[test]
fn faces_have_their_colors() {
    let scene = build(&ply(&diffuse("face_color"))).expect("a scene");
    assert_eq!(color(&scene, 0.8, 0.2), [0.0, 0.0, 1.0]);
    assert_eq!(color(&scene, 0.2, 0.8), [1.0, 0.0, 0.0]);
}

#[test]
fn instances_have_the_colors_of_their_group() {
    let group = format!("<shape type='shapegroup' id='g'>{}</shape>", ply(&diffuse("face_color")));
    let instance = "<shape type='instance'><ref id='g'/>\
                    <transform name='to_world'><translate x='3'/></transform></shape>";
    let scene = build(&format!("{}{group}{instance}", ply(""))).expect("a scene");
    assert_eq!(color(&scene, 3.8, 0.2), [0.0, 0.0, 1.0]);
    assert_eq!(color(&scene, 3.2, 0.8), [1.0, 0.0, 0.0]);
    assert_eq!(color(&scene, 0.2, 0.8), [0.5; 3]);
}

#[test]
fn what_cannot_be_read_is_refused() {
    let error = |shapes: &str| build(shapes).expect_err("an error");
    assert!(error(&ply(&diffuse("vertex_color"))).contains("`face_color`"));
    assert!(error(&ply(&diffuse("vertex_pair"))).contains("2 channels"));
    assert!(error(&ply(&diffuse("color"))).contains("must start with"));
    let sphere = format!("<shape type='sphere'>{}</shape>", diffuse("face_color"));
    assert!(error(&sphere).contains("only meshes"));
    let light = "<emitter type='area'><texture name='radiance' type='mesh_attribute'>\
                 <string name='name' value='face_color'/></texture></emitter>";
    assert!(error(&ply(light)).contains("a light cannot"));
}
