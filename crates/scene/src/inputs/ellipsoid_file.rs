//! Ellipsoid files, as read by `ellipsoids` and `ellipsoidsmesh`.

use crate::builder::Assets;
use crate::manual::{ParameterManual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_math::Bounds3;
use etendue_mesh::{TriangleMesh, read_ply_points};
use glam::{DMat3, DMat4, DQuat, DVec3, Quat, Vec3};

/// The parameter that names the file.
pub(crate) const FILENAME: ParameterManual = parameter(
    "filename",
    "string",
    "",
    "A PLY file whose vertices have `x`, `y`, `z`, the logarithms `scale_0` to `scale_2` of the half \
     axes, and the quaternion `rot_0` (its real part) to `rot_3`. Files of Gaussian splats are such.",
);
/// The parameter that scales the sizes in the file.
pub(crate) const SCALE_FACTOR: ParameterManual =
    parameter("scale_factor", "float", "1", "A factor on the half axes.");
/// The parameter that sets the extent of each ellipsoid.
pub(crate) const EXTENT: ParameterManual = parameter(
    "extent",
    "float",
    "3",
    "Another factor on the half axes. Where they are standard deviations of a Gaussian, this is where \
     it is cut off.",
);
/// The parameter that shrinks ellipsoids of low opacity.
pub(crate) const EXTENT_ADAPTIVE_CLAMPING: ParameterManual = parameter(
    "extent_adaptive_clamping",
    "boolean",
    "false",
    "Cut each Gaussian off where its opacity (the property `opacities`, or that of splats) falls to \
     0.01: the extent is multiplied by √(2 ln(opacity / 0.01)) / 3. Fainter ones are left out.",
);
/// The parameter that places the ellipsoids.
pub(crate) const TO_WORLD: ParameterManual = parameter(
    "to_world",
    "transform",
    "",
    "Placement. The half axes are scaled by the mean over all directions, and keep their proportions.",
);

/// The opacity at which a Gaussian is cut off.
const LEAST_OPACITY: f32 = 0.01;
/// The smallest half axis, before scaling.
const LEAST_HALF_AXIS: f64 = 1e-6;

/// An ellipsoid in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ellipsoid {
    /// The centre.
    pub(crate) center: Vec3,
    /// Rotates the world axes to the axes of the ellipsoid; unit length.
    pub(crate) rotation: Quat,
    /// The half axes; positive.
    pub(crate) half_axes: Vec3,
}

impl Ellipsoid {
    /// The unit axes, as columns.
    #[must_use]
    pub(crate) fn axes(&self) -> DMat3 {
        DMat3::from_quat(self.rotation.as_dquat().normalize())
    }

    /// The bounding box, rounded outwards.
    #[must_use]
    pub(crate) fn bounds(&self) -> Bounds3 {
        let half = self.axes() * DMat3::from_diagonal(self.half_axes.as_dvec3());
        // The extent along each world axis is that of the transformed unit sphere.
        let reach = DVec3::from_array([0, 1, 2].map(|axis| half.row(axis).length()));
        let center = self.center.as_dvec3();
        Bounds3::new(
            (center - reach).as_vec3().map(f32::next_down),
            (center + reach).as_vec3().map(f32::next_up),
        )
    }
}

/// Reads the file named by `filename`, and the other parameters above. Returns `None` after
/// reporting an error.
#[must_use]
pub(crate) fn read(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Vec<Ellipsoid>> {
    let positive = f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX);
    let placement = Placement {
        to_world: parameters.transform("to_world"),
        scale: parameters.float_in("scale_factor", 1.0, positive.clone()),
        extent: parameters.float_in("extent", 3.0, positive),
        is_adaptive: parameters.boolean("extent_adaptive_clamping", false),
    };
    let is_placed = crate::inputs::transform::read_transform(parameters, "to_world").is_some();
    let (path, bytes) = assets.read_file(parameters, "filename")?;
    if !is_placed {
        return None;
    }
    let points = read_ply_points(&bytes).map_err(|error| error.to_string());
    if let Ok(points) = &points
        && placement.is_adaptive
        && opacities(points).is_none()
    {
        let message = "the file has no opacities: `extent` is the same for all";
        parameters.warning(Fault::BadValue, "extent_adaptive_clamping", message);
    }
    match points.and_then(|points| placement.place(&points)) {
        Ok(ellipsoids) => Some(ellipsoids),
        Err(problem) => {
            let message = format!("{}: {problem}", path.display());
            parameters.error(Fault::Geometry, "filename", message);
            None
        }
    }
}

/// How the ellipsoids are placed and scaled.
#[derive(Clone, Copy, Debug)]
struct Placement {
    to_world: DMat4,
    scale: f64,
    extent: f64,
    is_adaptive: bool,
}

