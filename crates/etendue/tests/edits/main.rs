//! An edited scene is bit-identical to the scene loaded from the changed document, and what has not
//! changed is neither read nor built again.

mod mutations;
mod scenes;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;

use etendue::document::{Document, NodeId, Value};
use etendue::scene::SensorSetup;
use etendue::{
    Cancel, Loaded, LoadedScene, Region, RenderJob, RenderOptions, SceneOptions, SensorChoice,
    Silent, Workers, load_document, load_text,
};
use scenes::{CountedFiles, files};

fn options() -> SceneOptions {
    SceneOptions { editable: true, ..SceneOptions::default() }
}

fn load(text: &str, files: &CountedFiles) -> LoadedScene {
    let loaded = load_text(text, PathBuf::from("/scene"), files, &options());
    loaded.scene.unwrap_or_else(|| panic!("{}", loaded.diagnostics))
}

fn document_of(scene: &LoadedScene) -> Document {
    Document::clone(scene.document().expect("the scene is editable"))
}

/// The bits of a few samples of every sensor, all channels. A corner of large films is enough: a
/// film without parameters has half a million pixels.
fn pictures(scene: &LoadedScene, workers: &Workers) -> Vec<Vec<u32>> {
    let picture = |(index, setup): (usize, &SensorSetup)| {
        let [width, height] = [setup.film.width.min(8), setup.film.height.min(6)];
        let options = RenderOptions {
            sensor: SensorChoice::Index(index),
            region: Some(Region { x: 0, y: 0, width, height }),
            samples_per_pixel: Some(2),
            ..RenderOptions::default()
        };
        let job = RenderJob::new(scene, &options).expect("there is such a sensor");
        let rendering = job.render(workers, &Silent, &Cancel::new()).expect("it can be rendered");
        let channels = rendering.picture.channels.iter();
        channels.flat_map(|channel| channel.data.iter().map(|value| value.to_bits())).collect()
    };
    scene.scene.sensors().iter().enumerate().map(picture).collect()
}

/// Panics unless both are the same scene or report the same errors.
fn assert_same(edited: &Loaded, fresh: &Loaded, workers: &Workers, what: &str) {
    assert_eq!(edited.diagnostics.list, fresh.diagnostics.list, "{what}");
    assert_eq!(edited.diagnostics.error_count, fresh.diagnostics.error_count, "{what}");
    let (Some(edited), Some(fresh)) = (&edited.scene, &fresh.scene) else {
        assert_eq!(edited.scene.is_some(), fresh.scene.is_some(), "{what}");
        return;
    };
    assert_eq!(edited.scene.content_hash(), fresh.scene.content_hash(), "{what}");
    assert_eq!(edited.scene.statistics(), fresh.scene.statistics(), "{what}");
    assert_eq!(edited.settings, fresh.settings, "{what}");
    assert!(pictures(edited, workers) == pictures(fresh, workers), "{what}: other pictures");
}

/// Changes and removes every value of a scene; removes, duplicates and moves every child.
fn check_every_mutation(text: &str) {
    on_one_thread(|workers| {
        let files = files();
        let scene = load(text, &files);
        let mutations = mutations::all(&document_of(&scene));
        assert!(mutations.len() > 50);
        let mut built = 0;
        for (what, changed) in mutations {
            let changed = Arc::new(changed);
            let edited = scene.edited(changed.clone(), &files);
            let fresh = load_document(changed, &files, &options());
            assert_same(&edited, &fresh, workers, &what);
            built += usize::from(edited.scene.is_some());
        }
        assert!(built > 30, "most changes leave a scene: {built}");
    });
}

/// Hundreds of tiny scenes load and render faster if no thread waits for another.
fn on_one_thread(test: impl FnOnce(&Workers) + Send) {
    let workers = Workers::new(NonZeroUsize::new(1)).unwrap();
    workers.run(|| test(&workers));
}

#[test]
fn surfaces_and_lights_after_any_change_are_those_of_a_fresh_load() {
    check_every_mutation(scenes::SURFACES);
}

#[test]
fn groups_media_and_volumes_after_any_change_are_those_of_a_fresh_load() {
    check_every_mutation(scenes::VOLUMES);
}

#[test]
fn other_shapes_and_sensors_after_any_change_are_those_of_a_fresh_load() {
    check_every_mutation(scenes::SHAPES);
}

/// What an edit reuses from a chain of edits is still correct, including when an edit is reverted.
#[test]
fn edits_of_edits_are_those_of_a_fresh_load() {
    on_one_thread(|workers| {
        for text in [scenes::SURFACES, scenes::VOLUMES, scenes::SHAPES] {
            check_chain(text, workers);
        }
    });
}

fn check_chain(text: &str, workers: &Workers) {
    let files = files();
    let mut scene = load(text, &files);
    let mut seed = 7;
    for step in 0..25 {
        let mut mutations = mutations::all(&document_of(&scene));
        seed = (seed * 31 + 11) % 1009;
        let (what, changed) = mutations.swap_remove(seed % mutations.len());
        let changed = Arc::new(changed);
        let edited = scene.edited(changed.clone(), &files);
        let fresh = load_document(changed, &files, &options());
        assert_same(&edited, &fresh, workers, &format!("step {step}: {what}"));
        scene = edited.scene.unwrap_or(scene);
    }
}

