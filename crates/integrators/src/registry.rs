//! Every integrator, one line each.

use crate::aov::{self, Aov};
use crate::depth::{self, Depth};
use crate::direct::{self, Direct};
use crate::integrator::Integrator;
use crate::moment::{self, Moment};
use crate::nested::Nested;
use crate::options::IntegratorOptions;
use crate::path::{self, Path};
use crate::ptracer::{self, ParticleTracer};
use crate::volpath::{self, VolumePath};
use crate::volpathmis;
use etendue_document::{
    Child, Class, Diagnostic, Diagnostics, Document, Fault, NodeId, Parameters, Span,
};
use etendue_scene::Manual;
use etendue_scene::registry::report_unknown;

/// What an integrator is built from.
struct Build<'a> {
    parameters: &'a Parameters<'a>,
    options: &'a IntegratorOptions,
    /// How many integrators this one is nested in.
    nesting: u32,
}

type BuildIntegrator = fn(&Build<'_>) -> Option<Box<dyn Integrator>>;

/// An integrator plugin: its XML `type`, its manual page and its constructor.
pub struct IntegratorPlugin {
    /// The XML `type`.
    pub name: &'static str,
    /// Its manual page.
    pub manual: &'static Manual,
    build: BuildIntegrator,
}

const fn plugin(
    name: &'static str,
    manual: &'static Manual,
    build: BuildIntegrator,
) -> IntegratorPlugin {
    IntegratorPlugin { name, manual, build }
}

/// The integrators.
pub static INTEGRATORS: &[IntegratorPlugin] = &[
    plugin("aov", &aov::MANUAL, |b| Some(Box::new(Aov::build(b.parameters, b.nested()?)))),
    plugin("depth", &depth::MANUAL, |_| Some(Box::new(Depth))),
    plugin("direct", &direct::MANUAL, |b| Some(Box::new(Direct::build(b.parameters, b.options)))),
    plugin("moment", &moment::MANUAL, |b| {
        let nested = b.nested()?;
        if nested.is_empty() {
            let message = "`moment` needs an integrator inside it";
            b.parameters.error(Fault::MissingParameter, "", message);
            return None;
        }
        Some(Box::new(Moment::new(nested)))
    }),
    plugin("path", &path::MANUAL, |b| Some(Box::new(Path::build(b.parameters, b.options)))),
    plugin("ptracer", &ptracer::MANUAL, |b| Some(Box::new(ParticleTracer::build(b.parameters)))),
    plugin("volpath", &volpath::MANUAL, |b| {
        Some(Box::new(VolumePath::build(b.parameters, b.options)))
    }),
    plugin("volpathmis", &volpathmis::MANUAL, |b| {
        Some(Box::new(volpathmis::build(b.parameters, b.options)))
    }),
];

/// Deeper nesting is a mistake or an attack.
const MAX_NESTING: u32 = 8;

impl Build<'_> {
    /// The integrators nested in this one.
    fn nested(&self) -> Option<Vec<Nested>> {
        if self.nesting >= MAX_NESTING {
            self.parameters.error(Fault::Limit, "", "integrators are nested too deeply");
            return None;
        }
        let mut nested = Vec::new();
        for child in self.parameters.children_of(Class::Integrator) {
            let parameters =
                self.parameters.document().parameters(child.node, self.parameters.diagnostics());
            let name = child.name.as_ref().map(ToString::to_string);
            let name = name.unwrap_or_else(|| format!("_arg_{}", nested.len()));
            let options = IntegratorOptions { name: None, ..self.options.clone() };
            let build =
                Build { parameters: &parameters, options: &options, nesting: self.nesting + 1 };
            let integrator = build.by_name(parameters.plugin())?;
            if integrator.particles().is_some() {
                let (outer, inner) = (self.parameters.plugin(), parameters.plugin());
                let message = format!("`{outer}` leaves out the particles of `{inner}`");
                parameters.warning(Fault::Approximation, "", message);
            }
            nested.push(Nested { name, integrator });
            parameters.finish();
        }
        Some(nested)
    }

    fn by_name(&self, name: &str) -> Option<Box<dyn Integrator>> {
        let Some(plugin) = find(name) else {
            report_unknown(self.parameters, INTEGRATORS.iter().map(|plugin| plugin.name));
            return None;
        };
        (plugin.build)(self)
    }
}

fn find(name: &str) -> Option<&'static IntegratorPlugin> {
    INTEGRATORS.iter().find(|plugin| plugin.name == name)
}

/// The integrator of a scene, or a path tracer if the file has none; `None` after reporting an
/// error.
#[must_use]
pub fn build_integrator(
    document: &Document,
    options: &IntegratorOptions,
    diagnostics: &Diagnostics,
) -> Option<Box<dyn Integrator>> {
    let of_scene = scene_integrator(document);
    let parameters = document.parameters(of_scene.unwrap_or(document.root), diagnostics);
    let name = match (&options.name, of_scene) {
        (Some(name), _) => name,
        (None, Some(_)) => parameters.plugin(),
        (None, None) => "path",
    };
    // If the library's user named it, no position in the scene is at fault.
    if options.name.is_some() && find(name).is_none() {
        let message = format!("there is no integrator `{name}`");
        diagnostics.error(Fault::UnknownPlugin, None, message);
        return None;
    }
    let integrator = Build { parameters: &parameters, options, nesting: 0 }.by_name(name)?;
    warn_of_media(document, name, parameters.span(), diagnostics);
    if options.clamp_indirect.is_some() && integrator.clamp_indirect().is_none() {
        let message = format!("`{name}` has no indirect light to limit");
        diagnostics.warning(Fault::UnknownParameter, None, message);
    }
    // Parameters of the scene's integrator may be unknown to the replacement.
    if of_scene.is_some() && options.name.is_none() {
        parameters.finish();
    }
    if diagnostics.has_errors() { None } else { Some(integrator) }
}

/// Warns if surfaces hold media but the integrator renders only surfaces.
fn warn_of_media(document: &Document, name: &str, place: Span, diagnostics: &Diagnostics) {
    if !["path", "direct", "ptracer"].contains(&name) {
        return;
    }
    let is_medium = |child: &Child| document.node(child.node).class == Class::Medium;
    let shapes = document.nodes.iter().filter(|node| node.class == Class::Shape);
    let first = shapes.flat_map(|shape| &shape.children).find(|child| is_medium(child));
    if let Some(medium) = first {
        let message = format!("`{name}` renders surfaces and leaves media out");
        diagnostics.push(
            Diagnostic::warning(Fault::Approximation, place, message)
                .related(medium.span, "a medium is here")
                .help("`volpath` renders media"),
        );
    }
}

/// The first integrator of the scene; that there is only one has been checked with the scene.
fn scene_integrator(document: &Document) -> Option<NodeId> {
    let children = document.node(document.root).children.iter().map(|child| child.node);
    children.into_iter().find(|child| document.node(*child).class == Class::Integrator)
}

/// Every plugin of this crate: class, name and manual page.
#[must_use]
pub fn plugins() -> Vec<(Class, &'static str, &'static Manual)> {
    INTEGRATORS.iter().map(|plugin| (Class::Integrator, plugin.name, plugin.manual)).collect()
}
