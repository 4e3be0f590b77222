//! Builds a scene from a document: typed parameters become plugins.

mod assets;
mod attached;
mod attributes;
mod colors;
mod input;
mod keep;
mod media;
mod memory;
mod shapes;

pub use assets::Assets;
pub use input::{BuildOptions, Identity, SceneInput};

use crate::bsdf::BSDFS;
use crate::bsdf::Material;
use crate::bsdf::diffuse::Diffuse;
use crate::cache::AssetCache;
use crate::emitter::EMITTERS;
use crate::emitter::{Emitter, read_sampling_weight};
use crate::film::FILMS;
use crate::film::FilmSpec;
use crate::ids::{MaterialId, MediumId, TextureId};
use crate::medium::Medium;
use crate::models::coat::CoatTables;
use crate::phase::PhaseFunction;
use crate::plugin::find;
use crate::rfilter::ReconstructionFilter;
use crate::scene::{Parts, Scene, SensorSetup};
use crate::sensor::SENSORS;
use crate::sensor::SHAPE_SENSORS;
use crate::sensor::Sensor;
use crate::shape::Geometry;
use crate::texture::TEXTURES;
use crate::texture::Texture;
use crate::volume::Volume;
use etendue_document::{
    Child, Class, Diagnostics, Document, Fault, NodeId, Parameters, Resources, Span,
};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A scene without its tree, which no longer needs its document. Separate steps keep the peak
/// memory of reading and of building the tree apart.
#[derive(Debug)]
pub struct GatheredScene {
    parts: Parts,
    cache: Option<Arc<AssetCache>>,
}

impl GatheredScene {
    /// Builds the tree. Errors go to `diagnostics`; `None` if there are any.
    #[must_use]
    pub fn build(self, diagnostics: &Diagnostics) -> Option<Scene> {
        Scene::new(self.parts, self.cache.as_deref(), diagnostics)
    }
}

/// Builds the frozen scene of a document in one step. Errors and warnings go to `diagnostics`;
/// `None` if there are errors. Files are read through `resources` in parallel.
#[must_use]
pub fn build_scene(
    document: &Document,
    resources: &dyn Resources,
    diagnostics: &Diagnostics,
    options: &BuildOptions,
) -> Option<Scene> {
    let input = SceneInput { document, resources, identity: Identity::Texts, cache: None };
    gather_scene(&input, diagnostics, options)?.build(diagnostics)
}

/// Builds the scene of a document without its tree. Errors and warnings go to `diagnostics`; `None`
/// if there are errors.
#[must_use]
pub fn gather_scene(
    input: &SceneInput<'_>,
    diagnostics: &Diagnostics,
    options: &BuildOptions,
) -> Option<GatheredScene> {
    let document = input.document;
    let assets = Assets::of(input, diagnostics, options);
    let loaded = assets.load();
    let mut builder = Builder::new(&assets, options);
    builder.textures_decoded = loaded.textures;
    let root = document.parameters(document.root, diagnostics);
    let mut parts = builder.shapes(&root, loaded.geometry);
    let sensors = std::mem::take(&mut parts.sensors);
    parts.sensors = builder.sensors(&root, sensors);
    builder.connect_attributes(&mut parts.shapes);
    let parts = Parts { emitters: builder.emitters(&root, parts.emitters), ..parts };
    builder.warn_of_unmeasured(&parts.emitters);
    builder.check_integrators(&root);
    builder.unused_nodes(&root);
    root.finish();
    assets.report_not_found();
    if diagnostics.has_errors() {
        return None;
    }
    let hash = assets.content_hash(input.identity);
    let Builder { materials, textures, media, emitter_weights, .. } = builder;
    let tier = options.tier;
    let parts = Parts { materials, textures, media, emitter_weights, hash, tier, ..parts };
    Some(GatheredScene { parts, cache: input.cache.cloned() })
}

/// Builds plugins from document nodes. Shared nodes are built once.
pub struct Builder<'a> {
    /// The document, its files, and the diagnostics.
    pub assets: &'a Assets<'a>,
    /// The materials so far.
    pub materials: Vec<Material>,
    /// The textures so far.
    pub textures: Vec<Texture>,
    /// The media so far.
    pub media: Vec<Medium>,
    /// The tables of rough coats.
    pub(crate) coats: CoatTables,
    /// The sampling weight of each emitter, relative to the others.
    emitter_weights: Vec<f32>,
    options: &'a BuildOptions,
    materials_built: HashMap<NodeId, Option<MaterialId>>,
    textures_built: HashMap<NodeId, Option<TextureId>>,
    textures_decoded: HashMap<NodeId, assets::Decoded<'a>>,
    media_built: HashMap<NodeId, Option<MediumId>>,
    phases_built: HashMap<NodeId, Option<PhaseFunction>>,
    volumes_built: HashMap<NodeId, Option<Volume>>,
    default_material: Option<MaterialId>,
    black_material: Option<MaterialId>,
    /// The irradiance meters so far.
    irradiance_meters: Vec<Span>,
    /// The emitters and sensors that shapes refer to, once asked for.
    attached_to_shapes: Option<HashSet<NodeId>>,
    /// Whether any texture reads mesh attributes.
    has_attribute_textures: bool,
}