impl Placement {
    /// Builds the ellipsoids from the attributes of the points.
    fn place(&self, points: &TriangleMesh) -> Result<Vec<Ellipsoid>, String> {
        let scales = values::<3>(points, "scale").ok_or_else(|| lacks("scale_0` to `scale_2"))?;
        let rotations = values::<4>(points, "rot").ok_or_else(|| lacks("rot_0` to `rot_3"))?;
        let opacities = opacities(points).filter(|_| self.is_adaptive);
        let (turn, stretch) = polar_decomposition(DMat3::from_mat4(self.to_world));
        let mut ellipsoids = Vec::with_capacity(points.positions.len());
        for (index, position) in points.positions.iter().enumerate() {
            let Some(extent) = self.extent_of(opacities.as_ref().map(|all| all[index])) else {
                continue;
            };
            let logarithms = Vec3::from_array(scales[index]).as_dvec3();
            let half_axes = logarithms.exp().max(DVec3::splat(LEAST_HALF_AXIS));
            let [real, i, j, k] = rotations[index].map(f64::from);
            let rotation = DQuat::from_xyzw(i, j, k, real);
            if rotation.length_squared() == 0.0 {
                return Err(format!("the quaternion of ellipsoid {index} is zero"));
            }
            ellipsoids.push(Ellipsoid {
                center: self.to_world.transform_point3(position.as_dvec3()).as_vec3(),
                rotation: (turn * rotation.normalize()).normalize().as_quat(),
                half_axes: (half_axes * (self.scale * stretch * extent)).as_vec3(),
            });
        }
        Ok(ellipsoids)
    }

    /// The factor applied to the half axes at this opacity; `None` if the ellipsoid is too faint.
    fn extent_of(&self, opacity: Option<f32>) -> Option<f64> {
        let Some(opacity) = opacity else { return Some(self.extent) };
        let excess = f64::from(opacity / LEAST_OPACITY).ln();
        (excess > 0.0).then(|| self.extent * (2.0 * excess).sqrt() / 3.0)
    }
}

fn lacks(names: &str) -> String {
    format!("the vertices have no properties `{names}`: they are no ellipsoids")
}

/// The rows of a vertex attribute with `N` channels.
fn values<'a, const N: usize>(points: &'a TriangleMesh, name: &str) -> Option<&'a [[f32; N]]> {
    let is_it = |found: &str| found.strip_prefix("vertex_") == Some(name);
    let attribute = points.attributes.iter().find(|attribute| is_it(&attribute.name))?;
    (attribute.channels as usize == N).then(|| attribute.values.as_chunks().0)
}

/// The opacity of each ellipsoid. Gaussian splat files, recognised by their spherical harmonics,
/// store it before the sigmoid (Kerbl et al., "3D Gaussian Splatting for Real-Time Radiance Field
/// Rendering", 2023, section 5).
fn opacities(points: &TriangleMesh) -> Option<Vec<f32>> {
    if let Some(opacities) = values::<1>(points, "opacities") {
        return Some(opacities.as_flattened().to_vec());
    }
    let is_harmonic = |name: &str| name == "vertex_f_dc";
    points.attributes.iter().find(|attribute| is_harmonic(&attribute.name))?;
    let sigmoid = |x: &f32| 1.0 / (1.0 + (-x).exp());
    values::<1>(points, "opacity").map(|all| all.as_flattened().iter().map(sigmoid).collect())
}

/// Polar decomposition: the rotation nearest to a matrix, and the mean stretch, which is the mean
/// eigenvalue of the remaining factor. A reflection is dropped: an ellipsoid is symmetric under
/// point reflection.
///
/// Higham, "Computing the Polar Decomposition with Applications", 1986: Newton's iteration.
fn polar_decomposition(matrix: DMat3) -> (DQuat, f64) {
    let mut turn = matrix;
    // Converges quadratically; 25 steps suffice for any single-precision matrix.
    for _ in 0..25 {
        turn = (turn + turn.inverse().transpose()) * 0.5;
    }
    let left = turn.transpose() * matrix;
    let mean = (left.x_axis.x + left.y_axis.y + left.z_axis.z) / 3.0;
    let turn = if turn.determinant() < 0.0 { turn * -1.0 } else { turn };
    (DQuat::from_mat3(&turn), mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_and_a_stretch_are_found_again() {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1);
        let stretch = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 6.0));
        for mirror in [1.0, -1.0] {
            let (found, mean) = polar_decomposition(DMat3::from_quat(turn) * stretch * mirror);
            assert!((mean - 3.0).abs() < 1e-12, "{mean}");
            assert!(found.dot(turn).abs() > 1.0 - 1e-12, "{found}");
        }
    }

    #[test]
    fn an_ellipsoid_touches_its_box() {
        let rotation = Quat::from_xyzw(0.1, 0.3, 0.2, 0.9).normalize();
        let half_axes = Vec3::new(0.9, 0.6, 0.3);
        let ellipsoid = Ellipsoid { center: Vec3::new(0.1, 0.2, 0.3), rotation, half_axes };
        // What Mitsuba 3.9.1 reports for the same ellipsoid.
        let bounds = ellipsoid.bounds();
        let expected =
            [Vec3::new(-0.604805, -0.46849, -0.262469), Vec3::new(0.804805, 0.86849, 0.862469)];
        assert!((bounds.min - expected[0]).abs().max_element() < 1e-5, "{bounds:?}");
        assert!((bounds.max - expected[1]).abs().max_element() < 1e-5, "{bounds:?}");
    }
}
