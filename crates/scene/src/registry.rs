//! Every plugin, one line each. Building, the manual and the tests walk these tables; nothing is
//! listed twice.

use crate::bsdf::{self, Material};
use crate::builder::{Assets, Builder};
use crate::emitter::{self, Emitter};
use crate::film::{self, FilmSpec};
use crate::ids::ShapeId;
use crate::manual::Manual;
use crate::medium::{self, Medium};
use crate::phase::{self, PhaseFunction};
use crate::rfilter;
use crate::sampler;
use crate::sensor::{self, Sensor};
use crate::shape::{self, Geometry};
use crate::texture::{self, Texture};
use crate::volume::{self, Volume};
use etendue_document::{Class, Fault, Parameters, list_names, near_names};
use std::sync::Arc;

/// One plugin of a family whose members are built by functions of type `F`.
#[derive(Clone, Copy, Debug)]
pub struct Plugin<F: 'static> {
    /// The XML `type`.
    pub name: &'static str,
    /// Its manual page.
    pub manual: &'static Manual,
    /// Builds it from a node's parameters.
    pub build: F,
}

/// Writes a [`Plugin`] on one line.
const fn plugin<F>(name: &'static str, manual: &'static Manual, build: F) -> Plugin<F> {
    Plugin { name, manual, build }
}

