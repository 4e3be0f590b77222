//! Output files: default names, whose files are replaced, two names of one file, links and pipes.

use std::fs;

use etendue::image::{MetadataValue, metadata};

use crate::run::{Workplace, small_scene};

/// Copies the small scene, with another grey, to a file of the workplace.
fn write_scene(workplace: &Workplace, name: &str, grey: &str) {
    let text = fs::read_to_string(small_scene()).unwrap();
    let path = workplace.path(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text.replace("\"0.5\"", &format!("\"{grey}\""))).unwrap();
}

#[test]
fn a_scene_called_scene_gives_files_with_the_name_of_its_folder() {
    let workplace = Workplace::new();
    for folder in ["cups", "box"] {
        write_scene(&workplace, &format!("{folder}/scene.xml"), "0.5");
    }
    workplace.succeed(&["render", "cups/scene.xml", "box/scene.xml", "-q"]);
    let expected = ["box", "box.exr", "box.png", "cups", "cups.exr", "cups.png"];
    assert_eq!(workplace.files(), expected);
    // From within the folder, too.
    let mut command = workplace.command(&["render", "scene.xml", "-q"]);
    command.current_dir(workplace.path("cups"));
    assert!(command.status().unwrap().success());
    assert!(workplace.path("cups/cups.exr").is_file());
}

#[test]
fn only_pictures_of_the_same_scene_are_replaced_without_being_told() {
    let workplace = Workplace::new();
    write_scene(&workplace, "a/box.xml", "0.5");
    write_scene(&workplace, "b/box.xml", "0.4");
    workplace.succeed(&["render", "a/box.xml", "-q"]);
    let first = workplace.read("box.exr");
    let refused = workplace.fail(&["render", "b/box.xml", "-q"]);
    assert!(refused.stderr.contains("box.exr exists and is of another scene, a/box.xml"));
    assert!(refused.stderr.contains("--overwrite"), "{}", refused.stderr);
    assert_eq!(workplace.read("box.exr"), first);
    // A scene that has changed since is the same scene.
    write_scene(&workplace, "a/box.xml", "0.3");
    workplace.succeed(&["render", "a/box.xml", "-q"]);
    assert_ne!(workplace.read("box.exr"), first);
    // What was asked for by name is replaced.
    workplace.succeed(&["render", "b/box.xml", "-q", "-o", "box.exr"]);
    workplace.succeed(&["render", "b/box.xml", "-q", "--overwrite"]);
    workplace.succeed(&["render", "b/box.xml", "-q"]);
    fs::write(workplace.path("box.png"), "mine").unwrap();
    let refused = workplace.fail(&["render", "b/box.xml", "-q"]);
    assert!(refused.stderr.contains("box.png exists and was not written by Etendue"));
    assert_eq!(workplace.read("box.png"), b"mine");
}

#[test]
fn parts_with_default_names_are_told_apart_by_their_scenes() {
    let workplace = Workplace::new();
    write_scene(&workplace, "a/box.xml", "0.5");
    write_scene(&workplace, "b/box.xml", "0.4");
    let part = |scene: &'static str| ["render", scene, "-q", "--samples", "1/2"];
    workplace.succeed(&part("a/box.xml"));
    workplace.succeed(&part("a/box.xml"));
    workplace.fail(&part("b/box.xml"));
}

#[test]
fn finished_pictures_of_another_scene_are_not_skipped() {
    let workplace = Workplace::new();
    write_scene(&workplace, "a/box.xml", "0.5");
    write_scene(&workplace, "b/box.xml", "0.4");
    let render = |scene: &str, name: &str| {
        workplace.succeed(&["render", scene, "--skip-existing", "-o", name]).stderr
    };
    for name in ["x.exr", "x.png", "x.part"] {
        render("a/box.xml", name);
        let first = workplace.read(name);
        assert!(render("a/box.xml", name).contains("skipped"), "{name}");
        assert!(render("b/box.xml", name).contains("of another scene, rendered again"), "{name}");
        assert_ne!(workplace.read(name), first, "{name}");
    }
}