impl<'a> Builder<'a> {
    /// An empty builder.
    #[must_use]
    pub fn new(assets: &'a Assets<'a>, options: &'a BuildOptions) -> Self {
        Self {
            assets,
            materials: Vec::new(),
            textures: Vec::new(),
            media: Vec::new(),
            coats: CoatTables::default(),
            emitter_weights: Vec::new(),
            options,
            materials_built: HashMap::new(),
            textures_built: HashMap::new(),
            textures_decoded: HashMap::new(),
            media_built: HashMap::new(),
            phases_built: HashMap::new(),
            volumes_built: HashMap::new(),
            default_material: None,
            black_material: None,
            irradiance_meters: Vec::new(),
            attached_to_shapes: None,
            has_attribute_textures: assets
                .document
                .nodes
                .iter()
                .any(|node| node.class == Class::Texture && node.plugin == "mesh_attribute"),
        }
    }

    /// The parameters of a node.
    #[must_use]
    pub fn parameters(&self, node: NodeId) -> Parameters<'a> {
        self.assets.document.parameters(node, self.assets.diagnostics)
    }

    /// The material of a `bsdf` node; `None` after an error has been reported.
    pub fn material(&mut self, node: NodeId) -> Option<MaterialId> {
        if let Some(built) = self.materials_built.get(&node) {
            return *built;
        }
        let parameters = self.parameters(node);
        let material = find(BSDFS, &parameters).and_then(|build| build(self, &parameters));
        let id = material.map(|material| self.add_material(material));
        if id.is_some() {
            parameters.finish();
        }
        self.materials_built.insert(node, id);
        id
    }

    /// The materials of the `bsdf` children of a node, in order.
    pub fn nested_materials(&mut self, parameters: &Parameters<'_>) -> Vec<MaterialId> {
        let children = parameters.children_of(Class::Bsdf);
        children.iter().filter_map(|child| self.material(child.node)).collect()
    }

    /// Adds a material to the scene.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// The material of shapes without one: grey and diffuse, or black if they emit light, as in
    /// Mitsuba.
    fn default_material(&mut self, emitter: Option<&Child>) -> MaterialId {
        let (known, diffuse) = match emitter {
            None => (self.default_material, Diffuse::default()),
            Some(_) => (self.black_material, Diffuse::BLACK),
        };
        if let Some(id) = known {
            return id;
        }
        let id = self.add_material(Material::Diffuse(diffuse));
        match emitter {
            None => self.default_material = Some(id),
            Some(_) => self.black_material = Some(id),
        }
        id
    }

    /// The texture of a `texture` node; `None` after an error has been reported.
    pub fn texture(&mut self, node: NodeId) -> Option<TextureId> {
        if let Some(built) = self.textures_built.get(&node) {
            return *built;
        }
        let texture = if let Some(decoded) = self.textures_decoded.remove(&node) {
            decoded.parameters.finish();
            decoded.texture
        } else {
            let parameters = self.parameters(node);
            let texture = find(TEXTURES, &parameters).and_then(|build| build(self, &parameters));
            if texture.is_some() {
                parameters.finish();
            }
            texture
        };
        let id = texture.map(|texture| self.add_texture(texture));
        self.textures_built.insert(node, id);
        id
    }

    /// Adds a texture to the scene.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// The first texture child that is unnamed, or whose name no parameter used.
    pub fn unnamed_texture(&mut self, parameters: &Parameters<'_>) -> Option<TextureId> {
        let child = parameters.unnamed_child(Class::Texture)?;
        self.texture(child.node)
    }

    fn emitters(&mut self, root: &Parameters<'_>, mut emitters: Vec<Emitter>) -> Vec<Emitter> {
        for child in root.children_of(Class::Emitter) {
            let parameters = self.parameters(child.node);
            if self.is_left_to_shapes(&parameters) {
                continue;
            }
            let emitter = find(EMITTERS, &parameters).and_then(|build| build(self, &parameters));
            if let Some(emitter) = emitter {
                self.emitter_weights.push(read_sampling_weight(&parameters));
                parameters.finish();
                emitters.push(emitter);
            }
        }
        emitters
    }

    /// The sensors of the scene, followed by those of its shapes.
    fn sensors(&mut self, root: &Parameters<'_>, of_shapes: Vec<SensorSetup>) -> Vec<SensorSetup> {
        let mut children = root.children_of(Class::Sensor);
        children.retain(|child| !self.is_left_to_shapes(&self.parameters(child.node)));
        if children.is_empty() && of_shapes.is_empty() && !root.is_incomplete() {
            let message = "the scene has no sensor: there is nothing to see it with";
            self.assets.diagnostics.warning(Fault::MissingParameter, root.span(), message);
        }
        let mut sensors: Vec<SensorSetup> =
            children.iter().filter_map(|child| self.sensor(child.node, None)).collect();
        sensors.extend(of_shapes);
        sensors
    }

    /// A sensor of the scene, or of a shape.
    fn sensor(&mut self, node: NodeId, shape: Option<&Geometry>) -> Option<SensorSetup> {
        let parameters = self.parameters(node);
        let film = self.film(&parameters);
        let sampler = crate::sampler::build_child(&parameters);
        let medium = self.medium_around(&parameters);
        // Report errors of the sensor even if its film has errors as well.
        let some_film = film.clone().unwrap_or_default();
        let sensor = match shape {
            Some(shape) => {
                self.irradiance_meters.push(parameters.span());
                find(SHAPE_SENSORS, &parameters)?(&parameters, &some_film, shape)?
            }
            None => find(SENSORS, &parameters)?(self, &parameters, &some_film)?,
        };
        let id = parameters.id().map(str::to_owned);
        parameters.finish();
        Some(SensorSetup { id, sensor, film: film?, sampler: sampler?, medium })
    }

    /// Warns about irradiance meters in scenes with light that no ray from them can hit.
    fn warn_of_unmeasured(&self, emitters: &[Emitter]) {
        let Some(delta) = emitters.iter().find(|emitter| emitter.is_delta()) else { return };
        for &span in &self.irradiance_meters {
            let message = format!(
                "the light of `{}` reaches this meter only after it has been scattered: the meter sends \
                 rays, which cannot hit such an emitter",
                delta.kind()
            );
            self.assets.diagnostics.warning(Fault::Approximation, span, message);
        }
    }

    /// A sensor on the film of another one. Its own film and sampler are ignored.
    pub(crate) fn sensor_on(&mut self, node: NodeId, film: &FilmSpec) -> Option<Sensor> {
        let parameters = self.parameters(node);
        let _ = self.film(&parameters);
        let _ = crate::sampler::build_child(&parameters);
        let sensor = find(SENSORS, &parameters)?(self, &parameters, film)?;
        parameters.finish();
        Some(sensor)
    }

    fn film(&mut self, sensor: &Parameters<'_>) -> Option<FilmSpec> {
        let mut film = match sensor.unnamed_child(Class::Film) {
            None => FilmSpec::default(),
            Some(child) => {
                let parameters = self.parameters(child.node);
                let build = find(FILMS, &parameters)?;
                let film = build(self, &parameters);
                parameters.finish();
                film?
            }
        };
        let resized = self.options.film_size.map_or(Ok(()), |size| film.resize(size));
        let cropped = self.options.crop.map_or(Ok(()), |crop| film.set_crop(crop));
        for problem in [resized, cropped].into_iter().filter_map(Result::err) {
            self.assets.diagnostics.error(Fault::BadValue, None, problem);
        }
        if let Some(name) = &self.options.filter {
            match ReconstructionFilter::by_name(name) {
                Some(filter) => film.filter = filter,
                None => {
                    let message = format!("there is no reconstruction filter `{name}`");
                    self.assets.diagnostics.error(Fault::UnknownPlugin, None, message);
                }
            }
        }
        Some(film)
    }

    /// Warns about superfluous integrators. The first one is built elsewhere, because this crate
    /// does not know how light is computed.
    fn check_integrators(&self, root: &Parameters<'_>) {
        for child in root.children_of(Class::Integrator).into_iter().skip(1) {
            let message = "a scene has one integrator: this one is left out";
            self.assets.diagnostics.warning(Fault::BadValue, child.span, message);
        }
    }

    /// Builds the top-level nodes that others may refer to. This reports errors in them even if
    /// nothing uses them.
    fn unused_nodes(&mut self, root: &Parameters<'_>) {
        for child in root.children_of(Class::Bsdf) {
            let _ = self.material(child.node);
        }
        for child in root.children_of(Class::Texture) {
            let _ = self.texture(child.node);
        }
        for child in root.children_of(Class::Medium) {
            let _ = self.medium(child.node);
        }
        for child in root.children_of(Class::Phase) {
            let _ = self.phase(child.node);
        }
        for child in root.children_of(Class::Volume) {
            let _ = self.volume(child.node);
        }
        self.unused_parts_of_sensors(root);
    }
}
