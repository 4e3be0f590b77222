//! The commands and scenes of the documentation work as they stand.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::run::{Outcome, Workplace, binary, small_scene};

/// The pages for users. CONTRIBUTING.md and `contrib` have tests of their own.
const PAGES: [&str; 5] = [
    "README.md",
    "docs/guide.md",
    "docs/scene-format.md",
    "docs/long-renders.md",
    "docs/command-line.md",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The fenced blocks of a page in some language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join(page)).unwrap();
    let start = format!("```{language}\n");
    let after = text.split(&start).skip(1);
    after.map(|rest| rest.split("\n```").next().unwrap().to_owned()).collect()
}

/// A folder with the files that commands of the pages name.
fn prepare() -> Workplace {
    let workplace = Workplace::new();
    fs::copy(small_scene(), workplace.path("scene.xml")).unwrap();
    let scenes = workplace.path("scenes/cornell-box");
    fs::create_dir_all(&scenes).unwrap();
    fs::copy(root().join("scenes/cornell-box/scene.xml"), scenes.join("scene.xml")).unwrap();
    for name in ["scene.exr", "ours.exr", "theirs.exr"] {
        workplace.succeed(&["render", "scene.xml", "-q", "-o", name]);
    }
    workplace
}

/// Runs the command as a line of the shell if it redirects files.
fn run(workplace: &Workplace, line: &str) -> Outcome {
    if !line.contains(['<', '>']) {
        return workplace.run(&line.split_whitespace().collect::<Vec<_>>());
    }
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("\"$0\" {line}")]).arg(binary());
    shell.current_dir(workplace.path("")).output().unwrap().into()
}

#[test]
fn every_command_of_the_pages_runs() {
    let mut count = 0;
    for page in PAGES {
        let workplace = prepare();
        for line in blocks(page, "sh").iter().flat_map(|block| block.lines()) {
            let command = line.split(" #").next().unwrap();
            // What Cargo and Git do is not the command's.
            let Some(arguments) = command.strip_prefix("etendue ") else { continue };
            if cfg!(not(unix)) && arguments.contains(['<', '>']) {
                continue;
            }
            let outcome = run(&workplace, arguments);
            assert_eq!(outcome.code, Some(0), "{page}: {line}: {}", outcome.stderr);
            count += 1;
        }
    }
    assert!(count >= 7, "{count} commands: the pages have more");
}

#[test]
fn every_scene_of_the_pages_loads_without_a_finding() {
    let mut count = 0;
    for page in PAGES {
        for scene in blocks(page, "xml").iter().filter(|block| block.starts_with("<scene")) {
            let workplace = Workplace::new();
            fs::write(workplace.path("a.xml"), scene).unwrap();
            let outcome = workplace.succeed(&["check", "a.xml"]);
            assert_eq!(
                outcome.stdout, "a.xml: 0 errors, 0 warnings\n",
                "{page}: {}",
                outcome.stderr
            );
            count += 1;
        }
    }
    assert!(count > 0, "the pages have scenes");
}
