//! Every parameter of every plugin with extreme values: the command ends soon, with exit code 0 or 2,
//! and without a panic.
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "the test writes scenes, runs the command, and shows what it finds"
)]

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::thread::sleep;
use std::time::{Duration, Instant};

use etendue::document::Class;
use etendue::image::{EncodeOptions, FileFormat, Picture, encode};
use etendue::integrators::INTEGRATORS;
use etendue::scene::{Manual, ParameterManual, registry};
use rayon::prelude::*;

/// Extreme values of any kind.
const VALUES: [&str; 12] = [
    "0",
    "-1",
    "1",
    "1e38",
    "-1e38",
    "1e-38",
    "-1e-38",
    "2147483648",
    "nan",
    "inf",
    "",
    "\u{fffd}<&",
];

/// How long a text of the longest value is.
const LONG: usize = 100_000;

/// How long a render of a few samples may take on a busy machine. The command itself is told to stop
/// much earlier.
const PATIENCE: Duration = Duration::from_secs(30);

/// A scene with one extreme value.
struct Case {
    /// Class, plugin, parameter and value, for messages.
    name: String,
    scene: String,
}

/// The elements that give a parameter a value, by the words of its kind in the manual.
fn elements(parameter: &ParameterManual, value: &str) -> Vec<String> {
    let ParameterManual { name, kind, .. } = parameter;
    let value = value.replace('&', "&amp;").replace('<', "&lt;");
    let simple = |element: &str| format!("<{element} name=\"{name}\" value=\"{value}\"/>");
    let transform = |operation: &str| {
        format!("<transform name=\"{name}\"><{operation} value=\"{value}\"/></transform>")
    };
    let mut all = Vec::new();
    for word in kind.split([' ', ',']) {
        match word {
            "float" | "integer" | "boolean" | "string" | "point" | "vector" => {
                all.push(simple(word));
            }
            "spectrum" | "color" => all.extend(["rgb", "spectrum"].map(simple)),
            "texture" => all.push(format!(
                "<texture type=\"checkerboard\" name=\"{name}\"><float name=\"color0\" \
                 value=\"{value}\"/></texture>"
            )),
            "transform" => all.extend(["scale", "translate"].map(transform)),
            "volume" => all.push(format!(
                "<volume type=\"constvolume\" name=\"{name}\"><float name=\"value\" \
                 value=\"{value}\"/></volume>"
            )),
            _ => {}
        }
    }
    if all.is_empty() {
        all.push(simple("string"));
    }
    all
}

/// The sample of a manual without its own value of a parameter and with another one instead.
fn with_value(sample: &str, plugin: &str, parameter: &str, element: &str) -> Option<String> {
    let mut sample = sample.to_owned();
    let named = format!("name=\"{parameter}\"");
    if let Some(place) = sample.find(&named) {
        let start = sample[..place].rfind('<')?;
        let end = place + sample[place..].find('>')? + 1;
        // A value that is an element of its own stays; two values of one name are an error.
        if sample[..end].ends_with("/>") {
            sample.replace_range(start..end, "");
        }
    }
    let place = sample.find(&format!("type=\"{plugin}\""))?;
    let start = sample[..place].rfind('<')? + 1;
    let class: String = sample[start..].chars().take_while(|c| c.is_ascii_lowercase()).collect();
    let end = place + sample[place..].find('>')?;
    if sample[..end].ends_with('/') {
        sample.replace_range(end - 1..=end, &format!(">{element}</{class}>"));
    } else {
        sample.insert_str(end + 1, element);
    }
    Some(sample)
}

/// A whole scene around a sample of a class.
fn scene_around(class: Class, sample: &str) -> String {
    const FILM: &str = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"8\"/>\
                        <integer name=\"height\" value=\"8\"/></film>";
    const VIEW: &str = "<transform name=\"to_world\"><lookat origin=\"0, 1, 5\" \
                        target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>";
    const LIGHT: &str = "<emitter type=\"constant\"/>";
    let sensor = |inner: &str| format!("<sensor type=\"perspective\">{VIEW}{inner}</sensor>");
    let inner = match class {
        _ if sample.starts_with("<scene>") => {
            sample.replacen("<scene>", "", 1).replace("</scene>", "")
        }
        Class::Bsdf => format!("<shape type=\"sphere\">{sample}</shape>"),
        Class::Texture if !sample.contains(" name=\"reflectance\"") => {
            let named = sample.replacen("<texture", "<texture name=\"reflectance\"", 1);
            format!("<shape type=\"sphere\"><bsdf type=\"diffuse\">{named}</bsdf></shape>")
        }
        Class::Texture => {
            format!("<shape type=\"sphere\"><bsdf type=\"diffuse\">{sample}</bsdf></shape>")
        }
        Class::Film => sensor(sample),
        Class::Sampler => sensor(&format!("{sample}{FILM}")),
        Class::ReconstructionFilter => {
            sensor(&FILM.replace("</film>", &format!("{sample}</film>")))
        }
        _ => sample.to_owned(),
    };
    let camera = if inner.contains("<sensor") { String::new() } else { sensor(FILM) };
    let shape = if inner.contains("<shape") { "" } else { "<shape type=\"sphere\"/>" };
    let integrator = match class {
        Class::Integrator => "",
        Class::Medium | Class::Phase | Class::Volume => "<integrator type=\"volpath\"/>",
        _ => "<integrator type=\"path\"/>",
    };
    format!("<scene version=\"3.0.0\">{integrator}{camera}{LIGHT}{shape}{inner}</scene>")
}

