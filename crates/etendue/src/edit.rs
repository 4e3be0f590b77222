//! Edits: from a scene and a changed document to a scene that shares what has not changed.

use std::sync::Arc;

use etendue_document::{Document, Resources};
use etendue_scene::Identity;

use crate::load::{self, Loaded};
use crate::loaded_scene::{Input, LoadedScene};

impl LoadedScene {
    /// The scene of another document, mostly this one's [`Self::document`] with a few changes. The
    /// options are those that this scene was loaded with.
    ///
    /// The result is the scene that [`load_document`](crate::load_document) makes of the document,
    /// to the bit. What has not changed is shared with this scene if it is
    /// [editable](crate::SceneOptions::editable): geometry, pictures, grids, and the tree unless a
    /// shape, an instance or its place has changed. A new sensor, film, integrator, material or light
    /// then takes milliseconds. This scene stays as it is and may be rendered meanwhile.
    ///
    /// Files on disk are taken to be unchanged; [`Self::forget_file`] and [`Self::forget_files`] say
    /// otherwise.
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
