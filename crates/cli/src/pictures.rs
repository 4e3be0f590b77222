//! Reads picture files.

use std::fmt::Display;
use std::io::{Read, stdin};
use std::path::Path;

use etendue::Files;
use etendue::document::Resources;
use etendue::image::{Limits, Picture, decode_picture};

use crate::failure::Failure;
use crate::{terminal, text};

/// The name that stands for standard input or output.
pub(crate) const STANDARD: &str = "-";

/// Reads a picture in any supported format, and prints what is not followed in it.
pub(crate) fn read(path: &Path) -> Result<Picture, Failure> {
    let is_standard = path == Path::new(STANDARD);
    let name = if is_standard { "standard input".to_owned() } else { text::path(path) };
    let unreadable =
        |error: &dyn Display| Failure::bad_input(format!("cannot read {name}: {error}"));
    let bytes = if is_standard {
        read_standard_input().map_err(|error| unreadable(&error))?
    } else {
        Files::default().read(path).map_err(|error| unreadable(&error))?.to_vec()
    };
    let picture = decode_picture(&bytes, &name).map_err(|error| unreadable(&error))?;
    for warning in &picture.warnings {
        terminal::warning(&format!("{name}: {warning}"));
    }
    Ok(picture)
}

/// One layer of a picture, or one channel, as the picture's main layer.
pub(crate) fn layer(picture: &Picture, name: &str, path: &Path) -> Result<Picture, Failure> {
    picture.layer(name).ok_or_else(|| {
        let layers = picture.layers();
        let names: Vec<&str> =
            layers.iter().map(|(name, _)| *name).filter(|name| !name.is_empty()).collect();
        let known = match names.as_slice() {
            [] => "it has none but its colours".to_owned(),
            names => format!("the layers are {}", names.join(", ")),
        };
        Failure::bad_input(format!("{} has no layer `{name}`; {known}", text::path(path)))
    })
}

/// All bytes of standard input, up to what a picture may take in memory.
fn read_standard_input() -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stdin().lock().take(Limits::default().bytes).read_to_end(&mut bytes)?;
    Ok(bytes)
}
