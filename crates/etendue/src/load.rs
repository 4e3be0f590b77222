//! From a scene file to a scene that can be rendered.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use etendue_document::{
    Diagnostics, Document, DocumentOptions, Node, Resolver, Resources, Sources,
};
use etendue_integrators::{Integrator, build_integrator};
use etendue_mitsuba::LoadOptions;
use etendue_scene::{BuildOptions, Scene, gather_scene};

use crate::{DiagnosticReport, SceneOptions};

/// A scene that has been read.
pub struct Loaded {
    /// What there is to render; `None` if there were errors.
    pub content: Option<LoadedScene>,
    /// Errors and warnings.
    pub diagnostics: DiagnosticReport,
    /// How long it took.
    pub times: LoadTimes,
}

/// A scene and how its light is computed.
pub struct LoadedScene {
    /// What light meets.
    pub scene: Scene,
    /// How it is computed.
    pub integrator: Box<dyn Integrator>,
    /// What the user decided over what the scene says, by name: with the scene's own hash it tells
    /// whether two renders are of the same picture.
    pub settings: Vec<(String, String)>,
}

/// Wall time of loading, by part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadTimes {
    /// From text to document.
    pub document: Duration,
    /// From document to scene: meshes, textures, acceleration structures.
    pub scene: Duration,
}

/// Reads a scene file with everything that it names.
///
/// Errors do not end it early where it can go on, so that one run finds them all. Parallel parts
/// run on the current thread pool: call it within [`crate::Workers::run`]. Relative paths start at
/// `working_directory`.
pub fn load(
    path: &Path,
    working_directory: PathBuf,
    resources: &dyn Resources,
    options: &SceneOptions,
) -> Loaded {
    let load_options = load_options(working_directory, options);
    load_with(resources, options, |diagnostics| {
        etendue_mitsuba::read_file(path, resources, &load_options, diagnostics)
    })
}

/// The same for a scene in memory. The files that it names are sought in `working_directory`.
pub fn load_text(
    text: &str,
    working_directory: PathBuf,
    resources: &dyn Resources,
    options: &SceneOptions,
) -> Loaded {
    let load_options = load_options(working_directory, options);
    load_with(resources, options, |diagnostics| {
        etendue_mitsuba::read_text(text, resources, &load_options, diagnostics)
    })
}

/// The same for a scene that was built in code. The files that it names are sought in
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

fn load_options(working_directory: PathBuf, options: &SceneOptions) -> LoadOptions {
    LoadOptions {
        defines: options.defines.clone(),
        search_paths: options.search_paths.clone(),
        working_directory,
        ..LoadOptions::default()
    }
}

fn load_with(
    resources: &dyn Resources,
    options: &SceneOptions,
    read: impl FnOnce(&Diagnostics) -> Result<Document, Sources>,
) -> Loaded {
    let diagnostics = if options.strict { Diagnostics::strict() } else { Diagnostics::new() };
    let started = Instant::now();
    let document = read(&diagnostics);
    let document_time = started.elapsed();
    let (content, sources) = match document {
        Ok(document) => build(document, resources, &diagnostics, options),
        Err(sources) => (None, sources),
    };
    let content = content.filter(|_| !diagnostics.has_errors());
    let times = LoadTimes {
        document: document_time,
        scene: started.elapsed().saturating_sub(document_time),
    };
    Loaded { content, diagnostics: DiagnosticReport::new(&diagnostics, sources), times }
}

/// What there is to render, and the texts that it was read from.
fn build(
    document: Document,
    resources: &dyn Resources,
    diagnostics: &Diagnostics,
    options: &SceneOptions,
) -> (Option<LoadedScene>, Sources) {
    // Both, whatever becomes of the first: one run finds the mistakes of both.
    let gathered = gather_scene(&document, resources, diagnostics, &options.build);
    let integrator = build_integrator(&document, &options.integrator, diagnostics);
    // Of a million instances, the document would stand beside the tree while that is built.
    let sources = document.into_sources();
    let scene = gathered.and_then(|gathered| gathered.build(diagnostics));
    let content = scene.zip(integrator).map(|(scene, integrator)| LoadedScene {
        scene,
        integrator,
        settings: settings(options),
    });
    (content, sources)
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
