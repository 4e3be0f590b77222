//! The transform of texture coordinates.

use etendue_document::{Fault, Parameters};
use glam::{Affine2, DAffine2};

/// Reads `to_uv`, an affine map of texture coordinates, which may be singular. Returns `None` after
/// reporting an error.
pub(crate) fn read_to_uv(parameters: &Parameters<'_>) -> Option<Affine2> {
    let matrix = parameters.transform("to_uv");
    // The images of u, v and the origin; the third dimension is ignored.
    let [x, y, origin] =
        [matrix.x_axis, matrix.y_axis, matrix.w_axis].map(|c| c.truncate().truncate());
    let affine = DAffine2::from_cols(x, y, origin).as_affine2();
    if affine.is_finite() {
        return Some(affine);
    }
    parameters.error(Fault::BadValue, "to_uv", "the transform is not finite");
    None
}
