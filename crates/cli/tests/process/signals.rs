//! Ctrl-C, SIGTERM and SIGHUP.

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use etendue::image::decode_exr_layers;

use crate::run::{Outcome, Workplace, small_scene};

/// Starts a render that would take far longer than the test.
fn start(workplace: &Workplace) -> Child {
    let scene = small_scene();
    let arguments = ["render", &scene, "--spp", "100000000", "-o", "a.exr", "-o", "b.png"];
    let mut command = workplace.command(&arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Waits long enough for a scene of two shapes to load and start rendering, even on a busy machine.
fn wait_until_rendering() {
    sleep(Duration::from_millis(1500));
}

fn finish(child: Child) -> Outcome {
    child.wait_with_output().unwrap().into()
}

#[test]
fn a_signal_stops_the_render_and_saves_its_results() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let workplace = Workplace::new();
        let child = start(&workplace);
        wait_until_rendering();
        send(signal, &child);
        let sent = Instant::now();
        let outcome = finish(child);
        assert!(sent.elapsed() < Duration::from_secs(10));
        assert_eq!(outcome.code, Some(code), "{}", outcome.stderr);
        assert!(outcome.stderr.contains("stopped early"), "{}", outcome.stderr);
        assert_eq!(workplace.files(), ["a.exr", "a.exr.checkpoint", "b.png"]);
        let picture = decode_exr_layers(&workplace.read("a.exr")).unwrap();
        let red = &picture.channels[0].data;
        assert!(red.iter().all(|&value| value > 0.0), "every pixel of this scene is lit");
    }
}

#[test]
fn a_signal_during_loading_ends_the_process_at_once_and_leaves_no_file() {
    let workplace = Workplace::new();
    // A large scene takes long to load. An endless pipe is no alternative, because it is rejected.
    let sphere = "<shape type=\"sphere\"/>\n".repeat(400_000);
    std::fs::write(
        workplace.path("large.xml"),
        format!("<scene version=\"3.0.0\">{sphere}</scene>"),
    )
    .unwrap();
    let mut command = workplace.command(&["render", "large.xml"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_millis(100));
    send("-INT", &child);
    let outcome = finish(child);
    assert_eq!(outcome.code, Some(130), "{}", outcome.stderr);
    assert_eq!(workplace.files(), ["large.xml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_render_under_nohup_survives_the_terminal() {
    let workplace = Workplace::new();
    let binary = crate::run::binary();
    let scene = small_scene();
    let mut command = Command::new("nohup");
    command.current_dir(workplace.path("")).arg(binary);
    command.args(["render", &scene, "-q", "--time", "4s", "--no-checkpoint", "-o", "a.exr"]);
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().unwrap();
    wait_until_rendering();
    send("-HUP", &child);
    assert_eq!(finish(child).code, Some(0));
}

/// Mirrors all around the camera: without roulette, a path never leaves.
const HALL_OF_MIRRORS: &str = r#"<scene version="3.0.0"><integrator type="path">
    <integer name="rr_depth" value="2000000000"/></integrator>
    <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="256"/>
    <integer name="height" value="256"/></film></sensor><shape type="cube"><transform name="to_world">
    <scale value="10"/></transform><boolean name="flip_normals" value="true"/>
    <bsdf type="conductor"/></shape><emitter type="point"/></scene>"#;

#[test]
fn endless_paths_end_with_the_time() {
    let workplace = Workplace::new();
    std::fs::write(workplace.path("mirrors.xml"), HALL_OF_MIRRORS).unwrap();
    let started = Instant::now();
    let outcome = workplace.succeed(&[
        "render",
        "mirrors.xml",
        "--time",
        "1s",
        "--no-checkpoint",
        "-o",
        "a.exr",
    ]);
    assert!(started.elapsed() < Duration::from_secs(60), "{:?}", started.elapsed());
    assert!(outcome.stderr.contains("some pixels have no sample"), "{}", outcome.stderr);
}

#[test]
fn endless_paths_end_with_a_signal() {
    let workplace = Workplace::new();
    std::fs::write(workplace.path("mirrors.xml"), HALL_OF_MIRRORS).unwrap();
    let mut command = workplace.command(&["render", "mirrors.xml", "-o", "a.exr"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_until_rendering();
    send("-TERM", &child);
    let sent = Instant::now();
    assert_eq!(finish(child).code, Some(143));
    assert!(sent.elapsed() < Duration::from_secs(10), "{:?}", sent.elapsed());
}
