//! Looks up the files that a scene names.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::names::{list_names, near_names};
use crate::printable::printable;
use crate::resources::{Resources, normalise};
use crate::span::SourceId;

/// The folders in which file names are resolved.
///
/// Real scenes name files relative to the scene's folder, to a folder above it, to the folder the
/// renderer was started in, or to one given on the command line. A name is looked up in this order:
/// as an absolute path, in the folder of the file that names it, in the scene's `<path>` entries,
/// in the search paths, in the working directory, and in every folder above that of the file that
/// names it. Backslashes separate folders like slashes.
#[derive(Clone, Debug, Default)]
pub struct Resolver {
    /// The folder of each text of the document, by source id.
    pub source_folders: Vec<PathBuf>,
    /// The scene's `<path>` entries.
    pub scene_paths: Vec<PathBuf>,
    /// The user's search paths.
    pub search_paths: Vec<PathBuf>,
    /// The base of relative names: the host's current directory.
    pub working_directory: PathBuf,
}

/// A file that was not found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotFound {
    /// The name as written.
    pub name: String,
    /// Every path that was tried, in order.
    pub tried: Vec<PathBuf>,
    /// The base folders of these paths, in order; none if the name is an absolute path.
    pub folders: Vec<PathBuf>,
}

impl NotFound {
    /// Advice for a diagnostic: the folders that were searched, which are the same for all files
    /// that a text names.
    pub fn help(&self) -> Vec<String> {
        if self.folders.is_empty() {
            return Vec::new();
        }
        let shown = |folder: &PathBuf| printable(&folder.to_string_lossy()).into_owned();
        let folders: Vec<String> = self.folders.iter().map(shown).collect();
        vec![format!("looked for it in\n{}", folders.join("\n"))]
    }

    /// Like [`Self::help`], preceded by the names of similar files. Finding these lists all
    /// folders, which takes time if a scene misses a thousand files.
    pub fn help_with_near_names(&self, resources: &dyn Resources) -> Vec<String> {
        let near = near_files(&self.tried, resources);
        let names = list_names(near.iter().map(String::as_str));
        let near = (!near.is_empty()).then(|| format!("there is {names}"));
        near.into_iter().chain(self.help()).collect()
    }
}

impl fmt::Display for NotFound {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "no file `{}`", self.name)
    }
}

impl std::error::Error for NotFound {}

impl Resolver {
    /// Finds the file that `name`, written in the text `source`, refers to. A document built in
    /// code has no text, so its names are looked up only in the other folders.
    ///
    /// # Errors
    ///
    /// If none of the [`Resolver::candidates`] exists.
    pub fn resolve(
        &self,
        name: &str,
        source: impl Into<Option<SourceId>>,
        resources: &dyn Resources,
    ) -> Result<PathBuf, NotFound> {
        let source = source.into();
        let tried = self.candidates(name, source);
        match tried.iter().find(|path| resources.exists(path)) {
            Some(path) => Ok(path.clone()),
            None => {
                let is_relative = !as_path(name).is_absolute();
                let folders = if is_relative { self.folders(source) } else { Vec::new() };
                Err(NotFound { name: name.to_owned(), tried, folders })
            }
        }
    }

    /// The normalised paths at which `name`, written in the text `source`, may be found, in order
    /// of preference and without duplicates.
    pub fn candidates(&self, name: &str, source: impl Into<Option<SourceId>>) -> Vec<PathBuf> {
        let as_written = Path::new(name);
        let with_slashes = as_path(name);
        if with_slashes.is_absolute() {
            return vec![normalise(&with_slashes)];
        }
        let mut candidates = Vec::new();
        for folder in self.folders(source.into()) {
            // A backslash may also be part of a file name, but this is rare.
            for file in [as_written, &with_slashes] {
                let path = normalise(&folder.join(file));
                if !candidates.contains(&path) {
                    candidates.push(path);
                }
            }
        }
        candidates
    }

    /// The folders in which a name written in the text `source` is looked up, in order and without
    /// duplicates.
    fn folders(&self, source: Option<SourceId>) -> Vec<PathBuf> {
        let own = source.and_then(|source| self.source_folders.get(source.index()));
        let own = own.map(|folder| normalise(&self.working_directory.join(folder)));
        let given = self.scene_paths.iter().chain(&self.search_paths);
        let given = given.map(|path| self.working_directory.join(path));
        let working = std::iter::once(self.working_directory.clone());
        let above = own.as_deref().into_iter().flat_map(|own| own.ancestors().skip(1));
        let above: Vec<PathBuf> = above.map(Path::to_path_buf).collect();
        let mut folders = Vec::new();
        for folder in own.clone().into_iter().chain(given).chain(working).chain(above) {
            if !folders.contains(&folder) {
                folders.push(folder);
            }
        }
        folders
    }
}

