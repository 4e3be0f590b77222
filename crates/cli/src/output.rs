//! Output files. They are checked before rendering starts, and written completely or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use etendue::SampleChoice;
use etendue::durable::{folder_of, temporary_name, write_durably};
use etendue::image::{FileFormat, ImageError};

use crate::failure::Failure;
use crate::text;

/// A picture file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) path: PathBuf,
    pub(crate) format: FileFormat,
}

impl Target {
    /// Takes the format from the extension, and checks that the file can be created.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let Some(format) = extension.and_then(FileFormat::from_extension) else {
            let known: Vec<_> =
                FileFormat::all().filter_map(|f| f.extensions().first().copied()).collect();
            let problem = match extension {
                Some(extension) => format!("`.{extension}` is not a picture format"),
                None => "the name has no extension, which selects the format".to_owned(),
            };
            let (path, known) = (text::path(path), known.join(", "));
            return Err(Failure::bad_input(format!(
                "cannot write {path}: {problem}; the formats are {known}"
            )));
        };
        probe(path)?;
        Ok(Self { path: path.to_path_buf(), format })
    }

    /// Writes an encoded picture.
    pub(crate) fn write(&self, encoded: Result<Vec<u8>, ImageError>) -> Result<(), Failure> {
        let result = match encoded {
            Ok(bytes) => write_durably(&self.path, |out| out.write_all(&bytes))
                .map_err(|error| error.to_string()),
            Err(error) => Err(error.to_string()),
        };
        let path = text::path(&self.path);
        result.map_err(|reason| Failure::failed(format!("cannot write {path}: {reason}")))
    }
}

/// The default outputs of a scene: its name with `.exr` and `.png`, or with `.A-B.part` or
/// `.I-of-N.part` for a subset of the samples.
pub(crate) fn default_names(
    scene: &Path,
    folder: &Path,
    samples: Option<&SampleChoice>,
) -> Vec<PathBuf> {
    let stem = scene.file_stem().unwrap_or_else(|| "picture".as_ref());
    // The stem may contain dots, so `set_extension` would cut it.
    let named = |extension: String| {
        let mut name = stem.to_owned();
        name.push(".");
        name.push(extension);
        folder.join(name)
    };
    match samples {
        Some(SampleChoice::Indices(indices)) => {
            vec![named(format!("{}-{}.part", indices.start, indices.end))]
        }
        Some(SampleChoice::Part { number, count }) => {
            vec![named(format!("{number}-of-{count}.part"))]
        }
        None => ["exr", "png"].map(|extension| named(extension.to_owned())).into(),
    }
}

/// Checks that a file can be written, by creating a temporary one beside it.
pub(crate) fn probe(path: &Path) -> Result<(), Failure> {
    let tried = if path.is_dir() {
        Err("it is a folder".to_owned())
    } else if path.exists() && !path.is_file() {
        Err("it is not a regular file".to_owned())
    } else if !folder_of(path).is_dir() {
        Err(format!("there is no folder {}", text::path(folder_of(path))))
    } else {
        let temporary = temporary_name(path);
        let made = fs::File::create_new(&temporary).and_then(|_| fs::remove_file(&temporary));
        made.map_err(|error| error.to_string())
    };
    let path = text::path(path);
    tried.map_err(|reason| Failure::bad_input(format!("cannot write {path}: {reason}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_names_are_the_scenes() {
        let scene = Path::new("a/b/scene.v2.xml");
        let names = default_names(scene, Path::new("out"), None);
        assert_eq!(names, [PathBuf::from("out/scene.v2.exr"), PathBuf::from("out/scene.v2.png")]);
        let part = default_names(scene, Path::new("out"), Some(&SampleChoice::Indices(16..32)));
        assert_eq!(part, [PathBuf::from("out/scene.v2.16-32.part")]);
    }
}
