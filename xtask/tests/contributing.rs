//! Follows `CONTRIBUTING.md`: applies its code to a copy of the repository and runs its commands
//! there, so that the page stays correct.
//!
//! The info string of a fenced block states its purpose: `rust file=PATH` (or another language) is
//! a new file, `diff file=PATH` adds lines to an existing one, and `sh run` holds commands.
#![allow(clippy::disallowed_methods, reason = "the test writes and runs a copy of the repository")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A fenced block with an instruction.
#[derive(Debug)]
enum Block {
    /// A new file.
    File { path: String, text: String },
    /// Lines to add to a file.
    Diff { path: String, text: String },
    /// Commands, one per line.
    Run(String),
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace").into()
}

/// The blocks of a page that have an instruction, in order.
fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        let Some(info) = line.strip_prefix("```") else { continue };
        let text: String = lines
            .by_ref()
            .take_while(|line| *line != "```")
            .map(|line| format!("{line}\n"))
            .collect();
        let (language, instruction) = info.split_once(' ').unwrap_or((info, ""));
        match (language, instruction.strip_prefix("file=")) {
            ("diff", Some(path)) => blocks.push(Block::Diff { path: path.to_owned(), text }),
            (_, Some(path)) => blocks.push(Block::File { path: path.to_owned(), text }),
            ("sh", None) if instruction == "run" => blocks.push(Block::Run(text)),
            (_, None) => assert_eq!(instruction, "", "an unknown instruction"),
        }
    }
    blocks
}

/// Adds the lines of a diff to a text. The diff's context lines must appear consecutively in
/// exactly one place.
fn patched(text: &str, diff: &str) -> Result<String, String> {
    let lines: Vec<&str> = text.lines().collect();
    let is_added = |line: &&str| line.starts_with('+');
    let context: Vec<&str> =
        diff.lines().filter(|line| !is_added(line)).map(|line| &line[1..]).collect();
    let places: Vec<usize> = (0..lines.len().saturating_sub(context.len() - 1))
        .filter(|&start| lines[start..start + context.len()] == context[..])
        .collect();
    let [place] = places[..] else {
        return Err(format!("its lines stand in {} places:\n{}", places.len(), context.join("\n")));
    };
    let replaced = diff.lines().map(|line| &line[1..]);
    let (before, after) = (&lines[..place], &lines[place + context.len()..]);
    let all: Vec<&str> =
        before.iter().copied().chain(replaced).chain(after.iter().copied()).collect();
    Ok(all.join("\n") + "\n")
}

/// Copies the files that git tracks, with their times, so that unchanged files are not recompiled.
fn copy_repository(folder: &Path) {
    let listing = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    let listing = listing.expect("git lists the files").stdout;
    for name in listing.split(|&byte| byte == 0).filter(|name| !name.is_empty()) {
        let name = std::str::from_utf8(name).expect("a name in UTF-8");
        let (from, to) = (root().join(name), folder.join(name));
        // A deleted but uncommitted file is still listed.
        let Ok(metadata) = fs::metadata(&from) else { continue };
        fs::create_dir_all(to.parent().expect("a file in a folder")).expect("a folder");
        fs::copy(&from, &to).expect("a copy");
        let file = fs::File::options().write(true).open(&to).expect("the copy");
        file.set_modified(metadata.modified().expect("a time")).expect("the same time");
    }
}

fn run(folder: &Path, command: &str) {
    let mut words = command.split_whitespace();
    let program = words.next().expect("a command");
    let mut process = Command::new(program);
    process.args(words).current_dir(folder).env("CARGO_TARGET_DIR", root().join("target"));
    let status = process.status().unwrap_or_else(|error| panic!("{command}: {error}"));
    assert!(status.success(), "`{command}` failed in {}", folder.display());
}

#[test]
#[ignore = "compiles a copy of the workspace, which takes minutes"]
fn the_page_can_be_followed() {
    let folder = root().join("target/contributing");
    let _ = fs::remove_dir_all(&folder);
    copy_repository(&folder);
    let page = fs::read_to_string(root().join("CONTRIBUTING.md")).expect("the page");
    let (commands, changes): (Vec<Block>, Vec<Block>) =
        blocks(&page).into_iter().partition(|block| matches!(block, Block::Run(_)));
    for change in &changes {
        match change {
            Block::File { path, text } => {
                assert!(!folder.join(path).exists(), "{path} is there already");
                fs::write(folder.join(path), text).expect("a new file");
            }
            Block::Diff { path, text } => {
                let before = fs::read_to_string(folder.join(path)).expect(path);
                let after = patched(&before, text).unwrap_or_else(|why| panic!("{path}: {why}"));
                fs::write(folder.join(path), after).expect("the changed file");
            }
            Block::Run(_) => unreachable!("commands are apart"),
        }
    }
    for command in &commands {
        let Block::Run(lines) = command else { continue };
        lines.lines().for_each(|line| run(&folder, line));
    }
    for picture in ["spheres.png", "moon.png"] {
        let bytes = fs::metadata(folder.join(picture)).expect(picture).len();
        assert!(bytes > 500, "{picture} has {bytes} bytes, as an empty picture would");
    }
}

#[test]
fn lines_are_added_where_the_others_stand_once() {
    let text = "a\nb\nc\nb\n";
    assert_eq!(patched(text, " a\n+x\n b\n").unwrap(), "a\nx\nb\nc\nb\n");
    assert!(patched(text, " b\n+x\n").unwrap_err().contains("2 places"));
    assert!(patched(text, " d\n+x\n").unwrap_err().contains("0 places"));
}

#[test]
fn every_change_of_the_page_fits_the_repository() {
    let page = fs::read_to_string(root().join("CONTRIBUTING.md")).expect("the page");
    let changes = blocks(&page);
    let diffs = changes.iter().filter_map(|block| match block {
        Block::Diff { path, text } => Some((path, text)),
        _ => None,
    });
    let mut count = 0;
    for (path, text) in diffs {
        count += 1;
        let file = fs::read_to_string(root().join(path)).expect(path);
        patched(&file, text).unwrap_or_else(|why| panic!("{path}: {why}"));
    }
    assert!(count > 4, "the page changes {count} files");
}