#[test]
fn headers_of_exr_and_png_files_tell_the_scene() {
    let workplace = Workplace::new();
    write_scene(&workplace, "cups/scene.xml", "0.5");
    workplace.succeed(&["render", "cups/scene.xml", "-q", "--spp", "3", "--seed", "7"]);
    for name in ["cups.exr", "cups.png"] {
        let entries = metadata(&workplace.read(name));
        let find = |wanted: &str| {
            let found = entries.iter().find(|(name, _)| name == wanted);
            found.map(|(_, value)| value.clone())
        };
        let text = |text: &str| Some(MetadataValue::Text(text.to_owned()));
        assert_eq!(find("scene"), text("cups/scene.xml"), "{name}");
        assert_eq!(find("seed"), text("7"), "{name}");
        let count = if name == "cups.png" { text("3") } else { Some(MetadataValue::Integer(3)) };
        assert_eq!(find("samplesPerPixel"), count, "{name}");
        assert!(
            matches!(find("software"), Some(MetadataValue::Text(t)) if t.starts_with("Etendue "))
        );
    }
    // The header of a file that is cut off still tells.
    let whole = workplace.read("cups.exr");
    assert_eq!(metadata(&whole[..whole.len() / 2]), metadata(&whole));
    assert!(metadata(&whole[..50]).is_empty());
}

#[test]
fn two_names_of_one_file_are_refused() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("sub")).unwrap();
    let refuse = |names: &[&str]| {
        let scene = small_scene();
        let mut arguments = vec!["render", &scene, "-q"];
        for name in names {
            arguments.extend(["-o", name]);
        }
        let refused = workplace.fail(&arguments);
        assert!(refused.stderr.contains("are the same file"), "{}", refused.stderr);
    };
    refuse(&["a.exr", "a.exr"]);
    refuse(&["a.exr", "./a.exr"]);
    refuse(&["a.exr", "b.png", "sub/../a.exr"]);
    refuse(&["a.part", "./a.part"]);
    let whole = workplace.path("a.exr").to_str().unwrap().to_owned();
    refuse(&["a.exr", &whole]);
    let scene = small_scene();
    let preview = workplace.fail(&["render", &scene, "-o", "a.png", "--preview", "./a.png"]);
    assert!(preview.stderr.contains("are the same file"), "{}", preview.stderr);
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_names_of_one_file_found_behind_them() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("sub")).unwrap();
    fs::write(workplace.path("sub/real.exr"), "old").unwrap();
    std::os::unix::fs::symlink("sub/real.exr", workplace.path("link.exr")).unwrap();
    std::os::unix::fs::symlink("sub/new.exr", workplace.path("dangling.exr")).unwrap();
    std::os::unix::fs::symlink("sub", workplace.path("folder")).unwrap();
    fs::hard_link(workplace.path("sub/real.exr"), workplace.path("hard.exr")).unwrap();
    for other in ["sub/real.exr", "hard.exr", "folder/real.exr"] {
        let arguments = ["render", &small_scene(), "-q", "-o", "link.exr", "-o", other];
        let refused = workplace.fail(&arguments);
        assert!(refused.stderr.contains("are the same file"), "{}", refused.stderr);
    }
    workplace.succeed(&["render", &small_scene(), "-q", "-o", "link.exr", "-o", "dangling.exr"]);
    for (link, file) in [("link.exr", "sub/real.exr"), ("dangling.exr", "sub/new.exr")] {
        assert!(workplace.path(link).is_symlink(), "{link}");
        assert!(workplace.read(file).starts_with(&[0x76, 0x2f, 0x31, 0x01]), "{file}");
        assert!(!workplace.path(file).is_symlink());
    }
    std::os::unix::fs::symlink("b.exr", workplace.path("a.exr")).unwrap();
    std::os::unix::fs::symlink("a.exr", workplace.path("b.exr")).unwrap();
    let circle = workplace.fail(&["render", &small_scene(), "-o", "a.exr"]);
    assert!(circle.stderr.contains("lead in a circle"), "{}", circle.stderr);
}

#[cfg(unix)]
#[test]
fn pipes_and_folders_are_refused_before_rendering() {
    let workplace = Workplace::new();
    let made = std::process::Command::new("mkfifo").arg(workplace.path("pipe.exr")).status();
    assert!(made.unwrap().success());
    let pipe = workplace.fail(&["render", &small_scene(), "-o", "pipe.exr"]);
    assert!(pipe.stderr.contains("it is a pipe or a device"), "{}", pipe.stderr);
    fs::create_dir(workplace.path("folder.exr")).unwrap();
    let folder = workplace.fail(&["render", &small_scene(), "-o", "folder.exr", "-o", "b.exr"]);
    assert!(folder.stderr.contains("it is a folder"), "{}", folder.stderr);
}
