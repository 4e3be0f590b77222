//! Textures: the scale and offset of coordinates, filters, wrapping, gamma.

use etendue_document::{FlatNode, Parameter, Value};
use glam::{DMat4, DVec3};

use super::approximation::Approximations;
use super::entries::{find, new_parameter, number, take};

/// Upgrades the parameters of one texture.
pub(super) fn upgrade(node: &mut FlatNode, approximations: &mut Approximations) {
    coordinates(node);
    match node.plugin.as_str() {
        "vertexcolors" => vertex_colors(node),
        "wireframe" => wireframe(node, approximations),
        "curvature" => curvature(node, approximations),
        _ => {}
    }
    if node.plugin == "bitmap" {
        filter(node, approximations);
        wrapping(node, approximations);
        gamma(node, approximations);
    }
}

/// Vertex colours are an ordinary mesh attribute.
fn vertex_colors(node: &mut FlatNode) {
    node.parameters =
        vec![new_parameter(node, "name", Value::String("vertex_color".to_owned()))].into();
    node.plugin = "mesh_attribute".into();
}

/// Texture coordinates do not tell where edges are, so only the colour between them remains.
fn wireframe(node: &mut FlatNode, approximations: &mut Approximations) {
    node.parameters.retain(|parameter| parameter.name == "interior_color");
    node.children.retain(|child| child.name.as_deref() == Some("interior_color"));
    node.parameters.iter_mut().for_each(|parameter| parameter.name = "color0".into());
    node.children.iter_mut().for_each(|child| child.name = Some("color0".into()));
    if node.parameters.is_empty() && node.children.is_empty() {
        node.parameters.push(new_parameter(node, "color0", Value::Float(0.5)));
    }
    without_lines(node);
    let message = "a `wireframe` is rendered in its interior colour, without edges";
    approximations.add(message, node.span);
}

/// Curvature is not computed here; a constant replaces it.
fn curvature(node: &mut FlatNode, approximations: &mut Approximations) {
    node.parameters = vec![new_parameter(node, "color0", Value::Float(0.5))].into();
    node.children.clear();
    without_lines(node);
    approximations.add("a `curvature` texture is rendered as grey", node.span);
}

/// A grid without lines becomes a colour.
fn without_lines(node: &mut FlatNode) {
    let width = new_parameter(node, "line_width", Value::Float(0.0));
    node.parameters.push(width);
    node.plugin = "gridtexture".into();
}

/// `uscale`, `vscale`, `uoffset`, `voffset` become `to_uv`: scaled first, then offset, as in
/// version 0.6.
fn coordinates(node: &mut FlatNode) {
    let mut place = None;
    let mut read = |name: &str, default: f64| {
        let value = find(node, name).and_then(|parameter| number(&parameter.value));
        // A value of another type is kept and reported as unknown.
        let Some(value) = value else {
            return default;
        };
        place = take(node, name).map(|parameter| parameter.span).or(place);
        value
    };
    let scale = DVec3::new(read("uscale", 1.0), read("vscale", 1.0), 1.0);
    let offset = DVec3::new(read("uoffset", 0.0), read("voffset", 0.0), 0.0);
    let Some(span) = place else {
        return;
    };
    let matrix = DMat4::from_translation(offset) * DMat4::from_scale(scale);
    let outer = match take(node, "to_uv").map(|parameter| parameter.value) {
        Some(Value::Transform(outer)) => outer.into(),
        _ => DMat4::IDENTITY,
    };
    node.parameters.push(Parameter {
        name: "to_uv".into(),
        original_name: "to_uv".into(),
        value: Value::transform(outer * matrix),
        span,
    });
}

/// Mipmap filters are replaced by the filter without levels.
fn filter(node: &mut FlatNode, approximations: &mut Approximations) {
    replace_text(node, "filter_type", |filter| match filter {
        "trilinear" | "ewa" | "isotropic" | "anisotropic" => {
            let message =
                format!("the texture filter `{filter}` is rendered as `bilinear`, without levels");
            Some(("bilinear", Some(message)))
        }
        _ => None,
    })
    .into_iter()
    .for_each(|(message, span)| approximations.add(message, span));
}

/// `wrap_mode_u` and `wrap_mode_v` become one `wrap_mode`; `zero` and `one` have no equivalent.
fn wrapping(node: &mut FlatNode, approximations: &mut Approximations) {
    let u = take(node, "wrap_mode_u");
    let v = take(node, "wrap_mode_v");
    if let (Some(u), Some(v)) = (&u, &v)
        && u.value != v.value
    {
        let message = "`wrapModeU` counts for both directions, `wrapModeV` is left out";
        approximations.add(message, v.span);
    }
    if let Some(mode) = u.or(v) {
        node.parameters.push(Parameter { name: "wrap_mode".into(), ..mode });
    }
    replace_text(node, "wrap_mode", |mode| match mode {
        "zero" | "one" | "black" | "white" => {
            Some(("clamp", Some(format!("the wrap mode `{mode}` is rendered as `clamp`"))))
        }
        _ => None,
    })
    .into_iter()
    .for_each(|(message, span)| approximations.add(message, span));
}

/// A gamma of 1 means raw numbers; a negative gamma means the file's own.
fn gamma(node: &mut FlatNode, approximations: &mut Approximations) {
    let Some((gamma, span)) = find(node, "gamma").and_then(|p| Some((number(&p.value)?, p.span)))
    else {
        return;
    };
    take(node, "gamma");
    if gamma == 1.0 {
        if find(node, "raw").is_none() {
            node.parameters.push(Parameter {
                name: "raw".into(),
                original_name: "gamma".into(),
                value: Value::Boolean(true),
                span,
            });
        }
    } else if gamma > 0.0 {
        let message = format!("a texture gamma of {gamma} is rendered as the sRGB curve");
        approximations.add(message, span);
    }
}

/// Replaces a text if `replacement` has a substitute; returns what to report, and where.
fn replace_text(
    node: &mut FlatNode,
    name: &str,
    replacement: impl Fn(&str) -> Option<(&'static str, Option<String>)>,
) -> Option<(String, etendue_document::Span)> {
    let parameter = node.parameters.iter_mut().rfind(|parameter| parameter.name == name)?;
    let Value::String(text) = &mut parameter.value else {
        return None;
    };
    let (new, message) = replacement(text)?;
    new.clone_into(text);
    message.map(|message| (message, parameter.span))
}
