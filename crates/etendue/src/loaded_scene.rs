//! A scene that can be rendered, and what its edits need of it.

use std::path::Path;
use std::sync::Arc;

use etendue_document::{Diagnostics, Document, Resources, Sources, normalise};
use etendue_integrators::{Integrator, build_integrator};
use etendue_scene::{AssetCache, BuildOptions, Identity, Scene, SceneInput, gather_scene};

use crate::options::SceneOptions;

/// A scene and how its light is computed. Clones are cheap and share everything.
#[derive(Clone)]
pub struct LoadedScene {
    /// What light meets.
    pub scene: Arc<Scene>,
    /// How it is computed.
    pub integrator: Arc<dyn Integrator>,
    /// What the user decided over what the scene says, by name: with the scene's own hash it tells
    /// whether two renders are of the same picture.
    pub settings: Arc<[(String, String)]>,
    pub(crate) options: Arc<SceneOptions>,
    pub(crate) editable: Option<Editable>,
}

/// What an edit needs of the scene before.
#[derive(Clone)]
pub(crate) struct Editable {
    document: Arc<Document>,
    pub(crate) cache: Arc<AssetCache>,
}

/// What a scene is built from.
pub(crate) struct Input {
    pub(crate) document: Arc<Document>,
    pub(crate) identity: Identity,
    /// Where there is one, the document is kept, too.
    pub(crate) cache: Option<Arc<AssetCache>>,
}

impl LoadedScene {
    /// The document that the scene was built from, if [`SceneOptions::editable`] asked for it to be
    /// kept.
    pub fn document(&self) -> Option<&Arc<Document>> {
        self.editable.as_ref().map(|editable| &editable.document)
    }

    /// What to do when a file has changed: the next edit reads it again. `path` is where the scene's
    /// names lead, which is absolute if the scene's working directory was.
    pub fn forget_file(&self, path: &Path) {
        if let Some(editable) = &self.editable {
            editable.cache.forget_file(&normalise(path));
        }
    }

    /// What to do when any file may have changed: the next edit reads all of them again.
    pub fn forget_files(&self) {
        if let Some(editable) = &self.editable {
            editable.cache.forget_all();
        }
    }
}

impl Input {
    /// Builds what there is to render; returns the texts that it was read from, too.
    pub(crate) fn build(
        self,
        resources: &dyn Resources,
        diagnostics: &Diagnostics,
        options: &Arc<SceneOptions>,
    ) -> (Option<LoadedScene>, Sources) {
        let Self { document, identity, cache } = self;
        if identity == Identity::Nodes && !document.check(diagnostics) {
            return (None, document.sources.clone());
        }
        let input = SceneInput { document: &document, resources, identity, cache: cache.as_ref() };
        // Both, whatever becomes of the first: one run finds the mistakes of both.
        let gathered = gather_scene(&input, diagnostics, &options.build);
        let integrator = build_integrator(&document, &options.integrator, diagnostics);
        let kept = Arc::clone(&document);
        let editable = cache.map(|cache| Editable { document: kept, cache });
        // Of a million instances, the document would stand beside the tree while that is built.
        let sources = match Arc::try_unwrap(document) {
            Ok(document) => document.into_sources(),
            Err(shared) => shared.sources.clone(),
        };
        let scene = gathered.and_then(|gathered| gathered.build(diagnostics));
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

/// What changes the picture. Where files are sought does not: their content is in the scene's hash.
fn settings(options: &SceneOptions) -> Vec<(String, String)> {
    // Which instructions rays use does not change the hits.
    let build = BuildOptions { tier: None, ..options.build.clone() };
    // As the compiler writes them out, so that an option that is added is not forgotten here.
    let settings = [
        ("definitions", format!("{:?}", options.defines)),
        ("scene options", format!("{build:?}")),
        ("integrator options", format!("{:?}", options.integrator)),
    ];
    settings.map(|(name, value)| (name.to_owned(), value)).into()
}
