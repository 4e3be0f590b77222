//! A plugin of any family, and its lookup by name.

use crate::manual::{Manual, PLUGINS_PAGE};
use etendue_document::{Class, Diagnostic, Fault, Parameters, list_names, list_some, near_names};

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
pub(crate) const fn plugin<F>(name: &'static str, manual: &'static Manual, build: F) -> Plugin<F> {
    Plugin { name, manual, build }
}

/// Finds the plugin of a node in its family's table. For an unknown name, the error lists the known
/// ones.
pub fn find<F: Copy>(table: &'static [Plugin<F>], parameters: &Parameters<'_>) -> Option<F> {
    let name = parameters.plugin();
    if let Some(plugin) = table.iter().find(|plugin| plugin.name == name) {
        return Some(plugin.build);
    }
    report_unknown(parameters, table.iter().map(|plugin| plugin.name));
    None
}

/// Reports an unknown plugin.
pub fn report_unknown(parameters: &Parameters<'_>, names: impl Iterator<Item = &'static str>) {
    if let Some(advice) = unsupported(parameters.class(), parameters.plugin()) {
        let message = format!("`{}` is not supported: {advice}", parameters.plugin());
        parameters.diagnostics().error(Fault::Unsupported, parameters.span(), message);
        return;
    }
    let names: Vec<&str> = names.collect();
    let (class, plugin) = (parameters.class(), parameters.plugin());
    let message = format!("unknown {} `{plugin}`", class.name());
    let mut diagnostic = Diagnostic::error(Fault::UnknownPlugin, parameters.span(), message);
    let near = near_names(plugin, names.iter().copied());
    if let Some(known) = instead(class, plugin) {
        diagnostic = diagnostic.help(format!("write `{known}`"));
    } else if !near.is_empty() {
        diagnostic = diagnostic.help(format!("did you mean {}?", list_names(near)));
    }
    let some = list_some(plugin, names, PLUGINS_PAGE);
    parameters.diagnostics().push(diagnostic.help(format!("there are {some}")));
}

/// Names that people give to plugins, and the names that these have.
static INSTEAD: &[(Class, &[&str], &str)] = &[
    (Class::Bsdf, &["glass", "refractive", "transparent"], "dielectric"),
    (Class::Bsdf, &["frosted", "frostedglass"], "roughdielectric"),
    (Class::Bsdf, &["metal", "specular", "reflective"], "conductor"),
    (Class::Bsdf, &["matte", "lambert", "lambertian"], "diffuse"),
    (Class::Bsdf, &["glossy", "shiny", "coated", "uber", "substrate"], "roughplastic"),
    (Class::Bsdf, &["disney", "pbr", "standard", "principledbsdf"], "principled"),
    (Class::Bsdf, &["mix", "blend"], "blendbsdf"),
    (Class::Shape, &["box", "cuboid"], "cube"),
    (Class::Shape, &["plane", "quad", "square", "rect"], "rectangle"),
    (Class::Shape, &["circle", "disc"], "disk"),
    (Class::Shape, &["trianglemesh", "wavefront"], "obj"),
    (Class::Emitter, &["ambient", "infinite", "background", "environment"], "constant"),
    (Class::Emitter, &["hdri", "ibl", "skybox", "environmentmap", "skydome"], "envmap"),
    (Class::Emitter, &["distant", "parallel"], "directional"),
    (Class::Emitter, &["omni", "pointlight"], "point"),
    (Class::Emitter, &["spotlight"], "spot"),
    (Class::Sensor, &["pinhole", "camera", "fov"], "perspective"),
    (Class::Sensor, &["panorama", "environment", "equirectangular"], "spherical"),
    (Class::Sensor, &["ortho"], "orthographic"),
    (Class::Integrator, &["pathtracer", "pt", "path_tracer", "unidirectional"], "path"),
    (Class::Integrator, &["directlighting", "direct_lighting"], "direct"),
    (Class::Integrator, &["bdpt", "bidirectional", "mlt", "pssmlt", "vcm"], "path"),
    (Class::Integrator, &["lighttracer", "light_tracer"], "ptracer"),
    (Class::Texture, &["image", "imagemap", "picture", "file"], "bitmap"),
    (Class::Texture, &["checker", "checkers", "chessboard"], "checkerboard"),
    (Class::Sampler, &["random", "uniform"], "independent"),
];

/// The name of the plugin that people mean by another one.
pub fn instead(class: Class, plugin: &str) -> Option<&'static str> {
    let plugin = plugin.to_lowercase();
    let row =
        INSTEAD.iter().find(|(of, names, _)| *of == class && names.contains(&plugin.as_str()));
    row.map(|(.., known)| *known)
}

/// Advice for a Mitsuba plugin that has no equivalent or near equivalent here.
fn unsupported(class: Class, plugin: &str) -> Option<&'static str> {
    (class == Class::Bsdf && plugin == "measured_polarized").then_some(
        "light has no polarisation here; give the shape another material, such as `measured`",
    )
}
