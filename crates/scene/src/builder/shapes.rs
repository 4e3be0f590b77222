//! Shapes, groups and instances.

use super::Builder;
use super::assets::{LoadedShape, Made};
use super::attached::is_outside_shapes;
use crate::emitter::SHAPE_EMITTERS;
use crate::emitter::{Emitter, read_sampling_weight};
use crate::ids::{EmitterId, GroupId, MaterialId, ShapeId};
use crate::inputs::transform::read_transform;
use crate::plugin::find;
use crate::scene::{Parts, Tree, TreeContent};
use crate::shape::COMPOSITE_SHAPES;
use crate::shape::instance::Instance;
use crate::shape::shapegroup::Group;
use crate::shape::{Geometry, Shape};
use etendue_document::{Child, Class, Fault, NodeId, Parameters};
use std::collections::{HashMap, HashSet};

/// Shapes with their geometry, but without materials.
struct LoadedShapes<'a> {
    loaded: HashMap<NodeId, LoadedShape<'a>>,
    /// Those that are held more than once.
    shared: HashSet<NodeId>,
}

impl<'a> Builder<'a> {
    /// All shapes of the scene: top-level ones, then those within groups. Then instances.
    pub(super) fn shapes(
        &mut self,
        root: &Parameters<'_>,
        loaded: HashMap<NodeId, LoadedShape<'a>>,
    ) -> Parts {
        let mut parts = Parts::default();
        let children = root.children_of(Class::Shape);
        let plugin = |child: &&Child| self.assets.document.node(child.node).plugin.as_str();
        let (composite, simple): (Vec<_>, Vec<_>) = children
            .into_iter()
            .partition(|child| COMPOSITE_SHAPES.iter().any(|entry| entry.name == plugin(child)));
        let instances: Vec<NodeId> = composite
            .iter()
            .filter(|child| plugin(child) == "instance")
            .map(|child| child.node)
            .collect();
        let shared = self.shared_shapes(&simple);
        let mut loaded = LoadedShapes { loaded, shared };
        for child in simple {
            if let Some(shape) = self.take_shape(child.node, &mut loaded) {
                self.add_shape(shape, &mut parts);
            }
        }
        self.add_instances(&instances, &mut loaded, &mut parts);
        parts
    }

    /// The shapes that the scene and its groups hold more than once, by references.
    fn shared_shapes(&self, of_scene: &[&Child]) -> HashSet<NodeId> {
        let nodes = &self.assets.document.nodes;
        let mut groups = nodes.iter().filter(|node| node.plugin == "shapegroup").peekable();
        if groups.peek().is_none() {
            return HashSet::new();
        }
        let mut seen: HashSet<NodeId> = of_scene.iter().map(|child| child.node).collect();
        let members = groups.flat_map(|group| group.children.iter().map(|child| child.node));
        members.filter(|member| !seen.insert(*member)).collect()
    }

