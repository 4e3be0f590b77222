//! Checkpoints: killed renders resume, and checkpoints that do not match are rejected unchanged.

use std::fs;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::run::{Outcome, Workplace, binary, small_scene};

const CHECKPOINT: &str = "a.pfm.checkpoint";

/// Renders the small scene to `a.pfm`.
fn arguments<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["render", scene, "-q", "-o", "a.pfm"], more].concat()
}

/// A finished render that has kept its checkpoint of 4 samples per pixel.
fn with_checkpoint() -> (Workplace, String) {
    let (workplace, scene) = (Workplace::new(), small_scene());
    workplace.succeed(&arguments(&scene, &["--keep-checkpoint"]));
    assert_eq!(workplace.files(), ["a.pfm", CHECKPOINT]);
    (workplace, scene)
}

/// The picture of an uninterrupted render.
fn uninterrupted(more: &[&str]) -> Vec<u8> {
    let workplace = Workplace::new();
    workplace.succeed(&arguments(&small_scene(), more));
    assert_eq!(workplace.files(), ["a.pfm"]);
    workplace.read("a.pfm")
}

/// Runs the command, which must fail with `message` and leave every file unchanged.
fn reject(workplace: &Workplace, arguments: &[&str], message: &str) {
    let before = workplace.read(CHECKPOINT);
    let picture = fs::read(workplace.path("a.pfm")).ok();
    let outcome = workplace.fail(arguments);
    assert!(outcome.stderr.contains(message), "{arguments:?}: {}", outcome.stderr);
    assert_eq!(workplace.read(CHECKPOINT), before, "{arguments:?}");
    assert_eq!(fs::read(workplace.path("a.pfm")).ok(), picture, "{arguments:?}");
}

