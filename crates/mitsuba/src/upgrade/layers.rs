//! Composite BSDFs and sheets: mixtures, coatings, diffuse transmission, woven cloth.

use etendue_document::{Child, Class, Diagnostics, Fault, FlatNode, NodeId, Parameter, Value};
use glam::DVec3;

use super::approximation::Approximations;
use super::bsdf::with_parameters;
use super::entries::{color, find, new_parameter, number, take};

/// The reflectance at normal incidence of a coat without a numeric index: that of glass.
const USUAL_REFLECTANCE: f64 = 0.04;

/// Upgrades one BSDF whose children have been upgraded; new nodes are appended.
pub(super) fn upgrade(
    nodes: &mut Vec<FlatNode>,
    index: usize,
    approximations: &mut Approximations,
    diagnostics: &Diagnostics,
) {
    match nodes[index].plugin.as_str() {
        "mixturebsdf" => {
            if let Err(problem) = mixture(nodes, index) {
                refuse(&mut nodes[index], &problem, diagnostics);
            }
        }
        "coating" | "roughcoating" => match nested(nodes, index).as_slice() {
            [base] => coating(nodes, index, base, approximations),
            bases => {
                let problem =
                    format!("needs one bsdf inside it, the material below, not {}", bases.len());
                refuse(&mut nodes[index], &problem, diagnostics);
            }
        },
        "difftrans" => diffuse_transmitter(&mut nodes[index]),
        "hk" => slab(&mut nodes[index], approximations),
        "irawan" => cloth(&mut nodes[index], approximations),
        _ => {}
    }
}

/// The children that are BSDFs.
fn nested(nodes: &[FlatNode], index: usize) -> Vec<Child> {
    let is_bsdf = |child: &&Child| nodes[child.node.index()].class == Class::Bsdf;
    nodes[index].children.iter().filter(is_bsdf).cloned().collect()
}

/// Reports what is wrong with a composite, and puts a plain material in its place.
fn refuse(node: &mut FlatNode, problem: &str, diagnostics: &Diagnostics) {
    let message = format!("`{}` {problem}", node.plugin);
    diagnostics.error(Fault::MissingParameter, node.span, message);
    node.plugin = "diffuse".into();
    node.parameters.clear();
    node.children.clear();
}

/// A mixture of any number becomes nested blends of two. If the weights sum to less than one, the
/// rest is black; if to more, all are scaled down, as in version 0.6. The error says what is wrong
/// with the mixture.
fn mixture(nodes: &mut Vec<FlatNode>, index: usize) -> Result<(), String> {
    let materials = nested(nodes, index);
    if materials.is_empty() {
        return Err("needs the bsdfs that it mixes inside it".to_owned());
    }
    let Some(Value::String(text)) = find(&nodes[index], "weights").map(|weights| &weights.value)
    else {
        return Err("needs the string `weights`, one number for each bsdf".to_owned());
    };
    let words = text.split([',', ';', ' ', '\t', '\n']).filter(|word| !word.is_empty());
    let weights: Result<Vec<f64>, _> = words.map(str::parse::<f64>).collect();
    let weights = weights.map_err(|_| "has `weights` that are not numbers".to_owned())?;
    if !weights.iter().all(|weight| weight.is_finite() && *weight >= 0.0) {
        return Err("has `weights` that are negative".to_owned());
    }
    if weights.len() != materials.len() {
        return Err(format!("has {} weights for {} bsdfs", weights.len(), materials.len()));
    }
    let total: f64 = weights.iter().sum();
    let mut parts: Vec<(Child, f64)> = materials.into_iter().zip(weights).collect();
    if total < 1.0 {
        let origin = &nodes[index];
        let nothing = new_parameter(origin, "reflectance", Value::Float(0.0));
        let black = with_parameters(origin, "diffuse", vec![nothing]);
        parts.push((add(nodes, black), 1.0 - total));
    }
    let root = blend(nodes, index, &parts);
    let FlatNode { plugin, parameters, children, .. } = nodes[root.node.index()].clone();
    let node = &mut nodes[index];
    (node.plugin, node.parameters, node.children) = (plugin, parameters, children);
    Ok(())
}

/// Appends a node; returns its entry for a parent.
fn add(nodes: &mut Vec<FlatNode>, node: FlatNode) -> Child {
    let child = Child { name: None, node: NodeId(nodes.len() as u32), span: node.span };
    nodes.push(node);
    child
}

/// A balanced tree of blends, to limit the depth.
fn blend(nodes: &mut Vec<FlatNode>, origin: usize, parts: &[(Child, f64)]) -> Child {
    if let [(only, _)] = parts {
        return only.clone();
    }
    let halves = parts.split_at(parts.len() / 2);
    let [first, second] = [halves.0, halves.1].map(|half| {
        (blend(nodes, origin, half), half.iter().map(|(_, weight)| weight).sum::<f64>())
    });
    let sum = first.1 + second.1;
    let weight = if sum > 0.0 { second.1 / sum } else { 0.0 };
    let weight = new_parameter(&nodes[origin], "weight", Value::Float(weight));
    let mut node = with_parameters(&nodes[origin], "blendbsdf", vec![weight]);
    node.children = vec![first.0, second.0].into();
    add(nodes, node)
}