fn cases_of(class: Class, plugin: &str, manual: &Manual) -> Vec<Case> {
    let long = "9".repeat(LONG);
    let values = VALUES.into_iter().chain([long.as_str()]);
    let mut cases = Vec::new();
    for value in values {
        for parameter in manual.parameters {
            for element in elements(parameter, value) {
                // Samples in Rust have nothing that a text could name.
                let sample = with_value(manual.sample, plugin, parameter.name, &element);
                let Some(sample) = sample.filter(|sample| sample.starts_with('<')) else {
                    continue;
                };
                let shown: String = element.chars().take(80).collect();
                let name = format!("{} {plugin}: {shown}", class.name());
                cases.push(Case { name, scene: scene_around(class, &sample) });
            }
        }
    }
    cases
}

/// The files that samples name.
fn write_files(folder: &Path) {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut picture = Picture::new(2, 2);
    for name in ["R", "G", "B"] {
        picture.push(name, vec![0.5; 4]);
    }
    let encoded = |format| encode(&picture, format, &EncodeOptions::default()).unwrap();
    let header = [1, 2, 1, 1, 1].map(i32::to_le_bytes).concat();
    let values = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.25].map(f32::to_le_bytes).concat();
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
               end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let made = [
        ("sample.obj", triangle.as_bytes().to_vec()),
        ("sample.ply", ply.as_bytes().to_vec()),
        ("curves.txt", b"0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1\n".to_vec()),
        ("smoke.vol", [b"VOL\x03".to_vec(), header, values].concat()),
        ("sample.exr", encoded(FileFormat::Exr)),
        ("wood.png", encoded(FileFormat::Png)),
    ];
    for (name, bytes) in made {
        fs::write(folder.join(name), bytes).unwrap();
    }
    let stored = [
        ("sample.serialized", "scene/tests/data/triangle.serialized"),
        ("distance.vol", "scene/tests/data/distance.vol"),
        ("ellipsoids.ply", "scene/tests/data/ellipsoids.ply"),
        ("sample.bsdf", "scene/src/bsdf/measured/isotropic.bsdf"),
    ];
    for (name, file) in stored {
        fs::copy(crates.join(file), folder.join(name)).unwrap();
    }
}

/// What is wrong with the run of a case, if anything.
fn problem(binary: &Path, folder: &Path, number: usize, case: &Case) -> Option<String> {
    let scene = format!("{number}.xml");
    fs::write(folder.join(&scene), &case.scene).unwrap();
    let mut command = Command::new(binary);
    command.current_dir(folder).args(["render", &scene, "-q", "--no-checkpoint", "-t", "1"]);
    command.args(["--spp", "1", "--time", "2s", "--memory", "2GB", "--size", "8x8"]);
    command.args(["-o", &format!("{number}.exr")]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stderr = child.stderr.take().unwrap();
    let messages = std::thread::spawn(move || {
        let mut text = Vec::new();
        let _ = stderr.read_to_end(&mut text);
        String::from_utf8_lossy(&text).into_owned()
    });
    let began = Instant::now();
    let status: Option<ExitStatus> = loop {
        match child.try_wait().unwrap() {
            Some(status) => break Some(status),
            None if began.elapsed() > PATIENCE => {
                child.kill().unwrap();
                child.wait().unwrap();
                break None;
            }
            None => sleep(Duration::from_millis(2)),
        }
    };
    let messages = messages.join().unwrap();
    let _ = fs::remove_file(folder.join(format!("{number}.exr")));
    let _ = fs::remove_file(folder.join(scene));
    match status.map(|status| status.code()) {
        Some(Some(0 | 2)) if !messages.contains("panicked") => None,
        None => Some(format!("{}: still running after {PATIENCE:?}", case.name)),
        Some(code) => Some(format!("{}: exit code {code:?}: {messages}", case.name)),
    }
}

#[test]
#[ignore = "runs the command ten thousand times, which takes many minutes"]
fn every_parameter_of_every_plugin_survives_extreme_values() {
    let folder = tempfile::tempdir().unwrap();
    write_files(folder.path());
    let binary = std::env::var_os("ETENDUE")
        .map_or_else(|| PathBuf::from(env!("CARGO_BIN_EXE_etendue")), PathBuf::from);
    let mut cases = Vec::new();
    for (class, plugin, manual) in registry::plugins() {
        cases.extend(cases_of(class, plugin, manual));
    }
    for integrator in INTEGRATORS {
        cases.extend(cases_of(Class::Integrator, integrator.name, integrator.manual));
    }
    println!("{} cases", cases.len());
    assert!(cases.len() > 1000, "the manuals have more parameters than that");
    let problems = Mutex::new(Vec::new());
    cases.par_iter().enumerate().for_each(|(number, case)| {
        if let Some(problem) = problem(&binary, folder.path(), number, case) {
            println!("{problem}");
            problems.lock().unwrap().push(problem);
        }
    });
    let problems = problems.into_inner().unwrap();
    assert!(problems.is_empty(), "{} problems:\n{}", problems.len(), problems.join("\n"));
}
