//! Files: found, read, hashed and decoded in parallel.

use super::input::{BuildOptions, Identity, SceneInput};
use super::memory::MemoryBudget;
use crate::cache::{AssetCache, Digest, NodeDigests};
use crate::models::mesh::{Mesh, MeshOptions};
use crate::plugin::find;
use crate::shape::COMPOSITE_SHAPES;
use crate::shape::Geometry;
use crate::shape::SHAPES;
use crate::texture::{Texture, bitmap};
use etendue_document::{
    Class, Diagnostic, Diagnostics, Document, Fault, NodeId, NotFound, Parameters, ResourceError,
    Resources, Severity, Span, Value,
};
use etendue_image::{Bitmap, ImageError, PictureHeader, decode, read_header};
use etendue_math::Bounds3;
use etendue_mesh::{MeshError, TriangleMesh};
use rayon::prelude::*;
use std::any::Any;
use std::collections::{BTreeMap, HashMap};
use std::fmt::{self, Debug};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use xxhash_rust::xxh3::xxh3_128;

/// The input of plugins: the document, files by name, and diagnostics.
pub struct Assets<'a> {
    /// The scene as the user wrote it.
    pub document: &'a Document,
    /// Bytes by name.
    pub resources: &'a dyn Resources,
    /// Where errors and warnings go.
    pub diagnostics: &'a Diagnostics,
    /// The parts of earlier scenes; also keeps those of this scene.
    pub(super) cache: Option<&'a AssetCache>,
    /// The digests of all nodes, if there is a cache.
    pub(super) digests: Option<Arc<NodeDigests>>,
    skip_missing: bool,
    budget: Arc<MemoryBudget>,
    log: Mutex<Log>,
}

/// The results of file requests.
#[derive(Default)]
struct Log {
    read: Vec<FileRead>,
    /// Files that were not found, and where the scene names them.
    not_found: Vec<(Span, NotFound)>,
}

/// A file that was read.
#[derive(Clone)]
pub(super) struct FileRead {
    /// Its name in the scene.
    pub(super) name: String,
    /// The place of that name in the scene.
    pub(super) span: Span,
    /// Its path on disk.
    pub(super) path: PathBuf,
    /// 128-bit XXH3 of its bytes. It takes a fifth of the time of BLAKE3, which was a sixteenth of
    /// loading a large scene. An accidental collision is practically impossible.
    pub(super) hash: u128,
}

/// The most missing files that get suggestions; each suggestion lists whole folders.
const SUGGESTED: usize = 20;

impl Debug for Assets<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Assets")
            .field("skip_missing", &self.skip_missing)
            .finish_non_exhaustive()
    }
}

/// A texture decoded ahead of the rest of the scene.
pub(super) struct Decoded<'a> {
    pub(super) parameters: Parameters<'a>,
    pub(super) texture: Option<Texture>,
}

/// A value made from a node, and a digest of all its inputs, including files.
#[derive(Clone)]
pub(super) struct Made<T> {
    pub(super) value: T,
    /// Zero without a cache.
    pub(super) digest: u128,
}

/// The geometry of a shape, built before its material.
pub(super) struct LoadedShape<'a> {
    pub(super) parameters: Parameters<'a>,
    pub(super) geometry: Option<Made<Geometry>>,
}

/// Everything that is built in parallel.
pub(super) struct Loaded<'a> {
    pub(super) geometry: HashMap<NodeId, LoadedShape<'a>>,
    pub(super) textures: HashMap<NodeId, Decoded<'a>>,
}

impl<'a> Assets<'a> {
    /// Assets without any files read.
    #[must_use]
    pub fn new(
        document: &'a Document,
        resources: &'a dyn Resources,
        diagnostics: &'a Diagnostics,
    ) -> Self {
        Self {
            document,
            resources,
            diagnostics,
            cache: None,
            digests: None,
            skip_missing: false,
            budget: Arc::new(MemoryBudget::new(u64::MAX)),
            log: Mutex::default(),
        }
    }

    /// Assets with the cache of `input`. A missing file is a warning if `options` say so.
    pub(super) fn of(
        input: &SceneInput<'a>,
        diagnostics: &'a Diagnostics,
        options: &BuildOptions,
    ) -> Self {
        Self {
            cache: input.cache.map(|cache| &**cache),
            digests: input.cache.map(|_| Arc::new(NodeDigests::new(input.document))),
            skip_missing: options.skip_missing,
            budget: Arc::new(MemoryBudget::new(options.memory_limit.unwrap_or(u64::MAX))),
            ..Self::new(input.document, input.resources, diagnostics)
        }
    }

