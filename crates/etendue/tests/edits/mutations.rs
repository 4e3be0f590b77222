//! Small changes of documents.

use etendue::document::{Class, Document, FlatNode, NodeId, Value};
use etendue::math::glam::{DAffine3, DVec3};

/// Every small change of a document, with a description.
pub(crate) fn all(document: &Document) -> Vec<(String, Document)> {
    let mut list = Vec::new();
    for (index, node) in document.nodes.iter().enumerate() {
        let name = format!("{index}: {} {}", node.class.name(), node.plugin);
        for (at, parameter) in node.parameters.iter().enumerate() {
            let name = format!("{name}, `{}`", parameter.name);
            list.push(change(document, format!("{name} changed"), index, |node| {
                let value = &mut node.parameters[at].value;
                *value = other_value(value);
            }));
            list.push(change(document, format!("{name} removed"), index, |node| {
                remove(&mut node.parameters, at);
            }));
        }
        for at in 0..node.children.len() {
            list.push(change(document, format!("{name}, child {at} removed"), index, |node| {
                remove(&mut node.children, at);
            }));
            list.push(change(document, format!("{name}, child {at} twice"), index, |node| {
                let child = node.children[at].clone();
                node.children.push(child);
            }));
        }
        if node.children.len() > 1 {
            list.push(change(document, format!("{name}, children turned round"), index, |node| {
                node.children.reverse();
            }));
        }
    }
    list.extend(additions(document));
    list
}

fn change(
    document: &Document,
    what: String,
    index: usize,
    change: impl FnOnce(&mut FlatNode),
) -> (String, Document) {
    let mut document = document.clone();
    change(&mut document.nodes[index]);
    (what, document)
}

fn remove<T>(list: &mut etendue::document::List<T>, at: usize) {
    let mut index = 0;
    list.retain(|_| {
        index += 1;
        index != at + 1
    });
}

/// A node of each class, added to the scene before and after all others.
fn additions(document: &Document) -> Vec<(String, Document)> {
    let kinds = [
        (Class::Shape, "sphere"),
        (Class::Shape, "cube"),
        (Class::Shape, "cone"),
        (Class::Emitter, "point"),
        (Class::Emitter, "constant"),
        (Class::Bsdf, "plastic"),
        (Class::Sensor, "perspective"),
        (Class::Integrator, "direct"),
        (Class::Texture, "checkerboard"),
        (Class::Medium, "homogeneous"),
    ];
    let mut list = Vec::new();
    for (class, plugin) in kinds {
        for at_end in [false, true] {
            let mut document = document.clone();
            let id = NodeId(document.nodes.len() as u32);
            let root = document.nodes[document.root.index()].clone();
            let mut child = root.children[0].clone();
            (child.name, child.node) = (None, id);
            let mut children = root.children.into_vec();
            children.insert(if at_end { children.len() } else { 0 }, child);
            document.nodes[document.root.index()].children = children.into();
            document.nodes.push(FlatNode {
                class,
                plugin: plugin.into(),
                id: None,
                span: root.span,
                parameters: Vec::new().into(),
                children: Vec::new().into(),
            });
            list.push((format!("{} {plugin} added, at end: {at_end}", class.name()), document));
        }
    }
    list
}

fn other_value(value: &Value) -> Value {
    match value {
        Value::Boolean(boolean) => Value::Boolean(!boolean),
        Value::Integer(integer) => Value::Integer(integer + 1),
        Value::Float(float) => Value::Float(float * 0.75 + 0.01),
        Value::String(text) => Value::String(other_text(text)),
        Value::Point(point) => Value::Point(*point + DVec3::new(0.125, 0.0, 0.25)),
        Value::Vector(vector) => Value::Vector(*vector + DVec3::new(0.125, 0.0, 0.25)),
        Value::Rgb(rgb) => Value::Rgb(*rgb * 0.5),
        Value::Transform(affine) => {
            Value::Transform(DAffine3::from_translation(DVec3::new(0.1, 0.2, 0.0)) * *affine)
        }
        Value::Points(points) => Value::Points(points.iter().map(|point| *point * 1.25).collect()),
        // A value of another type, which is an error.
        _ => Value::Boolean(true),
    }
}

/// Another file of the same kind, or an unknown name.
fn other_text(text: &str) -> String {
    match text {
        "colored.ply" => "plain.ply".to_owned(),
        "plain.ply" => "colored.ply".to_owned(),
        "a.pfm" => "b.pfm".to_owned(),
        _ => format!("{text}-other"),
    }
}
