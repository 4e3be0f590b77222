//! Parts and checkpoints that somebody has made up, and names that are no files.

use std::fs;
use std::process::Command;

use etendue::{FilmRecord, SumsFile};

use crate::run::{Workplace, small_scene};

/// A part of the small scene whose record has been changed. Its checksum is right.
fn forge(workplace: &Workplace, change: impl FnOnce(&mut FilmRecord)) {
    workplace.succeed(&["render", &small_scene(), "-q", "--samples", "1/1", "-o", "a.part"]);
    let part = SumsFile::new(workplace.path("a.part"));
    let (file, film) = part.read(1 << 30).unwrap();
    let mut record = file.record;
    change(&mut record);
    part.write(&film, &record).unwrap();
}

#[test]
fn settings_that_no_render_has_make_no_picture() {
    let settings = [
        ("film", "0 0"),
        ("film", "39 24"),
        ("film", "4294967295 4294967295"),
        ("exposure", "inf"),
        ("pixel format", "cmyk"),
        ("world to NDC", "1 2 3"),
        ("scene", "\u{1b}[2J"),
        ("seed", "-1"),
    ];
    for (name, value) in settings {
        let workplace = Workplace::new();
        forge(&workplace, |record| {
            let note = record.notes.iter_mut().find(|(other, _)| other == name).unwrap();
            note.1 = value.to_owned();
        });
        let outcome = workplace.fail(&["merge", "a.part", "-o", "a.exr", "-o", "a.png"]);
        assert!(!outcome.stderr.contains("samples per pixel in"), "{}", outcome.stderr);
    }
}

#[test]
fn a_checkpoint_with_the_sums_of_another_picture_is_not_resumed() {
    let workplace = Workplace::new();
    let scene = small_scene();
    let render = |more: &[&str], name: &str| {
        let arguments = ["render", &scene, "-q", "--spp", "4", "--keep-checkpoint", "-o", name];
        workplace.succeed(&[&arguments, more].concat());
    };
    render(&[], "a.exr");
    render(&["--crop", "0,0,8,8"], "b.exr");
    let sums = |name: &str| SumsFile::new(workplace.path(name));
    let (own, _) = sums("a.exr.checkpoint").read(1 << 30).unwrap();
    let (_, film) = sums("b.exr.checkpoint").read(1 << 30).unwrap();
    sums("a.exr.checkpoint").write(&film, &own.record).unwrap();
    let outcome = workplace.fail(&["render", &scene, "--spp", "8", "--resume", "-o", "a.exr"]);
    assert!(outcome.stderr.contains("its header announces"), "{}", outcome.stderr);
}

#[test]
fn a_scene_is_not_read_from_a_part() {
    let workplace = Workplace::new();
    forge(&workplace, |_| {});
    let outcome = workplace.fail(&["info", "a.part"]);
    assert!(outcome.stderr.contains("etendue merge"), "{}", outcome.stderr);
}

#[cfg(unix)]
#[test]
fn pipes_are_refused_instead_of_waited_for() {
    let workplace = Workplace::new();
    let pipe = |name: &str| {
        let made = Command::new("mkfifo").arg(workplace.path(name)).status().unwrap();
        assert!(made.success());
    };
    ["a.part", "a.exr.checkpoint", "b.exr", "c.xml", ".d.exr.1.tmp"].into_iter().for_each(pipe);
    let scene = small_scene();
    workplace.fail(&["merge", "a.part", "-o", "x.exr"]);
    workplace.fail(&["render", &scene, "--resume", "-o", "a.exr"]);
    workplace.fail(&["render", &scene, "-o", "b.exr"]);
    workplace.fail(&["render", "c.xml", "-o", "x.exr"]);
    workplace.fail(&["diff", "b.exr", "b.exr"]);
    workplace.succeed(&["render", &scene, "-q", "--spp", "1", "-o", "d.exr"]);
    assert!(workplace.path(".d.exr.1.tmp").exists());
}

#[cfg(unix)]
#[test]
fn the_target_of_a_link_is_what_is_replaced() {
    let workplace = Workplace::new();
    fs::write(workplace.path("target.exr"), "old").unwrap();
    std::os::unix::fs::symlink("target.exr", workplace.path("link.exr")).unwrap();
    workplace.succeed(&["render", &small_scene(), "-q", "--spp", "1", "-o", "link.exr"]);
    assert!(workplace.path("link.exr").symlink_metadata().unwrap().is_symlink());
    assert!(workplace.read("target.exr").len() > 1000);
    assert_eq!(workplace.files(), ["link.exr", "target.exr"]);
}
