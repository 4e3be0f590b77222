//! Plugins that nobody knows, replaced by the plainest of their family.

use std::collections::{BTreeSet, HashSet};

use etendue_document::{
    Child, Class, Diagnostic, Diagnostics, Document, Fault, FlatNode, NodeId, Parameter, Value,
};
use etendue_integrators as integrators;
use etendue_scene::registry;

/// The plainest plugin of a family.
struct Plain {
    plugin: &'static str,
    /// The parameters that it takes over.
    kept: &'static [&'static str],
    /// What it gets besides.
    given: &'static [(&'static str, f64)],
    /// The classes of the children that it takes over.
    children: &'static [Class],
}

const FILM: &[&str] =
    &["width", "height", "crop_offset_x", "crop_offset_y", "crop_width", "crop_height"];

/// The plainest plugin of a family; `None` for families that are left out.
fn plainest(class: Class) -> Option<Plain> {
    let plain = |plugin, kept, given, children| Some(Plain { plugin, kept, given, children });
    match class {
        Class::Bsdf => plain("diffuse", &[], &[("reflectance", 0.5)], &[]),
        Class::Texture => plain("rawconstant", &[], &[("value", 0.5)], &[]),
        Class::Integrator => plain("path", &["max_depth", "rr_depth", "hide_emitters"], &[], &[]),
        Class::Film => plain("hdrfilm", FILM, &[], &[Class::ReconstructionFilter]),
        Class::Sampler => plain("independent", &["sample_count", "seed"], &[], &[]),
        Class::ReconstructionFilter => plain("gaussian", &[], &[], &[]),
        Class::Sensor => {
            let children = &[Class::Film, Class::Sampler, Class::Medium];
            plain("perspective", &["to_world", "fov", "fov_axis"], &[], children)
        }
        Class::Phase => plain("isotropic", &[], &[], &[]),
        Class::Volume => plain("constvolume", &["to_world"], &[("value", 0.5)], &[]),
        _ => None,
    }
}

/// Replaces unknown plugins, or leaves them out, with a warning each.
pub(crate) fn replace_unknown(document: &mut Document, diagnostics: &Diagnostics) {
    let pages = registry::plugins().into_iter().chain(integrators::plugins());
    let known: BTreeSet<(Class, &str)> = pages.map(|(class, name, _)| (class, name)).collect();
    let is_unknown = |node: &FlatNode| {
        // The scene itself is no plugin, a subsurface has none here, and a curve is checked by the
        // shape that it belongs to. Nodes without a name have been reported.
        !matches!(node.class, Class::Scene | Class::Subsurface | Class::Curve)
            && !node.plugin.is_empty()
            && !known.contains(&(node.class, node.plugin.as_str()))
    };
    let unknown: Vec<usize> =
        (0..document.nodes.len()).filter(|index| is_unknown(&document.nodes[*index])).collect();
    let mut left_out = HashSet::new();
    for index in unknown {
        let classes = |child: &Child| document.nodes[child.node.index()].class;
        let children: Vec<Class> = document.nodes[index].children.iter().map(classes).collect();
        let node = &mut document.nodes[index];
        let (class, old) = (node.class.name(), node.plugin.clone());
        let message = match plainest(node.class) {
            Some(plain) => {
                replace(node, &plain, &children);
                format!("unknown {class} `{old}`: `{}` replaces it", plain.plugin)
            }
            None => {
                // Nodes without a name are not built.
                node.plugin = "".into();
                node.parameters.clear();
                node.children.clear();
                left_out.insert(NodeId(index as u32));
                format!("unknown {class} `{old}`: it is left out")
            }
        };
        diagnostics.push(Diagnostic::warning(Fault::Approximation, node.span, message));
    }
    if !left_out.is_empty() {
        for node in &mut document.nodes {
            node.children.retain(|child| !left_out.contains(&child.node));
        }
    }
}

/// Turns a node into a plain one; `children` are the classes of its children.
fn replace(node: &mut FlatNode, plain: &Plain, children: &[Class]) {
    node.plugin = plain.plugin.into();
    node.parameters.retain(|parameter| plain.kept.contains(&parameter.name.as_str()));
    for (name, value) in plain.given {
        node.parameters.push(Parameter {
            name: (*name).into(),
            original_name: (*name).into(),
            value: Value::Float(*value),
            span: node.span,
        });
    }
    let mut classes = children.iter();
    node.children.retain(|_| classes.next().is_some_and(|class| plain.children.contains(class)));
}
