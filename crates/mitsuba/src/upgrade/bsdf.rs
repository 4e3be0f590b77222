//! BSDFs: Phong and Ward models, and microfacet distributions that no longer exist.

use etendue_document::{Child, Class, FlatNode, List, NodeId, Parameter, SpectrumValue, Value};
use glam::DVec3;

use super::approximation::Approximations;
use super::entries::{find, new_parameter, number, take};

/// Upgrades one BSDF; new nodes are appended.
pub(super) fn upgrade(
    nodes: &mut Vec<FlatNode>,
    index: usize,
    approximations: &mut Approximations,
) {
    match nodes[index].plugin.as_str() {
        "phong" | "ward" => glossy(nodes, index, approximations),
        "normalmap" => name_the_map(nodes, index),
        name if name.starts_with("rough") => distribution(&mut nodes[index], approximations),
        _ => {}
    }
}

/// Version 0.6 gives the picture of a `normalmap` no name.
fn name_the_map(nodes: &mut [FlatNode], index: usize) {
    let has_map = |name: Option<&str>| name == Some("normalmap");
    if find(&nodes[index], "normalmap").is_some()
        || nodes[index].children.iter().any(|child| has_map(child.name.as_deref()))
    {
        return;
    }
    let is_texture = |child: &Child| nodes[child.node.index()].class == Class::Texture;
    if let Some(place) = nodes[index].children.iter().position(is_texture) {
        nodes[index].children[place].name = Some("normalmap".into());
    }
}

/// Up to version 0.6 the default conductor is copper; since then, a mirror.
pub(super) fn old_defaults(node: &mut FlatNode) {
    let conductor = matches!(node.plugin.as_str(), "conductor" | "roughconductor");
    let stated = |name: &str| {
        find(node, name).is_some()
            || node.children.iter().any(|child| child.name.as_deref() == Some(name))
    };
    if node.class == Class::Bsdf && conductor && !["material", "eta", "k"].into_iter().any(stated) {
        let copper = new_parameter(node, "material", Value::String("Cu".to_owned()));
        node.parameters.push(copper);
    }
}

/// `as` (anisotropic Phong, Ashikhmin and Shirley) and `phong` become Beckmann with the same
/// `alpha`, from which version 0.6 derives their exponents.
fn distribution(node: &mut FlatNode, approximations: &mut Approximations) {
    let mut parameters = node.parameters.iter_mut();
    let Some(parameter) = parameters.rfind(|parameter| parameter.name == "distribution") else {
        return;
    };
    let Value::String(name) = &mut parameter.value else {
        return;
    };
    if matches!(name.as_str(), "phong" | "as") {
        let message = format!("the microfacet distribution `{name}` is rendered as `beckmann`");
        approximations.add(message, parameter.span);
        "beckmann".clone_into(name);
    }
}

/// The parts of a Phong or Ward model.
struct Glossy {
    diffuse: DVec3,
    specular: DVec3,
    alpha_u: f64,
    alpha_v: f64,
}

/// Phong and Ward add a glossy lobe to a diffuse one. This is equivalent to a blend of
/// `roughconductor` without Fresnel term and `diffuse`, each divided by its weight. A textured
/// colour cannot be divided; then `roughplastic` is the closest model.
fn glossy(nodes: &mut Vec<FlatNode>, index: usize, approximations: &mut Approximations) {
    let node = &mut nodes[index];
    let plugin = std::mem::take(&mut node.plugin);
    let (alpha_u, alpha_v) = roughness(node, &plugin);
    let colors =
        color(node, "diffuse_reflectance", 0.5).zip(color(node, "specular_reflectance", 0.2));
    let new = match colors {
        Some((diffuse, specular)) => {
            blend(nodes, index, &Glossy { diffuse, specular, alpha_u, alpha_v });
            "a blend of `diffuse` and `roughconductor`"
        }
        None => {
            let keep = ["diffuse_reflectance", "specular_reflectance"];
            node.parameters.retain(|parameter| keep.contains(&parameter.name.as_str()));
            let alpha = new_parameter(node, "alpha", Value::Float((alpha_u * alpha_v).sqrt()));
            node.parameters.push(alpha);
            node.plugin = "roughplastic".into();
            "`roughplastic`"
        }
    };
    approximations.add(format!("`{plugin}` is rendered as {new}"), nodes[index].span);
}

