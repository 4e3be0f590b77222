//! Reads picture files.

use std::path::Path;

use etendue::Files;
use etendue::document::Resources;
use etendue::image::{Picture, decode_picture};

use crate::failure::Failure;

/// Reads a picture in any supported format.
pub(crate) fn read(path: &Path) -> Result<Picture, Failure> {
    let name = path.display().to_string();
    let bytes = Files::default()
        .read(path)
        .map_err(|error| Failure::bad_input(format!("cannot read {name}: {error}")))?;
    decode_picture(&bytes, &name)
        .map_err(|error| Failure::bad_input(format!("cannot read {name}: {error}")))
}
