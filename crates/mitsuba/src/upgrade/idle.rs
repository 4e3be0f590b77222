//! Parameters that Mitsuba has and that change no picture here: they are dropped without a warning.

use etendue_document::{Class, FlatNode};

/// A class, its plugins (all if empty), and the names of their parameters without effect.
type Idle = (Class, &'static [&'static str], &'static [&'static str]);

const IDLE: [Idle; 4] = [
    // How the work is divided, and a limit that the command line has too.
    (Class::Integrator, &[], &["samples_per_pass", "timeout"]),
    // Everything is in focus.
    (Class::Sensor, &["perspective", "orthographic"], &["focus_distance"]),
    // Differentiable rendering only.
    (Class::Shape, &[], &["silhouette_sampling_weight"]),
    // Whether colours have different extinction is found from the values.
    (Class::Medium, &[], &["has_spectral_extinction"]),
];

/// Drops the parameters of a node that have no effect.
pub(super) fn drop_idle(node: &mut FlatNode) {
    for (class, plugins, names) in IDLE {
        let is_concerned = plugins.is_empty() || plugins.contains(&node.plugin.as_str());
        if node.class == class && is_concerned {
            node.parameters.retain(|parameter| !names.contains(&parameter.name.as_str()));
        }
    }
}
