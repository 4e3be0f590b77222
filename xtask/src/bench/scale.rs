//! `cargo xtask bench scale`: rate and memory by the number of triangles and of instances, of the
//! tree alone and of whole renders.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use clap::Parser;

use crate::etendue;
use crate::workspace::{cargo, root};

/// Generated scenes of growing size.
#[derive(Debug, Parser)]
pub(super) struct Arguments {
    /// No more triangles or instances than this
    #[arg(long, value_name = "COUNT", default_value_t = 10_000_000)]
    most: usize,
    /// The tree alone, without whole renders
    #[arg(long)]
    tree_only: bool,
}

/// What is counted, and how many of them at most.
const SERIES: [(&str, &[usize]); 2] = [
    ("triangles", &[1_000, 10_000, 100_000, 1_000_000, 10_000_000]),
    ("instances", &[1_000, 10_000, 100_000, 1_000_000]),
];

/// Runs the benchmark.
pub(super) fn run(arguments: &Arguments) -> Result<(), String> {
    trees(arguments.most)?;
    if arguments.tree_only {
        return Ok(());
    }
    if !etendue::build() {
        return Err("etendue does not compile".to_owned());
    }
    println!("\n{:<24}{:>9}{:>9}", "whole render", "wall s", "peak MB");
    let folder = etendue::folder("bench/scale")?;
    let terrain = folder.join("terrain.xml");
    let side = (arguments.most.min(10_000_000) / 2).isqrt();
    write(&folder.join("terrain.ply"), |file| write_terrain(file, side))?;
    write(&terrain, |file| write_scene(file, TERRAIN, 0))?;
    measure(&terrain, &format!("{} triangles", 2 * side * side))?;
    let grove = folder.join("grove.xml");
    let count = arguments.most.min(1_000_000);
    write(&folder.join("plate.ply"), |file| write_terrain(file, 71))?;
    write(&grove, |file| write_scene(file, GROVE, count))?;
    measure(&grove, &format!("{count} instances"))
}

/// The tree alone: a process for each row, so that its peak is its own.
fn trees(most: usize) -> Result<(), String> {
    let build = ["build", "--quiet", "--release", "--package", "etendue-bvh", "--example", "scale"];
    super::rays::check(cargo().args(build))?;
    let program = root().join("target/release/examples/scale");
    let columns = ["build s", "Mrays/s", "tree MB", "peak MB", "hits"];
    print!("{:<12}{:>10}{:>9}", "", "count", "threads");
    columns.iter().for_each(|column| print!("{column:>10}"));
    println!();
    for (kind, counts) in SERIES {
        for count in counts.iter().filter(|&&count| count <= most) {
            for threads in ["1", "2"] {
                let mut command = Command::new(&program);
                let row = etendue::output(command.args([kind, &count.to_string(), threads]))?;
                print!("{kind:<12}{count:>10}{threads:>9}");
                row.split_whitespace().for_each(|figure| print!("{figure:>10}"));
                println!();
            }
        }
    }
    Ok(())
}

/// The head of both scenes.
const HEAD: &str = r#"<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="4"/></integrator>
<sensor type="perspective"><float name="fov" value="50"/><transform name="to_world">
<lookat origin="0.5, 0.6, -0.6" target="0.5, 0, 0.5" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="640"/><integer name="height" value="360"/></film></sensor>
<emitter type="constant"/>
"#;
/// Ten million triangles.
const TERRAIN: &str = r#"<shape type="ply"><string name="filename" value="terrain.ply"/><bsdf type="diffuse"/></shape>"#;
/// Ten thousand triangles, to be placed a million times.
const GROVE: &str = r#"<shape type="shapegroup" id="plate"><shape type="ply"><string name="filename" value="plate.ply"/><bsdf type="diffuse"/></shape></shape>"#;

fn write(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), String> {
    let message = |error: std::io::Error| format!("{}: {error}", path.display());
    let mut file = BufWriter::new(File::create(path).map_err(message)?);
    content(&mut file).and_then(|()| file.flush()).map_err(message)
}

/// A scene with so many instances of the group `plate`, on a grid over the unit square.
fn write_scene(file: &mut impl Write, shapes: &str, instances: usize) -> std::io::Result<()> {
    writeln!(file, "{HEAD}{shapes}")?;
    let side = instances.isqrt().max(1);
    for index in 0..instances {
        let [x, z] = [index % side, index / side].map(|place| place as f64 / side as f64);
        let scale = 0.8 / side as f64;
        writeln!(
            file,
            r#"<shape type="instance"><ref id="plate"/><transform name="to_world"><scale value="{scale}"/><translate x="{x}" z="{z}"/></transform></shape>"#
        )?;
    }
    writeln!(file, "</scene>")
}

/// Hills of `side`² quads, as a binary PLY file.
fn write_terrain(file: &mut impl Write, side: usize) -> std::io::Result<()> {
    let (vertices, faces) = ((side + 1) * (side + 1), 2 * side * side);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\n\
         property float y\nproperty float z\nelement face {faces}\n\
         property list uchar int vertex_indices\nend_header\n"
    )?;
    for place in 0..vertices {
        let [x, z] = [place % (side + 1), place / (side + 1)].map(|k| k as f32 / side as f32);
        let y = 0.05 * (x * 9.0).sin() * (z * 7.0).cos() + 0.01 * (x * 61.0 + z * 53.0).sin();
        for number in [x, y, z] {
            file.write_all(&number.to_le_bytes())?;
        }
    }
    for quad in 0..side * side {
        let a = (quad / side * (side + 1) + quad % side) as u32;
        let below = a + side as u32 + 1;
        for triangle in [[a, below, a + 1], [a + 1, below, below + 1]] {
            file.write_all(&[3])?;
            for index in triangle {
                file.write_all(&index.to_le_bytes())?;
            }
        }
    }
    Ok(())
}

/// Renders a scene with few samples; prints the time and the most memory that it took.
fn measure(scene: &Path, name: &str) -> Result<(), String> {
    let output = scene.with_extension("pfm");
    let mut command = etendue::command();
    command.arg("render").arg(scene).args(["--spp", "4", "--quiet", "--threads", "2"]);
    command.arg("--output").arg(&output).stdin(Stdio::null());
    let started = Instant::now();
    let mut child = command.spawn().map_err(|error| error.to_string())?;
    let status = format!("/proc/{}/status", child.id());
    let mut peak = f64::NAN;
    let outcome = loop {
        // The system forgets the peak with the process: the last look counts. (Polling, because
        // the standard library does not tell what a child used.)
        peak = peak_megabytes(&status).unwrap_or(peak);
        if let Some(outcome) = child.try_wait().map_err(|error| error.to_string())? {
            break outcome;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let seconds = started.elapsed().as_secs_f64();
    println!("{name:<24}{seconds:>9.2}{peak:>9.0}");
    if outcome.success() { Ok(()) } else { Err(format!("{name} do not render")) }
}

/// The most memory that a process ever had, where Linux says it.
fn peak_megabytes(status: &str) -> Option<f64> {
    let status = std::fs::read_to_string(status).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1.024e-3)
}
