//! The command line page: a handwritten part and the output of `--help`.

use std::process::Command;

use crate::repository::root;

/// The text above the help of the subcommands.
const INTRODUCTION: &str = include_str!("command_line.md");

/// The subcommands, in the order of the page.
const SUBCOMMANDS: [&str; 8] =
    ["render", "merge", "check", "info", "diff", "convert", "completions", "man"];

/// The text of the page. Builds the `etendue` command if needed.
pub(super) fn page() -> Result<String, String> {
    let mut text = INTRODUCTION.to_owned();
    for name in SUBCOMMANDS {
        let help = help(name)?;
        text.push_str(&format!("\n## etendue {name}\n\n```text\n{}\n```\n", help.trim_end()));
    }
    Ok(text)
}

/// The output of `etendue NAME --help`, without trailing spaces.
fn help(name: &str) -> Result<String, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = ["run", "--quiet", "--package", "etendue-cli", "--", name, "--help"];
    let output = Command::new(cargo)
        .args(arguments)
        .current_dir(root())
        // Fix the line width, so that it does not depend on the terminal.
        .env("COLUMNS", "100")
        .output()
        .map_err(|error| format!("cannot start cargo: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n"))
}
