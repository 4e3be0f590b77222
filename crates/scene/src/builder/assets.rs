//! Files: found, read, hashed and decoded, several at once.

use crate::models::mesh::{Mesh, MeshOptions};
use crate::registry::{self, find};
use crate::shape::Geometry;
use crate::texture::{Texture, bitmap};
use etendue_document::{
    Class, Diagnostic, Diagnostics, Document, Fault, NodeId, NotFound, Parameters, ResourceError,
    Resources, Severity, Span, Value,
};
use etendue_math::Bounds3;
use etendue_mesh::{MeshError, TriangleMesh};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use std::fmt::{self, Debug};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use xxhash_rust::xxh3::xxh3_128;

/// What plugins are built from: the document, bytes by name, and where findings go.
pub struct Assets<'a> {
    /// What the user wrote.
    pub document: &'a Document,
    /// Bytes by name.
    pub resources: &'a dyn Resources,
    /// Where errors and warnings go.
    pub diagnostics: &'a Diagnostics,
    skip_missing: bool,
    /// A hash of every file read so far: XXH3 with 128 bits, which takes a fifth of the time of
    /// BLAKE3. That was a sixteenth of loading a large scene. Chance cannot make two files agree.
    hashes: Mutex<BTreeMap<PathBuf, u128>>,
    /// Files that were not found, and where they are named.
    not_found: Mutex<Vec<(Span, NotFound)>>,
}

/// Near names are sought for this many missing files: for each, whole folders are listed.
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

/// The geometry of a shape, built ahead of its material.
pub(super) struct LoadedShape<'a> {
    pub(super) parameters: Parameters<'a>,
    pub(super) geometry: Option<Geometry>,
}

/// Everything that could be built in parallel.
pub(super) struct Loaded<'a> {
    pub(super) geometry: HashMap<NodeId, LoadedShape<'a>>,
    pub(super) textures: HashMap<NodeId, Decoded<'a>>,
}

impl<'a> Assets<'a> {
    /// Nothing read yet.
    #[must_use]
    pub fn new(
        document: &'a Document,
        resources: &'a dyn Resources,
        diagnostics: &'a Diagnostics,
        skip_missing: bool,
    ) -> Self {
        Self {
            document,
            resources,
            diagnostics,
            skip_missing,
            hashes: Mutex::default(),
            not_found: Mutex::default(),
        }
    }

    /// Builds the geometry of all shapes and decodes all pictures, several at once.
    pub(super) fn load(&self) -> Loaded<'_> {
        let (pictures, shapes) = self.find();
        // Sizes differ by a thousand: each file is stolen alone.
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

    /// What is built ahead of the nodes that hold it: the textures that show pictures, those of each
    /// file together, and shapes with geometry of their own.
    fn find(&self) -> (Vec<Vec<Parameters<'_>>>, Vec<NodeId>) {
        let is_composite =
            |plugin| registry::COMPOSITE_SHAPES.iter().any(|entry| entry.name == plugin);
        let (mut shapes, mut textures) = (Vec::new(), Vec::new());
        for id in (0..self.document.nodes.len() as u32).map(NodeId) {
            let node = self.document.node(id);
            match (node.class, node.plugin.as_str()) {
                // The lack of a type has been reported where the text was read.
                (_, "") => {}
                (Class::Shape, plugin) if !is_composite(plugin) => shapes.push(id),
                (Class::Texture, "bitmap") => textures.push(id),
                _ => {}
            }
        }
        // To look for a file may take long: several at once. Textures that name none, or one that is
        // missing, stay alone and report that.
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

    /// The textures that show one file.
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
        let build = find(registry::SHAPES, &parameters);
        let geometry = build.and_then(|build| build(self, &parameters));
        if let Some(geometry) = &geometry {
            self.check_extent(geometry, parameters.span());
        }
        LoadedShape { parameters, geometry }
    }

    /// The bytes of the file that the parameter `name` names, and where it was found; `None` after
    /// reporting what went wrong.
    #[must_use]
    pub fn read_file(&self, parameters: &Parameters<'_>, name: &str) -> Option<(PathBuf, Vec<u8>)> {
        let file_name = parameters.required_string(name)?;
        self.read_named_file(file_name, parameters.span_of(name))
    }

    /// The bytes of the file that is called `file_name` at `span`; `None` where there is none, which
    /// is reported when the scene is complete, and after reporting what else went wrong.
    #[must_use]
    pub fn read_named_file(&self, file_name: &str, span: Span) -> Option<(PathBuf, Vec<u8>)> {
        let path = match self.document.resolve(file_name, span, self.resources) {
            Ok(path) => path,
            Err(not_found) => {
                self.not_found
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .push((span, not_found));
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
                self.remember(&path, &bytes);
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

    /// Reports a shape without any surface, and one that reaches beyond all numbers.
    pub(super) fn check_extent(&self, geometry: &Geometry, span: Span) {
        if geometry.primitive_count() == 0 {
            let message = "this mesh has no triangles: there is nothing of it to be seen";
            self.diagnostics.warning(Fault::Geometry, span, message);
        } else {
            self.check_bounds(&geometry.bounds(), span);
        }
    }

    /// Reports a shape that reaches beyond all numbers.
    pub(super) fn check_bounds(&self, bounds: &Bounds3, span: Span) {
        if !(bounds.min.is_finite() && bounds.max.is_finite()) {
            let message = "this shape reaches beyond what single precision can hold";
            self.diagnostics.error(Fault::Geometry, span, message);
        }
    }

    /// Reports the files that were not found, in the order of the page, those that come first with
    /// the names of files that resemble them. To be called when everything has been built.
    pub fn report_not_found(&self) {
        let mut list =
            std::mem::take(&mut *self.not_found.lock().unwrap_or_else(PoisonError::into_inner));
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

    /// How bad a missing file is.
    fn missing(&self) -> Severity {
        if self.skip_missing { Severity::Warning } else { Severity::Error }
    }

    /// Reads the file that `filename` names as a mesh, and places it; `None` after reporting what
    /// went wrong. `options` are read first, so that their mistakes show as well.
    #[must_use]
    pub fn read_mesh(
        &self,
        parameters: &Parameters<'_>,
        read: impl FnOnce(&Path, &[u8]) -> Result<TriangleMesh, MeshError>,
    ) -> Option<Mesh> {
        let options = MeshOptions::read(parameters);
        let (path, bytes) = self.read_file(parameters, "filename")?;
        let options = options?;
        let placed = read(&path, &bytes).and_then(|mesh| Mesh::new(mesh, &options));
        placed
            .map_err(|error| {
                let message = format!("{}: {error}", path.display());
                parameters.error(Fault::Geometry, "filename", message);
            })
            .ok()
    }

    fn remember(&self, path: &Path, bytes: &[u8]) {
        let hash = xxh3_128(bytes);
        // A panic elsewhere cannot leave the map half written.
        self.hashes.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned(), hash);
    }

    /// The hash of everything the scene was built from: the texts, or the nodes where there are none,
    /// and every file read.
    pub(super) fn content_hash(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        for source in self.document.sources.iter() {
            for piece in source.pieces() {
                hasher.update(&piece);
            }
        }
        // What was built in code has no text.
        if self.document.sources.iter().next().is_none() {
            self.document.for_each_byte(|bytes| {
                hasher.update(bytes);
            });
        }
        for hash in self.hashes.lock().unwrap_or_else(PoisonError::into_inner).values() {
            hasher.update(&hash.to_le_bytes());
        }
        hasher.finalize().into()
    }
}
