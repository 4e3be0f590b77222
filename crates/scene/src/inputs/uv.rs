//! The transform of texture coordinates.

use etendue_document::{Fault, Parameters};
use glam::{Affine2, DAffine2};

/// Reads `to_uv`, an affine map of texture coordinates that need not have an inverse; `None` after
/// an error has been reported.
pub(crate) fn read_to_uv(parameters: &Parameters<'_>) -> Option<Affine2> {
    let matrix = parameters.transform("to_uv");
    // What maps u, v and the origin: the third dimension has no part in it.
    let [x, y, origin] =
        [matrix.x_axis, matrix.y_axis, matrix.w_axis].map(|c| c.truncate().truncate());
    let affine = DAffine2::from_cols(x, y, origin).as_affine2();
    if affine.is_finite() {
        return Some(affine);
    }
    parameters.error(Fault::BadValue, "to_uv", "the transform is not finite");
    None
}
