//! Placements: 4×4 transform parameters.

use etendue_document::{Fault, Parameters};
use etendue_math::Transform;

/// Reads a 4×4 transform. Returns `None` after reporting a singular matrix.
#[must_use]
pub(crate) fn read_transform(parameters: &Parameters<'_>, name: &str) -> Option<Transform> {
    let transform = Transform::from_matrix(&parameters.transform(name));
    if transform.is_none() {
        parameters.error(Fault::BadValue, name, "the transform has no inverse, or is not finite");
    }
    transform
}