    /// The same assets with a separate log and separate `diagnostics`.
    pub(super) fn recording<'b>(&'b self, diagnostics: &'b Diagnostics) -> Assets<'b> {
        Assets {
            diagnostics,
            digests: self.digests.clone(),
            budget: Arc::clone(&self.budget),
            log: Mutex::default(),
            ..*self
        }
    }

    /// Merges the log of [`Self::recording`]; returns the files that it read.
    pub(super) fn absorb(&self, recording: Assets<'_>) -> Vec<FileRead> {
        let Log { read, not_found } =
            recording.log.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.log().not_found.extend(not_found);
        self.note_files(read.clone());
        read
    }

    /// Records files as read.
    pub(super) fn note_files(&self, files: Vec<FileRead>) {
        self.log().read.extend(files);
    }

    /// Ignores poisoning: a panicking thread leaves no half-written entry.
    fn log(&self) -> MutexGuard<'_, Log> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Builds the geometry of all shapes and decodes all images in parallel.
    pub(super) fn load(&self) -> Loaded<'_> {
        let (pictures, shapes) = self.find();
        // Sizes differ by a factor of a thousand, so each file is a task.
        let (pictures, shapes) = rayon::join(
            || {
                let textures = |textures| self.load_textures(textures);
                pictures.into_par_iter().with_max_len(1).map(textures).collect::<Vec<_>>()
            },
            || {
                let shape = |&node| self.load_shape(node);
                shapes.par_iter().with_max_len(1).map(shape).collect::<Vec<_>>()
            },
        );
        let textures = pictures.into_iter().flatten();
        Loaded {
            geometry: shapes.into_iter().map(|shape| (shape.parameters.node(), shape)).collect(),
            textures: textures.map(|texture| (texture.parameters.node(), texture)).collect(),
        }
    }

    /// The nodes that are built early: image textures, grouped by file, and shapes with their own
    /// geometry.
    fn find(&self) -> (Vec<Vec<Parameters<'_>>>, Vec<NodeId>) {
        let is_composite = |plugin| COMPOSITE_SHAPES.iter().any(|entry| entry.name == plugin);
        let (mut shapes, mut textures) = (Vec::new(), Vec::new());
        for id in (0..self.document.nodes.len() as u32).map(NodeId) {
            let node = self.document.node(id);
            match (node.class, node.plugin.as_str()) {
                // A missing type was reported when the text was read.
                (_, "") => {}
                (Class::Shape, plugin) if !is_composite(plugin) => shapes.push(id),
                (Class::Texture, "bitmap") => textures.push(id),
                _ => {}
            }
        }
        // Finding a file may take long, so it runs in parallel. Textures without a file, or with a
        // missing one, stay single and report that.
        let textures: Vec<_> = textures
            .into_par_iter()
            .map(|texture| {
                let parameters = self.document.parameters(texture, self.diagnostics);
                (self.picture_file(&parameters).ok_or(texture), parameters)
            })
            .collect();
        let mut pictures = BTreeMap::<_, Vec<_>>::new();
        for (file, parameters) in textures {
            pictures.entry(file).or_default().push(parameters);
        }
        (pictures.into_values().collect(), shapes)
    }

    fn picture_file(&self, texture: &Parameters<'_>) -> Option<PathBuf> {
        if texture.has("data") {
            return None;
        }
        let (Value::String(name), span) = texture.value("filename")? else { return None };
        self.document.resolve(name, span, self.resources).ok()
    }

    /// The textures that share a file.
    fn load_textures<'p>(&self, all: Vec<Parameters<'p>>) -> Vec<Decoded<'p>> {
        let textures = bitmap::load(self, &all);
        let decoded = |(parameters, texture): (_, Option<_>)| {
            let texture = texture.map(Texture::Bitmap);
            Decoded { parameters, texture }
        };
        all.into_iter().zip(textures).map(decoded).collect()
    }

    fn load_shape(&self, id: NodeId) -> LoadedShape<'_> {
        let parameters = self.document.parameters(id, self.diagnostics);
        let geometry = find(SHAPES, &parameters).and_then(|build| {
            self.kept_with_digest(&parameters, &[], |assets, parameters| {
                let geometry = build(assets, parameters)?;
                assets.check_extent(&geometry, parameters.span());
                Some(geometry)
            })
        });
        LoadedShape { parameters, geometry }
    }

    /// The bytes of the file that the parameter `name` names, and its path; `None` after an error
    /// has been reported.
    #[must_use]
    pub fn read_file(&self, parameters: &Parameters<'_>, name: &str) -> Option<(PathBuf, Vec<u8>)> {
        let file_name = parameters.required_string(name)?;
        self.read_named_file(file_name, parameters.span_of(name))
    }

    /// The bytes of the file `file_name`, named at `span`. `None` if there is none, which is
    /// reported once the scene is complete, or after another error has been reported.
    #[must_use]
    pub fn read_named_file(&self, file_name: &str, span: Span) -> Option<(PathBuf, Vec<u8>)> {
        let path = match self.document.resolve(file_name, span, self.resources) {
            Ok(path) => path,
            Err(not_found) => {
                self.log().not_found.push((span, not_found));
                return None;
            }
        };
        match self.resources.read(&path) {
            Ok(bytes) if bytes.is_empty() => {
                let message = format!("the file `{}` is empty", path.display());
                self.diagnostics.error(Fault::Io, span, message);
                None
            }
            Ok(bytes) => {
                let (name, hash) = (file_name.to_owned(), xxh3_128(&bytes));
                self.log().read.push(FileRead { name, span, path: path.clone(), hash });
                Some((path, bytes))
            }
            Err(ResourceError::NotFound) => {
                let message = format!("no file `{}`", path.display());
                self.diagnostics.push(Diagnostic::new(self.missing(), Fault::Io, span, message));
                None
            }
            Err(error) => {
                let message = format!("cannot read `{}`: {error}", path.display());
                self.diagnostics.error(Fault::Io, span, message);
                None
            }
        }
    }

    /// The path of the file `file_name`, named at `span`. `None` if it is missing or there is no
    /// cache.
    pub(crate) fn find_kept_file(&self, file_name: &str, span: Span) -> Option<PathBuf> {
        self.cache?;
        self.document.resolve(file_name, span, self.resources).ok()
    }

    /// The value that an earlier scene made from a file by the method `way`.
    pub(crate) fn kept_of_file<T: Any + Clone + Send + Sync>(
        &self,
        path: &Path,
        way: &str,
    ) -> Option<T> {
        let kept = self.cache?.find::<OfFile<T>>(file_digest(path, way))?;
        self.note_files(vec![kept.file.clone()]);
        Some(kept.value.clone())
    }

    /// Keeps a value made from a file by the method `way`. The file has been read.
    pub(crate) fn keep_of_file<T: Any + Clone + Send + Sync>(
        &self,
        path: &Path,
        way: &str,
        value: &T,
    ) {
        let Some(cache) = self.cache else { return };
        let Some(file) = self.log().read.iter().rfind(|file| file.path == path).cloned() else {
            return;
        };
        let kept = OfFile { value: value.clone(), file };
        cache.keep(file_digest(path, way), Arc::new(kept), vec![path.to_owned()]);
    }

    /// Reports a shape without surfaces, and one whose bounds are not finite.
    pub(super) fn check_extent(&self, geometry: &Geometry, span: Span) {
        if geometry.primitive_count() == 0 {
            let message = "this mesh has no triangles: there is nothing of it to be seen";
            self.diagnostics.warning(Fault::Geometry, span, message);
        } else {
            self.check_bounds(&geometry.bounds(), span);
        }
    }

    /// Reports a shape whose bounds are not finite.
    pub(super) fn check_bounds(&self, bounds: &Bounds3, span: Span) {
        if !(bounds.min.is_finite() && bounds.max.is_finite()) {
            let message = "this shape reaches beyond what single precision can hold";
            self.diagnostics.error(Fault::Geometry, span, message);
        }
    }

    /// Reports the files that were not found, in document order. The first ones get suggestions of
    /// similar names. Call this once everything has been built.
    pub fn report_not_found(&self) {
        let mut list = std::mem::take(&mut self.log().not_found);
        list.sort_by_key(|(span, _)| *span);
        for (index, (span, not_found)) in list.iter().enumerate() {
            let mut diagnostic =
                Diagnostic::new(self.missing(), Fault::Io, *span, not_found.to_string());
            diagnostic.help = match index {
                0..SUGGESTED => not_found.help_with_near_names(self.resources),
                _ => not_found.help(),
            };
            self.diagnostics.push(diagnostic);
        }
    }

    /// The severity of a missing file.
    fn missing(&self) -> Severity {
        if self.skip_missing { Severity::Warning } else { Severity::Error }
    }

    /// Reads the mesh file of the parameter `filename` and transforms it; `None` after an error has
    /// been reported. `options` are read first, so that their errors are reported as well.
    #[must_use]
    pub fn read_mesh(
        &self,
        parameters: &Parameters<'_>,
        read: impl FnOnce(&Path, &[u8]) -> Result<TriangleMesh, MeshError>,
    ) -> Option<Mesh> {
        let options = MeshOptions::read(parameters);
        let (path, bytes) = self.read_file(parameters, "filename")?;
        let options = options?;
        let report = |fault, problem: &dyn fmt::Display| {
            let message = format!("{}: {problem}", path.display());
            parameters.error(fault, "filename", message);
        };
        let reading = MESH_READING_FACTOR.saturating_mul(bytes.len() as u64);
        self.budget.claim(reading).map_err(|exceeded| report(Fault::Limit, &exceeded)).ok()?;
        let placed = read(&path, &bytes).and_then(|mesh| Mesh::new(mesh, &options));
        self.budget.release(reading);
        let mesh = placed.map_err(|error| report(Fault::Geometry, &error)).ok()?;
        let kept = mesh.memory_bytes() + TREE_BYTES_PER_TRIANGLE * mesh.triangles().len();
        self.budget.claim(kept as u64).map_err(|exceeded| report(Fault::Limit, &exceeded)).ok()?;
        Some(mesh)
    }

    /// Decodes a picture of which something else is made that takes `bytes_per_pixel`, or none if the
    /// samples are kept as they are; if the memory for it is left.
    ///
    /// # Errors
    ///
    /// Why not, with the class of the fault.
    pub(crate) fn decode_picture(
        &self,
        (path, bytes): (&Path, &[u8]),
        bytes_per_pixel: u64,
    ) -> Result<Bitmap, (Fault, String)> {
        let name = path.to_string_lossy();
        let explain =
            |error: &ImageError| (fault_of(error), format!("{}: {error}", path.display()));
        let header = read_header(bytes, &name).map_err(|error| explain(&error))?;
        let PictureHeader { width, height, decoded_bytes, decoding_bytes } = header;
        let kept = decoded_bytes.max(bytes_per_pixel * u64::from(width) * u64::from(height));
        // What is decoded and what is made of it are in memory together.
        let made = if bytes_per_pixel > 0 { kept } else { 0 };
        let needed = decoding_bytes.max(decoded_bytes.saturating_add(made));
        self.budget.claim(needed).map_err(|exceeded| {
            let shown = path.display();
            (Fault::Limit, format!("{shown}: a picture of {width}x{height} pixels: {exceeded}"))
        })?;
        let decoded = decode(bytes, &name);
        self.budget.release(needed - kept.min(needed));
        decoded.map_err(|error| explain(&error))
    }

    /// The hash of all inputs of the scene: its texts or nodes, and every file read.
    pub(super) fn content_hash(&self, identity: Identity) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        let texts = self.document.sources.iter();
        let has_texts = self.document.sources.iter().next().is_some();
        if identity == Identity::Texts && has_texts {
            for piece in texts.flat_map(|source| source.pieces()) {
                hasher.update(&piece);
            }
        } else {
            self.document.for_each_byte(|bytes| {
                hasher.update(bytes);
            });
        }
        // Each file once, in an order that does not depend on threads.
        let log = self.log();
        let hashes: BTreeMap<&Path, u128> =
            log.read.iter().map(|file| (file.path.as_path(), file.hash)).collect();
        for hash in hashes.values() {
            hasher.update(&hash.to_le_bytes());
        }
        hasher.finalize().into()
    }
}

/// The memory for reading a mesh, in sizes of its file: two copies of the arrays of a binary file.
const MESH_READING_FACTOR: u64 = 2;

/// The memory for building a tree, per triangle. A finished tree takes half of it.
const TREE_BYTES_PER_TRIANGLE: usize = 100;

/// Classifies the error of a picture that cannot be read.
fn fault_of(error: &ImageError) -> Fault {
    match error {
        ImageError::UnknownFormat { .. } | ImageError::Unsupported { .. } => Fault::Unsupported,
        ImageError::TooLarge { .. } | ImageError::NoMemory { .. } => Fault::Limit,
        _ => Fault::Syntax,
    }
}

/// A value made from a file, and the file.
struct OfFile<T> {
    value: T,
    file: FileRead,
}

fn file_digest(path: &Path, way: &str) -> u128 {
    let mut digest = Digest::default();
    digest.path(path);
    digest.text(way);
    digest.finish()
}
