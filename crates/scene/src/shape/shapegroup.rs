//! `shapegroup`: shapes that instances place in the scene.

use crate::ids::ShapeId;
use crate::manual::{Manual, parameter};
use etendue_bvh::Bvh;
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Shapes that are not seen themselves, but wherever an `instance` places the group. The \
              shapes must not emit light or be instances.",
    parameters: &[parameter(
        "shapes",
        "shape",
        "",
        "The shapes: nested, or references; any names.",
    )],
    sample: r#"<scene><shape type="shapegroup" id="pair"><shape type="sphere"/><shape type="cube"/></shape><shape type="instance"><ref id="pair"/></shape></scene>"#,
};

/// The shapes of a group and the tree over them.
#[derive(Clone, Debug)]
pub struct Group {
    /// The tree, in the group's space.
    pub bvh: Arc<Bvh>,
    /// The index of the group's first shape in the scene's vector; the others follow.
    pub first_shape: ShapeId,
}