/// Builds a material.
pub type BuildMaterial = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Material>;
/// Builds the geometry of a shape. Only this step reads files, so that it can run in parallel.
pub type BuildGeometry = fn(&Assets<'_>, &Parameters<'_>) -> Option<Geometry>;
/// Builds a texture.
pub type BuildTexture = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Texture>;
/// Builds an emitter that is no shape's.
pub type BuildEmitter = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Emitter>;
/// Builds the emitter of a shape.
pub type BuildShapeEmitter = fn(&mut Builder<'_>, &Parameters<'_>, ShapeId) -> Emitter;
/// Builds a sensor for a film.
pub type BuildSensor = fn(&mut Builder<'_>, &Parameters<'_>, &FilmSpec) -> Option<Sensor>;
/// Builds the sensor of a shape for a film.
pub type BuildShapeSensor = fn(&Parameters<'_>, &FilmSpec, &Geometry) -> Option<Sensor>;
/// Builds a film.
pub type BuildFilm = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<FilmSpec>;

/// Builds a medium.
pub type BuildMedium = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Medium>;
/// Builds a phase function.
pub type BuildPhase = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<PhaseFunction>;
/// Builds a volume.
pub type BuildVolume = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Volume>;

/// The materials.
pub static BSDFS: &[Plugin<BuildMaterial>] = &[
    plugin("blendbsdf", &bsdf::blendbsdf::MANUAL, |b, p| {
        bsdf::blendbsdf::build(b, p).map(Material::Blend)
    }),
    plugin("bumpmap", &bsdf::bumpmap::MANUAL, |b, p| {
        bsdf::bumpmap::build(b, p).map(Material::BumpMap)
    }),
    plugin("circular", &bsdf::circular::MANUAL, |b, p| {
        bsdf::circular::build(b, p).map(Material::Null)
    }),
    plugin("conductor", &bsdf::conductor::MANUAL, |b, p| {
        bsdf::conductor::build(b, p).map(Material::Conductor)
    }),
    plugin("dielectric", &bsdf::dielectric::MANUAL, |b, p| {
        bsdf::dielectric::build(b, p).map(Material::Dielectric)
    }),
    plugin("diffuse", &bsdf::diffuse::MANUAL, |b, p| {
        bsdf::diffuse::build(b, p).map(Material::Diffuse)
    }),
    plugin("hair", &bsdf::hair::MANUAL, |b, p| bsdf::hair::build(b, p).map(Material::Hair)),
    plugin("mask", &bsdf::mask::MANUAL, |b, p| bsdf::mask::build(b, p).map(Material::Mask)),
    plugin("measured", &bsdf::measured::MANUAL, |b, p| {
        bsdf::measured::build(b, p).map(Material::Measured)
    }),
    plugin("normalmap", &bsdf::normalmap::MANUAL, |b, p| {
        bsdf::normalmap::build(b, p).map(Material::NormalMap)
    }),
    plugin("null", &bsdf::null::MANUAL, |b, p| bsdf::null::build(b, p).map(Material::Null)),
    plugin("plastic", &bsdf::plastic::MANUAL, |b, p| {
        bsdf::plastic::build(b, p).map(Material::Plastic)
    }),
    plugin("polarizer", &bsdf::polarizer::MANUAL, |b, p| {
        bsdf::polarizer::build(b, p).map(Material::Null)
    }),
    plugin("principled", &bsdf::principled::MANUAL, |b, p| {
        bsdf::principled::build(b, p).map(Material::Principled)
    }),
    plugin("principledthin", &bsdf::principledthin::MANUAL, |b, p| {
        bsdf::principledthin::build(b, p).map(Material::PrincipledThin)
    }),
    plugin("retarder", &bsdf::retarder::MANUAL, |b, p| {
        bsdf::retarder::build(b, p).map(Material::Null)
    }),
    plugin("roughconductor", &bsdf::roughconductor::MANUAL, |b, p| {
        bsdf::roughconductor::build(b, p).map(Material::RoughConductor)
    }),
    plugin("roughdielectric", &bsdf::roughdielectric::MANUAL, |b, p| {
        bsdf::roughdielectric::build(b, p).map(Material::RoughDielectric)
    }),
    plugin("roughdiffuse", &bsdf::roughdiffuse::MANUAL, |b, p| {
        bsdf::roughdiffuse::build(b, p).map(Material::RoughDiffuse)
    }),
    plugin("roughplastic", &bsdf::roughplastic::MANUAL, |b, p| {
        bsdf::roughplastic::build(b, p).map(Material::RoughPlastic)
    }),
    plugin("thindielectric", &bsdf::thindielectric::MANUAL, |b, p| {
        bsdf::thindielectric::build(b, p).map(Material::ThinDielectric)
    }),
    plugin("twosided", &bsdf::twosided::MANUAL, |b, p| {
        bsdf::twosided::build(b, p).map(Material::TwoSided)
    }),
];

/// The shapes with geometry of their own.
pub static SHAPES: &[Plugin<BuildGeometry>] = &[
    plugin("bsplinecurve", &shape::bsplinecurve::MANUAL, |a, p| {
        shape::bsplinecurve::build(a, p).map(|curve| Geometry::BSplineCurve(Arc::new(curve)))
    }),
    plugin("cube", &shape::cube::MANUAL, |_, p| shape::cube::build(p).map(Geometry::Mesh)),
    plugin("cylinder", &shape::cylinder::MANUAL, |_, p| {
        shape::cylinder::build(p).map(Geometry::Cylinder)
    }),
    plugin("disk", &shape::disk::MANUAL, |_, p| shape::disk::build(p).map(Geometry::Disk)),
    plugin("ellipsoids", &shape::ellipsoids::MANUAL, |a, p| {
        shape::ellipsoids::build(a, p).map(|cloud| Geometry::Ellipsoids(Arc::new(cloud)))
    }),
    plugin("ellipsoidsmesh", &shape::ellipsoidsmesh::MANUAL, |a, p| {
        shape::ellipsoidsmesh::build(a, p).map(|cloud| Geometry::EllipsoidsMesh(Arc::new(cloud)))
    }),
    plugin("linearcurve", &shape::linearcurve::MANUAL, |a, p| {
        shape::linearcurve::build(a, p).map(|curve| Geometry::LinearCurve(Arc::new(curve)))
    }),
    plugin("mesh", &shape::mesh::MANUAL, |a, p| shape::mesh::build(a, p).map(Geometry::Mesh)),
    plugin("obj", &shape::obj::MANUAL, |a, p| shape::obj::build(a, p).map(Geometry::Mesh)),
    plugin("ply", &shape::ply::MANUAL, |a, p| shape::ply::build(a, p).map(Geometry::Mesh)),
    plugin("rectangle", &shape::rectangle::MANUAL, |_, p| {
        shape::rectangle::build(p).map(Geometry::Mesh)
    }),
    plugin("revsurface", &shape::revsurface::MANUAL, |_, p| {
        shape::revsurface::build(p).map(|surface| Geometry::RevSurface(Arc::new(surface)))
    }),
    plugin("sdfgrid", &shape::sdfgrid::MANUAL, |a, p| {
        shape::sdfgrid::build(a, p).map(|grid| Geometry::SdfGrid(Arc::new(grid)))
    }),
    plugin("serialized", &shape::serialized::MANUAL, |a, p| {
        shape::serialized::build(a, p).map(Geometry::Mesh)
    }),
    plugin("sphere", &shape::sphere::MANUAL, |_, p| shape::sphere::build(p).map(Geometry::Sphere)),
];

/// The shapes that are made of others: their names and pages. The scene's builder resolves them.
pub static COMPOSITE_SHAPES: &[Plugin<()>] = &[
    plugin("instance", &shape::instance::MANUAL, ()),
    plugin("shapegroup", &shape::shapegroup::MANUAL, ()),
];

/// The textures.
pub static TEXTURES: &[Plugin<BuildTexture>] = &[
    plugin("bitmap", &texture::bitmap::MANUAL, |b, p| {
        texture::bitmap::build(b, p).map(Texture::Bitmap)
    }),
    plugin("checkerboard", &texture::checkerboard::MANUAL, |b, p| {
        texture::checkerboard::build(b, p).map(Texture::Checkerboard)
    }),
    plugin("gridtexture", &texture::gridtexture::MANUAL, |b, p| {
        texture::gridtexture::build(b, p).map(Texture::Grid)
    }),
    plugin("mesh_attribute", &texture::mesh_attribute::MANUAL, |b, p| {
        texture::mesh_attribute::build(b, p).map(Texture::MeshAttribute)
    }),
    plugin("rawconstant", &texture::rawconstant::MANUAL, |b, p| {
        texture::rawconstant::build(b, p).map(Texture::Constant)
    }),
    plugin("scale", &texture::scale::MANUAL, |b, p| {
        texture::scale::build(b, p).map(Texture::Scale)
    }),
    plugin("volume", &texture::volume::MANUAL, |b, p| {
        texture::volume::build(b, p).map(Texture::Volume)
    }),
];

/// The emitters that stand alone.
pub static EMITTERS: &[Plugin<BuildEmitter>] = &[
    plugin("constant", &emitter::constant::MANUAL, |b, p| {
        emitter::constant::build(b, p).map(Emitter::Constant)
    }),
    plugin("directional", &emitter::directional::MANUAL, |b, p| {
        emitter::directional::build(b, p).map(Emitter::Directional)
    }),
    plugin("envmap", &emitter::envmap::MANUAL, |b, p| {
        emitter::envmap::build(b, p).map(Emitter::Environment)
    }),
    plugin("point", &emitter::point::MANUAL, |b, p| {
        emitter::point::build(b, p).map(Emitter::Point)
    }),
    plugin("projector", &emitter::projector::MANUAL, |b, p| {
        emitter::projector::build(b, p).map(Emitter::Projector)
    }),
    plugin("spot", &emitter::spot::MANUAL, |b, p| emitter::spot::build(b, p).map(Emitter::Spot)),
    plugin("sunsky", &emitter::sunsky::MANUAL, |b, p| {
        emitter::sunsky::build(b, p).map(Box::new).map(Emitter::SunSky)
    }),
];

/// The emitters that are nested in a shape: their names and pages.
pub static SHAPE_EMITTERS: &[Plugin<BuildShapeEmitter>] = &[
    plugin("area", &emitter::area::MANUAL, |b, p, shape| {
        Emitter::Area(emitter::area::build(b, p, shape))
    }),
    plugin("directionalarea", &emitter::directionalarea::MANUAL, |b, p, shape| {
        Emitter::DirectionalArea(emitter::directionalarea::build(b, p, shape))
    }),
];

/// The media.
pub static MEDIA: &[Plugin<BuildMedium>] = &[
    plugin("heterogeneous", &medium::heterogeneous::MANUAL, medium::heterogeneous::build),
    plugin("homogeneous", &medium::homogeneous::MANUAL, medium::homogeneous::build),
];

/// The phase functions.
pub static PHASES: &[Plugin<BuildPhase>] = &[
    plugin("blendphase", &phase::blendphase::MANUAL, |b, p| {
        phase::blendphase::build(b, p).map(|blend| PhaseFunction::Blend(Box::new(blend)))
    }),
    plugin("hg", &phase::hg::MANUAL, |b, p| {
        phase::hg::build(b, p).map(PhaseFunction::HenyeyGreenstein)
    }),
    plugin("isotropic", &phase::isotropic::MANUAL, phase::isotropic::build),
    plugin("rayleigh", &phase::rayleigh::MANUAL, phase::rayleigh::build),
    plugin("sggx", &phase::sggx::MANUAL, |b, p| phase::sggx::build(b, p).map(PhaseFunction::Sggx)),
    plugin("tabphase", &phase::tabphase::MANUAL, |b, p| {
        phase::tabphase::build(b, p).map(|table| PhaseFunction::Tabulated(Box::new(table)))
    }),
];

/// The volumes.
pub static VOLUMES: &[Plugin<BuildVolume>] = &[
    plugin("constvolume", &volume::constvolume::MANUAL, |b, p| {
        volume::constvolume::build(b, p).map(Volume::Constant)
    }),
    plugin("gridvolume", &volume::gridvolume::MANUAL, |b, p| {
        let grid = b.assets.kept(p, &[], |a, p| volume::gridvolume::build(a, p).map(Arc::new));
        grid.map(Volume::Grid)
    }),
];

/// The sensors.
pub static SENSORS: &[Plugin<BuildSensor>] = &[
    plugin("batch", &sensor::batch::MANUAL, |b, p, f| {
        sensor::batch::build(b, p, f).map(Sensor::Batch)
    }),
    plugin("distant", &sensor::distant::MANUAL, |b, p, f| {
        sensor::distant::build(b, p, f).map(Box::new).map(Sensor::Distant)
    }),
    plugin("orthographic", &sensor::orthographic::MANUAL, |b, p, f| {
        sensor::orthographic::build(b, p, f).map(Sensor::Orthographic)
    }),
    plugin("perspective", &sensor::perspective::MANUAL, |b, p, f| {
        sensor::perspective::build(b, p, f).map(Sensor::Perspective)
    }),
    plugin("radiancemeter", &sensor::radiancemeter::MANUAL, |b, p, f| {
        sensor::radiancemeter::build(b, p, f).map(Sensor::Radiancemeter)
    }),
    plugin("thinlens", &sensor::thinlens::MANUAL, |b, p, f| {
        sensor::thinlens::build(b, p, f).map(Sensor::ThinLens)
    }),
];

/// The sensors that are nested in a shape.
pub static SHAPE_SENSORS: &[Plugin<BuildShapeSensor>] =
    &[plugin("irradiancemeter", &sensor::irradiancemeter::MANUAL, |p, f, geometry| {
        let meter = sensor::irradiancemeter::build(p, f, geometry);
        meter.map(Box::new).map(Sensor::Irradiancemeter)
    })];

/// The films.
pub static FILMS: &[Plugin<BuildFilm>] = &[
    plugin("hdrfilm", &film::hdrfilm::MANUAL, film::hdrfilm::build),
    plugin("ldrfilm", &film::ldrfilm::MANUAL, film::ldrfilm::build),
];

/// Finds the plugin of a node in its family's table; reports an unknown one with the names there are.
pub fn find<F: Copy>(table: &'static [Plugin<F>], parameters: &Parameters<'_>) -> Option<F> {
    let name = parameters.plugin();
    if let Some(plugin) = table.iter().find(|plugin| plugin.name == name) {
        return Some(plugin.build);
    }
    report_unknown(parameters, table.iter().map(|plugin| plugin.name));
    None
}

/// Reports a plugin that nobody knows.
pub fn report_unknown(parameters: &Parameters<'_>, names: impl Iterator<Item = &'static str>) {
    if let Some(advice) = unsupported(parameters.class(), parameters.plugin()) {
        let message = format!("`{}` is not supported: {advice}", parameters.plugin());
        parameters.diagnostics().error(Fault::Unsupported, parameters.span(), message);
        return;
    }
    let names: Vec<&str> = names.collect();
    let class = parameters.class().name();
    let message = format!("unknown {class} `{}`", parameters.plugin());
    let near = near_names(parameters.plugin(), names.iter().copied());
    let mut diagnostic =
        etendue_document::Diagnostic::error(Fault::UnknownPlugin, parameters.span(), message);
    if !near.is_empty() {
        diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
    }
    parameters.diagnostics().push(diagnostic.help(format!("there are {}", list_names(names))));
}

/// What to do instead of using a plugin of Mitsuba that has no equal here, not even a near one.
fn unsupported(class: Class, plugin: &str) -> Option<&'static str> {
    (class == Class::Bsdf && plugin == "measured_polarized").then_some(
        "light has no polarisation here; give the shape another material, such as `measured`",
    )
}

