//! Output of figures: a table for people, JSON for programs, a folder in `benches/runs` for the
//! record.

use clap::Args;
use serde_json::Value;

use crate::workspace::root;

/// How the figures are output.
#[derive(Debug, Args)]
pub(super) struct SavedRun {
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
    /// Also store the figures as JSON below benches/runs, in a folder named by day and machine,
    /// such as 2026-11-22-amd-epyc-zen5
    #[arg(long, value_name = "FOLDER", value_parser = folder_name)]
    keep: Option<String>,
}

impl SavedRun {
    /// Whether figures are needed as JSON.
    pub(super) fn wants_json(&self) -> bool {
        self.json || self.keep.is_some()
    }

    /// Whether the table is printed.
    pub(super) fn shows_table(&self) -> bool {
        !self.json
    }
}

/// A folder name, not a path.
fn folder_name(name: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(is_plain) {
        return Ok(name.to_owned());
    }
    Err("a name of letters, digits and hyphens is expected".to_owned())
}

/// Prints and stores the figures of the benchmark `name` as requested.
pub(super) fn finish(name: &str, figures: &Value, keeping: &SavedRun) -> Result<(), String> {
    let json = serde_json::to_string_pretty(figures).map_err(|error| error.to_string())? + "\n";
    text(name, &json, keeping)
}

/// Like [`finish`], for figures that are JSON already.
pub(super) fn text(name: &str, text: &str, keeping: &SavedRun) -> Result<(), String> {
    if keeping.json {
        print!("{text}");
    }
    let Some(folder) = &keeping.keep else { return Ok(()) };
    let folder = root().join("benches/runs").join(folder);
    let path = folder.join(format!("{name}.json"));
    let message = |error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(&folder).map_err(message)?;
    std::fs::write(&path, text).map_err(message)?;
    eprintln!("stored as {}", path.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_a_name() {
        assert!(folder_name("2026-11-22-amd-epyc-zen5").is_ok());
        for path in ["", "..", "a/b", "/tmp"] {
            assert!(folder_name(path).is_err(), "{path}");
        }
    }
}
