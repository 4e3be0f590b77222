//! Older dialects become the names of version 3, on the document, before any plugin sees it.
//!
//! Real files mix dialects whatever version they claim, so the rules apply to every file; only defaults that have changed
//! go by the version.
//! What only has another name changes silently. What is rendered as something near is reported
//! as an approximation, each kind once, with every line.

mod approximation;
mod bsdf;
mod emitter;
mod integrator;
mod layers;
mod medium;
mod names;
mod sensor;
mod shape;
mod spectrum;
mod tables;
mod texture;

use std::collections::HashMap;

use etendue_document::{
    Class, Diagnostics, NameInterner, Node, Parameter, SourceId, Sources, Value,
};

use approximation::Approximations;

/// The major version of each file that states one.
pub(crate) type Versions = HashMap<SourceId, u32>;

/// Upgrades every node. New nodes come after the old ones.
pub(crate) fn upgrade(
    nodes: &mut Vec<Node>,
    sources: &Sources,
    versions: &Versions,
    diagnostics: &Diagnostics,
) {
    let mut approximations = Approximations::default();
    let mut words = NameInterner::default();
    nodes.iter_mut().for_each(|node| names::upgrade(node, &mut words));
    for node in nodes.iter_mut().filter(|node| versions.get(&node.span.source) == Some(&0)) {
        bsdf::old_defaults(node);
        medium::old_defaults(node);
        medium::old_grid(node);
    }
    // From the end, so that what is nested has been upgraded before what holds it.
    for index in (0..nodes.len()).rev() {
        tables::rename_plugin(&mut nodes[index]);
        spectrum::inline(nodes, index);
        shape::dissolve_merges(nodes, index);
        tables::approximate_plugin(&mut nodes[index], &mut approximations);
        match nodes[index].class {
            Class::Integrator => integrator::upgrade(nodes, index, &mut approximations),
            Class::Sensor => sensor::upgrade(&mut nodes[index], diagnostics),
            Class::Texture => texture::upgrade(&mut nodes[index], &mut approximations),
            Class::Emitter => {
                let is_old = versions.get(&nodes[index].span.source) == Some(&0);
                emitter::upgrade(&mut nodes[index], is_old);
                emitter::stop_the_clock(&mut nodes[index], &mut approximations);
            }
            Class::Bsdf => {
                bsdf::upgrade(nodes, index, &mut approximations);
                layers::upgrade(nodes, index, &mut approximations);
            }
            Class::Medium => medium::upgrade(&mut nodes[index], &mut approximations),
            Class::Phase => medium::upgrade_phase(nodes, index),
            Class::Volume => medium::upgrade_volume(nodes, index),
            Class::Shape if versions.get(&nodes[index].span.source) == Some(&0) => {
                medium::old_boundary(nodes, index);
            }
            _ => {}
        }
    }
    approximations.report(sources, diagnostics);
}

/// Removes the parameters of that name and returns the last, which is the one that counts.
fn take(node: &mut Node, name: &str) -> Option<Parameter> {
    let mut taken = None;
    node.parameters.retain(|parameter| {
        let wanted = parameter.name == name;
        if wanted {
            taken = Some(parameter.clone());
        }
        !wanted
    });
    taken
}

/// The parameter of that name that counts: the last.
fn find<'a>(node: &'a Node, name: &str) -> Option<&'a Parameter> {
    node.parameters.iter().rfind(|parameter| parameter.name == name)
}

/// A value that is one number.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}