/// Every plugin of this crate: class, name and manual page.
pub fn plugins() -> Vec<(Class, &'static str, &'static Manual)> {
    fn pages<F>(
        class: Class,
        table: &'static [Plugin<F>],
    ) -> impl Iterator<Item = (Class, &'static str, &'static Manual)> {
        table.iter().map(move |plugin| (class, plugin.name, plugin.manual))
    }
    let mut all: Vec<_> = pages(Class::Shape, SHAPES).collect();
    all.extend(pages(Class::Shape, COMPOSITE_SHAPES));
    all.extend(pages(Class::Bsdf, BSDFS));
    all.extend(pages(Class::Texture, TEXTURES));
    all.extend(pages(Class::Emitter, EMITTERS));
    all.extend(pages(Class::Emitter, SHAPE_EMITTERS));
    all.extend(pages(Class::Medium, MEDIA));
    all.extend(pages(Class::Phase, PHASES));
    all.extend(pages(Class::Volume, VOLUMES));
    all.extend(pages(Class::Sensor, SENSORS));
    all.extend(pages(Class::Sensor, SHAPE_SENSORS));
    all.extend(pages(Class::Film, FILMS));
    all.extend(pages(Class::ReconstructionFilter, rfilter::FILTERS));
    all.extend(pages(Class::Sampler, sampler::SAMPLERS));
    all
}