/// Replaces backslashes of a file name by slashes.
fn as_path(name: &str) -> PathBuf {
    name.trim().replace('\\', "/").into()
}

/// Similar file names in the folders that were searched.
fn near_files(tried: &[PathBuf], resources: &dyn Resources) -> Vec<String> {
    let Some(wanted) = tried.first().and_then(|path| path.file_name()?.to_str()) else {
        return Vec::new();
    };
    let folders = tried.iter().filter_map(|path| path.parent());
    let names: Vec<String> = folders.flat_map(|folder| resources.list(folder)).collect();
    near_names(wanted, names.iter().map(String::as_str)).into_iter().map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resources::MemoryResources;
    use crate::source::Sources;

    fn resolver(folder: &str) -> (Resolver, SourceId) {
        let id = Sources::default().add("scene.xml", "");
        let resolver = Resolver {
            source_folders: vec![folder.into()],
            working_directory: "/home/ada".into(),
            ..Resolver::default()
        };
        (resolver, id)
    }

    #[test]
    fn a_name_meant_from_the_folder_of_folders_is_found_from_anywhere() {
        let files = MemoryResources::default().with("/s/testcases/coffee/models/Mesh000.obj", "");
        for folder in ["/s/testcases/coffee", "/s/testcases/kitchen/../coffee"] {
            let (resolver, id) = resolver(folder);
            let found = resolver.resolve("testcases/coffee/models/Mesh000.obj", id, &files);
            assert_eq!(found, Ok("/s/testcases/coffee/models/Mesh000.obj".into()));
        }
    }

    #[test]
    fn a_name_meant_from_the_folder_above_is_found() {
        let files = MemoryResources::default().with("/s/mesh/cube.obj", "");
        let (resolver, id) = resolver("/s/testcases");
        assert_eq!(resolver.resolve("mesh/cube.obj", id, &files), Ok("/s/mesh/cube.obj".into()));
    }

    #[test]
    fn the_own_folder_comes_before_paths_before_the_working_directory_before_those_above() {
        let (mut resolver, id) = resolver("/s/scenes");
        resolver.scene_paths.push("/p".into());
        resolver.search_paths.push("more".into());
        let candidates = resolver.candidates("./a.png", id);
        let expected = [
            "/s/scenes/a.png",
            "/p/a.png",
            "/home/ada/more/a.png",
            "/home/ada/a.png",
            "/s/a.png",
            "/a.png",
        ];
        assert_eq!(candidates, expected.map(PathBuf::from));
    }

    #[test]
    fn backslashes_and_absolute_names() {
        let files = MemoryResources::default().with("/s/textures/wood.png", "");
        let (resolver, id) = resolver("/s");
        let found = Ok(PathBuf::from("/s/textures/wood.png"));
        assert_eq!(resolver.resolve("textures\\wood.png", id, &files), found);
        assert_eq!(resolver.resolve("/s/textures/wood.png", id, &files), found);
        assert_eq!(resolver.candidates("/x/y.png", id).len(), 1, "an absolute name has one place");
    }

    #[test]
    fn a_missing_file_lists_where_it_was_sought_and_what_resembles_it() {
        let files = MemoryResources::default().with("/s/textures/wood.png", "");
        let (resolver, id) = resolver("/s");
        let missing = resolver.resolve("textures/wod.png", id, &files).unwrap_err();
        assert_eq!(missing.tried[0], PathBuf::from("/s/textures/wod.png"));
        assert_eq!(missing.to_string(), "no file `textures/wod.png`");
        let sought = "looked for it in\n/s\n/home/ada\n/";
        assert_eq!(missing.help(), [sought]);
        assert_eq!(missing.help_with_near_names(&files), ["there is `wood.png`", sought]);
        let absolute = resolver.resolve("/s/textures/wod.png", id, &files).unwrap_err();
        assert_eq!(absolute.help_with_near_names(&files), ["there is `wood.png`"]);
    }
}
