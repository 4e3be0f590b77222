//! Which scene an existing output file belongs to.

use std::ffi::OsStr;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use etendue::image::{MetadataValue, metadata};
use etendue::{SumsFile, scene_name};

/// The headers of pictures are shorter than this.
const HEADER_BYTES: u64 = 32 << 20;

/// What an output file says about its scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// Etendue did not write it.
    Foreign,
    /// Etendue rendered it.
    Scene {
        /// The scene's name, as of [`name_of_scene`]; empty if the file has none.
        name: String,
        /// The hash of the scene and its files.
        hash: String,
    },
}

/// The name of a scene in the headers of pictures: its file with the folder, such as
/// `cups/scene.xml`. So two scenes of one name in different folders are told apart, and pictures do
/// not tell where their scene lies.
pub(crate) fn name_of_scene(scene: &Path) -> String {
    let whole = scene.canonicalize().unwrap_or_else(|_| scene.to_owned());
    let text = |name: &OsStr| name.to_string_lossy().into_owned();
    let file = whole.file_name().map(text).unwrap_or_default();
    match whole.parent().and_then(Path::file_name).map(text) {
        Some(folder) => format!("{folder}/{file}"),
        None => file,
    }
}

/// What a picture or part says. Formats without metadata say nothing, as if they were foreign.
pub(crate) fn read(path: &Path) -> Origin {
    if let Ok(header) = SumsFile::new(path).read_header() {
        let identity = &header.record.identity;
        let hash = identity.iter().find(|(name, _)| name == "scene and its files");
        return Origin::Scene {
            name: scene_name(&header.record.notes).unwrap_or_default().to_owned(),
            hash: hash.map_or_else(String::new, |(_, hash)| hash.clone()),
        };
    }
    let mut bytes = Vec::new();
    let opened = File::open(path);
    let read = opened.and_then(|file| file.take(HEADER_BYTES).read_to_end(&mut bytes));
    let entries = if read.is_ok() { metadata(&bytes) } else { Vec::new() };
    let text = |wanted: &str| {
        entries.iter().find_map(|(name, value)| match value {
            MetadataValue::Text(text) if name == wanted => Some(text.clone()),
            _ => None,
        })
    };
    match (text("software"), text("sceneHash")) {
        (Some(software), Some(hash)) if software.starts_with("Etendue ") => {
            Origin::Scene { name: text("scene").unwrap_or_default(), hash }
        }
        _ => Origin::Foreign,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_named_by_file_and_folder() {
        assert_eq!(name_of_scene(Path::new("no/such/cups/scene.xml")), "cups/scene.xml");
        assert_eq!(name_of_scene(Path::new("scene.xml")), "scene.xml");
    }
}