    /// A shape, to be added to the scene or a group. Of a shared one, a copy whose parameters have
    /// been read to the same extent.
    fn take_shape(&self, node: NodeId, shapes: &mut LoadedShapes<'a>) -> Option<LoadedShape<'a>> {
        if !shapes.shared.contains(&node) {
            return shapes.loaded.remove(&node);
        }
        let LoadedShape { parameters: read, geometry } = shapes.loaded.get(&node)?;
        let parameters = self.parameters(node);
        parameters.repeat(&read.reading());
        Some(LoadedShape { parameters, geometry: geometry.clone() })
    }

    fn add_shape(&mut self, loaded: LoadedShape<'_>, parts: &mut Parts) {
        let LoadedShape { parameters, geometry } = loaded;
        let emitter = parameters.unnamed_child(Class::Emitter);
        let material = self.shape_material(&parameters, emitter);
        let Some(Made { value: mut geometry, digest }) = geometry else { return };
        self.keep_attributes(&parameters, &mut geometry);
        let id = ShapeId(parts.shapes.len() as u32);
        let emitter = emitter.and_then(|child| self.shape_emitter(child, id)).map(|emitter| {
            geometry.prepare_sampling();
            self.warn_if_not_sampled(&parameters, &geometry);
            if let (Geometry::Mesh(mesh), Emitter::Area(area)) = (&mut geometry, &emitter) {
                area.let_follow(mesh, &self.textures);
            }
            parts.emitters.push(emitter);
            EmitterId(parts.emitters.len() as u32 - 1)
        });
        parts.medium_interfaces.extend(
            self.medium_interface(&parameters).map(|medium_interface| (id, medium_interface)),
        );
        for child in parameters.children_of(Class::Sensor) {
            parts.sensors.extend(self.sensor(child.node, Some(&geometry)));
        }
        parameters.finish();
        parts.shapes.push(Shape { geometry, material, emitter });
        if self.assets.cache.is_some() {
            parts.geometry_digests.push(digest);
        }
    }

    /// Warns about a light that emitter sampling cannot find.
    fn warn_if_not_sampled(&self, parameters: &Parameters<'_>, geometry: &Geometry) {
        if geometry.area() > 0.0 {
            return;
        }
        let message = format!(
            "a `{}` that emits light is not sampled: only rays that hit it by chance find its light, \
             which is noisy",
            parameters.plugin()
        );
        self.assets.diagnostics.warning(Fault::Approximation, parameters.span(), message);
    }

    fn shape_material(
        &mut self,
        parameters: &Parameters<'_>,
        emitter: Option<&Child>,
    ) -> MaterialId {
        let children = parameters.children_of(Class::Bsdf);
        if let [_, second, ..] = children.as_slice() {
            let message = "a shape has one material: this one is left out";
            self.assets.diagnostics.warning(Fault::BadValue, second.span, message);
        }
        let first = children.first().and_then(|child| self.material(child.node));
        first.unwrap_or_else(|| self.default_material(emitter))
    }

    fn shape_emitter(&mut self, child: &Child, shape: ShapeId) -> Option<Emitter> {
        let parameters = self.parameters(child.node);
        if is_outside_shapes(&parameters) {
            return None;
        }
        let build = find(SHAPE_EMITTERS, &parameters)?;
        let emitter = build(self, &parameters, shape);
        self.emitter_weights.push(read_sampling_weight(&parameters));
        parameters.finish();
        Some(emitter)
    }

    fn add_instances(
        &mut self,
        nodes: &[NodeId],
        loaded: &mut LoadedShapes<'a>,
        parts: &mut Parts,
    ) {
        // Groups come first, because an instance's bounds depend on its group.
        let mut groups: HashMap<NodeId, Option<GroupId>> = HashMap::new();
        let mut grouped = Vec::new();
        let mut placed = Vec::with_capacity(nodes.len());
        parts.instances.reserve_exact(nodes.len());
        for &node in nodes {
            let parameters = self.parameters(node);
            let to_world = read_transform(&parameters, "to_world");
            let group = self.group_of(&parameters, &mut groups, loaded, &mut grouped);
            let span = parameters.span();
            parameters.finish();
            let (Some(to_world), Some(group)) = (to_world, group) else { continue };
            // Rays are transformed into the group by the inverse in single precision.
            if !to_world.affine().inverse().is_finite() {
                let message = "this shape reaches beyond what single precision can hold";
                self.assets.diagnostics.error(Fault::Geometry, span, message);
                continue;
            }
            parts.instances.push(Instance::new(group, &to_world));
            placed.push(node);
        }
        let mut first = parts.shapes.len() as u32;
        for Parts { shapes, medium_interfaces, geometry_digests, .. } in &grouped {
            let in_scene = |id: ShapeId| ShapeId(first + id.0);
            parts
                .medium_interfaces
                .extend(medium_interfaces.iter().map(|&(id, media)| (in_scene(id), media)));
            let content = TreeContent { shapes, geometry_digests, ..TreeContent::default() };
            match content.build(self.options.tier, self.assets.cache) {
                Ok(Tree { bvh, digest }) => {
                    parts.groups.push(Group { bvh, first_shape: ShapeId(first) });
                    parts.group_digests.push(digest);
                }
                Err(problem) => {
                    self.assets.diagnostics.error(Fault::Geometry, None, problem);
                    return;
                }
            }
            first += shapes.len() as u32;
        }
        for (instance, node) in parts.instances.iter().zip(placed) {
            let bounds = instance.bounds(&parts.groups[instance.group.index()]);
            self.assets.check_bounds(&bounds, self.assets.document.node(node).span);
        }
        parts.top_level_shapes = Some(parts.shapes.len());
        parts.shapes.extend(grouped.into_iter().flat_map(|members| members.shapes));
    }

    fn group_of(
        &mut self,
        instance: &Parameters<'_>,
        groups: &mut HashMap<NodeId, Option<GroupId>>,
        loaded: &mut LoadedShapes<'a>,
        grouped: &mut Vec<Parts>,
    ) -> Option<GroupId> {
        let Some(child) = instance.unnamed_child(Class::Shape) else {
            instance.error(
                Fault::MissingParameter,
                "shapegroup",
                "an instance needs a shape group",
            );
            return None;
        };
        if let Some(known) = groups.get(&child.node) {
            return *known;
        }
        let parameters = self.parameters(child.node);
        let group = if parameters.plugin() == "shapegroup" {
            grouped.push(self.grouped(&parameters, loaded));
            Some(GroupId(grouped.len() as u32 - 1))
        } else {
            parameters.error(
                Fault::BadValue,
                "shapegroup",
                "an instance takes a `shapegroup`, no other shape",
            );
            None
        };
        parameters.finish();
        groups.insert(child.node, group);
        group
    }

    fn grouped(&mut self, group: &Parameters<'_>, loaded: &mut LoadedShapes<'a>) -> Parts {
        let mut members = Parts::default();
        for child in group.children_of(Class::Shape) {
            match self.take_shape(child.node, loaded) {
                Some(shape) => self.add_shape(shape, &mut members),
                None => {
                    let message = "a shape group holds shapes: no instances and no other groups";
                    self.assets.diagnostics.error(Fault::Unsupported, child.span, message);
                }
            }
        }
        if !members.emitters.is_empty() {
            let message = "shapes of a group cannot emit light";
            self.assets.diagnostics.error(Fault::Unsupported, group.span(), message);
        }
        members
    }
}
