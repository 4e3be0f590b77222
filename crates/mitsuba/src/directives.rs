//! The elements that control how the scene is read and are not part of it.

use std::path::Path;

use etendue_document::{Class, Fault, Name, NodeId, Parameter, Target, Value};

use crate::defines::NAME_LENGTH;
use crate::element::Element;
use crate::loader::Loader;

/// `<default name="spp" value="16"/>`: the value of `$spp` unless the caller gave one.
pub(crate) fn default(loader: &mut Loader<'_>, element: &Element<'_>, _: NodeId) {
    let name = element.required("name", loader.diagnostics);
    let value = element.required("value", loader.diagnostics);
    let Some(name) = name.filter(|_| value.is_some() || element.broken) else {
        return;
    };
    if name.value.is_empty() {
        loader.diagnostics.error(Fault::BadValue, name.span, "a default needs a name");
        return;
    }
    if name.value.len() > NAME_LENGTH {
        let message = format!("a name has at most {NAME_LENGTH} bytes");
        loader.diagnostics.error(Fault::Limit, name.span, message);
        return;
    }
    loader.defines.add_default(&name.value, value.map(|value| &*value.value));
}

/// `<alias id="old" as="new"/>`: another id for an object.
pub(crate) fn alias(loader: &mut Loader<'_>, element: &Element<'_>, _: NodeId) {
    let id = element.required("id", loader.diagnostics);
    let new = element.required("as", loader.diagnostics);
    if let (Some(id), Some(new)) = (id, new) {
        let target = Target::Alias(Name::from(&*id.value));
        loader.builder.define(Name::from(&*new.value), target, new.span);
    }
}

/// `<ref id="..."/>`: an object defined elsewhere, before or after.
pub(crate) fn reference(loader: &mut Loader<'_>, element: &Element<'_>, parent: NodeId) {
    let Some(id) = element.required("id", loader.diagnostics) else {
        return;
    };
    let name = element.value("name").filter(|name| !name.is_empty());
    let name = name.map(|name| loader.builder.name(name));
    loader.builder.refer(parent, (name, element.span), (&id.value, id.span));
}

/// `<path value="..."/>`: an additional folder in which files are looked up.
pub(crate) fn path(loader: &mut Loader<'_>, element: &Element<'_>, _: NodeId) {
    let Some(value) = element.required("value", loader.diagnostics) else {
        return;
    };
    let limit = loader.options.limits.paths;
    if loader.resolver.scene_paths.len() >= limit {
        let message = format!("more than {limit} `<path>` entries");
        loader.diagnostics.error(Fault::Limit, value.span, message);
        return;
    }
    let folder = value.value.replace('\\', "/");
    let folder = loader.source_folder().join(Path::new(&folder));
    loader.resolver.scene_paths.push(folder);
}

/// `<vec value="x, y, z"/>`: a control point of the enclosing curve.
pub(crate) fn control_point(loader: &mut Loader<'_>, element: &Element<'_>, parent: NodeId) {
    if loader.builder.node_mut(parent).class != Class::Curve {
        let message = "`<vec>` stands inside a `<curve>` only";
        loader.diagnostics.error(Fault::Syntax, element.span, message);
        return;
    }
    let Some(point) = element.vector(None, loader.diagnostics) else {
        return;
    };
    let node = loader.builder.node_mut(parent);
    let last = node.parameters.iter_mut().find_map(|parameter| match &mut parameter.value {
        Value::Points(points) => Some(points),
        _ => None,
    });
    match last {
        Some(points) => points.push(point),
        None => node.parameters.push(Parameter {
            name: "points".into(),
            original_name: "vec".into(),
            value: Value::Points(vec![point]),
            span: element.span,
        }),
    }
}
