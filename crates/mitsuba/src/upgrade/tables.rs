//! Changes between versions, as data.

use etendue_document::{Class, FlatNode, Value};

use super::approximation::Approximations;
use super::entries::new_parameter;

/// A renamed parameter with the same meaning.
struct Renamed {
    class: Class,
    /// The plugins it applies to; if empty, all of the class.
    plugins: &'static [&'static str],
    old: &'static str,
    new: &'static str,
}

const fn renamed(
    class: Class,
    plugins: &'static [&'static str],
    old: &'static str,
    new: &'static str,
) -> Renamed {
    Renamed { class, plugins, old, new }
}

static RENAMED: &[Renamed] = &[
    renamed(Class::Bsdf, &["diffuse", "roughdiffuse"], "diffuse_reflectance", "reflectance"),
    renamed(Class::Bsdf, &["plastic", "roughplastic"], "reflectance", "diffuse_reflectance"),
    renamed(Class::Film, &[], "high_quality_edges", "sample_border"),
    // Version 0.3 and before.
    renamed(Class::Bsdf, &["lambertian"], "diffuse_reflectance", "reflectance"),
    renamed(Class::Bsdf, &["roughmetal", "roughglass"], "alpha_b", "alpha"),
    renamed(Class::Medium, &["heterogeneous"], "density", "sigma_t"),
    // Version 0.4 and before.
    renamed(Class::Medium, &[], "density_multiplier", "scale"),
    renamed(Class::Medium, &[], "size_multiplier", "scale"),
    renamed(Class::Emitter, &["area", "constant"], "intensity", "radiance"),
    renamed(Class::Emitter, &["directional"], "intensity", "irradiance"),
    renamed(Class::Emitter, &["envmap"], "intensity_scale", "scale"),
    renamed(Class::Integrator, &[], "luminaire_samples", "emitter_samples"),
    renamed(Class::Integrator, &[], "hide_luminaires", "hide_emitters"),
];

/// The renamed parameters of a plugin: old and new names.
pub(super) fn renamed_parameters(class: Class, plugin: &str) -> Vec<(&'static str, &'static str)> {
    let applies = |rule: &&Renamed| {
        rule.class == class && (rule.plugins.is_empty() || rule.plugins.contains(&plugin))
    };
    RENAMED.iter().filter(applies).map(|rule| (rule.old, rule.new)).collect()
}

/// A plugin that is approximated by another one, and what is lost.
struct Approximated {
    class: Class,
    old: &'static str,
    new: &'static str,
    loss: &'static str,
    kept: Kept,
}

/// What an approximating plugin takes from the one that it stands for.
enum Kept {
    /// Everything: both have the same parameters.
    All,
    /// The parameters and children of these names, and children without a name.
    Names(&'static [&'static str]),
}

/// A stand-in that takes over all parameters, or those that integrators share.
const fn approximated(
    class: Class,
    old: &'static str,
    new: &'static str,
    loss: &'static str,
) -> Approximated {
    let kept = match class {
        Class::Integrator => Kept::Names(KEPT_INTEGRATOR_PARAMETERS),
        _ => Kept::All,
    };
    Approximated { class, old, new, loss, kept }
}

/// A stand-in that takes over the named parameters.
const fn reduced(
    class: Class,
    [old, new]: [&'static str; 2],
    loss: &'static str,
    kept: &'static [&'static str],
) -> Approximated {
    Approximated { class, old, new, loss, kept: Kept::Names(kept) }
}

const SAME_LIGHT: &str = "which finds the same light by other paths";
const NO_BIAS: &str = "which finds the same light without its bias";
const NO_GRADIENTS: &str = "which computes no gradients";

