//! A plugin of any family, and its lookup by name.

use crate::manual::Manual;
use etendue_document::{Class, Fault, Parameters, list_names, near_names};

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
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
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

/// Advice for a Mitsuba plugin that has no equivalent or near equivalent here.
fn unsupported(class: Class, plugin: &str) -> Option<&'static str> {
    (class == Class::Bsdf && plugin == "measured_polarized").then_some(
        "light has no polarisation here; give the shape another material, such as `measured`",
    )
}
