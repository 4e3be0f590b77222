//! Reads picture files.

use std::fmt::Display;
use std::path::Path;

use etendue::Files;
use etendue::document::Resources;
use etendue::image::{Picture, decode_picture};

use crate::failure::Failure;
use crate::text;

/// Reads a picture in any supported format.
pub(crate) fn read(path: &Path) -> Result<Picture, Failure> {
    let problem = |error: &dyn Display| {
        Failure::bad_input(format!("cannot read {}: {error}", text::path(path)))
    };
    let bytes = Files::default().read(path).map_err(|error| problem(&error))?;
    decode_picture(&bytes, &text::path(path)).map_err(|error| problem(&error))
}
