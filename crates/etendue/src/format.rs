//! The scene file formats and how the format of a file is detected.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use etendue_document::{
    Diagnostic, Diagnostics, Document, Fault, ResourceError, Resources, Sources, list_names,
};
use etendue_mitsuba::LoadOptions;

use crate::options::SceneOptions;

/// A scene file format: how a text becomes a document.
///
/// A new scene reader implements this and adds one line to [`FORMATS`]. Hosts that build documents
/// themselves need no format: [`load_document`](crate::load_document) takes a document.
pub struct Format {
    /// The format's display name.
    pub name: &'static str,
    /// Its file extensions, in lower case and without the dot.
    pub extensions: &'static [&'static str],
    /// Whether a file that begins with these bytes, leading white space removed, is in this format.
    recognizes: fn(&[u8]) -> bool,
    /// Reads a scene. Even with errors, it returns a document that holds what could be read. If the
    /// input is not a scene at all, it returns only the source texts, for the excerpts of the
    /// diagnostics.
    read: fn(&SceneSource<'_>, &ReadContext<'_>) -> Result<Document, Sources>,
}

/// All readable formats, in the order in which they are tried. A file that none recognises is read
/// as the first format, whose reader reports what is wrong.
pub static FORMATS: &[Format] = &[Format {
    name: "Mitsuba XML",
    extensions: &["xml"],
    recognizes: |start| start.starts_with(b"<"),
    read: read_mitsuba,
}];

/// Where a scene comes from.
pub(crate) enum SceneSource<'a> {
    /// A file. The files it names are looked up first in its folder.
    File(&'a Path),
    /// A text.
    Text(&'a str),
}

/// The context for reading a scene.
pub(crate) struct ReadContext<'a> {
    pub(crate) resources: &'a dyn Resources,
    /// The base of relative paths.
    pub(crate) working_directory: &'a Path,
    pub(crate) options: &'a SceneOptions,
    pub(crate) diagnostics: &'a Diagnostics,
}

/// A kind of file that may be mistaken for a scene, or a scene format that is not supported yet.
struct OtherKind {
    /// With its article, for messages.
    name: &'static str,
    mark: Mark,
    /// What to do about it.
    help: &'static str,
}

