//! Output files. They are checked before rendering starts, and written completely or not at all.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use etendue::SampleChoice;
use etendue::durable::{folder_of, follow_links, temporary_name, write_durably};
use etendue::image::{FileFormat, ImageError};

use crate::failure::Failure;
use crate::{parsers, text};

/// A picture file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    /// The name that the user gave.
    pub(crate) path: PathBuf,
    pub(crate) format: FileFormat,
    /// The file to replace: where links lead.
    file: PathBuf,
}

impl Target {
    /// Takes the format from the extension, and checks that the file can be created.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        Self::with_format(path, None)
    }

    /// As [`Self::new`], with a format that the extension does not decide.
    pub(crate) fn with_format(path: &Path, format: Option<FileFormat>) -> Result<Self, Failure> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let known = || extension.and_then(FileFormat::from_extension);
        let Some(format) = format.or_else(known) else {
            let problem = match extension {
                Some(extension) => format!("`.{extension}` is not a picture format"),
                None => "the name has no extension, which selects the format".to_owned(),
            };
            let (path, known) = (text::path(path), parsers::format_names());
            return Err(Failure::bad_input(format!(
                "cannot write {path}: {problem}; the formats are {known}"
            )));
        };
        Ok(Self { path: path.to_path_buf(), format, file: probe(path)? })
    }

    /// Writes an encoded picture.
    pub(crate) fn write(&self, encoded: Result<Vec<u8>, ImageError>) -> Result<(), Failure> {
        let result = match encoded {
            Ok(bytes) => write_durably(&self.file, |out| out.write_all(&bytes))
                .map_err(|error| error.to_string()),
            Err(error) => Err(error.to_string()),
        };
        let path = text::path(&self.path);
        result.map_err(|reason| Failure::failed(format!("cannot write {path}: {reason}")))
    }
}

/// The default outputs of a scene: its name with `.exr` and `.png`, or with `.A-B.part` or
/// `.I-of-N.part` for a subset of the samples. A scene called `scene`, as most are, has the name of
/// its folder.
pub(crate) fn default_names(
    scene: &Path,
    folder: &Path,
    samples: Option<&SampleChoice>,
) -> Vec<PathBuf> {
    let stem = name_of(scene);
    // The stem may contain dots, so `set_extension` would cut it.
    let named = |extension: String| {
        let mut name = stem.clone();
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

/// The name of a scene without its extension.
fn name_of(scene: &Path) -> OsString {
    let stem = scene.file_stem().unwrap_or_else(|| "picture".as_ref());
    if !stem.eq_ignore_ascii_case("scene") {
        return stem.to_owned();
    }
    let whole = scene.canonicalize().unwrap_or_else(|_| scene.to_owned());
    whole.parent().and_then(Path::file_name).unwrap_or(stem).to_owned()
}

/// Checks that a file can be written, by creating a temporary one beside it. Returns where links lead.
pub(crate) fn probe(path: &Path) -> Result<PathBuf, Failure> {
    let tried = follow_links(path).map_err(|error| error.to_string()).and_then(|file| {
        check_kind(&file)?;
        if !folder_of(&file).is_dir() {
            return Err(format!("there is no folder {}", text::path(folder_of(&file))));
        }
        let temporary = temporary_name(&file);
        let made = fs::File::create_new(&temporary).and_then(|_| fs::remove_file(&temporary));
        made.map(|()| file).map_err(|error| error.to_string())
    });
    let path = text::path(path);
    tried.map_err(|reason| Failure::bad_input(format!("cannot write {path}: {reason}")))
}

/// Refuses what is not a file that can be replaced.
fn check_kind(file: &Path) -> Result<(), String> {
    let Ok(metadata) = fs::symlink_metadata(file) else {
        return Ok(());
    };
    if metadata.is_dir() {
        Err("it is a folder".to_owned())
    } else if !metadata.is_file() {
        Err("it is a pipe or a device, not a file".to_owned())
    } else {
        Ok(())
    }
}

/// Refuses two names of one file: the second picture would replace the first.
pub(crate) fn check_distinct<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    let mut seen: Vec<(&Path, FileIdentity)> = Vec::new();
    for path in paths {
        let identity = FileIdentity::of(path);
        if let Some((first, _)) = seen.iter().find(|(_, other)| *other == identity) {
            let (first, path) = (text::path(first), text::path(path));
            return Err(Failure::bad_input(format!("{first} and {path} are the same file")));
        }
        seen.push((path, identity));
    }
    Ok(())
}

/// Which file a name stands for.
#[derive(PartialEq)]
enum FileIdentity {
    /// Device and number of a file that exists: hard links and names in another case share them.
    #[cfg(unix)]
    Number([u64; 2]),
    /// The folder without links, and the name in it.
    Path(PathBuf),
}

impl FileIdentity {
    fn of(path: &Path) -> Self {
        let file = follow_links(path).unwrap_or_else(|_| path.to_owned());
        #[cfg(unix)]
        if let Ok(metadata) = fs::metadata(&file) {
            use std::os::unix::fs::MetadataExt;
            return Self::Number([metadata.dev(), metadata.ino()]);
        }
        if let Ok(whole) = file.canonicalize() {
            return Self::Path(whole);
        }
        let folder = folder_of(&file).canonicalize();
        let folder = folder.unwrap_or_else(|_| folder_of(&file).to_owned());
        Self::Path(folder.join(file.file_name().unwrap_or_default()))
    }
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

    #[test]
    fn a_scene_called_scene_has_the_name_of_its_folder() {
        for (scene, expected) in [("no/cups/scene.xml", "cups"), ("no/cups/SCENE.XML", "cups")] {
            let names = default_names(Path::new(scene), Path::new(""), None);
            assert_eq!(names[0], PathBuf::from(format!("{expected}.exr")), "{scene}");
        }
        let names = default_names(Path::new("scene.xml"), Path::new(""), None);
        assert_eq!(names[0], PathBuf::from("scene.exr"), "there is no such file, so no folder");
    }
}
