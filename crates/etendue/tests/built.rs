//! Scenes built in code render exactly like the same scenes from files.

use std::path::PathBuf;

use etendue::document::{MemoryResources, Node, look_at, rgb};
use etendue::mesh::{Attribute, AttributeDomain, TriangleMesh, write_ply};
use etendue::{
    Cancel, Error, Loaded, RenderJob, RenderOptions, SceneOptions, Silent, Workers, load_node,
    load_text, render_node,
};

/// A wavy surface with normals, texture coordinates and a colour per vertex.
fn sheet() -> TriangleMesh {
    const SIDE: u32 = 12;
    let mut mesh = TriangleMesh::default();
    let mut colors = Vec::new();
    for row in 0..=SIDE {
        for column in 0..=SIDE {
            let (u, v) = (column as f32 / SIDE as f32, row as f32 / SIDE as f32);
            let height = 0.3 * (5.0 * u).sin() * (4.0 * v).cos();
            mesh.positions.push([2.0 * u - 1.0, 2.0 * v - 1.0, height].into());
            mesh.normals.push([0.2 * u - 0.1, 0.3 * v, 1.0].into());
            mesh.uvs.push([u, v].into());
            colors.extend([u, v, 0.5]);
        }
    }
    for row in 0..SIDE {
        for column in 0..SIDE {
            let first = row * (SIDE + 1) + column;
            let next = first + SIDE + 1;
            mesh.indices.push([first, first + 1, next + 1]);
            mesh.indices.push([first, next + 1, next]);
        }
    }
    mesh.attributes.push(Attribute {
        name: "vertex_color".to_owned(),
        domain: AttributeDomain::Vertex,
        channels: 3,
        values: colors,
    });
    mesh
}

const SCENE: &str = r#"<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="1, -2, 3" target="0, 0, 0" up="0, 0, 1"/></transform>
        <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="20"/></film>
        <sampler type="independent"><integer name="sample_count" value="8"/></sampler>
    </sensor>
    <emitter type="constant"><rgb name="radiance" value="0.5, 0.7, 0.9"/></emitter>
    <shape type="ply"><string name="filename" value="sheet.ply"/>
        <bsdf type="twosided"><bsdf type="plastic">
            <texture type="mesh_attribute" name="diffuse_reflectance"><string name="name" value="vertex_color"/></texture>
        </bsdf></bsdf>
    </shape>
</scene>"#;

/// The scene of [`SCENE`] with a shape in place of its file.
fn scene(shape: Node) -> Node {
    let film = Node::film("hdrfilm").with("width", 24).with("height", 20);
    let sampler = Node::sampler("independent").with("sample_count", 8);
    let sensor = Node::sensor("perspective")
        .with("to_world", look_at([1.0, -2.0, 3.0], [0.0; 3], [0.0, 0.0, 1.0]))
        .child(film)
        .child(sampler);
    let colors = Node::texture("mesh_attribute").with("name", "vertex_color");
    let plastic = Node::bsdf("plastic").with("diffuse_reflectance", colors);
    Node::scene()
        .child(Node::integrator("path"))
        .child(sensor)
        .child(Node::emitter("constant").with("radiance", rgb([0.5, 0.7, 0.9])))
        .child(shape.child(Node::bsdf("twosided").child(plastic)))
}

/// The mesh as a node that holds its arrays.
fn node_of(mesh: &TriangleMesh) -> Node {
    Node::shape("mesh")
        .with("positions", mesh.positions.iter().map(|p| p.to_array()).collect::<Vec<_>>())
        .with("normals", mesh.normals.iter().map(|n| n.to_array()).collect::<Vec<_>>())
        .with("uv", mesh.uvs.iter().map(|uv| uv.to_array()).collect::<Vec<_>>())
        .with("indices", mesh.indices.clone())
        .with("vertex_color", mesh.attributes[0].values.clone())
}

/// The bits of all channels of the picture.
fn bits(load: impl FnOnce() -> Loaded + Send) -> Vec<u32> {
    let workers = Workers::new(None).unwrap();
    let loaded = workers.run(load);
    assert!(loaded.diagnostics.list.is_empty(), "{:?}", loaded.diagnostics.list);
    let scene = loaded.scene.unwrap();
    let job = RenderJob::new(&scene, &RenderOptions::default()).unwrap();
    let rendering = job.render(&workers, &Silent, &Cancel::new()).unwrap();
    let channels = rendering.picture.channels.iter();
    channels.flat_map(|channel| channel.data.iter().map(|value| value.to_bits())).collect()
}

#[test]
fn a_mesh_from_arrays_gives_the_bits_of_the_same_mesh_from_a_file() {
    let mesh = sheet();
    let files = MemoryResources::default().with("sheet.ply", write_ply(&mesh));
    let options = SceneOptions::default();
    let from_file = bits(|| load_text(SCENE, PathBuf::new(), &files, &options));
    let nothing = MemoryResources::default();
    let node = scene(node_of(&mesh));
    let from_arrays = bits(|| load_node(node, PathBuf::new(), &nothing, &options));
    assert!(from_file == from_arrays);
    assert!(from_file.iter().any(|bits| *bits != from_file[0]), "the picture shows the mesh");
}

#[test]
fn errors_of_a_scene_in_code_name_nodes() {
    let shape = node_of(&sheet()).with("flip", 1.0).with("max_smooth_angle", "wide");
    let result = render_node(scene(shape), &SceneOptions::default(), &RenderOptions::default());
    let Err(Error::Scene(report)) = result else {
        panic!("the angle is not a number");
    };
    let place = |index: usize| {
        let span = report.list[index].span.expect("it has a place");
        report.sources.locate(span).to_string()
    };
    let mut places = [place(0), place(1)];
    places.sort();
    assert_eq!(places, ["scene.shape.flip", "scene.shape.max_smooth_angle"]);
    assert!(report.to_string().contains("at scene.shape.max_smooth_angle"), "{report}");
}
