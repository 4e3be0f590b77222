//! `cargo xtask links`: checks that relative links in Markdown files lead to existing files.

use std::fs;
use std::path::{Path, PathBuf};

use crate::workspace::root;

/// Checks every Markdown file of the repository; prints the dead links.
pub(crate) fn run(_arguments: &[String]) -> bool {
    let root = root();
    let mut is_well = true;
    for file in markdown_files(&root) {
        let text = fs::read_to_string(&file).unwrap_or_default();
        let folder = file.parent().unwrap_or(&root);
        for (line, target) in relative_links(&text) {
            if !folder.join(&target).exists() {
                let shown = file.strip_prefix(&root).unwrap_or(&file);
                eprintln!("{}:{line}: there is no {target}", shown.display());
                is_well = false;
            }
        }
    }
    is_well
}

/// The Markdown files below a folder, without build outputs and hidden folders.
fn markdown_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_skipped = name.starts_with('.') || name == "target";
        if path.is_dir() && !is_skipped {
            files.extend(markdown_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            files.push(path);
        }
    }
    files
}

/// The targets of relative links with their line numbers, from 1: `[text](target)`,
/// `![text](target)`, `src="target"`, `href="target"`. Code blocks are skipped, and anchors
/// removed.
fn relative_links(text: &str) -> Vec<(usize, String)> {
    let mut links = Vec::new();
    let mut is_code = false;
    for (index, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        }
        // An indented line is either code or a list item's text, so its links are checked too.
        if !is_code {
            let found = LINK_STARTS.iter().flat_map(|&(start, end)| targets(line, start, end));
            links.extend(found.map(|target| (index + 1, target)));
        }
    }
    links
}

/// The delimiters of a link target.
const LINK_STARTS: [(&str, char); 3] = [("](", ')'), ("src=\"", '"'), ("href=\"", '"')];

fn targets(line: &str, start: &str, end: char) -> Vec<String> {
    let after_starts = line.match_indices(start).map(|(place, _)| &line[place + start.len()..]);
    let whole = after_starts.filter_map(|rest| rest.split(end).next());
    let paths = whole.filter(|target| !target.contains("://") && !target.starts_with("mailto:"));
    let paths = paths.filter_map(|target| target.split(['#', ' ']).next());
    paths.filter(|path| !path.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_links_are_found_and_others_left_alone() {
        let text = "\
A [page](docs/a.md#part) and ![a picture](gallery/b.png \"title\").
<img src=\"c.png\"> [web](https://example.com/x) [here](#part) [mail](mailto:a@b.c)
```
[code](nowhere.md)
```
[two](d.md) [links](e.md)";
        let expected =
            [(1, "docs/a.md"), (1, "gallery/b.png"), (2, "c.png"), (6, "d.md"), (6, "e.md")];
        assert_eq!(relative_links(text), expected.map(|(line, path)| (line, path.to_owned())));
    }
}
