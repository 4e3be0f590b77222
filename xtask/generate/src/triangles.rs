//! Writes the triangles and the first camera of a scene to a plain binary file, so that `cargo
//! xtask bench rays` can trace them without the renderer.
//!
//! All numbers are little-endian. The camera comes first: three pairs of an origin and a direction,
//! for the upper left, upper right and lower left corner of the film. Rays between them are linear
//! in the film position. Then follow the number of meshes, and for each mesh the number of
//! vertices, the number of triangles, the vertices (three `f32` each) and the triangles (three
//! `u32` each). Counts are `u64`.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::Args;
use etendue::scene::Scene;
use etendue::{Files, SceneOptions, Workers, load};
use glam::{Vec2, Vec3};

/// What to write, and where.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// The file to write
    output: PathBuf,
}

/// Writes the file.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let here = std::env::current_dir().map_err(|error| error.to_string())?;
    let workers = Workers::new(None).map_err(|error| error.to_string())?;
    let loaded =
        workers.run(|| load(&arguments.scene, here, &Files::default(), &SceneOptions::default()));
    let scene = loaded.scene.ok_or_else(|| loaded.diagnostics.to_string())?;
    let message = |error: std::io::Error| format!("{}: {error}", arguments.output.display());
    let mut file = BufWriter::new(File::create(&arguments.output).map_err(message)?);
    write(&scene.scene, &mut file).and_then(|()| file.flush()).map_err(message)
}

fn write(scene: &Scene, file: &mut impl Write) -> std::io::Result<()> {
    for [origin, direction] in corners(scene) {
        write_vector(file, origin)?;
        write_vector(file, direction)?;
    }
    write_count(file, scene.meshes().count())?;
    for mesh in scene.meshes() {
        write_count(file, mesh.positions().len())?;
        write_count(file, mesh.triangles().len())?;
        for position in mesh.positions() {
            write_vector(file, *position)?;
        }
        for index in mesh.triangles().as_flattened() {
            file.write_all(&index.to_le_bytes())?;
        }
    }
    Ok(())
}

/// The rays of three corners of the first camera's film, with directions that end on one plane.
fn corners(scene: &Scene) -> [[Vec3; 2]; 3] {
    let Some(setup) = scene.sensors().first() else { return [[Vec3::ZERO, Vec3::Z]; 3] };
    let ray = |position: Vec2| setup.sensor.sample_ray(position, Vec2::splat(0.5)).ray;
    let forward = ray(Vec2::splat(0.5)).direction;
    [Vec2::ZERO, Vec2::X, Vec2::Y].map(|position| {
        let ray = ray(position);
        [ray.origin, ray.direction / ray.direction.dot(forward)]
    })
}

fn write_vector(file: &mut impl Write, vector: Vec3) -> std::io::Result<()> {
    vector.to_array().iter().try_for_each(|number| file.write_all(&number.to_le_bytes()))
}

fn write_count(file: &mut impl Write, count: usize) -> std::io::Result<()> {
    file.write_all(&(count as u64).to_le_bytes())
}
