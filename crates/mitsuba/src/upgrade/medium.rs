//! Media, their phase functions and volumes.

use etendue_document::{Child, Class, FlatNode, List, NodeId, Parameter, Value};
use glam::DVec3;

use super::approximation::Approximations;
use super::entries::{color, find, new_parameter, take};

/// The named media of version 0.6, with their measured coefficients.
static PRESETS: &str = include_str!("data/media.txt");

/// The medium of version 0.6 where a scene names none.
const DEFAULT_PRESET: &str = "skin1";

/// Upgrades one medium.
pub(super) fn upgrade(node: &mut FlatNode, approximations: &mut Approximations) {
    // Both tracking methods converge to the same picture, except for the bias of one.
    take(node, "method");
    take(node, "step_size");
    if node.plugin == "homogeneous" {
        coefficients(node, approximations);
    }
}

/// Up to version 0.6 the default medium is skin.
pub(super) fn old_defaults(node: &mut FlatNode) {
    let stated = ["material", "sigma_s", "sigma_a", "sigma_t", "albedo"];
    let says_nothing = stated.iter().all(|name| !has(node, name));
    if node.class == Class::Medium && node.plugin == "homogeneous" && says_nothing {
        let skin = new_parameter(node, "material", Value::String(DEFAULT_PRESET.to_owned()));
        node.parameters.push(skin);
    }
}

/// `sigma_s` and `sigma_a`, or a preset of both, become `sigma_t` and `albedo`.
fn coefficients(node: &mut FlatNode, approximations: &mut Approximations) {
    let preset = preset(node);
    let (stated_s, stated_a) = (constant(node, "sigma_s"), constant(node, "sigma_a"));
    if preset.is_none() && stated_s.is_none() && stated_a.is_none() {
        return;
    }
    let (preset_s, preset_a) = preset.unwrap_or_default();
    let (scattering, absorption) = (stated_s.unwrap_or(preset_s), stated_a.unwrap_or(preset_a));
    if has(node, "sigma_t") {
        let message = "`sigmaT` counts: `sigmaS`, `sigmaA` and `material` are left out";
        approximations.add(message, node.span);
        return;
    }
    let extinction = scattering + absorption;
    // Without extinction, the albedo is arbitrary.
    let share = |index: usize| {
        if extinction[index] > 0.0 { scattering[index] / extinction[index] } else { 0.0 }
    };
    let albedo = DVec3::new(share(0), share(1), share(2));
    let added = [("sigma_t", extinction), ("albedo", albedo)]
        .map(|(name, value)| new_parameter(node, name, Value::Rgb(value)));
    node.parameters.extend(added);
}

/// Removes the name of a preset and returns its scattering and absorption. An unknown name is kept
/// and reported.
pub(super) fn preset(node: &mut FlatNode) -> Option<(DVec3, DVec3)> {
    let Value::String(name) = &find(node, "material")?.value else { return None };
    let found = coefficients_of(&name.to_lowercase())?;
    take(node, "material");
    Some(found)
}

/// Scattering and absorption of skin, which is what version 0.6 renders by default.
pub(super) fn skin() -> (DVec3, DVec3) {
    coefficients_of(DEFAULT_PRESET).unwrap_or_default()
}

/// Scattering and absorption of a named medium.
fn coefficients_of(name: &str) -> Option<(DVec3, DVec3)> {
    let lines = PRESETS.lines().filter(|line| !line.starts_with('#'));
    let (_, numbers) =
        lines.filter_map(|line| line.split_once(": ")).find(|(known, _)| *known == name)?;
    let numbers: Vec<f64> = numbers.split(' ').filter_map(|word| word.parse().ok()).collect();
    let [s0, s1, s2, a0, a1, a2] = numbers.try_into().ok()?;
    Some((DVec3::new(s0, s1, s2), DVec3::new(a0, a1, a2)))
}

/// Removes a constant colour and returns it; others are kept and reported.
fn constant(node: &mut FlatNode, name: &str) -> Option<DVec3> {
    let value = color(&find(node, name)?.value)?;
    take(node, name);
    Some(value)
}

/// Upgrades one phase function whose children have been upgraded; new nodes are appended.
pub(super) fn upgrade_phase(nodes: &mut Vec<FlatNode>, index: usize) {
    if nodes[index].plugin == "mixturephase" {
        mixture(nodes, index);
    }
}

