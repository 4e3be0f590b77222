//! Arguments beyond reason, memory, and outputs that others use or take away.

use std::fs;
#[cfg(target_os = "linux")]
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use etendue::image::{EncodeOptions, FileFormat, Picture, encode};

use crate::run::{Outcome, Workplace, small_scene};

/// Values that no option with a number, a size, a time or a choice accepts.
const WRONG: [&str; 9] =
    ["", "-1", "nan", "1e300", "99999999999999999999999", "x", "0x10", "1.5.2", "\u{fffd}"];

#[test]
fn impossible_values_of_every_option_are_errors_at_once() {
    let workplace = Workplace::new();
    let scene = small_scene();
    let render = ["render", scene.as_str(), "-o", "x.exr"];
    let check = ["check", scene.as_str()];
    let info = ["info", scene.as_str()];
    let convert = ["convert", scene.as_str(), "x.png"];
    let diff = ["diff", scene.as_str(), scene.as_str()];
    let options: [(&[&str], &[&str]); 5] = [
        (
            &render,
            &[
                "--spp",
                "--time",
                "--samples",
                "--seed",
                "--crop",
                "--replay",
                "--resume",
                "--checkpoint-every",
                "--preview-every",
                "--preview",
                "--sensor",
                "--size",
                "--filter",
                "--integrator",
                "--memory",
                "--threads",
                "-D",
            ],
        ),
        (&check, &["--size", "--filter", "--integrator", "--memory", "-t"]),
        (&info, &["--size", "--filter", "--integrator", "--memory", "-t"]),
        (&convert, &["--exposure", "--tonemap"]),
        (&diff, &["--metric", "--variance"]),
    ];
    for (command, options) in options {
        for option in options {
            for value in WRONG {
                let argument = match option.strip_prefix("--") {
                    Some(_) => format!("{option}={value}"),
                    None => format!("{option}{value}"),
                };
                let arguments = [command, &[argument.as_str()]].concat();
                let outcome = workplace.fail(&arguments);
                assert!(outcome.stderr.len() < 4000, "{arguments:?}: {}", outcome.stderr);
            }
        }
    }
}

#[test]
fn thousands_of_threads_are_refused_at_once() {
    let workplace = Workplace::new();
    for count in ["3000", "20000", "0"] {
        let began = Instant::now();
        let outcome = workplace.fail(&["render", &small_scene(), "-t", count]);
        assert!(began.elapsed() < Duration::from_secs(5));
        assert!(outcome.stderr.contains("expected a number from 1 to"), "{}", outcome.stderr);
    }
}

/// A scene with several pictures of 1000 × 1000 pixels, which take 3 MB each.
fn pictures(workplace: &Workplace, count: usize) {
    let mut picture = Picture::new(1000, 1000);
    for name in ["R", "G", "B"] {
        picture.push(name, vec![0.5; 1_000_000]);
    }
    let png = encode(&picture, FileFormat::Png, &EncodeOptions::default()).unwrap();
    let mut text = "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>".to_owned();
    for index in 0..count {
        fs::write(workplace.path(&format!("p{index}.png")), &png).unwrap();
        text += &format!(
            "<shape type=\"sphere\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" \
             name=\"reflectance\"><string name=\"filename\" value=\"p{index}.png\"/></texture>\
             </bsdf></shape>"
        );
    }
    fs::write(workplace.path("pictures.xml"), text + "</scene>").unwrap();
}

#[test]
fn pictures_have_one_budget_of_memory() {
    let workplace = Workplace::new();
    pictures(&workplace, 4);
    workplace.succeed(&["check", "-q", "pictures.xml", "--memory", "13MB"]);
    let outcome = workplace.fail(&["check", "pictures.xml", "--memory", "8MB"]);
    let message =
        "png: a picture of 1000x1000 pixels: it needs 3.0 MB of memory, and 2.0 MB are left";
    assert_eq!(outcome.stderr.matches(message).count(), 2, "{}", outcome.stderr);
}

#[test]
fn meshes_share_the_budget() {
    let workplace = Workplace::new();
    let mut obj = String::new();
    for index in 0..10_000 {
        obj += &format!("v {index} 0 0\nv {index} 1 0\nv {index} 0 1\nf -1 -2 -3\n");
    }
    fs::write(workplace.path("m.obj"), obj).unwrap();
    let scene = "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><shape type=\"obj\">\
                 <string name=\"filename\" value=\"m.obj\"/></shape></scene>";
    fs::write(workplace.path("m.xml"), scene).unwrap();
    workplace.succeed(&["check", "-q", "m.xml", "--memory", "10MB"]);
    let outcome = workplace.fail(&["check", "m.xml", "--memory", "1MB"]);
    assert!(outcome.stderr.contains("m.obj: it needs"), "{}", outcome.stderr);
}

