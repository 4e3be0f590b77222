//! Transforms: checks that they are usable, and the placement of cameras.

use glam::{DMat3, DMat4, DVec3};

/// Camera to world: the camera at `origin` looks along +z at `target`, y is as close to `up` as
/// possible, and x points to the left of the picture. If `up` is zero, an arbitrary up direction is
/// chosen.
///
/// # Errors
///
/// If `target` is `origin` or `up` is parallel to the view direction.
pub fn look_at_matrix(origin: DVec3, target: DVec3, up: DVec3) -> Result<DMat4, &'static str> {
    let Some(direction) = (target - origin).try_normalize() else {
        return Err("`origin` and `target` are the same point");
    };
    let up = if up == DVec3::ZERO { direction.any_orthonormal_vector() } else { up };
    let side = up.normalize_or_zero().cross(direction);
    let Some(left) = side.try_normalize().filter(|_| side.length() > 1e-9) else {
        return Err("`up` is parallel to the direction of view");
    };
    let matrix = DMat3::from_cols(left, direction.cross(left), direction);
    Ok(DMat4::from_translation(origin) * DMat4::from_mat3(matrix))
}

/// The tolerance for the last row (0, 0, 0, 1) of an affine matrix, because exporters round
/// numbers.
const AFFINE_TOLERANCE: f64 = 1e-4;

/// A smaller volume spanned by three unit columns is rounding error.
const SINGULAR_VOLUME: f64 = 1e-12;

/// Why a matrix is unusable as the transformation `name`, if it is. Texture transforms (`to_uv`)
/// may be singular.
pub fn transform_problem(name: &str, matrix: DMat4) -> Option<&'static str> {
    let is_planar = matches!(name, "to_uv" | "toUV");
    if !matrix.is_finite() {
        Some("this transform has numbers beyond all bounds")
    } else if !is_planar && !is_affine(matrix) {
        Some("the last row of a matrix must be 0, 0, 0, 1")
    } else if !is_planar && is_singular(matrix) {
        Some("this transform is singular: it has no inverse")
    } else {
        None
    }
}

pub(crate) fn is_affine(matrix: DMat4) -> bool {
    let last = matrix.row(3);
    last.truncate().abs().max_element() <= AFFINE_TOLERANCE
        && (last.w - 1.0).abs() <= AFFINE_TOLERANCE
}

/// Whether the matrix is singular. The test is independent of scale, so tiny objects are accepted.
fn is_singular(matrix: DMat4) -> bool {
    let linear = DMat3::from_mat4(matrix);
    let unit = |column: DVec3| column.normalize_or_zero();
    let unit = DMat3::from_cols(unit(linear.x_axis), unit(linear.y_axis), unit(linear.z_axis));
    unit.determinant().abs() < SINGULAR_VOLUME || !matrix.inverse().is_finite()
}

/// The thickness that a flattened space keeps, relative to its size.
const FLAT_THICKNESS: f64 = 1e-6;

/// A matrix that flattens space to a plane, such as a scale with one zero, made invertible: space
/// keeps a thickness that no picture shows. `None` for other matrices, also for those that leave
/// only a line or a point.
pub fn thickened(matrix: DMat4) -> Option<DMat4> {
    if !matrix.is_finite() || !is_affine(matrix) || !is_singular(matrix) {
        return None;
    }
    let linear = DMat3::from_mat4(matrix);
    let size = linear.to_cols_array().into_iter().fold(0.0, |size: f64, next| size.max(next.abs()));
    // Perpendicular to all rows: the direction that is lost; to all columns: that of the thickness.
    let lost = longest_cross(linear.transpose() * (1.0 / size))?;
    let normal = longest_cross(linear * (1.0 / size))?;
    let along = lost * (FLAT_THICKNESS * size);
    let thickness = DMat3::from_cols(normal * along.x, normal * along.y, normal * along.z);
    let thick = [linear + thickness, linear - thickness];
    let thick = thick.into_iter().max_by(|a, b| a.determinant().total_cmp(&b.determinant()))?;
    let mut result = DMat4::from_mat3(thick);
    result.w_axis = matrix.w_axis;
    (!is_singular(result)).then_some(result)
}

/// The direction perpendicular to the columns of a matrix with entries up to one; `None` if they
/// span less than a plane.
fn longest_cross(matrix: DMat3) -> Option<DVec3> {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let crosses = [x.cross(y), y.cross(z), z.cross(x)];
    let longest = crosses.into_iter().max_by(|a, b| a.length().total_cmp(&b.length()))?;
    (longest.length() > 1e-9).then(|| longest.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_looks_along_its_z_axis() {
        let matrix = look_at_matrix(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y).unwrap();
        assert_eq!(matrix.transform_point3(DVec3::Z), DVec3::Z * 3.0);
        assert_eq!(matrix.transform_vector3(DVec3::X), -DVec3::X);
        assert!(look_at_matrix(DVec3::X, DVec3::X, DVec3::Y).is_err());
        assert!(look_at_matrix(DVec3::X, DVec3::Y, DVec3::Y - DVec3::X).is_err());
        assert!(look_at_matrix(DVec3::X, DVec3::Y, DVec3::ZERO).is_ok());
    }

    #[test]
    fn a_flattened_space_keeps_a_thickness() {
        let turn = DMat4::from_rotation_x(0.4) * DMat4::from_rotation_y(-1.1);
        let flat = DMat4::from_scale(DVec3::new(30.0, 0.0, 2.0));
        let moved = DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0));
        for matrix in [flat, turn * flat, moved * turn * flat * turn] {
            let thick = thickened(matrix).unwrap();
            assert_eq!(transform_problem("to_world", thick), None);
            assert!(thick.determinant() > 0.0);
            for point in [DVec3::ONE, DVec3::NEG_X, DVec3::ZERO] {
                let moved = thick.transform_point3(point) - matrix.transform_point3(point);
                assert!(moved.length() < 1e-4, "{moved}");
            }
        }
        assert_eq!(thickened(DMat4::IDENTITY), None);
        assert_eq!(thickened(DMat4::from_scale(DVec3::X)), None, "a line");
        assert_eq!(thickened(DMat4::from_scale(DVec3::ZERO)), None, "a point");
    }

    #[test]
    fn coordinates_on_a_surface_may_be_collapsed() {
        let flat = DMat4::from_scale(DVec3::new(0.0, 1.0, 1.0));
        assert_eq!(transform_problem("to_uv", flat), None);
        assert!(transform_problem("to_world", flat).is_some());
    }
}
