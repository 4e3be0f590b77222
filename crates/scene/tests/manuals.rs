//! Manual pages match their plugins: each sample builds without diagnostics, and the listed
//! parameters are those that the code reads.

use etendue_document::{
    Class, Diagnostic, Diagnostics, Document, DocumentOptions, Fault, MemoryResources, Node,
};
use etendue_image::{Channel, EncodeOptions, FileFormat, Picture, encode};
use etendue_mesh::{Attribute, AttributeDomain, TriangleMesh, write_obj, write_ply};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Manual, build_scene, registry};
use glam::Vec3;

fn mesh() -> TriangleMesh {
    TriangleMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        indices: vec![[0, 1, 2]],
        attributes: vec![Attribute {
            name: "vertex_color".into(),
            domain: AttributeDomain::Vertex,
            channels: 3,
            values: vec![0.5; 9],
        }],
        ..TriangleMesh::default()
    }
}

/// One triangle in the serialized format, version 4 (Mitsuba 3's manual of `serialized`), for
/// the sample of that plugin.
fn serialized() -> Vec<u8> {
    include_bytes!("data/triangle.serialized").to_vec()
}

fn picture() -> Picture {
    let channels =
        ["R", "G", "B"].map(|name| Channel { name: name.to_owned(), data: vec![0.5; 4] });
    Picture { channels: channels.to_vec(), ..Picture::new(2, 2) }
}

/// A volume of two cells.
fn volume() -> Vec<u8> {
    let header = [1, 2, 1, 1, 1].map(i32::to_le_bytes).concat();
    let values = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.25].map(f32::to_le_bytes).concat();
    [b"VOL\x03".to_vec(), header, values].concat()
}

fn resources() -> MemoryResources {
    let encoded = |format| {
        encode(&picture(), format, &EncodeOptions::default()).expect("the picture can be written")
    };
    MemoryResources::default()
        .with("sample.obj", write_obj(&mesh()))
        .with("sample.ply", write_ply(&mesh()))
        .with("curves.txt", b"0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1\n".to_vec())
        .with("ellipsoids.ply", include_bytes!("data/ellipsoids.ply").to_vec())
        .with("sample.bsdf", include_bytes!("../src/bsdf/measured/isotropic.bsdf").to_vec())
        .with("sample.serialized", serialized())
        .with("smoke.vol", volume())
        .with("distance.vol", include_bytes!("data/distance.vol").to_vec())
        .with("sample.exr", encoded(FileFormat::Exr))
        .with("wood.png", encoded(FileFormat::Png))
}

/// A whole scene around a sample of a class.
fn scene_around(class: Class, sample: &str) -> String {
    let sensor = if sample.contains("<sensor") { "" } else { "<sensor type=\"perspective\"/>" };
    if let Some(inner) = sample.strip_prefix("<scene>") {
        return format!("<scene>{sensor}{inner}");
    }
    let inner = match class {
        Class::Bsdf => format!("<shape type=\"sphere\">{sample}</shape>"),
        Class::Texture => {
            let named = sample.replacen("<texture", "<texture name=\"reflectance\"", 1);
            let named =
                if sample.contains(" name=\"reflectance\"") { sample.to_owned() } else { named };
            format!("<shape type=\"sphere\"><bsdf type=\"diffuse\">{named}</bsdf></shape>")
        }
        Class::Film | Class::Sampler => {
            return format!("<scene><sensor type=\"perspective\">{sample}</sensor></scene>");
        }
        Class::ReconstructionFilter => {
            let film = format!("<film type=\"hdrfilm\">{sample}</film>");
            return format!("<scene><sensor type=\"perspective\">{film}</sensor></scene>");
        }
        _ => sample.to_owned(),
    };
    format!("<scene>{sensor}{inner}</scene>")
}

/// The samples written in code, which the manuals hold as text.
fn node_of(name: &str) -> Node {
    match name {
        "mesh" => include!("../src/shape/mesh/sample.rs"),
        other => panic!("the sample of `{other}` is not XML: build it here"),
    }
}

