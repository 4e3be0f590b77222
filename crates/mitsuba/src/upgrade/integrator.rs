//! Integrators that wrap others or show layers.

use etendue_document::{Class, FlatNode, NodeId, Parameter, Value};

use super::approximation::Approximations;
use super::entries::{find, new_parameter, take};

/// Wrappers of version 0.6 that change the sample distribution or caching but not the converged
/// picture of the nested integrator; and version 3's Stokes vectors, whose first component is that
/// picture.
const WRAPPERS: &[&str] = &["adaptive", "irrcache", "stokes"];

/// Upgrades an integrator whose children have been upgraded.
pub(super) fn upgrade(nodes: &mut [FlatNode], index: usize, approximations: &mut Approximations) {
    drop_strict_normals(&mut nodes[index], approximations);
    unwrap(nodes, index, approximations);
    layers(nodes, index, approximations);
}

/// The layers of version 0.6's `field`, and their names here.
const FIELDS: &[(&str, &str)] = &[
    ("position", "position"),
    ("relPosition", "position"),
    ("distance", "depth"),
    ("geoNormal", "geo_normal"),
    ("shNormal", "sh_normal"),
    ("uv", "uv"),
    ("albedo", "albedo"),
    ("shapeIndex", "shape_index"),
    ("primIndex", "prim_index"),
];

/// Version 0.6's `field` and `multichannel` are version 3's `aov`: fields become its layers, other
/// integrators stay nested in it.
fn layers(nodes: &mut [FlatNode], index: usize, approximations: &mut Approximations) {
    let mut names = Vec::new();
    match nodes[index].plugin.as_str() {
        "field" => names.extend(field(&nodes[index])),
        "multichannel" => {
            for child in &nodes[index].children {
                let nested = &nodes[child.node.index()];
                if nested.class == Class::Integrator && nested.plugin == "aov" {
                    let layers = find(nested, "aovs").map(|layers| &layers.value);
                    if let Some(Value::String(layers)) = layers {
                        names.push(layers.clone());
                    }
                }
            }
        }
        _ => return,
    }
    let plugin = nodes[index].plugin.clone();
    let message = format!("`{plugin}` is rendered as `aov`, whose layers have names of their own");
    approximations.add(message, nodes[index].span);
    let is_layer = |id: NodeId| nodes[id.index()].plugin == "aov";
    let mut children = nodes[index].children.clone();
    children.retain(|child| !is_layer(child.node));
    let node = &mut nodes[index];
    let layers = new_parameter(node, "aovs", Value::String(names.join(", ")));
    node.parameters = vec![layers].into();
    node.children = children;
    node.plugin = "aov".into();
}

/// The layer that a `field` shows, as `aov` names it.
fn field(node: &FlatNode) -> Option<String> {
    let Value::String(field) = &find(node, "field")?.value else { return None };
    let known = FIELDS.iter().find(|(old, _)| old == field);
    let layer = known.map_or(field.as_str(), |(_, new)| new);
    Some(format!("{layer}:{layer}"))
}

/// Version 0.6's `strictNormals` removes light that arrives on different sides of the geometric and
/// the shading normal. Version 3 has no such parameter and drops it when it converts scenes. Meshes
/// without normals are smooth there and lose much light with it. We therefore render old scenes as
/// version 3 does; `strict_normals` still enables the rule.
fn drop_strict_normals(node: &mut FlatNode, approximations: &mut Approximations) {
    let old = find(node, "strict_normals").filter(|old| old.original_name == "strictNormals");
    let Some(Parameter { value: Value::Boolean(wanted), span, .. }) = old.cloned() else { return };
    take(node, "strict_normals");
    if wanted {
        let message = "`strictNormals` is dropped, as in version 3: `strict_normals` asks for it";
        approximations.add(message, span);
    }
}

/// Replaces a wrapper by the nested integrator, which has been upgraded.
fn unwrap(nodes: &mut [FlatNode], index: usize, approximations: &mut Approximations) {
    let wrapper = &nodes[index];
    if !WRAPPERS.contains(&wrapper.plugin.as_str()) {
        return;
    }
    let mut nested = wrapper.children.iter().map(|child| &nodes[child.node.index()]);
    let Some(inner) = nested.find(|inner| inner.class == Class::Integrator) else {
        return;
    };
    let message = format!("`{}` is left out around `{}`", wrapper.plugin, inner.plugin);
    approximations.add(message, wrapper.span);
    let FlatNode { plugin, parameters, children, .. } = inner.clone();
    let outer = &mut nodes[index];
    (outer.plugin, outer.parameters, outer.children) = (plugin, parameters, children);
}
