//! `cargo xtask references`: renders the references of the test scenes according to their table.

use std::path::PathBuf;

use clap::Args;
use etendue::image::{EncodeOptions, ExrPrecision, FileFormat, Picture, decode_exr_layers, encode};

use crate::repository::root;
use crate::test_scenes::cases::{self, Expected};
use crate::test_scenes::{build, folder, render, succeed};

/// Which references to render, and how.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scenes by name; all if none is named
    names: Vec<String>,
    /// The `etendue` command to render with; this checkout's if not given
    #[arg(long, value_name = "FILE")]
    binary: Option<PathBuf>,
}

/// Renders and writes.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let binary = arguments.binary.clone().map_or_else(build, Ok)?;
    let temporary = root().join("target/reference.exr");
    let references = folder().join("references");
    std::fs::create_dir_all(&references).map_err(|error| error.to_string())?;
    let rows = cases::read(&folder())?;
    let is_named = |scene: &String| arguments.names.is_empty() || arguments.names.contains(scene);
    if let Some(name) = arguments.names.iter().find(|name| rows.iter().all(|r| r.scene != **name)) {
        return Err(format!("there is no scene `{name}`"));
    }
    for row in rows.iter().filter(|row| is_named(&row.scene)) {
        let Expected::Stored { options, samples } = &row.expected else { continue };
        let scene = folder().join(format!("{}.xml", row.scene));
        let mut command = render(&binary, &scene, options);
        command.args(["--variance", "--seed", "1", "--spp", &samples.to_string(), "--output"]);
        succeed(command.arg(&temporary)).map_err(|message| format!("{}: {message}", row.scene))?;
        let read = std::fs::read(&temporary).map_err(|error| error.to_string())?;
        let bytes = compact(&decode_exr_layers(&read).map_err(|error| error.to_string())?)?;
        let path = references.join(format!("{}.exr", row.scene));
        std::fs::write(&path, &bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        println!("{:>8} bytes  {}", bytes.len(), row.scene);
    }
    Ok(())
}

/// The colours and their standard errors in half floats; variances would exceed their range.
fn compact(picture: &Picture) -> Result<Vec<u8>, String> {
    let mut stored = Picture::new(picture.width, picture.height);
    let plane = |name: &str| {
        let channel = picture.channel(name);
        channel.map(|channel| channel.data.clone()).ok_or_else(|| format!("no channel {name}"))
    };
    for name in ["R", "G", "B"] {
        stored.push(name, plane(name)?);
        let errors = plane(&format!("variance.{name}"))?.iter().map(|value| value.sqrt()).collect();
        stored.push(format!("error.{name}"), errors);
    }
    let options = EncodeOptions { exr_precision: ExrPrecision::Half, ..EncodeOptions::default() };
    encode(&stored, FileFormat::Exr, &options).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_keeps_small_errors() {
        let mut picture = Picture::new(1, 1);
        for name in ["R", "G", "B"] {
            picture.push(name, vec![0.5]);
            picture.push(format!("variance.{name}"), vec![1e-8]);
        }
        let stored = decode_exr_layers(&compact(&picture).unwrap()).unwrap();
        assert_eq!(stored.channel("G").unwrap().data, [0.5]);
        assert!((stored.channel("error.G").unwrap().data[0] - 1e-4).abs() < 1e-7);
    }
}
