//! A scene that can be rendered, and what its edits reuse.

use std::path::Path;
use std::sync::Arc;

use etendue_document::{Diagnostic, Diagnostics, Document, Fault, Resources, Sources, normalise};
use etendue_integrators::{Integrator, build_integrator};
use etendue_scene::{AssetCache, BuildOptions, Identity, Scene, SceneInput, gather_scene};

use crate::development::hexadecimal;
use crate::lenient::replace_unknown;
use crate::options::SceneOptions;

/// A scene and its integrator. Clones are cheap and share everything.
#[derive(Clone)]
pub struct LoadedScene {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The integrator.
    pub integrator: Arc<dyn Integrator>,
    /// The user's choices that override the scene's, by name. Together with the scene's hash, they
    /// tell whether two renders are of the same picture.
    pub settings: Arc<[(String, String)]>,
    pub(crate) options: Arc<SceneOptions>,
    pub(crate) editable: Option<Editable>,
}

/// What an edit needs from the previous scene.
#[derive(Clone)]
pub(crate) struct Editable {
    document: Arc<Document>,
    pub(crate) cache: Arc<AssetCache>,
}

/// What a scene is built from.
pub(crate) struct Input {
    pub(crate) document: Arc<Document>,
    pub(crate) identity: Identity,
    /// If present, the document is kept too.
    pub(crate) cache: Option<Arc<AssetCache>>,
}

impl LoadedScene {
    /// The document the scene was built from, if [`SceneOptions::editable`] asked to keep it.
    pub fn document(&self) -> Option<&Arc<Document>> {
        self.editable.as_ref().map(|editable| &editable.document)
    }

    /// A hash of the scene and the files that it names, in hexadecimal, as pictures and parts hold it.
    pub fn hash(&self) -> String {
        hexadecimal(&self.scene.content_hash())
    }

    /// Call this when a file has changed: the next edit reads it again. `path` is the path the
    /// scene's file name resolves to, which is absolute if the scene's working directory was.
    pub fn forget_file(&self, path: &Path) {
        if let Some(editable) = &self.editable {
            editable.cache.forget_file(&normalise(path));
        }
    }

    /// Call this when any file may have changed: the next edit reads all of them again.
    pub fn forget_files(&self) {
        if let Some(editable) = &self.editable {
            editable.cache.forget_all();
        }
    }
}

impl Input {
    /// Builds the scene and the integrator; also returns the source texts.
    pub(crate) fn build(
        self,
        resources: &dyn Resources,
        diagnostics: &Diagnostics,
        options: &Arc<SceneOptions>,
    ) -> (Option<LoadedScene>, Sources) {
        let Self { mut document, identity, cache } = self;
        if options.lenient {
            replace_unknown(Arc::make_mut(&mut document), diagnostics);
        }
        if identity == Identity::Nodes && !document.check(diagnostics) {
            return (None, document.sources.clone());
        }
        let input = SceneInput { document: &document, resources, identity, cache: cache.as_ref() };
        // Build both even if the first fails, so that one run reports the errors of both.
        let gathered = gather_scene(&input, diagnostics, &options.build);
        let integrator = build_integrator(&document, &options.integrator, diagnostics);
        let kept = Arc::clone(&document);
        let editable = cache.map(|cache| Editable { document: kept, cache });
        // With a million instances, keeping the document would add to the peak memory of the tree
        // build.
        let sources = match Arc::try_unwrap(document) {
            Ok(document) => document.into_sources(),
            Err(shared) => shared.sources.clone(),
        };
        let scene = gathered.and_then(|gathered| gathered.build(diagnostics));
        if let (Some(scene), Some(integrator)) = (&scene, &integrator) {
            warn_of_darkness(scene, &**integrator, diagnostics);
        }
        let loaded = scene.zip(integrator).map(|(scene, integrator)| LoadedScene {
            scene: Arc::new(scene),
            integrator: integrator.into(),
            settings: settings(options).into(),
            options: Arc::clone(options),
            editable,
        });
        (loaded, sources)
    }
}

/// Warns about a scene that renders black.
fn warn_of_darkness(scene: &Scene, integrator: &dyn Integrator, diagnostics: &Diagnostics) {
    if scene.has_light() || !integrator.needs_light() {
        return;
    }
    let message = match scene.emitter_count() {
        0 => "the scene has no emitter: the picture will be black",
        _ => "all emitters of the scene are black: the picture will be black",
    };
    diagnostics.push(
        Diagnostic::warning(Fault::MissingParameter, None, message)
            .help("`<emitter type=\"constant\"/>` surrounds it with white light"),
    );
}

/// The options that change the picture. Search paths do not; the content of files is in the scene's
/// hash.
fn settings(options: &SceneOptions) -> Vec<(String, String)> {
    // The instruction set used for rays does not change the hits, and a memory limit changes nothing.
    let build = BuildOptions { tier: None, memory_limit: None, ..options.build.clone() };
    // Use the derived `Debug` output, so that new options are included automatically.
    let settings = [
        ("definitions", format!("{:?}", options.defines)),
        ("scene options", format!("{build:?}")),
        ("integrator options", format!("{:?}", options.integrator)),
    ];
    let lenient = options.lenient.then(|| ("unknown plugins", "replaced".to_owned()));
    settings.into_iter().chain(lenient).map(|(name, value)| (name.to_owned(), value)).collect()
}