/// How a kind of file is recognised.
enum Mark {
    /// The bytes the file begins with.
    Start(&'static [u8]),
    /// The file name extension.
    Extension(&'static str),
}

/// A row of [`OTHER_KINDS`].
const fn other(name: &'static str, mark: Mark, help: &'static str) -> OtherKind {
    OtherKind { name, mark, help }
}

const MESH_HELP: &str = "a scene names its meshes, as in `<shape type=\"ply\">`";
const PICTURE_HELP: &str = "a scene names its pictures, as in `<texture type=\"bitmap\">`";
/// What a scene looks like, for files in the formats of other renderers.
const SCENE_HELP: &str = "a scene is XML: `<scene version=\"3.0.0\">`, then its objects; \
     docs/scene-format.md shows one to begin with";
const PACKED_HELP: &str = "unpack it first";
const SUMS_HELP: &str =
    "`etendue merge` makes a picture of parts, and `--resume` goes on with a checkpoint";

static OTHER_KINDS: &[OtherKind] = &[
    other("a pbrt scene", Mark::Extension("pbrt"), SCENE_HELP),
    other("a glTF scene", Mark::Extension("gltf"), SCENE_HELP),
    other("a glTF scene", Mark::Start(b"glTF"), SCENE_HELP),
    other("a JSON file", Mark::Start(b"{"), SCENE_HELP),
    other("an OpenEXR picture", Mark::Start(b"\x76\x2f\x31\x01"), PICTURE_HELP),
    other("a PNG picture", Mark::Start(b"\x89PNG"), PICTURE_HELP),
    other("a JPEG picture", Mark::Start(b"\xff\xd8\xff"), PICTURE_HELP),
    other("a gzip archive", Mark::Start(b"\x1f\x8b"), PACKED_HELP),
    other("a zip archive", Mark::Start(b"PK\x03\x04"), PACKED_HELP),
    other("a PLY mesh", Mark::Start(b"ply\n"), MESH_HELP),
    other("a PLY mesh", Mark::Start(b"ply\r"), MESH_HELP),
    other("a Mitsuba mesh", Mark::Start(b"\x1c\x04"), MESH_HELP),
    other("a Wavefront OBJ mesh", Mark::Extension("obj"), MESH_HELP),
    other("a Blender file", Mark::Start(b"BLENDER"), "export it with Blender's Mitsuba add-on"),
    other("a USD scene", Mark::Start(b"PXR-USDC"), SCENE_HELP),
    other("a USD scene", Mark::Start(b"#usda"), SCENE_HELP),
    other("a checkpoint or a part of a render", Mark::Start(b"etendue sums"), SUMS_HELP),
];

/// Detects the format of a scene and reads it. Each file is read only once, even if its first bytes
/// are inspected.
pub(crate) fn read(
    source: &SceneSource<'_>,
    context: &ReadContext<'_>,
) -> Result<Document, Sources> {
    match source {
        SceneSource::File(path) => {
            let whole_path = context.working_directory.join(path);
            // The format's reader reports unreadable files.
            let bytes = context.resources.read(&whole_path).ok();
            let format = find_format(path, bytes.as_deref(), context)?;
            let ahead = ReadAhead::new(context.resources, whole_path, bytes);
            (format.read)(source, &ReadContext { resources: &ahead, ..*context })
        }
        SceneSource::Text(text) => {
            let format = find_format(Path::new("<scene>"), Some(text.as_bytes()), context)?;
            (format.read)(source, context)
        }
    }
}

/// Detects the format of a file by its first bytes, or else by its extension. Reports files of
/// other known kinds.
fn find_format(
    path: &Path,
    bytes: Option<&[u8]>,
    context: &ReadContext<'_>,
) -> Result<&'static Format, Sources> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if let Some(bytes) = bytes {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let start = bytes.trim_ascii_start();
        if let Some(format) = FORMATS.iter().find(|format| (format.recognizes)(start)) {
            return Ok(format);
        }
        let is_it = |kind: &&OtherKind| match kind.mark {
            Mark::Start(mark) => start.starts_with(mark),
            Mark::Extension(mark) => extension == mark,
        };
        if let Some(kind) = OTHER_KINDS.iter().find(is_it) {
            context.diagnostics.push(kind.diagnostic(path));
            return Err(Sources::default());
        }
    }
    let by_extension = |format: &&Format| format.extensions.contains(&extension.as_str());
    Ok(FORMATS.iter().find(by_extension).unwrap_or(&FORMATS[0]))
}

impl OtherKind {
    fn diagnostic(&self, path: &Path) -> Diagnostic {
        let formats = list_names(FORMATS.iter().map(|format| format.name));
        let (path, name) = (path.display(), self.name);
        let message = format!("{path} is {name}, but scenes are read from {formats}");
        Diagnostic::error(Fault::Unsupported, None, message).help(self.help)
    }
}

fn read_mitsuba(source: &SceneSource<'_>, context: &ReadContext<'_>) -> Result<Document, Sources> {
    let ReadContext { resources, working_directory, options, diagnostics } = *context;
    let options = LoadOptions {
        defines: options.defines.clone(),
        search_paths: options.search_paths.clone(),
        working_directory: working_directory.to_owned(),
        ..LoadOptions::default()
    };
    match source {
        SceneSource::File(path) => {
            etendue_mitsuba::read_file(path, resources, &options, diagnostics)
        }
        SceneSource::Text(text) => {
            etendue_mitsuba::read_text(text, resources, &options, diagnostics)
        }
    }
}

/// Resources with one file already in memory: the first read of that file returns those bytes.
struct ReadAhead<'a> {
    resources: &'a dyn Resources,
    path: PathBuf,
    bytes: Mutex<Option<Vec<u8>>>,
}

