//! The table of all elements.

use etendue_document::{Class, NodeId, Value};

use crate::element::Element;
use crate::loader::Loader;
use crate::{directives, transform, values};

/// The kind of an element.
pub(crate) enum Kind {
    /// An object with a plugin.
    Object(Class),
    /// A named value of the enclosing object.
    Value {
        /// Reads it; reports errors and then returns `None`.
        read: fn(&mut Loader<'_>, &Element<'_>) -> Option<Value>,
        /// The attributes it accepts.
        attributes: &'static [&'static str],
        /// Whether it holds elements that `read` inspects.
        nested: bool,
    },
    /// An instruction to the reader.
    Directive {
        /// Executes it, inside the given object.
        run: fn(&mut Loader<'_>, &Element<'_>, NodeId),
        /// The attributes it accepts.
        attributes: &'static [&'static str],
    },
    /// The content of another file.
    Include {
        /// The attributes it accepts.
        attributes: &'static [&'static str],
    },
}

const fn value(
    read: fn(&mut Loader<'_>, &Element<'_>) -> Option<Value>,
    attributes: &'static [&'static str],
) -> Kind {
    Kind::Value { read, attributes, nested: false }
}

const fn directive(
    run: fn(&mut Loader<'_>, &Element<'_>, NodeId),
    attributes: &'static [&'static str],
) -> Kind {
    Kind::Directive { run, attributes }
}

/// The elements inside a `<scene>` or an object.
///
/// Versions before 0.5 write `camera` and `luminaire`.
static ELEMENTS: &[(&str, Kind)] = &[
    ("integrator", Kind::Object(Class::Integrator)),
    ("sensor", Kind::Object(Class::Sensor)),
    ("camera", Kind::Object(Class::Sensor)),
    ("film", Kind::Object(Class::Film)),
    ("sampler", Kind::Object(Class::Sampler)),
    ("rfilter", Kind::Object(Class::ReconstructionFilter)),
    ("shape", Kind::Object(Class::Shape)),
    ("bsdf", Kind::Object(Class::Bsdf)),
    ("texture", Kind::Object(Class::Texture)),
    ("emitter", Kind::Object(Class::Emitter)),
    ("luminaire", Kind::Object(Class::Emitter)),
    ("medium", Kind::Object(Class::Medium)),
    ("phase", Kind::Object(Class::Phase)),
    ("volume", Kind::Object(Class::Volume)),
    ("subsurface", Kind::Object(Class::Subsurface)),
    ("curve", Kind::Object(Class::Curve)),
    ("boolean", value(values::boolean, &["name", "value"])),
    ("integer", value(values::integer, &["name", "value"])),
    ("float", value(values::float, &["name", "value"])),
    ("string", value(values::string, &["name", "value"])),
    ("point", value(values::point, &["name", "value", "x", "y", "z"])),
    ("vector", value(values::vector, &["name", "value", "x", "y", "z"])),
    ("rgb", value(values::rgb, &["name", "value", "intent"])),
    ("srgb", value(values::srgb, &["name", "value", "intent"])),
    ("spectrum", value(values::spectrum, &["name", "value", "filename", "intent"])),
    ("blackbody", value(values::blackbody, &["name", "temperature", "scale"])),
    ("transform", Kind::Value { read: transform::read, attributes: &["name"], nested: true }),
    ("default", directive(directives::default, &["name", "value"])),
    ("alias", directive(directives::alias, &["id", "as"])),
    ("ref", directive(directives::reference, &["id", "name"])),
    ("path", directive(directives::path, &["value"])),
    ("vec", directive(directives::control_point, &["value", "x", "y", "z"])),
    ("include", Kind::Include { attributes: &["filename", "name"] }),
];

/// The kind of the element of that name.
pub(crate) fn kind(element: &Element<'_>) -> Option<&'static Kind> {
    let name = element.name();
    // Version 3 writes colour plugins as `<spectrum type="...">`: they are textures.
    if name == "spectrum" && element.attribute("type").is_some() {
        return Some(&Kind::Object(Class::Texture));
    }
    ELEMENTS.iter().find(|(known, _)| *known == name).map(|(_, kind)| kind)
}

/// The names of all elements, for suggestions.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    ELEMENTS.iter().map(|(name, _)| *name)
}

/// Elements that people write, and what is written here instead.
static INSTEAD: &[(&[&str], &str)] = &[
    (&["color", "colour"], "a colour is `<rgb name=\"…\" value=\"r, g, b\"/>`"),
    (&["light", "lamp"], "a light is `<emitter type=\"…\">`"),
    (&["material", "brdf", "shader"], "a material is `<bsdf type=\"…\">`"),
    (&["object", "mesh", "geometry", "model"], "geometry is `<shape type=\"…\">`"),
    (
        &["sphere", "cube", "rectangle", "disk", "cylinder", "obj", "ply", "serialized"],
        "the name is a type: `<shape type=\"sphere\">`",
    ),
    (
        &["diffuse", "conductor", "dielectric", "plastic", "roughplastic", "principled"],
        "the name is a type: `<bsdf type=\"diffuse\">`",
    ),
    (&["area", "point", "constant", "envmap"], "the name is a type: `<emitter type=\"area\">`"),
    (
        &["translate", "rotate", "scale", "matrix", "lookat", "lookAt", "look_at"],
        "this stands inside a transform: `<transform name=\"to_world\">`",
    ),
    (&["int", "uint", "long"], "a whole number is `<integer name=\"…\" value=\"…\"/>`"),
    (&["number", "double", "real"], "a number is `<float name=\"…\" value=\"…\"/>`"),
    (&["bool"], "it is written `<boolean name=\"…\" value=\"true\"/>`"),
    (&["image", "bitmap"], "a picture is `<texture type=\"bitmap\">`"),
    (&["vec3", "vector3"], "three numbers are `<vector name=\"…\" value=\"x, y, z\"/>`"),
];

/// What to write instead of an element that does not exist.
pub(crate) fn advice(name: &str) -> Option<&'static str> {
    let row = INSTEAD.iter().find(|(names, _)| names.contains(&name));
    row.map(|(_, advice)| *advice)
}
