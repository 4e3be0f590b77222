//! Edits: builds the scene of a changed document and shares what has not changed.

use std::sync::Arc;

use etendue_document::{Document, Resources};
use etendue_scene::Identity;

use crate::load::{self, Loaded};
use crate::loaded_scene::{Input, LoadedScene};

impl LoadedScene {
    /// Builds the scene of another document, usually this scene's [`Self::document`] with a few
    /// changes. It uses the options this scene was loaded with.
    ///
    /// The result is bit-identical to what [`load_document`](crate::load_document) makes of the
    /// document. If this scene is [editable](crate::SceneOptions::editable), the new scene shares
    /// what has not changed: geometry, pictures and grids, and the tree unless a shape, an instance
    /// or its transform has changed. A new sensor, film, integrator, material or light then takes
    /// milliseconds. This scene is not modified and may be rendered meanwhile.
    ///
    /// Files on disk are assumed to be unchanged; call [`Self::forget_file`] or
    /// [`Self::forget_files`] if they are not.
    ///
    /// ```
    /// use etendue::document::{MemoryResources, Value};
    /// use etendue::{SceneOptions, load_text};
    ///
    /// let text = r#"<scene version="3.0.0">
    ///     <sensor type="perspective"/>
    ///     <emitter type="constant"/>
    ///     <shape type="sphere"><bsdf type="roughconductor"><float name="alpha" value="0.1"/></bsdf></shape>
    /// </scene>"#;
    /// let files = MemoryResources::default();
    /// let options = SceneOptions { editable: true, ..SceneOptions::default() };
    /// let smooth = load_text(text, "".into(), &files, &options).scene.unwrap();
    ///
    /// let mut document = (**smooth.document().unwrap()).clone();
    /// let metal = document.nodes.iter_mut().find(|node| node.plugin == "roughconductor").unwrap();
    /// metal.parameters[0].value = Value::Float(0.5);
    /// let rough = smooth.edited(document, &files).scene.unwrap();
    /// assert_ne!(smooth.scene.content_hash(), rough.scene.content_hash());
    /// ```
    pub fn edited(&self, document: impl Into<Arc<Document>>, resources: &dyn Resources) -> Loaded {
        let cache = self.editable.as_ref().map(|editable| Arc::new(editable.cache.next()));
        let input = Input { document: document.into(), identity: Identity::Nodes, cache };
        load::build(input, resources, &self.options)
    }
}
