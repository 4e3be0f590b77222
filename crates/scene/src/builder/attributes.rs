//! Mesh attributes: which of them textures read, and where.

use super::Builder;
use crate::ids::ShapeId;
use crate::shape::{Geometry, Shape};
use crate::texture::Texture;
use crate::texture::mesh_attribute::TriangleValues;
use etendue_document::{Class, Fault, NodeId, Parameters, Value, list_names};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

/// The attributes that the textures of a shape read, by the owner of the texture.
#[derive(Default)]
struct Wanted {
    by_materials: BTreeSet<String>,
    by_lights: BTreeSet<String>,
}

impl Builder<'_> {
    /// Keeps only the mesh attributes that its material reads, and reports missing ones.
    pub(super) fn keep_attributes(&self, shape: &Parameters<'_>, geometry: &mut Geometry) {
        let wanted = self.wanted_attributes(shape.node());
        if !wanted.by_lights.is_empty() {
            let message = "a light cannot be coloured by the attributes of its mesh";
            shape.diagnostics().error(Fault::Unsupported, shape.span(), message);
        }
        let Geometry::Mesh(mesh) = geometry else {
            if let Some(name) = wanted.by_materials.first() {
                let message = format!("only meshes have attributes such as `{name}`");
                shape.diagnostics().error(Fault::BadValue, shape.span(), message);
            }
            return;
        };
        for name in &wanted.by_materials {
            let found = mesh.attributes().iter().find(|attribute| attribute.name == *name);
            let message = match found {
                None if mesh.attributes().is_empty() => {
                    format!("this mesh has no attribute `{name}`, nor any other")
                }
                None => {
                    let names = mesh.attributes().iter().map(|attribute| attribute.name.as_str());
                    let names = list_names(names);
                    format!("this mesh has no attribute `{name}`; there is {names}")
                }
                Some(attribute) if !matches!(attribute.channels, 1 | 3 | 4) => {
                    let channels = attribute.channels;
                    format!("`{name}` has {channels} channels; a texture needs one or three")
                }
                Some(_) => continue,
            };
            shape.diagnostics().error(Fault::BadValue, shape.span(), message);
        }
        mesh.retain_attributes(|attribute| wanted.by_materials.contains(&attribute.name));
    }

    /// The attributes that the textures below a node read.
    fn wanted_attributes(&self, shape: NodeId) -> Wanted {
        let mut wanted = Wanted::default();
        if !self.has_attribute_textures {
            return wanted;
        }
        let mut seen = HashSet::new();
        let mut open = vec![(shape, false)];
        while let Some((id, in_light)) = open.pop() {
            let node = self.assets.document.node(id);
            if node.class == Class::Texture && node.plugin == "mesh_attribute" {
                let name = node.parameters.iter().rfind(|parameter| parameter.name == "name");
                if let Some(Value::String(name)) = name.map(|parameter| &parameter.value) {
                    let names =
                        if in_light { &mut wanted.by_lights } else { &mut wanted.by_materials };
                    names.insert(name.clone());
                }
            }
            for child in &node.children {
                let class = self.assets.document.node(child.node).class;
                let in_light = in_light || class == Class::Emitter;
                // Shapes are visited on their own.
                if class != Class::Shape && seen.insert((child.node, in_light)) {
                    open.push((child.node, in_light));
                }
            }
        }
        wanted
    }

    /// Gives every `mesh_attribute` texture its values once all shapes have their ids.
    pub(super) fn connect_attributes(&mut self, shapes: &mut [Shape]) {
        // Several textures may read the same attribute.
        let mut known: HashMap<(usize, &str), Arc<TriangleValues>> = HashMap::new();
        for texture in &mut self.textures {
            let Texture::MeshAttribute(texture) = texture else { continue };
            for (index, shape) in shapes.iter().enumerate() {
                let Geometry::Mesh(mesh) = &shape.geometry else { continue };
                let mut attributes = mesh.attributes().iter();
                let Some(attribute) = attributes.find(|found| found.name == texture.name()) else {
                    continue;
                };
                let values = known
                    .get(&(index, attribute.name.as_str()))
                    .cloned()
                    .or_else(|| TriangleValues::new(attribute, mesh.triangles()).map(Arc::new));
                let Some(values) = values else { continue };
                known.insert((index, attribute.name.as_str()), Arc::clone(&values));
                texture.connect(ShapeId(index as u32), values);
            }
        }
        drop(known);
        for shape in shapes {
            if let Geometry::Mesh(mesh) = &mut shape.geometry {
                mesh.retain_attributes(|_| false);
            }
        }
    }
}