/// A mixture of any number of phase functions becomes nested blends of two: the first and the rest.
fn mixture(nodes: &mut Vec<FlatNode>, index: usize) {
    let node = &nodes[index];
    let Some(Parameter { value: Value::String(text), .. }) = find(node, "weights") else { return };
    let weights: Vec<f64> = text
        .split([',', ' '])
        .filter_map(|word| word.parse().ok())
        .filter(|weight: &f64| *weight >= 0.0)
        .collect();
    let is_phase = |child: &&Child| nodes[child.node.index()].class == Class::Phase;
    let parts: Vec<Child> = node
        .children
        .iter()
        .filter(is_phase)
        .map(|child| Child { name: None, ..child.clone() })
        .collect();
    // If the counts differ, the plugin is kept and reported as unknown.
    if weights.len() != parts.len() || parts.is_empty() {
        return;
    }
    let span = node.span;
    let mut parts = parts.into_iter().zip(weights).rev();
    let Some((mut rest, mut sum)) = parts.next() else { return };
    for (first, weight) in parts {
        sum += weight;
        let share = if sum > 0.0 { (sum - weight) / sum } else { 0.0 };
        let mut blend = FlatNode {
            class: Class::Phase,
            plugin: "blendphase".into(),
            id: None,
            span,
            parameters: List::new(),
            children: vec![first, rest].into(),
        };
        blend.parameters = vec![new_parameter(&blend, "weight", Value::Float(share))].into();
        nodes.push(blend);
        rest = Child { name: None, node: NodeId(nodes.len() as u32 - 1), span };
    }
    let FlatNode { plugin, parameters, children, .. } = nodes[rest.node.index()].clone();
    let node = &mut nodes[index];
    (node.plugin, node.parameters, node.children) = (plugin, parameters, children);
}

/// Upgrades one volume whose children have been upgraded.
pub(super) fn upgrade_volume(
    nodes: &mut [FlatNode],
    index: usize,
    approximations: &mut Approximations,
) {
    let node = &mut nodes[index];
    take(node, "send_data");
    if node.plugin == "hgridvolume" {
        let message = "`hgridvolume` is rendered as `constvolume` of 0: its grids are not read";
        approximations.add(message, node.span);
        node.parameters = vec![new_parameter(node, "value", Value::Float(0.0))].into();
        node.plugin = "constvolume".into();
    }
    // A cache of another volume's values.
    if nodes[index].plugin != "volcache" {
        return;
    }
    let mut nested = nodes[index].children.iter().map(|child| &nodes[child.node.index()]);
    let Some(inner) = nested.find(|inner| inner.class == Class::Volume) else { return };
    let FlatNode { plugin, parameters, children, .. } = inner.clone();
    let outer = &mut nodes[index];
    (outer.plugin, outer.parameters, outer.children) = (plugin, parameters, children);
}

/// Up to version 0.6 the box in a grid's file always applies.
pub(super) fn old_grid(node: &mut FlatNode) {
    let is_grid = node.class == Class::Volume && node.plugin == "gridvolume";
    if is_grid && find(node, "use_grid_bbox").is_none() {
        let own_box = new_parameter(node, "use_grid_bbox", Value::Boolean(true));
        node.parameters.push(own_box);
    }
}

/// Up to version 0.6 a shape with a medium and without a BSDF has no surface.
pub(super) fn old_boundary(nodes: &mut Vec<FlatNode>, index: usize) {
    let node = &nodes[index];
    let holds = |class| node.children.iter().any(|child| nodes[child.node.index()].class == class);
    if !holds(Class::Medium)
        || holds(Class::Bsdf)
        || holds(Class::Emitter)
        || holds(Class::Subsurface)
    {
        return;
    }
    let span = node.span;
    let surface = FlatNode {
        class: Class::Bsdf,
        plugin: "null".into(),
        id: None,
        span,
        parameters: List::new(),
        children: List::new(),
    };
    nodes.push(surface);
    let child = Child { name: None, node: NodeId(nodes.len() as u32 - 1), span };
    nodes[index].children.push(child);
}

fn has(node: &FlatNode, name: &str) -> bool {
    find(node, name).is_some()
        || node.children.iter().any(|child| child.name.as_deref() == Some(name))
}
