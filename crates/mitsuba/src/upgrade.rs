//! Upgrades older dialects to version 3's names, on the document, before any plugin sees it.
//!
//! Real files mix dialects whatever version they state, so the rules apply to every file; only
//! changed defaults depend on the version. Renames are silent. Approximations are reported, each
//! kind once, with every line.

mod approximation;
mod bsdf;
mod emitter;
mod entries;
mod film;
mod idle;
mod integrator;
mod layers;
mod left_out;
mod medium;
mod names;
mod sensor;
mod shape;
mod spectrum;
mod subsurface;
mod tables;
mod texture;

use std::collections::{HashMap, HashSet};

use etendue_document::{Class, Diagnostics, FlatNode, NameInterner, SourceId, Sources};

use approximation::Approximations;

/// The major version of each file that states one.
pub(crate) type Versions = HashMap<SourceId, u32>;

/// Upgrades every node. New nodes are appended.
pub(crate) fn upgrade(
    nodes: &mut Vec<FlatNode>,
    sources: &Sources,
    versions: &Versions,
    diagnostics: &Diagnostics,
) {
    let is_old = |node: &FlatNode| {
        node.span.source().is_some_and(|source| versions.get(&source) == Some(&0))
    };
    let mut approximations = Approximations::default();
    let mut words = NameInterner::default();
    nodes.iter_mut().for_each(|node| names::upgrade(node, &mut words));
    for node in nodes.iter_mut().filter(|node| is_old(node)) {
        bsdf::old_defaults(node);
        medium::old_defaults(node);
        medium::old_grid(node);
    }
    // In reverse order, so that nested nodes are upgraded before their parents.
    for index in (0..nodes.len()).rev() {
        tables::rename_plugin(&mut nodes[index]);
        spectrum::inline(nodes, index);
        shape::dissolve_merges(nodes, index);
        shape::hair_radius(&mut nodes[index]);
        tables::approximate_plugin(&mut nodes[index], &mut approximations);
        match nodes[index].class {
            Class::Integrator => integrator::upgrade(nodes, index, &mut approximations),
            Class::Sensor => sensor::upgrade(&mut nodes[index], diagnostics),
            Class::Film => film::upgrade(&mut nodes[index], &mut approximations),
            Class::Texture => texture::upgrade(&mut nodes[index], &mut approximations),
            Class::Emitter => {
                let is_old = is_old(&nodes[index]);
                emitter::upgrade(&mut nodes[index], is_old);
                emitter::stop_the_clock(&mut nodes[index], &mut approximations);
            }
            Class::Bsdf => {
                bsdf::upgrade(nodes, index, &mut approximations);
                layers::upgrade(nodes, index, &mut approximations, diagnostics);
            }
            Class::Medium => medium::upgrade(&mut nodes[index], &mut approximations),
            Class::Phase => medium::upgrade_phase(nodes, index),
            Class::Volume => medium::upgrade_volume(nodes, index, &mut approximations),
            Class::Shape if is_old(&nodes[index]) => {
                medium::old_boundary(nodes, index);
            }
            _ => {}
        }
        idle::drop_idle(&mut nodes[index]);
    }
    let mut replaced = HashSet::new();
    for index in 0..nodes.len() {
        if nodes[index].class == Class::Shape {
            replaced.extend(subsurface::upgrade(nodes, index, &mut approximations));
        }
    }
    // The scene holds those that shapes have referred to.
    if let Some(scene) = nodes.first_mut().filter(|_| !replaced.is_empty()) {
        scene.children.retain(|child| !replaced.contains(&child.node));
    }
    left_out::remove(nodes, &mut approximations);
    approximations.report(sources, diagnostics);
}
