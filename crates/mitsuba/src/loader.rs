//! The state while a scene is read.

use std::path::{Path, PathBuf};

use etendue_document::{
    Diagnostics, DocumentBuilder, Resolver, Resources, SourceId, Sources, Span,
};

use crate::defines::Defines;
use crate::element::Element;
use crate::options::LoadOptions;
use crate::origin::Origin;
use crate::upgrade::Versions;

/// A file being read, and where it was included.
pub(crate) struct OpenFile {
    pub(crate) path: PathBuf,
    pub(crate) included_at: Option<Span>,
}

/// The state while a scene is read.
pub(crate) struct Loader<'a> {
    pub(crate) resources: &'a dyn Resources,
    pub(crate) options: &'a LoadOptions,
    pub(crate) diagnostics: &'a Diagnostics,
    pub(crate) sources: Sources,
    pub(crate) resolver: Resolver,
    pub(crate) defines: Defines,
    /// The file that is being read.
    pub(crate) source: SourceId,
    /// Where the parsed piece starts in that file.
    pub(crate) origin: Origin,
    /// That file and the chain of files that include it.
    pub(crate) open_files: Vec<OpenFile>,
    pub(crate) include_count: usize,
    pub(crate) missing_includes: usize,
    pub(crate) total_bytes: usize,
    /// The major version that each file states.
    pub(crate) versions: Versions,
    /// The nodes so far.
    pub(crate) builder: DocumentBuilder<'a>,
    /// The nesting depth of the current element.
    pub(crate) depth: usize,
    /// A limit was reached; reading stops.
    pub(crate) stopped: bool,
}

impl<'a> Loader<'a> {
    pub(crate) fn new(
        resources: &'a dyn Resources,
        options: &'a LoadOptions,
        diagnostics: &'a Diagnostics,
    ) -> Self {
        let resolver = Resolver {
            search_paths: options.search_paths.clone(),
            working_directory: options.working_directory.clone(),
            ..Resolver::default()
        };
        Self {
            resources,
            options,
            diagnostics,
            sources: Sources::default(),
            resolver,
            defines: Defines::new(&options.defines, options.limits.expansion_bytes),
            source: SourceId::default(),
            origin: Origin::default(),
            open_files: Vec::new(),
            include_count: 0,
            missing_includes: 0,
            total_bytes: 0,
            versions: Versions::new(),
            builder: DocumentBuilder::new(options.limits.document.clone(), diagnostics),
            depth: 0,
            stopped: false,
        }
    }

    /// Expands an element's attributes.
    pub(crate) fn open<'b>(&mut self, node: roxmltree::Node<'b, 'b>) -> Element<'b> {
        let element = Element::open(node, &self.origin, &mut self.defines, self.diagnostics);
        self.stopped |= self.defines.exhausted;
        element
    }

    /// Stores a text, with the folder of its file.
    pub(crate) fn add_source(
        &mut self,
        name: String,
        text: String,
        folder: Option<&Path>,
    ) -> SourceId {
        let folder = folder.unwrap_or(&self.options.working_directory);
        self.resolver.source_folders.push(folder.to_path_buf());
        self.sources.add(name, text)
    }

    /// Whether the file being read is of version 0.x.
    pub(crate) fn is_old(&self) -> bool {
        self.versions.get(&self.source) == Some(&0)
    }

    /// The folder of the file being read.
    pub(crate) fn source_folder(&self) -> &Path {
        &self.resolver.source_folders[self.source.index()]
    }
}
