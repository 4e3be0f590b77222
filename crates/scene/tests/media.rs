//! Media, volumes and references to them, from scene files.

use etendue_document::{Diagnostic, Diagnostics, MemoryResources};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use glam::Vec3;

/// A row of cells along x in the unit cube.
fn row(values: &[f32]) -> Vec<u8> {
    let header = [1, values.len() as i32, 1, 1, 1].map(i32::to_le_bytes).concat();
    let bounds = [0.0_f32, 0.0, 0.0, 2.0, 1.0, 1.0].map(f32::to_le_bytes).concat();
    let values: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    [b"VOL\x03".to_vec(), header, bounds, values].concat()
}

fn build(text: &str) -> (Option<Scene>, Vec<Diagnostic>) {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default()
        .with("row.vol", row(&[0.2, 0.4, 0.6, 0.8]))
        .with("negative.vol", row(&[0.5, -0.5]))
        .with("nan.vol", row(&[0.5, f32::NAN]))
        .with("short.vol", &row(&[0.5, 0.5])[..50])
        .with("huge.vol", row(&[1e30, 1e30]))
        .with("thick.vol", row(&[1e7]));
    let text = format!("<scene version=\"3.0.0\">{text}<sensor type=\"perspective\"/></scene>");
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics).ok();
    let scene = document.and_then(|document| {
        build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
    });
    (scene, diagnostics.sorted())
}

#[track_caller]
fn scene(text: &str) -> Scene {
    let (scene, findings) = build(text);
    assert!(findings.is_empty(), "{findings:?}");
    scene.expect("a scene, or a finding")
}

const DOWN: Ray = Ray { origin: Vec3::new(0.5, 0.5, 5.0), direction: Vec3::NEG_Z, t_max: 1e4 };

#[test]
fn a_volume_textures_surfaces_by_their_place() {
    let scene = scene(
        r#"<shape type="rectangle"><bsdf type="diffuse"><texture name="reflectance" type="volume">
            <volume name="volume" type="gridvolume"><string name="filename" value="row.vol"/>
            <boolean name="use_grid_bbox" value="true"/></volume></texture></bsdf></shape>"#,
    );
    // The file's box is 2 wide, so the cell centres are at 0.25, 0.75, …
    for (x, expected) in [(0.25, 0.2), (0.5, 0.3), (0.75, 0.4), (-0.5, 0.2)] {
        let ray = Ray { origin: Vec3::new(x, 0.5, 5.0), ..DOWN };
        let surface = scene.intersect(&ray).expect("a hit");
        let found = scene.prepare_bsdf(&surface).albedo(surface.wi)[0];
        assert!((found - expected).abs() < 1e-5, "{x}: {found}");
    }
}

#[test]
fn a_shape_knows_the_media_on_its_sides() {
    let inner = r#"<shape type="sphere"><ref name="interior" id="milk"/><ref name="exterior" id="fog"/></shape>"#;
    let media = r#"<medium type="homogeneous" id="milk"/><medium type="heterogeneous" id="fog"/>"#;
    let grouped = format!(
        r#"<shape type="shapegroup" id="group">{inner}</shape><shape type="rectangle"/>
           <shape type="instance"><ref id="group"/></shape>"#
    );
    for shapes in [inner.to_owned(), format!(r#"<shape type="cube"/>{inner}"#), grouped] {
        let scene = scene(&(media.to_owned() + &shapes));
        let surface = scene.intersect(&Ray { origin: Vec3::new(0.0, 0.0, 5.0), ..DOWN });
        let surface = surface.expect("a hit");
        let medium_interface = scene.medium_interface(&surface);
        if shapes.contains("cube") {
            // The cube is as high as the sphere; the ray hits it next to the top of the sphere.
            let beside = scene.intersect(&Ray { origin: Vec3::new(0.9, 0.9, 5.0), ..DOWN });
            assert!(scene.medium_interface(&beside.expect("a hit")).is_none());
            continue;
        }
        let medium_interface = medium_interface.expect("media");
        let [inside, outside] = [Vec3::NEG_Z, Vec3::Z].map(|direction| {
            medium_interface.towards(surface.normal, direction).expect("a medium")
        });
        assert_ne!(inside, outside);
        assert_eq!(medium_interface.interior, Some(inside));
    }
}

#[test]
fn a_sensor_may_stand_in_a_medium() {
    let text = r#"<scene version="3.0.0"><medium type="homogeneous" id="fog"/>
        <sensor type="perspective"><ref id="fog"/></sensor></scene>"#;
    let (diagnostics, resources) = (Diagnostics::new(), MemoryResources::default());
    let document = read_text(text, &resources, &LoadOptions::default(), &diagnostics);
    let document = document.expect("a document");
    let scene = build_scene(&document, &resources, &diagnostics, &BuildOptions::default());
    assert!(scene.expect("a scene").sensors()[0].medium.is_some());
    assert!(diagnostics.sorted().is_empty());
}

#[test]
fn nonsense_is_found_and_said() {
    let medium = |inner: &str| format!(r#"<medium type="heterogeneous">{inner}</medium>"#);
    let grid = |name: &str, file: &str| {
        medium(&format!(
            r#"<volume name="{name}" type="gridvolume"><string name="filename" value="{file}"/></volume>"#
        ))
    };
    let cases = [
        (grid("sigma_t", "negative.vol"), "negative in places"),
        (grid("albedo", "negative.vol"), "negative in places"),
        (grid("sigma_t", "nan.vol"), "cell 1, 0, 0 holds NaN"),
        (grid("sigma_t", "short.vol"), "50 bytes"),
        (grid("sigma_t", "thick.vol"), "limited to"),
        (grid("sigma_t", "none.vol"), "none.vol"),
        (medium(r#"<rgb name="albedo" value="1, 1, 2"/>"#), "limited to 1"),
        (medium(r#"<float name="scale" value="-1"/>"#), "scale"),
        (medium(r#"<texture name="albedo" type="checkerboard"/>"#), "expected a number"),
        (medium(r#"<phase type="hg"/><phase type="hg"/>"#), "one phase function"),
        (grid("sigma_t", "row.vol").replace("heterogeneous", "homogeneous"), "everywhere"),
        (r#"<medium type="sky"/>"#.to_owned(), "unknown medium"),
        (r#"<volume type="sky"/>"#.to_owned(), "unknown volume"),
        (
            r#"<shape type="sphere"><medium type="homogeneous"/></shape>"#.to_owned(),
            "`interior` or its `exterior`",
        ),
    ];
    for (text, part) in cases {
        let findings = build(&text).1;
        assert!(findings.iter().any(|found| found.message.contains(part)), "{text}: {findings:?}");
    }
    assert!(
        build(&grid("sigma_t", "huge.vol"))
            .1
            .iter()
            .any(|found| found.message.contains("limited to"))
    );
}