/// The diagnostics of building a sample inside a whole scene.
fn findings_of_sample(class: Class, name: &str, manual: &Manual) -> Vec<Diagnostic> {
    match manual.sample_language() {
        "xml" => findings(&scene_around(class, manual.sample)),
        _ => findings_of_node(node_of(name)),
    }
}

fn findings_of_node(node: Node) -> Vec<Diagnostic> {
    let (diagnostics, resources) = (Diagnostics::new(), resources());
    let scene = Node::scene().child(Node::sensor("perspective")).child(node);
    let document = Document::build(scene, &DocumentOptions::default(), &diagnostics);
    let _ = build_scene(&document, &resources, &diagnostics, &BuildOptions::default());
    diagnostics.sorted()
}

/// The diagnostics of building a scene.
fn findings(text: &str) -> Vec<Diagnostic> {
    let (diagnostics, resources) = (Diagnostics::new(), resources());
    if let Ok(document) = read_text(text, &resources, &LoadOptions::default(), &diagnostics) {
        let _ = build_scene(&document, &resources, &diagnostics, &BuildOptions::default());
    }
    diagnostics.sorted()
}

#[test]
fn every_sample_builds_without_a_finding() {
    for (class, name, manual) in registry::plugins() {
        let found = findings_of_sample(class, name, manual);
        assert!(found.is_empty(), "{} `{name}`: {found:?}", class.name());
    }
}

/// The diagnostics of building a sample with an additional unknown parameter.
fn findings_of_spoiled_sample(class: Class, name: &str, manual: &Manual) -> Vec<Diagnostic> {
    if manual.sample_language() != "xml" {
        return findings_of_node(node_of(name).with("no_such_parameter", ""));
    }
    let opening = format!("type=\"{name}\"");
    let place = manual.sample.find(&opening).expect("the sample names its plugin") + opening.len();
    let (before, after) = manual.sample.split_at(place);
    let unknown = "<string name=\"no_such_parameter\" value=\"\"/>";
    let spoiled = match after.find(['>', '/']) {
        Some(end) if after[end..].starts_with("/>") => {
            let element = before[before.rfind('<').expect("an element") + 1..]
                .split(' ')
                .next()
                .expect("a name");
            format!("{before}{}>{unknown}</{element}{}", &after[..end], &after[end + 1..])
        }
        Some(end) => format!("{before}{}{unknown}{}", &after[..=end], &after[end + 1..]),
        None => panic!("the sample of `{name}` is no XML"),
    };
    findings(&scene_around(class, &spoiled))
}

/// The parameters that the code reads, as listed by the warning about an unknown one.
fn asked(class: Class, name: &str, manual: &Manual) -> Vec<String> {
    let found = findings_of_spoiled_sample(class, name, manual);
    let warning = found
        .iter()
        .find(|finding| {
            finding.fault == Fault::UnknownParameter
                && finding.message.contains("no_such_parameter")
        })
        .unwrap_or_else(|| panic!("`{name}` accepts anything: {found:?}"));
    let listed = warning.help.join(" ");
    let mut words: Vec<String> = listed.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    // The plugin itself is named too; a parameter may have the same name.
    if let Some(place) = words.iter().position(|word| word == name) {
        words.remove(place);
    }
    words
}

#[test]
fn every_parameter_that_is_asked_for_is_in_the_manual_and_none_else() {
    let mut wrong = Vec::new();
    for (class, name, manual) in registry::plugins() {
        let asked = asked(class, name, manual);
        for parameter in manual.parameters {
            // Objects may have any name or none.
            let nested = parameter.name == "(nested)"
                || ["bsdf", "texture", "shape", "curve", "emitter"].contains(&parameter.kind);
            if !nested && !asked.iter().any(|name| name == parameter.name) {
                wrong.push(format!("`{name}` does not ask for `{}`: {asked:?}", parameter.name));
            }
        }
        for asked in asked {
            if !manual.parameters.iter().any(|parameter| parameter.name == asked) {
                wrong.push(format!("the manual of `{name}` lacks `{asked}`"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
