//! A scene built without a file: a mesh from arrays, a material, a light and a camera. Writes
//! `octahedron.png`.
#![allow(clippy::disallowed_methods, reason = "an example is a host: it writes files")]

use etendue::document::{Node, look_at, rgb};
use etendue::image::FileFormat;
use etendue::{RenderOptions, SceneOptions, render_node};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let positions: Vec<[f32; 3]> = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let upper = [[0_u32, 2, 4], [4, 2, 1], [1, 2, 5], [5, 2, 0]];
    let lower = [[4_u32, 3, 0], [1, 3, 4], [5, 3, 1], [0, 3, 5]];
    let gold = Node::bsdf("roughconductor").with("material", "Au").with("alpha", 0.2);
    let octahedron = Node::shape("mesh")
        .with("positions", positions)
        .with("indices", [upper, lower].concat())
        .with("face_normals", true)
        .child(gold);

    let film = Node::film("hdrfilm").with("width", 320).with("height", 240);
    let camera = Node::sensor("perspective")
        .with("to_world", look_at([2.0, 1.5, 3.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
        .with("fov", 40.0)
        .child(film);
    let sky = Node::emitter("constant").with("radiance", rgb([0.3, 0.4, 0.6]));
    let sun = Node::emitter("directional")
        .with("direction", [-1.0, -2.0, -1.5])
        .with("irradiance", rgb([3.0, 2.8, 2.5]));
    let scene = Node::scene().children([Node::integrator("path"), camera, sky, sun, octahedron]);

    let options = RenderOptions { samples_per_pixel: Some(64), ..RenderOptions::default() };
    let rendering = render_node(scene, &SceneOptions::default(), &options)?;
    std::fs::write("octahedron.png", rendering.encode(FileFormat::Png)?)?;
    Ok(())
}