/// A clear coat over a diffuse base is `plastic`; over anything else, a mirror is mixed in,
/// weighted by the coat's reflectance at normal incidence.
fn coating(
    nodes: &mut Vec<FlatNode>,
    index: usize,
    base: &Child,
    approximations: &mut Approximations,
) {
    let below = nodes[base.node.index()].clone();
    let plugin = nodes[index].plugin.clone();
    let is_rough = plugin == "roughcoating";
    let new = if matches!(below.plugin.as_str(), "diffuse" | "roughdiffuse") {
        let new = if is_rough { "roughplastic" } else { "plastic" };
        coat_diffuse(&mut nodes[index], &below, new);
        format!("`{new}`")
    } else {
        let new = if is_rough { "roughconductor" } else { "conductor" };
        let weight = normal_reflectance(&nodes[index]);
        let mut coat = nodes[index].clone();
        keep(&mut coat, &["specular_reflectance", "alpha", "alpha_u", "alpha_v", "distribution"]);
        coat.id = None;
        coat.plugin = new.into();
        let material = new_parameter(&coat, "material", Value::String("none".to_owned()));
        coat.parameters.push(material);
        let coat = add(nodes, coat);
        let node = &mut nodes[index];
        let weight = new_parameter(node, "weight", Value::Float(weight));
        (node.parameters, node.children) = (vec![weight].into(), vec![base.clone(), coat].into());
        node.plugin = "blendbsdf".into();
        format!("a blend with a `{new}`")
    };
    let message =
        format!("`{plugin}` over `{}` is rendered as {new}, without absorption", below.plugin);
    approximations.add(message, nodes[index].span);
}

/// Turns a coating into a plastic, given its diffuse base.
fn coat_diffuse(node: &mut FlatNode, base: &FlatNode, plugin: &str) {
    let kept = ["int_ior", "ext_ior", "specular_reflectance", "alpha", "distribution"];
    keep(node, &kept);
    let reflectance = base.parameters.iter().filter(|parameter| parameter.name == "reflectance");
    node.parameters.extend(reflectance.cloned().map(|mut parameter| {
        parameter.name = "diffuse_reflectance".into();
        parameter
    }));
    let textures =
        base.children.iter().filter(|child| child.name.as_deref() == Some("reflectance"));
    node.children.extend(textures.map(|child| Child {
        name: Some("diffuse_reflectance".into()),
        node: child.node,
        span: child.span,
    }));
    // The base colours light that the coat reflects back onto it, as in the coating.
    let nonlinear = new_parameter(node, "nonlinear", Value::Boolean(true));
    node.parameters.push(nonlinear);
    node.plugin = plugin.into();
}

/// Keeps only the named parameters and children.
fn keep(node: &mut FlatNode, names: &[&str]) {
    node.parameters.retain(|parameter| names.contains(&parameter.name.as_str()));
    node.children.retain(|child| child.name.as_deref().is_some_and(|name| names.contains(&name)));
}

fn normal_reflectance(node: &FlatNode) -> f64 {
    let index = |name: &str| find(node, name).and_then(|parameter| number(&parameter.value));
    let Some(inside) = index("int_ior") else { return USUAL_REFLECTANCE };
    let eta = inside / index("ext_ior").unwrap_or(1.0);
    let root = (eta - 1.0) / (eta + 1.0);
    if root.is_finite() { (root * root).min(1.0) } else { USUAL_REFLECTANCE }
}

/// Diffuse transmission is a thin sheet that transmits all diffuse light.
fn diffuse_transmitter(node: &mut FlatNode) {
    rename(node, "transmittance", "base_color");
    let all = new_parameter(node, "diff_trans", Value::Float(2.0));
    node.parameters.push(all);
    node.plugin = "principledthin".into();
}

/// Hanrahan and Krueger's slab becomes a sheet with its albedo, with half of the light on either
/// side.
fn slab(node: &mut FlatNode, approximations: &mut Approximations) {
    let albedo = take(node, "albedo").and_then(|albedo| color(&albedo.value));
    let [scattering, absorption] =
        ["sigma_s", "sigma_a"].map(|name| take(node, name).and_then(|found| color(&found.value)));
    let ratio = scattering.zip(absorption).map(|(scattering, absorption)| {
        let extinction = (scattering + absorption).max(DVec3::splat(f64::MIN_POSITIVE));
        (scattering / extinction).clamp(DVec3::ZERO, DVec3::ONE)
    });
    let color = albedo.or(ratio).unwrap_or(DVec3::splat(0.5));
    node.parameters = vec![
        new_parameter(node, "base_color", Value::Rgb(color)),
        new_parameter(node, "diff_trans", Value::Float(1.0)),
    ]
    .into();
    node.children.clear();
    node.plugin = "principledthin".into();
    let message = "`hk` is rendered as `principledthin`, a diffuse sheet of its albedo";
    approximations.add(message, node.span);
}

/// Woven cloth becomes a rough surface: its weave is in a separate file format.
fn cloth(node: &mut FlatNode, approximations: &mut Approximations) {
    node.parameters = vec![new_parameter(node, "alpha", Value::Float(0.5))].into();
    node.children.clear();
    node.plugin = "roughdiffuse".into();
    let message = "`irawan` is rendered as `roughdiffuse`, without its weave";
    approximations.add(message, node.span);
}

fn rename(node: &mut FlatNode, old: &str, new: &str) {
    let parameters = node.parameters.iter_mut().filter(|parameter| parameter.name == old);
    parameters.for_each(|parameter: &mut Parameter| parameter.name = new.into());
    let children = node.children.iter_mut().filter(|child| child.name.as_deref() == Some(old));
    children.for_each(|child| child.name = Some(new.into()));
}
