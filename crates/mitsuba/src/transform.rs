//! `<transform>` and the operations inside it.

use etendue_document::{
    Diagnostic, Diagnostics, Fault, Value, list_names, look_at_matrix, thickened, transform_problem,
};
use glam::{DMat3, DMat4, DVec3};

use crate::element::Element;
use crate::loader::Loader;
use crate::numbers;

/// An operation: its element, its attributes and its reader.
struct Operation {
    name: &'static str,
    attributes: &'static [&'static str],
    read: fn(&Element<'_>, &Diagnostics) -> Option<DMat4>,
}

/// Versions before 2 write `lookAt`.
static OPERATIONS: &[Operation] = &[
    Operation { name: "translate", attributes: &["value", "x", "y", "z"], read: translate },
    Operation { name: "rotate", attributes: &["value", "x", "y", "z", "angle"], read: rotate },
    Operation { name: "scale", attributes: &["value", "x", "y", "z"], read: scale },
    Operation { name: "matrix", attributes: &["value"], read: matrix },
    Operation { name: "lookat", attributes: &["origin", "target", "up"], read: look_at },
    Operation { name: "lookAt", attributes: &["origin", "target", "up"], read: look_at },
];

/// The operations of a `<transform>`, each applied after those above it.
pub(crate) fn read(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let name = element.value("name").unwrap_or_default();
    let planar = matches!(name, "to_uv" | "toUV");
    // A flat shape can be seen; a flat camera or volume means nothing.
    let parent = element.node.parent_element();
    let may_be_flat = !planar && parent.is_some_and(|parent| parent.has_tag_name("shape"));
    let thickened = |matrix| if may_be_flat { thickened(matrix) } else { None };
    let mut transform = DMat4::IDENTITY;
    let mut failed = element.broken;
    for node in element.node.children().filter(roxmltree::Node::is_element) {
        let operation = loader.open(node);
        let matrix = apply(&operation, loader.diagnostics);
        let is_usable = |matrix: &DMat4| {
            thickened(*matrix).is_some() || check(*matrix, name, &operation, loader.diagnostics)
        };
        match matrix.filter(is_usable) {
            Some(matrix) if planar => transform = planar_matrix(matrix, &operation) * transform,
            Some(matrix) => transform = matrix * transform,
            None => failed = true,
        }
    }
    if let Some(thick) = thickened(transform).filter(|_| !failed) {
        let message = "this transform is flat: it keeps a thickness of a millionth";
        loader.diagnostics.warning(Fault::BadValue, element.span, message);
        transform = thick;
    }
    // The product may be unusable even if every factor is usable.
    let usable = !failed && check(transform, name, element, loader.diagnostics);
    usable.then(|| Value::transform(transform))
}

fn apply(element: &Element<'_>, diagnostics: &Diagnostics) -> Option<DMat4> {
    let Some(operation) = OPERATIONS.iter().find(|known| known.name == element.name()) else {
        let message = format!("`<{}>` is not an operation of a transform", element.name());
        let names = list_names(OPERATIONS.iter().map(|known| known.name));
        let diagnostic = Diagnostic::error(Fault::Syntax, element.span, message);
        diagnostics.push(diagnostic.help(format!("these are: {names}")));
        return None;
    };
    element.check_attributes(operation.attributes, diagnostics);
    if element.broken {
        return None;
    }
    (operation.read)(element, diagnostics)
}

fn translate(element: &Element<'_>, diagnostics: &Diagnostics) -> Option<DMat4> {
    element.vector(Some(0.0), diagnostics).map(DMat4::from_translation)
}

fn scale(element: &Element<'_>, diagnostics: &Diagnostics) -> Option<DMat4> {
    element.vector(Some(1.0), diagnostics).map(DMat4::from_scale)
}

/// A rotation by `angle` degrees about an axis.
fn rotate(element: &Element<'_>, diagnostics: &Diagnostics) -> Option<DMat4> {
    let axis = element.vector(Some(0.0), diagnostics)?;
    let angle = element.required("angle", diagnostics)?;
    let angle = element.read(angle, numbers::number, diagnostics)?;
    if let Some(axis) = axis.try_normalize() {
        return Some(DMat4::from_axis_angle(axis, angle.to_radians()));
    }
    let message = "a rotation needs an axis that is not zero";
    if angle == 0.0 {
        diagnostics.warning(Fault::BadValue, element.span, message);
        return Some(DMat4::IDENTITY);
    }
    diagnostics.error(Fault::BadValue, element.span, message);
    None
}

/// Sixteen numbers, row by row, or nine for the upper left corner.
fn matrix(element: &Element<'_>, diagnostics: &Diagnostics) -> Option<DMat4> {
    let attribute = element.required("value", diagnostics)?;
    let numbers = element.read(attribute, numbers::numbers, diagnostics)?;
    if let Ok(rows) = <&[f64; 16]>::try_from(numbers.as_slice()) {
        return Some(DMat4::from_cols_array(rows).transpose());
    }
    if let Ok(rows) = <&[f64; 9]>::try_from(numbers.as_slice()) {
        return Some(DMat4::from_mat3(DMat3::from_cols_array(rows).transpose()));
    }
    let message = format!("a matrix has 16 or 9 numbers, not {}", numbers.len());
    diagnostics.error(Fault::BadValue, attribute.span, message);
    None
}

/// Camera to world. Without `up`, an arbitrary up direction is chosen.
fn look_at(element: &Element<'_>, diagnostics: &Diagnostics) -> Option<DMat4> {
    let vector = |name| {
        let attribute = element.required(name, diagnostics)?;
        element.vector_in(attribute, diagnostics)
    };
    let (origin, target) = (vector("origin")?, vector("target")?);
    let up = match element.attribute("up") {
        Some(attribute) => element.vector_in(attribute, diagnostics)?,
        None => DVec3::ZERO,
    };
    let report = |message| diagnostics.error(Fault::BadValue, element.span, message);
    look_at_matrix(origin, target, up).map_err(report).ok()
}

/// Whether a matrix is usable as the transform `name`; reports why not.
fn check(matrix: DMat4, name: &str, element: &Element<'_>, diagnostics: &Diagnostics) -> bool {
    let problem = transform_problem(name, matrix);
    if let Some(problem) = problem {
        diagnostics.error(Fault::BadValue, element.span, problem);
    }
    problem.is_none()
}

/// Nine numbers for `to_uv` are a homogeneous transformation of the plane whose last column is the
/// offset; here, offsets are in the fourth column.
fn planar_matrix(matrix: DMat4, element: &Element<'_>) -> DMat4 {
    let count = element.value("value").map_or(0, |value| numbers::words(value).count());
    if element.name() != "matrix" || count != 9 {
        return matrix;
    }
    let mut moved = matrix;
    moved.w_axis = matrix.z_axis.truncate().with_z(0.0).extend(1.0);
    moved.z_axis = DVec3::Z.extend(0.0);
    moved
}
