//! Scenes built in code: errors name nodes, and buffers replace files.

use etendue_document::{
    Buffer, Diagnostics, Document, DocumentOptions, MemoryResources, Node, Value, reference, rgb,
};
use etendue_scene::models::mesh::Mesh;
use etendue_scene::shape::Geometry;
use etendue_scene::{BuildOptions, Scene, ShapeId, build_scene};
use glam::Vec3;

/// The scene, and the place and message of every diagnostic.
fn build(scene: Node) -> (Option<Scene>, Vec<(String, String)>) {
    let (diagnostics, resources) = (Diagnostics::new(), MemoryResources::default());
    let scene = scene.child(Node::sensor("perspective"));
    let document = Document::build(scene, &DocumentOptions::default(), &diagnostics);
    let built = build_scene(&document, &resources, &diagnostics, &BuildOptions::default());
    let found = diagnostics.sorted().into_iter().map(|found| {
        let span = found.span.expect("every finding has a place");
        (document.sources.locate(span).to_string(), found.message)
    });
    (built, found.collect())
}

fn one_finding(scene: Node) -> (String, String) {
    let (_, mut found) = build(scene);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

/// A square that faces +z.
fn square() -> Node {
    Node::shape("mesh")
        .with(
            "positions",
            vec![[-1.0_f32, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        )
        .with("indices", vec![[0_u32, 1, 2], [0, 2, 3]])
}

fn mesh_of(scene: &Scene) -> &Mesh {
    match &scene.shape(ShapeId(0)).geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

#[test]
fn errors_of_plugins_name_the_path_of_their_node() {
    let ball = |bsdf: Node| {
        Node::scene()
            .child(Node::shape("sphere"))
            .child(Node::shape("sphere").with("radius", 2.0).child(bsdf))
    };
    let cases = [
        (
            Node::bsdf("roughplastic").with("int_ior", -1.0),
            "scene.shapes[1].bsdf.int_ior",
            "`int_ior` is -1",
        ),
        (
            Node::bsdf("plastic").with("colour", rgb([0.5, 0.5, 0.5])),
            "scene.shapes[1].bsdf.colour",
            "`plastic` has no parameter `colour`",
        ),
        (Node::bsdf("plastik"), "scene.shapes[1].bsdf", "`plastik`"),
        (
            Node::bsdf("diffuse")
                .with("reflectance", Node::texture("bitmap").with("filename", "no.png")),
            "scene.shapes[1].bsdf.reflectance.filename",
            "no file `no.png`",
        ),
        (
            Node::bsdf("diffuse").with("reflectance", Node::texture("bitmap")),
            "scene.shapes[1].bsdf.reflectance",
            "needs the parameter `filename`",
        ),
    ];
    for (bsdf, path, words) in cases {
        let (place, message) = one_finding(ball(bsdf));
        assert_eq!(place, path, "{message}");
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn a_shared_material_is_built_once() {
    let square = || square().child(reference("grey"));
    let material = Node::bsdf("diffuse").id("grey").with("reflectance", 0.3);
    let (scene, found) = build(Node::scene().child(square()).child(square()).child(material));
    assert_eq!(found, []);
    let scene = scene.expect("no error was reported");
    assert_eq!(scene.shape(ShapeId(0)).material, scene.shape(ShapeId(1)).material);
}

#[test]
fn a_mesh_takes_arrays_of_several_types() {
    let positions = vec![0.0_f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let indices: [Value; 4] = [
        vec![0_u8, 1, 2].into(),
        vec![0_u16, 1, 2].into(),
        vec![0_i32, 1, 2].into(),
        vec![[0_i64, 1, 2]].into(),
    ];
    for indices in indices {
        let mesh =
            Node::shape("mesh").with("positions", positions.clone()).with("indices", indices);
        let (scene, found) = build(Node::scene().child(mesh));
        assert_eq!(found, []);
        let scene = scene.expect("no error was reported");
        assert_eq!(mesh_of(&scene).positions(), [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(mesh_of(&scene).triangles(), [[0, 1, 2]]);
    }
    let (scene, found) =
        build(Node::scene().child(Node::shape("mesh").with("positions", positions)));
    assert_eq!(found, []);
    assert_eq!(mesh_of(&scene.expect("no error was reported")).triangles(), [[0, 1, 2]]);
}

#[test]
fn arrays_that_do_not_fit_are_refused_with_their_name() {
    let cases: [(Node, &str, &str); 14] = [
        (Node::shape("mesh"), "", "needs the parameter `positions`"),
        (square().with("positions", 1.0), ".positions", "must be a buffer"),
        (square().with("positions", vec![0_u8; 12]), ".positions", "must hold floats, not bytes"),
        (
            Node::shape("mesh").with("positions", vec![[0.0_f32; 2]; 3]),
            ".positions",
            "has the shape [3, 2], but needs rows of 3",
        ),
        (Node::shape("mesh").with("positions", vec![[0.0_f32; 3]; 4]), ".positions", "every three"),
        (
            Node::shape("mesh").with("positions", vec![[f32::NAN; 3]; 3]),
            ".positions",
            "vertex 0 has a position that is not finite",
        ),
        (
            Node::shape("mesh").with("positions", vec![[1e300_f64; 3]; 3]),
            ".positions",
            "vertex 0 has a position that is not finite",
        ),
        (square().with("normals", vec![[0.0_f32, 0.0, 1.0]; 3]), ".positions", "but 3 normals"),
        (square().with("uv", vec![0.0_f32; 7]), ".uv", "needs rows of 2"),
        (square().with("indices", vec![0_u32; 7]), ".indices", "needs rows of 3"),
        (square().with("indices", vec![[0_u32, 1, 4]]), ".indices", "there are 4 vertices"),
        (square().with("indices", vec![[0_i32, 1, -2]]), ".indices", "holds -2"),
        (square().with("indices", vec![[0.0_f32; 3]]), ".indices", "must hold integers"),
        (
            square().with("vertex_color", vec![[0.0_f32; 3]; 2]),
            ".vertex_color",
            "has the shape [2, 3], but there are 4 vertices",
        ),
    ];
    for (mesh, entry, words) in cases {
        let (scene, found) = build(Node::scene().child(mesh));
        assert!(scene.is_none(), "{words}");
        // Cases replace entries that `square` gives, which is a warning.
        let found: Vec<_> =
            found.into_iter().filter(|(_, message)| !message.contains("given twice")).collect();
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].0, format!("scene.shape{entry}"), "{found:?}");
        assert!(found[0].1.contains(words), "{found:?}");
    }
}

#[test]
fn attributes_come_from_buffers() {
    let mesh = square()
        .with("vertex_color", vec![[255_u8, 0, 0]; 4])
        .with("face_weight", vec![0.25_f32, 0.75])
        .with("face_normals", true)
        .child(
            Node::bsdf("diffuse")
                .with("reflectance", Node::texture("mesh_attribute").with("name", "vertex_color")),
        );
    let (scene, found) = build(Node::scene().child(mesh));
    assert_eq!(found, []);
    assert!(scene.is_some());
    let unused = square().with("edge_color", vec![0.0_f32]);
    let (place, message) = one_finding(Node::scene().child(unused));
    assert_eq!(
        (place.as_str(), message.as_str()),
        ("scene.shape.edge_color", "`mesh` has no parameter `edge_color`")
    );
}

#[test]
fn pictures_and_grids_come_from_buffers() {
    let texels = vec![0_u8, 128, 255, 0, 0, 0, 255, 255, 255, 1, 2, 3];
    let texels = Buffer::new(texels, [2, 2, 3]).expect("twelve elements");
    let texture = Node::texture("bitmap").with("data", texels.clone()).with("raw", true);
    let map = Node::emitter("envmap").with("data", texels);
    let grid = Buffer::new(vec![0.5_f32; 24], [2, 3, 4]).expect("24 elements");
    let smoke = Node::medium("heterogeneous")
        .with("albedo", Node::volume("constvolume").with("value", 0.5))
        .with("sigma_t", Node::volume("gridvolume").with("data", grid));
    let scene = Node::scene()
        .child(square().child(Node::bsdf("diffuse").with("reflectance", texture)))
        .child(Node::shape("cube").child(Node::bsdf("null")).with("interior", smoke))
        .child(map);
    let (scene, found) = build(scene);
    assert_eq!(found, []);
    assert!(scene.is_some());
}

#[test]
fn pictures_and_grids_of_the_wrong_shape_are_refused() {
    let shaped = |shape: &[usize]| {
        Buffer::new(vec![0.5_f32; shape.iter().product()], shape).expect("as many as that")
    };
    let picture =
        |texture: Node| square().child(Node::bsdf("diffuse").with("reflectance", texture));
    let bitmap = || Node::texture("bitmap");
    let volume = |volume: Node| {
        let smoke = Node::medium("heterogeneous").with("sigma_t", volume);
        Node::shape("cube").child(Node::bsdf("null")).with("interior", smoke)
    };
    let grid = || Node::volume("gridvolume");
    let bitmap_data = "scene.shape.bsdf.reflectance.data";
    let grid_data = "scene.shape.interior.sigma_t.data";
    let cases = [
        (picture(bitmap().with("data", shaped(&[4]))), bitmap_data, "has the shape [4]"),
        (picture(bitmap().with("data", shaped(&[2, 2, 5]))), bitmap_data, "at most four channels"),
        (picture(bitmap().with("data", shaped(&[0, 2]))), bitmap_data, "2 × 0 texels"),
        (picture(bitmap().with("data", vec![[1_i32, 2]])), bitmap_data, "not 32-bit integers"),
        (picture(bitmap().with("data", "x")), bitmap_data, "must be a buffer, not a string"),
        (volume(grid().with("data", shaped(&[2, 2]))), grid_data, "layers, rows and columns"),
        (volume(grid().with("data", shaped(&[2, 2, 0]))), grid_data, "0 × 2 × 2 cells"),
        (volume(grid().with("data", shaped(&[1, 1, 1, 2]))), grid_data, "2 values in a cell"),
    ];
    for (shape, place, words) in cases {
        let (found_place, message) = one_finding(Node::scene().child(shape));
        assert_eq!(found_place, place, "{message}");
        assert!(message.contains(words), "{message}");
    }
    let both = bitmap().with("data", shaped(&[2, 2])).with("filename", "a.png");
    let (place, message) = one_finding(Node::scene().child(picture(both)));
    assert_eq!(place, "scene.shape.bsdf.reflectance.filename");
    assert!(message.contains("not from both"), "{message}");
}

#[test]
fn buffers_count_in_the_hash_of_the_scene() {
    let hash = |scene: Node| build(scene).0.expect("no error was reported").content_hash();
    let first = hash(Node::scene().child(square()));
    assert_eq!(first, hash(Node::scene().child(square())));
    let moved = Node::shape("mesh")
        .with("positions", vec![[-1.0_f32, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.5]]);
    assert_ne!(first, hash(Node::scene().child(moved)));
    assert_ne!(first, hash(Node::scene().child(square().with("flip_normals", true))));
}