/// A shell limits the address space to a gigabyte; the picture needs more.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_beyond_the_limit_of_the_shell_is_an_error() {
    let workplace = Workplace::new();
    fs::write(workplace.path("p0.png"), zeros_png(20_000)).unwrap();
    let scene = "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><emitter type=\"envmap\">\
                 <string name=\"filename\" value=\"p0.png\"/></emitter></scene>";
    fs::write(workplace.path("pictures.xml"), scene).unwrap();
    let binary = crate::run::binary();
    let shell = format!("ulimit -v 1000000; exec '{}' check pictures.xml", binary.display());
    let mut command = std::process::Command::new("sh");
    command.current_dir(workplace.path("")).args(["-c", &shell]);
    let outcome = Outcome::from(command.output().unwrap());
    assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("p0.png"), "{}", outcome.stderr);
}

/// A PNG file of grey zeros with 16 bits: few bytes that expand to many.
#[cfg(target_os = "linux")]
fn zeros_png(side: u32) -> Vec<u8> {
    use std::io::Write;
    let mut deflated = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let row = vec![0; 1 + 2 * side as usize];
    (0..side).for_each(|_| deflated.write_all(&row).unwrap());
    let sides = [side.to_be_bytes(), side.to_be_bytes()].concat();
    let header = [&sides[..], &[16, 0, 0, 0, 0]].concat();
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        let mut crc = flate2::Crc::new();
        crc.update(kind);
        crc.update(data);
        let length = (data.len() as u32).to_be_bytes();
        [&length[..], kind, data, &crc.sum().to_be_bytes()].concat()
    };
    let body = deflated.finish().unwrap();
    let chunks = [chunk(b"IHDR", &header), chunk(b"IDAT", &body), chunk(b"IEND", b"")].concat();
    [b"\x89PNG\r\n\x1a\n".to_vec(), chunks].concat()
}

#[test]
fn two_renders_of_one_output_do_not_mix() {
    let workplace = Workplace::new();
    let scene = small_scene();
    let long = ["render", &scene, "-q", "--spp", "100000000", "--no-checkpoint", "-o", "a.exr"];
    let mut first = workplace.command(&long).spawn().unwrap();
    let began = Instant::now();
    let lock = workplace.path(".a.exr.lock");
    while !lock.exists() && began.elapsed() < Duration::from_secs(30) {
        sleep(Duration::from_millis(20));
    }
    let short = ["render", &scene, "-q", "--spp", "1", "-o", "./a.exr"];
    let second = workplace.run(&short);
    first.kill().unwrap();
    first.wait().unwrap();
    assert_eq!(second.code, Some(1), "{}", second.stderr);
    assert!(second.stderr.contains("another process is rendering to"), "{}", second.stderr);
    // The lock of a process that was killed has ended.
    workplace.succeed(&short);
    assert_eq!(workplace.files(), ["a.exr"]);
}

#[test]
fn a_folder_that_vanishes_does_not_take_the_picture_with_it() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("out")).unwrap();
    let scene = small_scene();
    let arguments = ["render", &scene, "--time", "4s", "--no-checkpoint", "-o", "out/a.pfm"];
    let render = workplace.command(&arguments);
    let child = { render }.stderr(std::process::Stdio::piped()).spawn().unwrap();
    let began = Instant::now();
    while !workplace.path("out/.a.pfm.lock").exists() && began.elapsed() < Duration::from_secs(30) {
        sleep(Duration::from_millis(20));
    }
    fs::remove_dir_all(workplace.path("out")).unwrap();
    let outcome = child.wait_with_output().unwrap();
    let stderr = String::from_utf8(outcome.stderr).unwrap();
    assert_eq!(outcome.status.code(), Some(1), "{stderr}");
    assert!(
        stderr.contains("cannot write out/a.pfm") && stderr.contains("a.pfm instead"),
        "{stderr}"
    );
    assert!(!stderr.contains("samples per pixel in"), "{stderr}");
    assert_eq!(workplace.files(), ["a.pfm"]);
}

#[cfg(target_os = "linux")]
#[test]
fn progress_that_cannot_be_written_is_a_failure() {
    let workplace = Workplace::new();
    let scene = small_scene();
    let arguments = ["render", &scene, "--spp", "1", "--json-progress", "-o", "a.exr"];
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = workplace.command(&arguments);
    let outcome = command.stdout(full).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(outcome.status.code(), Some(1));
    assert!(workplace.path("a.exr").exists(), "the picture is still written");
}
