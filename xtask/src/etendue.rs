//! The `etendue` command as other commands drive it: built once, called, and read.

use std::path::PathBuf;
use std::process::Command;

use crate::workspace::{cargo, root};

/// Builds the command with optimisation; says on the terminal why it cannot.
pub(crate) fn build() -> bool {
    let built =
        cargo().args(["build", "--quiet", "--release", "--package", "etendue-cli"]).status();
    built.is_ok_and(|status| status.success())
}

/// The command, to be given arguments.
pub(crate) fn command() -> Command {
    Command::new(root().join("target/release/etendue"))
}

/// An empty place for what the command writes, below `target`.
///
/// # Errors
/// What the file system complains of.
pub(crate) fn folder(name: &str) -> Result<PathBuf, String> {
    let folder = root().join("target").join(name);
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    Ok(folder)
}

/// What a command prints, or what it complains of.
///
/// # Errors
/// The command's standard error, or why it cannot be started.
pub(crate) fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// What `etendue diff` says of two pictures with variances.
#[derive(Debug, PartialEq)]
pub(crate) struct Difference {
    /// The difference of means of the channel that differs most, in percent.
    pub(crate) mean: f64,
    /// The share of blocks of 8×8 pixels that are off by both four standard errors and 2 %, in
    /// percent.
    pub(crate) blocks: f64,
}

/// Compares two pictures: runs `etendue diff` with these arguments.
///
/// # Errors
/// As [`output`], or that the text is not understood.
pub(crate) fn diff(arguments: &mut Command) -> Result<Difference, String> {
    let text = output(arguments)?;
    parse(&text).ok_or_else(|| format!("`etendue diff` printed something else:\n{text}"))
}

/// Reads the relative means, the line below `means`, and the stricter line of `blocks`.
fn parse(text: &str) -> Option<Difference> {
    let means = text.lines().skip_while(|line| !line.starts_with("means")).nth(1)?;
    let means: Vec<f64> = means.split('%').filter_map(|word| word.trim().parse().ok()).collect();
    let mean = means.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let blocks =
        text.lines().find(|line| line.starts_with("blocks") && line.contains("and 2 %"))?;
    Some(Difference { mean, blocks: blocks.split_whitespace().nth(1)?.parse().ok()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_comparison_is_read_from_what_diff_prints() {
        let text = "MSE     5.8e-5\nmeans   -0.000035 0.1 0.2\n        -0.018 % 0.207 % -0.012 %\n\
                    blocks  9.000 % off by more than 4 standard errors (0 of 1024)\n\
                    blocks  1.250 % off by more than 4 standard errors and 2 % (0 of 1024)\n";
        assert_eq!(parse(text), Some(Difference { mean: 0.207, blocks: 1.25 }));
        assert_eq!(parse("MSE 1\n"), None);
    }
}
