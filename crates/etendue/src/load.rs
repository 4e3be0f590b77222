//! Loading: from a scene file, a text or a document to a scene that can be rendered.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use etendue_document::{
    Diagnostics, Document, DocumentOptions, Node, Resolver, Resources, Sources,
};
use etendue_scene::{AssetCache, Identity};

use crate::diagnostic_report::DiagnosticReport;
use crate::format::{self, ReadContext, SceneSource};
use crate::loaded_scene::{Input, LoadedScene};
use crate::options::SceneOptions;

/// The result of loading a scene.
pub struct Loaded {
    /// The scene; `None` if there were errors.
    pub scene: Option<LoadedScene>,
    /// Errors and warnings.
    pub diagnostics: DiagnosticReport,
    /// How long loading took.
    pub times: LoadTimes,
}

/// Wall time of loading, by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadTimes {
    /// From text to document.
    pub document: Duration,
    /// From document to scene: meshes, textures, acceleration structures.
    pub scene: Duration,
}

/// Reads a scene file and everything it names. The [`Format`](crate::Format) is detected by the
/// first bytes of the file, or else by its extension.
///
/// Loading continues after an error where it can, so that one run reports them all. Parallel parts
/// run on the current thread pool: call this within [`crate::Workers::run`]. Relative paths start
/// at `working_directory`.
pub fn load(
    path: &Path,
    working_directory: PathBuf,
    resources: &dyn Resources,
    options: &SceneOptions,
) -> Loaded {
    load_source(&SceneSource::File(path), &working_directory, resources, options)
}

/// Like [`load`], for a scene in memory. The files it names are looked up in `working_directory`.
pub fn load_text(
    text: &str,
    working_directory: PathBuf,
    resources: &dyn Resources,
    options: &SceneOptions,
) -> Loaded {
    load_source(&SceneSource::Text(text), &working_directory, resources, options)
}

/// Like [`load`], for a scene built in code. The files it names are looked up in
/// `working_directory`, and diagnostics name nodes by their paths.
pub fn load_node(
    scene: Node,
    working_directory: PathBuf,
    resources: &dyn Resources,
    options: &SceneOptions,
) -> Loaded {
    let search_paths = options.search_paths.clone();
    let resolver = Resolver { search_paths, working_directory, ..Resolver::default() };
    let document_options = DocumentOptions { resolver, ..DocumentOptions::default() };
    load_with(resources, options, |diagnostics| {
        Ok(Document::build(scene, &document_options, diagnostics))
    })
}

/// Like [`load`], for a document built in code, or changed after it was read.
pub fn load_document(
    document: impl Into<Arc<Document>>,
    resources: &dyn Resources,
    options: &SceneOptions,
) -> Loaded {
    let cache = new_cache(options);
    let input = Input { document: document.into(), identity: Identity::Nodes, cache };
    build(input, resources, &Arc::new(options.clone()))
}

/// Builds the scene of an existing document.
pub(crate) fn build(
    input: Input,
    resources: &dyn Resources,
    options: &Arc<SceneOptions>,
) -> Loaded {
    let diagnostics = new_diagnostics(options);
    let started = Instant::now();
    let (scene, sources) = input.build(resources, &diagnostics, options);
    let times = LoadTimes { document: Duration::ZERO, scene: started.elapsed() };
    Loaded::new(scene, &diagnostics, sources, times)
}

fn load_source(
    source: &SceneSource<'_>,
    working_directory: &Path,
    resources: &dyn Resources,
    options: &SceneOptions,
) -> Loaded {
    load_with(resources, options, |diagnostics| {
        format::read(source, &ReadContext { resources, working_directory, options, diagnostics })
    })
}

fn load_with(
    resources: &dyn Resources,
    options: &SceneOptions,
    read: impl FnOnce(&Diagnostics) -> Result<Document, Sources>,
) -> Loaded {
    let diagnostics = new_diagnostics(options);
    let started = Instant::now();
    let document = read(&diagnostics);
    let document_time = started.elapsed();
    let (scene, sources) = match document {
        Ok(document) => {
            let (document, cache) = (Arc::new(document), new_cache(options));
            let input = Input { document, identity: Identity::Texts, cache };
            input.build(resources, &diagnostics, &Arc::new(options.clone()))
        }
        Err(sources) => (None, sources),
    };
    let scene_time = started.elapsed().saturating_sub(document_time);
    let times = LoadTimes { document: document_time, scene: scene_time };
    Loaded::new(scene, &diagnostics, sources, times)
}

fn new_diagnostics(options: &SceneOptions) -> Diagnostics {
    if options.strict { Diagnostics::strict() } else { Diagnostics::new() }
}

fn new_cache(options: &SceneOptions) -> Option<Arc<AssetCache>> {
    options.editable.then(Arc::default)
}

impl Loaded {
    fn new(
        scene: Option<LoadedScene>,
        diagnostics: &Diagnostics,
        sources: Sources,
        times: LoadTimes,
    ) -> Self {
        Self {
            scene: scene.filter(|_| !diagnostics.has_errors()),
            diagnostics: DiagnosticReport::new(diagnostics, sources),
            times,
        }
    }
}