#[cfg(unix)]
#[test]
fn a_render_killed_several_times_gives_the_same_picture() {
    let more = ["--spp", "1500", "--checkpoint-every", "10ms"];
    let expected = uninterrupted(&["--spp", "1500", "-t", "1"]);
    let (workplace, scene) = (Workplace::new(), small_scene());
    for (milliseconds, threads) in [(150, "1"), (230, "2"), (90, "3"), (310, "1")] {
        let all = arguments(&scene, &[&more[..], &["--resume=auto", "-t", threads]].concat());
        let mut child = workplace.command(&all).stderr(Stdio::null()).spawn().unwrap();
        // Kill it only after its first checkpoint, when there is something to resume.
        wait_for(&workplace, &mut child);
        sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    workplace.succeed(&arguments(&scene, &[&more[..], &["--resume=auto"]].concat()));
    assert_eq!(workplace.read("a.pfm"), expected);
    assert_eq!(workplace.files(), ["a.pfm"], "checkpoint and abandoned files are gone");
}

/// Waits for a checkpoint or the end of the process.
fn wait_for(workplace: &Workplace, child: &mut Child) {
    let started = Instant::now();
    while !workplace.path(CHECKPOINT).exists() && child.try_wait().unwrap().is_none() {
        assert!(started.elapsed() < Duration::from_secs(60), "no checkpoint in a minute");
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn without_a_terminal_a_rerun_must_say_whether_to_resume() {
    let (workplace, scene) = with_checkpoint();
    reject(&workplace, &arguments(&scene, &[]), "4 samples per pixel from an earlier run");
    reject(&workplace, &arguments(&scene, &["--no-checkpoint"]), "--resume=never");
}

#[test]
fn samples_can_be_added_to_a_finished_render() {
    let (workplace, scene) = with_checkpoint();
    workplace.succeed(&arguments(&scene, &["--resume", "--spp", "9"]));
    assert_eq!(workplace.read("a.pfm"), uninterrupted(&["--spp", "9"]));
    assert_eq!(workplace.files(), ["a.pfm"]);
}

#[test]
fn fewer_samples_than_the_checkpoint_holds_are_rejected() {
    let (workplace, scene) = with_checkpoint();
    reject(
        &workplace,
        &arguments(&scene, &["--resume", "--spp", "3"]),
        "more than the 3 requested",
    );
}

#[test]
fn resume_needs_a_checkpoint_and_auto_does_not() {
    let (workplace, scene) = (Workplace::new(), small_scene());
    let outcome = workplace.fail(&arguments(&scene, &["--resume"]));
    assert!(outcome.stderr.contains("no checkpoint a.pfm.checkpoint"), "{}", outcome.stderr);
    workplace.succeed(&arguments(&scene, &["--resume=auto"]));
    assert_eq!(workplace.files(), ["a.pfm"]);
}

#[test]
fn resume_never_starts_over() {
    let (workplace, scene) = with_checkpoint();
    fs::write(workplace.path(CHECKPOINT), "torn").unwrap();
    workplace.succeed(&arguments(&scene, &["--resume=never"]));
    assert_eq!(workplace.files(), ["a.pfm"]);
}

#[test]
fn a_checkpoint_of_another_picture_is_rejected_with_the_differences() {
    let (workplace, scene) = with_checkpoint();
    let cases: [(&[&str], &str); 8] = [
        (&["--seed", "5"], "seed: 0; now 5"),
        (&["-s", "1"], "sensor: 0; now 1"),
        (&["-D", "grey=0.3"], "definitions: []; now [(\"grey\", \"0.3\")]"),
        (&["--size", "20x12"], "film: 40x24; now 20x12"),
        (&["--crop", "1,1,5,5"], "pixels: 40x24 from (0, 0); now 5x5 from (1, 1)"),
        (&["--filter", "box"], "scene options"),
        (&["--integrator", "direct"], "integrator options"),
        (&["--variance"], "variance: false; now true"),
    ];
    for (more, message) in cases {
        for resume in ["--resume", "--resume=auto"] {
            reject(&workplace, &arguments(&scene, &[more, &[resume]].concat()), message);
        }
    }
    let text = fs::read_to_string(&scene).unwrap().replace("0, 1, 5", "0, 2, 5");
    fs::write(workplace.path("small.xml"), text).unwrap();
    reject(&workplace, &arguments("small.xml", &["--resume"]), "scene and its files");
}

#[test]
fn damaged_and_foreign_checkpoints_are_rejected() {
    let (workplace, scene) = with_checkpoint();
    let whole = workplace.read(CHECKPOINT);
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    let mut newer = whole.clone();
    newer[12] = 9;
    let cases = [
        (flipped, "cannot resume"),
        (whole[..whole.len() / 2].to_vec(), "torn"),
        (b"PF\n4 4\n".to_vec(), "not a checkpoint"),
        (newer, "version 9"),
        (Vec::new(), "not a checkpoint"),
    ];
    for (bytes, message) in cases {
        fs::write(workplace.path(CHECKPOINT), bytes).unwrap();
        reject(&workplace, &arguments(&scene, &["--resume"]), message);
    }
}

/// Runs the command with file sizes limited to this many blocks of 512 bytes, which looks like a
/// full disk.
#[cfg(unix)]
fn run_on_a_full_disk(workplace: &Workplace, blocks: &str, arguments: &[&str]) -> Outcome {
    let mut command = std::process::Command::new("sh");
    command.current_dir(workplace.path("")).stdin(Stdio::null());
    command.args(["-c", "trap '' XFSZ; ulimit -f \"$0\"; exec \"$@\"", blocks]);
    command.arg(binary()).args(arguments).output().unwrap().into()
}

#[cfg(unix)]
#[test]
fn the_render_continues_if_checkpoints_do_not_fit_on_the_disk() {
    let (workplace, scene) = (Workplace::new(), small_scene());
    let more = ["--checkpoint-every", "10ms", "--spp", "300"];
    let outcome = run_on_a_full_disk(&workplace, "64", &arguments(&scene, &more));
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("cannot write a.pfm.checkpoint"), "{}", outcome.stderr);
    assert_eq!(workplace.files(), ["a.pfm"]);
    assert_eq!(workplace.read("a.pfm"), uninterrupted(&["--spp", "300"]));
}

#[cfg(unix)]
#[test]
fn the_checkpoint_remains_if_the_picture_does_not_fit_on_the_disk() {
    let (workplace, scene) = with_checkpoint();
    let whole = workplace.read(CHECKPOINT);
    fs::remove_file(workplace.path("a.pfm")).unwrap();
    let more = ["--resume", "--spp", "9"];
    let outcome = run_on_a_full_disk(&workplace, "8", &arguments(&scene, &more));
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("the previous checkpoint remains"), "{}", outcome.stderr);
    assert_eq!(workplace.read(CHECKPOINT), whole);
    workplace.succeed(&arguments(&scene, &more));
    assert_eq!(workplace.read("a.pfm"), uninterrupted(&["--spp", "9"]));
}

#[test]
fn finished_pictures_are_skipped_and_unfinished_ones_are_not() {
    let (workplace, scene) = (Workplace::new(), small_scene());
    fs::write(workplace.path("a.pfm"), "mine").unwrap();
    workplace.succeed(&arguments(&scene, &["--skip-existing"]));
    assert_eq!(workplace.read("a.pfm"), b"mine");
    let (workplace, scene) = with_checkpoint();
    fs::write(workplace.path("a.pfm"), "unfinished").unwrap();
    workplace.succeed(&arguments(&scene, &["--skip-existing", "--resume=auto"]));
    assert!(workplace.read("a.pfm").starts_with(b"PF"));
}

#[test]
fn a_preview_is_written_while_the_render_runs() {
    let (workplace, scene) = (Workplace::new(), small_scene());
    let more = ["--preview", "p.png", "--preview-every", "5ms", "--spp", "600"];
    workplace.succeed(&arguments(&scene, &more));
    let picture = etendue::image::decode(&workplace.read("p.png"), "p.png").unwrap();
    assert_eq!((picture.width, picture.height), (40, 24));
}

#[test]
fn json_progress_prints_lines_of_json() {
    let (workplace, scene) = (Workplace::new(), small_scene());
    let more = ["--json-progress", "--spp", "600", "--checkpoint-every", "20ms"];
    let outcome = workplace.succeed(&arguments(&scene, &more));
    let lines: Vec<serde_json::Value> =
        outcome.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let events: Vec<&str> = lines.iter().map(|line| line["event"].as_str().unwrap()).collect();
    assert_eq!((events[0], events[events.len() - 1]), ("start", "end"));
    assert!(events.contains(&"checkpoint"), "{events:?}");
    assert!(lines[0]["film_bytes"].as_u64().unwrap() > 40 * 24 * 64);
    let last = lines.iter().rfind(|line| line["event"] == "progress").unwrap();
    assert_eq!(last["samples_done"], 600 * 40 * 24);
    assert_eq!(last["fraction"], 1.0);
    assert_eq!(lines[lines.len() - 1]["files"][0], "a.pfm");
}