#[test]
fn a_document_that_holds_itself_is_an_error() {
    let files = files();
    let scene = load(scenes::SURFACES, &files);
    let mut document = document_of(&scene);
    let (root, shape) = (document.root, first(&document, "ply"));
    document.nodes[shape.index()].children[0].node = root;
    let edited = scene.edited(document, &files);
    assert!(edited.scene.is_none());
    assert_eq!(edited.diagnostics.list[0].message, "this node holds itself");
}

fn first(document: &Document, plugin: &str) -> NodeId {
    let found = document.nodes.iter().position(|node| node.plugin == plugin);
    NodeId(found.unwrap_or_else(|| panic!("a {plugin}")) as u32)
}

fn set(document: &mut Document, plugin: &str, parameter: &str, value: Value) {
    let node = first(document, plugin);
    let parameters = &mut document.nodes[node.index()].parameters;
    let found = parameters.iter_mut().find(|known| known.name == parameter);
    found.unwrap_or_else(|| panic!("a parameter {parameter}")).value = value;
}

#[test]
fn only_what_changed_is_read_and_built() {
    let files = files();
    let scene = load(scenes::SURFACES, &files);
    let tree = Arc::as_ptr(scene.scene.tree());
    let edit = |change: &dyn Fn(&mut Document)| {
        let mut document = document_of(&scene);
        change(&mut document);
        files.forget_reads();
        let edited = scene.edited(document, &files).scene.expect("no errors");
        (files.reads(), std::ptr::eq(Arc::as_ptr(edited.scene.tree()), tree))
    };
    let nothing: Vec<String> = Vec::new();
    assert_eq!(edit(&|_| ()), (nothing.clone(), true));
    let changes: [(&str, &str, Value); 8] = [
        ("perspective", "fov", Value::Float(50.0)),
        ("hdrfilm", "width", Value::Integer(9)),
        ("independent", "sample_count", Value::Integer(3)),
        ("path", "max_depth", Value::Integer(3)),
        ("area", "radiance", Value::Float(2.0)),
        ("roughplastic", "alpha", Value::Float(0.2)),
        ("envmap", "to_world", Value::transform(etendue::math::glam::DMat4::from_rotation_y(1.0))),
        ("bitmap", "wrap_mode", Value::String("mirror".into())),
    ];
    for (plugin, parameter, value) in changes {
        let found = edit(&|document| set(document, plugin, parameter, value.clone()));
        assert_eq!(found, (nothing.clone(), true), "{plugin} {parameter}");
    }
    let found = edit(&|document| {
        set(
            document,
            "ply",
            "to_world",
            Value::transform(etendue::math::glam::DMat4::from_scale([2.0; 3].into())),
        );
    });
    assert_eq!(found, (vec!["/scene/colored.ply".to_owned()], false), "its own file alone");
    let found = edit(&|document| set(document, "sphere", "radius", Value::Float(0.4)));
    assert_eq!(found, (nothing, false), "no file, but another tree");
}

#[test]
fn files_are_taken_as_unchanged_until_they_are_forgotten() {
    let files = files();
    let scene = load(scenes::SURFACES, &files);
    files.replace("/scene/colored.ply", scenes::PLAIN_PLY);
    let document = scene.document().unwrap().clone();
    let edited = |scene: &LoadedScene| scene.edited(document.clone(), &files).scene.unwrap();
    let hash = |scene: &LoadedScene| scene.scene.content_hash();

    let as_before = edited(&scene);
    scene.forget_file("/scene/colored.ply".as_ref());
    let again = load_document(document.clone(), &files, &options());
    let with_new_file = scene.edited(document.clone(), &files);
    assert_eq!(with_new_file.diagnostics.list, again.diagnostics.list);
    assert!(again.scene.is_none(), "the new mesh lacks the attribute that its material reads");

    files.replace("/scene/colored.ply", &scenes::COLORED_PLY.replace("255", "200"));
    let forgotten = as_before.clone();
    forgotten.forget_files();
    let new = load_document(document.clone(), &files, &options()).scene.unwrap();
    assert_ne!(hash(&edited(&forgotten)), hash(&as_before));
    assert_eq!(hash(&edited(&forgotten)), hash(&new));
}

#[test]
fn a_scene_without_its_document_can_be_edited_too() {
    let files = files();
    let plain = SceneOptions::default();
    let loaded = load_text(scenes::SURFACES, "/scene".into(), &files, &plain);
    let scene = loaded.scene.unwrap();
    assert!(scene.document().is_none());
    let document = document_of(&load(scenes::SURFACES, &files));
    let edited = scene.edited(document.clone(), &files);
    let fresh = load_document(document, &files, &plain);
    assert_same(&edited, &fresh, &Workers::new(None).unwrap(), "no change");
}
