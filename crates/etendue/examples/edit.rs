//! Measures how long edits of a scene take: `edit SCENE.xml`.
//!
//! For each kind of node in the scene, it changes one value and rebuilds the scene, reusing what
//! has not changed.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "an example is a host: it prints, and reads arguments"
)]

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use etendue::document::{Class, Document, FlatNode, NodeId, Value};
use etendue::math::glam::{DAffine3, DVec3};
use etendue::{Files, LoadedScene, SceneOptions, Workers, load};

/// The best of this many runs counts, because other processes may use the machine too.
const RUNS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: edit SCENE.xml")?;
    let workers = Workers::new(None)?;
    let folder = std::env::current_dir()?;
    let options = SceneOptions { editable: true, ..SceneOptions::default() };
    let files = Files::default();
    let started = Instant::now();
    let loaded = workers.run(|| load(Path::new(&path), folder, &files, &options));
    let scene = loaded.scene.ok_or_else(|| loaded.diagnostics.to_string())?;
    println!("{:<24} {:>9.1} ms", "first load", milliseconds(started.elapsed()));

    let document = scene.document().ok_or("the scene keeps its document")?;
    time(&workers, &scene, "nothing", document)?;
    for class in [
        Class::Sensor,
        Class::Film,
        Class::Sampler,
        Class::Integrator,
        Class::Bsdf,
        Class::Texture,
        Class::Emitter,
        Class::Medium,
        Class::Shape,
    ] {
        if let Some(changed) = changed(document, class) {
            time(&workers, &scene, class.name(), &changed)?;
        }
    }
    time(&workers, &scene, "emitter added", &with_light(document))?;
    time(&workers, &scene, "shape removed", &without_last_shape(document))?;
    Ok(())
}

/// Prints the shortest time of several runs.
fn time(
    workers: &Workers,
    scene: &LoadedScene,
    what: &str,
    document: &Document,
) -> Result<(), Box<dyn Error>> {
    let mut best = Duration::MAX;
    for _ in 0..RUNS {
        let document = document.clone();
        let started = Instant::now();
        let edited = workers.run(|| scene.edited(document, &Files::default()));
        best = best.min(started.elapsed());
        edited.scene.ok_or_else(|| edited.diagnostics.to_string())?;
    }
    println!("{what:<24} {:>9.1} ms", milliseconds(best));
    Ok(())
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

/// The document with one value changed, in the first node of a class that has a suitable one.
fn changed(document: &Document, class: Class) -> Option<Document> {
    let mut document = document.clone();
    let of_class = document.nodes.iter_mut().filter(|node| node.class == class);
    let mut values = of_class.flat_map(|node| &mut node.parameters).map(|found| &mut found.value);
    values.find_map(|value| {
        *value = match value {
            Value::Integer(integer) => Value::Integer(*integer + 1),
            Value::Float(float) => Value::Float(*float * 0.9),
            Value::Rgb(rgb) => Value::Rgb(*rgb * 0.9),
            Value::Transform(affine) => {
                Value::Transform(DAffine3::from_translation(DVec3::X * 0.01) * *affine)
            }
            _ => return None,
        };
        Some(())
    })?;
    Some(document)
}

/// The document with an additional light.
fn with_light(document: &Document) -> Document {
    let mut document = document.clone();
    let id = NodeId(document.nodes.len() as u32);
    let root = &mut document.nodes[document.root.index()];
    let span = root.span;
    root.children.push(etendue::document::Child { name: None, node: id, span });
    document.nodes.push(FlatNode {
        class: Class::Emitter,
        plugin: "point".into(),
        id: None,
        span,
        parameters: Vec::new().into(),
        children: Vec::new().into(),
    });
    document
}

/// The document without its last top-level shape.
fn without_last_shape(document: &Document) -> Document {
    let mut document = document.clone();
    let children = &document.nodes[document.root.index()].children;
    let is_shape = |child: &NodeId| document.nodes[child.index()].class == Class::Shape;
    let last = children.iter().map(|child| child.node).rfind(is_shape);
    let root = document.root.index();
    document.nodes[root].children.retain(|child| Some(child.node) != last);
    document
}