impl<'a> ReadAhead<'a> {
    fn new(resources: &'a dyn Resources, path: PathBuf, bytes: Option<Vec<u8>>) -> Self {
        Self { resources, path, bytes: Mutex::new(bytes) }
    }
}

impl Resources for ReadAhead<'_> {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ResourceError> {
        let ahead = || self.bytes.lock().unwrap_or_else(PoisonError::into_inner).take();
        let ahead = if path == self.path { ahead() } else { None };
        ahead.map_or_else(|| self.resources.read(path), Ok)
    }

    fn exists(&self, path: &Path) -> bool {
        self.resources.exists(path)
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        self.resources.list(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_document::MemoryResources;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn findings(name: &str, bytes: &[u8]) -> Vec<Diagnostic> {
        let files = MemoryResources::default().with(name, bytes);
        let diagnostics = Diagnostics::new();
        let context = ReadContext {
            resources: &files,
            working_directory: Path::new(""),
            options: &SceneOptions::default(),
            diagnostics: &diagnostics,
        };
        let _ = read(&SceneSource::File(Path::new(name)), &context);
        diagnostics.sorted()
    }

    #[test]
    fn a_scene_is_known_by_its_bytes_whatever_its_name() {
        let scene = b"\xef\xbb\xbf\n <scene version=\"3.0.0\"/>";
        for name in ["scene.xml", "scene", "scene.pbrt", "scene.json"] {
            assert_eq!(findings(name, scene), [], "{name}");
        }
    }

    #[test]
    fn other_files_are_named() {
        let cases: [(&str, &[u8], &str); 10] = [
            ("a.pbrt", b"LookAt 0 0 5", "a pbrt scene"),
            ("a.gltf", b"{\"asset\": {}}", "a glTF scene"),
            ("a.glb", b"glTF\x02\0\0\0", "a glTF scene"),
            ("a.json", b" { }", "a JSON file"),
            ("a.exr", b"\x76\x2f\x31\x01\x02", "an OpenEXR picture"),
            ("scene.xml", b"\x1f\x8b\x08\0", "a gzip archive"),
            ("scene.xml.zip", b"PK\x03\x04", "a zip archive"),
            ("a.serialized", b"\x1c\x04\x04\0", "a Mitsuba mesh"),
            ("a.obj", b"v 0 0 0", "a Wavefront OBJ mesh"),
            ("a.part", b"etendue sums\0", "a checkpoint or a part"),
        ];
        for (name, bytes, kind) in cases {
            let findings = findings(name, bytes);
            let message = &findings[0].message;
            assert_eq!((findings.len(), findings[0].fault), (1, Fault::Unsupported), "{message}");
            assert!(message.starts_with(&format!("{name} is {kind}")), "{message}");
            assert!(message.contains("`Mitsuba XML`"), "{message}");
        }
    }

    #[test]
    fn what_nobody_knows_is_read_as_the_first_format_which_tells_what_is_wrong() {
        assert_eq!(findings("a.xml", b"scene")[0].fault, Fault::Syntax);
        assert!(findings("a", b"")[0].message.contains("empty"));
    }

    #[test]
    fn a_file_is_read_once() {
        struct Counting(MemoryResources, AtomicUsize);
        impl Resources for Counting {
            fn read(&self, path: &Path) -> Result<Vec<u8>, ResourceError> {
                self.1.fetch_add(1, Ordering::Relaxed);
                self.0.read(path)
            }
            fn exists(&self, path: &Path) -> bool {
                self.0.exists(path)
            }
        }
        for text in ["<scene version=\"3.0.0\"/>", "<scene", "{}"] {
            let files = MemoryResources::default().with("/a/scene.xml", text);
            let files = Counting(files, AtomicUsize::new(0));
            let context = ReadContext {
                resources: &files,
                working_directory: Path::new("/a"),
                options: &SceneOptions::default(),
                diagnostics: &Diagnostics::new(),
            };
            let _ = read(&SceneSource::File(Path::new("scene.xml")), &context);
            assert_eq!(files.1.into_inner(), 1, "{text}");
        }
    }
}
