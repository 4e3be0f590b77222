//! Changes between versions, as data.

use etendue_document::{Class, FlatNode};

use super::approximation::Approximations;

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
}

const fn approximated(
    class: Class,
    old: &'static str,
    new: &'static str,
    loss: &'static str,
) -> Approximated {
    Approximated { class, old, new, loss }
}

const SAME_LIGHT: &str = "which finds the same light by other paths";
const NO_BIAS: &str = "which finds the same light without its bias";

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
    approximated(Class::Integrator, "prb", "path", "which computes no gradients"),
    approximated(Class::Integrator, "prb_basic", "path", "which computes no gradients"),
    approximated(Class::Integrator, "prb_projective", "path", "which computes no gradients"),
    approximated(Class::Integrator, "prbvolpath", "volpath", "which computes no gradients"),
    approximated(Class::Integrator, "direct_projective", "direct", "which computes no gradients"),
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
        if node.class == Class::Integrator {
            // The other parameters control features that do not exist here.
            node.parameters.retain(|p| KEPT_INTEGRATOR_PARAMETERS.contains(&&*p.name));
            node.children.clear();
        }
    }
}

/// The parameters that integrators of this version share with those they replace.
const KEPT_INTEGRATOR_PARAMETERS: &[&str] =
    &["max_depth", "rr_depth", "strict_normals", "hide_emitters"];