/// Beckmann roughness along both tangents.
///
/// Ward's lobe falls off with exp(−tan²θ_h / α²), like Beckmann's. Phong's falls off with cosⁿ of
/// the angle to the mirror direction, which is 2 θ_h, so with exp(−2 n θ_h²) near the peak: α² = 1
/// / (2 n + 1). This is Walter et al. 2007, section 5.2, for an exponent of 4 n.
fn roughness(node: &mut FlatNode, plugin: &str) -> (f64, f64) {
    let mut read = |name: &str, default: f64| {
        take(node, name).and_then(|parameter| number(&parameter.value)).unwrap_or(default)
    };
    if plugin == "ward" {
        return (read("alpha_u", 0.1), read("alpha_v", 0.1));
    }
    let exponent = read("exponent", 30.0).max(0.0);
    let alpha = (1.0 / (2.0 * exponent + 1.0)).sqrt();
    (alpha, alpha)
}

/// A constant colour; `None` if it is a texture or a measured spectrum.
fn color(node: &FlatNode, name: &str, default: f64) -> Option<DVec3> {
    if node.children.iter().any(|child| child.name.as_deref() == Some(name)) {
        return None;
    }
    let Some(parameter) = find(node, name) else {
        return Some(DVec3::splat(default));
    };
    match &parameter.value {
        Value::Rgb(color) => Some(*color),
        Value::Spectrum(SpectrumValue::Constant(number)) => Some(DVec3::splat(*number)),
        value => number(value).map(DVec3::splat),
    }
}

/// Turns the node into a blend of two new ones.
fn blend(nodes: &mut Vec<FlatNode>, index: usize, glossy: &Glossy) {
    let (diffuse, specular) = (glossy.diffuse.max_element(), glossy.specular.max_element());
    let sum = diffuse + specular;
    let weight = if sum > 0.0 { (specular / sum).clamp(0.0, 1.0) } else { 0.0 };
    let part = |color: DVec3, weight: f64| {
        let color = if weight > 0.0 { color / weight } else { color };
        Value::Rgb(color.clamp(DVec3::ZERO, DVec3::ONE))
    };
    let node = &nodes[index];
    let base = with_parameters(
        node,
        "diffuse",
        vec![new_parameter(node, "reflectance", part(glossy.diffuse, 1.0 - weight))],
    );
    let lobe = with_parameters(
        node,
        "roughconductor",
        vec![
            new_parameter(node, "material", Value::String("none".to_owned())),
            new_parameter(node, "distribution", Value::String("beckmann".to_owned())),
            new_parameter(node, "alpha_u", Value::Float(glossy.alpha_u)),
            new_parameter(node, "alpha_v", Value::Float(glossy.alpha_v)),
            new_parameter(node, "specular_reflectance", part(glossy.specular, weight)),
        ],
    );
    let weight = new_parameter(node, "weight", Value::Float(weight));
    let first = nodes.len() as u32;
    nodes.extend([base, lobe]);
    let node = &mut nodes[index];
    let child = |offset| Child { name: None, node: NodeId(first + offset), span: node.span };
    node.children = vec![child(0), child(1)].into();
    node.parameters = vec![weight].into();
    node.plugin = "blendbsdf".into();
}

/// A BSDF at the position of the node that it was made from.
pub(super) fn with_parameters(
    origin: &FlatNode,
    plugin: &str,
    parameters: Vec<Parameter>,
) -> FlatNode {
    FlatNode {
        class: Class::Bsdf,
        plugin: plugin.into(),
        id: None,
        span: origin.span,
        parameters: parameters.into(),
        children: List::new(),
    }
}