static APPROXIMATED: &[Approximated] = &[
    approximated(Class::Integrator, "bdpt", "path", SAME_LIGHT),
    approximated(Class::Integrator, "mlt", "path", SAME_LIGHT),
    approximated(Class::Integrator, "pssmlt", "path", SAME_LIGHT),
    approximated(Class::Integrator, "erpt", "path", SAME_LIGHT),
    approximated(Class::Integrator, "ppm", "path", NO_BIAS),
    approximated(Class::Integrator, "sppm", "path", NO_BIAS),
    approximated(Class::Integrator, "photonmapper", "path", NO_BIAS),
    approximated(Class::Integrator, "vpl", "path", NO_BIAS),
    approximated(Class::Integrator, "volpath_simple", "volpath", SAME_LIGHT),
    approximated(Class::Integrator, "prb", "path", NO_GRADIENTS),
    approximated(Class::Integrator, "prb_basic", "path", NO_GRADIENTS),
    approximated(Class::Integrator, "prb_projective", "path", NO_GRADIENTS),
    approximated(Class::Integrator, "prb_reparam", "path", NO_GRADIENTS),
    approximated(Class::Integrator, "prb_threepoint", "path", NO_GRADIENTS),
    approximated(Class::Integrator, "prbvolpath", "volpath", NO_GRADIENTS),
    approximated(Class::Integrator, "direct_projective", "direct", NO_GRADIENTS),
    approximated(Class::Integrator, "direct_reparam", "direct", NO_GRADIENTS),
    approximated(Class::Integrator, "emission_reparam", "path", NO_GRADIENTS),
    approximated(
        Class::Integrator,
        "ao",
        "direct",
        "which shows the direct light of the scene instead of ambient occlusion",
    ),
    approximated(Class::Integrator, "motion", "path", "which shows light instead of motion"),
    reduced(
        Class::Shape,
        ["heightfield", "rectangle"],
        "which is flat",
        &["to_world", "flip_normals"],
    ),
    reduced(
        Class::Shape,
        ["hair", "linearcurve"],
        "whose segments are joined by spheres",
        &["filename", "radius", "to_world"],
    ),
    approximated(Class::Phase, "kkay", "isotropic", "which scatters evenly"),
    approximated(Class::Phase, "microflake", "isotropic", "which scatters evenly"),
    approximated(Class::Sensor, "telecentric", "orthographic", "which has no depth of field"),
    approximated(
        Class::Sensor,
        "perspective_rdist",
        "perspective",
        "which has no radial distortion",
    ),
    approximated(Class::Bsdf, "pplastic", "roughplastic", "which knows no polarisation"),
    approximated(Class::Film, "specfilm", "hdrfilm", "which records three colours, not bands"),
    approximated(Class::Film, "tiledhdrfilm", "hdrfilm", "which writes the file at the end"),
    reduced(
        Class::Film,
        ["mfilm", "hdrfilm"],
        "which writes a picture instead of a table",
        &["width", "height", "crop_offset_x", "crop_offset_y", "crop_width", "crop_height"],
    ),
];

/// Renamed plugins with the same meaning.
static RENAMED_PLUGINS: &[(Class, &str, &str)] = &[
    (Class::Bsdf, "lambertian", "diffuse"),
    (Class::Bsdf, "mirror", "conductor"),
    (Class::Bsdf, "roughmetal", "roughconductor"),
    (Class::Bsdf, "roughglass", "roughdielectric"),
    (Class::Bsdf, "composite", "mixturebsdf"),
    (Class::Phase, "hgphase", "hg"),
    (Class::Texture, "ldrtexture", "bitmap"),
    (Class::Texture, "exrtexture", "bitmap"),
];

/// Gives a plugin its current name.
pub(super) fn rename_plugin(node: &mut FlatNode) {
    let same = |rule: &&(Class, &str, &str)| rule.0 == node.class && node.plugin == rule.1;
    if let Some((_, _, new)) = RENAMED_PLUGINS.iter().find(same) {
        node.plugin = (*new).into();
    }
}

/// Replaces an unsupported plugin by the closest one.
pub(super) fn approximate_plugin(node: &mut FlatNode, approximations: &mut Approximations) {
    let rule = APPROXIMATED.iter().find(|rule| rule.class == node.class && node.plugin == rule.old);
    if let Some(rule) = rule {
        let message = format!("`{}` is rendered as `{}`, {}", rule.old, rule.new, rule.loss);
        approximations.add(message, node.span);
        node.plugin = rule.new.into();
        if let Kept::Names(kept) = rule.kept {
            // The other parameters control features that do not exist here.
            node.parameters.retain(|parameter| kept.contains(&parameter.name.as_str()));
            let is_kept = |name: &str| kept.contains(&name);
            node.children.retain(|child| child.name.as_deref().is_none_or(is_kept));
        }
        if node.class == Class::Integrator {
            node.children.clear();
        }
        if rule.old == "emission_reparam" {
            set_max_depth(node, 1);
        }
    }
}

/// Limits the length of an integrator's paths.
fn set_max_depth(node: &mut FlatNode, depth: i64) {
    node.parameters.retain(|parameter| parameter.name != "max_depth");
    let depth = new_parameter(node, "max_depth", Value::Integer(depth));
    node.parameters.push(depth);
}

/// The parameters that integrators of this version share with those they replace.
const KEPT_INTEGRATOR_PARAMETERS: &[&str] =
    &["max_depth", "rr_depth", "strict_normals", "hide_emitters"];
