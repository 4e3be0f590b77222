//! `etendue info`: describes a scene, the program and the machine.

use std::path::PathBuf;

use clap::Args;
use etendue::bvh::Tier;
use etendue::document::printable;
use etendue::scene::{Scene, SensorSetup};
use etendue::{Loaded, LoadedScene, Workers};
use serde_json::{Value, json};

use super::scene::SceneArguments;
use crate::failure::{Failure, Status};
use crate::text::{bytes, duration, grouped};
use crate::{diagnostics, terminal};

/// The arguments of `etendue info`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The scene file; without one, show only the program and the machine
    #[arg(value_name = "SCENE")]
    path: Option<PathBuf>,
    /// Print JSON, for other programs
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Prints the program's properties, and those of the scene if there is one.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let workers = arguments.scene.workers()?;
    let program = program(&workers);
    let Some(path) = &arguments.path else {
        if arguments.json {
            terminal::json(&json!({ "program": program_as_json(&program) }))?;
        } else {
            terminal::result(&rows_as_text(&program))?;
        }
        return Ok(Status::Success);
    };
    let loaded = arguments.scene.load(path, &workers)?;
    diagnostics::show(&loaded.diagnostics, arguments.scene.detail());
    let Some(LoadedScene { scene, .. }) = &loaded.scene else {
        return Ok(Status::BadInput);
    };
    if arguments.json {
        let mut shown = as_json(&loaded, scene);
        shown["program"] = program_as_json(&program);
        terminal::json(&shown)?;
    } else {
        terminal::result(&(rows_as_text(&program) + &as_text(&loaded, scene)))?;
    }
    Ok(Status::Success)
}

/// A name and its value.
type Row = (&'static str, String);

/// The properties that a bug report should include: version, target, SIMD level and thread count.
fn program(workers: &Workers) -> [Row; 4] {
    let profile = if cfg!(debug_assertions) { " (debug)" } else { "" };
    [
        ("version", format!("{}{profile}", env!("CARGO_PKG_VERSION"))),
        ("target", format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS)),
        ("simd", format!("{:?}", Tier::detect()).to_lowercase()),
        ("threads", workers.thread_count().to_string()),
    ]
}

fn program_as_json(program: &[Row]) -> Value {
    program.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect()
}

fn rows_as_text(rows: &[Row]) -> String {
    rows.iter().map(|(name, value)| format!("{name:<10} {value}\n")).collect()
}

fn as_text(loaded: &Loaded, scene: &Scene) -> String {
    let statistics = scene.statistics();
    let bounds = scene.bounds();
    let emitters = statistics.emitters.iter().map(|(kind, count)| format!("{count} {kind}"));
    let emitters: Vec<String> = emitters.collect();
    let rows = [
        ("shapes", grouped(statistics.shapes)),
        ("triangles", grouped(statistics.triangles)),
        ("instances", grouped(statistics.instances)),
        ("materials", grouped(statistics.materials)),
        ("textures", grouped(statistics.textures)),
        ("media", grouped(statistics.media)),
        ("emitters", if emitters.is_empty() { "none".into() } else { emitters.join(", ") }),
        ("bounds", format!("{} to {}", point(bounds.min), point(bounds.max))),
        ("sensors", sensors(scene).join("; ")),
        (
            "memory",
            format!(
                "{} meshes, {} trees, {} textures, {} volumes",
                bytes(statistics.mesh_bytes),
                bytes(statistics.tree_bytes),
                bytes(statistics.texture_bytes),
                bytes(statistics.volume_bytes)
            ),
        ),
        (
            "loading",
            format!(
                "{} text, {} scene",
                duration(loaded.times.document),
                duration(loaded.times.scene)
            ),
        ),
        ("findings", diagnostics::summary(&loaded.diagnostics)),
    ];
    rows_as_text(&rows)
}

fn point(point: impl Into<[f32; 3]>) -> String {
    let [x, y, z] = point.into();
    format!("({x}, {y}, {z})")
}

/// `0: 640x360, 64 samples per pixel`.
fn sensors(scene: &Scene) -> Vec<String> {
    let describe = |(index, setup): (usize, &SensorSetup)| {
        let id = setup.id.as_ref().map(|id| format!(" `{}`", printable(id))).unwrap_or_default();
        let (film, count) = (&setup.film, setup.sampler.rounded_sample_count());
        format!("{index}{id}: {}x{}, {count} samples per pixel", film.width, film.height)
    };
    scene.sensors().iter().enumerate().map(describe).collect()
}

fn as_json(loaded: &Loaded, scene: &Scene) -> Value {
    let statistics = scene.statistics();
    let bounds = scene.bounds();
    let sensor = |setup: &SensorSetup| {
        json!({
            "id": setup.id,
            "width": setup.film.width,
            "height": setup.film.height,
            "samples_per_pixel": setup.sampler.rounded_sample_count(),
        })
    };
    json!({
        "shapes": statistics.shapes,
        "triangles": statistics.triangles,
        "instances": statistics.instances,
        "materials": statistics.materials,
        "textures": statistics.textures,
        "media": statistics.media,
        "emitters": statistics.emitters,
        "bounds": { "min": bounds.min.to_array(), "max": bounds.max.to_array() },
        "sensors": scene.sensors().iter().map(sensor).collect::<Vec<_>>(),
        "memory_bytes": {
            "meshes": statistics.mesh_bytes,
            "trees": statistics.tree_bytes,
            "textures": statistics.texture_bytes,
            "volumes": statistics.volume_bytes,
        },
        "seconds": {
            "document": loaded.times.document.as_secs_f64(),
            "scene": loaded.times.scene.as_secs_f64(),
        },
        "hash": hexadecimal(&scene.content_hash()),
        "findings": diagnostics::as_json(&loaded.diagnostics),
    })
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
