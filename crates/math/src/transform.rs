//! Affine transforms with their inverses.

use crate::bounds::Bounds3;
use crate::ray::Ray;
use glam::{Affine3A, DMat4, Mat3A, Vec3};

/// An invertible affine transform together with its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    forward: Affine3A,
    inverse: Affine3A,
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// The identity.
    pub const IDENTITY: Self = Self { forward: Affine3A::IDENTITY, inverse: Affine3A::IDENTITY };

    /// The transform of a 4×4 matrix whose last row is taken as (0, 0, 0, 1); `None` if it is
    /// singular or not finite. The inverse is computed in double precision.
    #[must_use]
    pub fn from_matrix(matrix: &DMat4) -> Option<Self> {
        if !matrix.is_finite() {
            return None;
        }
        let mut affine = *matrix;
        affine.x_axis.w = 0.0;
        affine.y_axis.w = 0.0;
        affine.z_axis.w = 0.0;
        affine.w_axis.w = 1.0;
        let inverse = affine.inverse();
        if !inverse.is_finite() || affine.determinant() == 0.0 {
            return None;
        }
        let transform = Self {
            forward: Affine3A::from_mat4(affine.as_mat4()),
            inverse: Affine3A::from_mat4(inverse.as_mat4()),
        };
        (transform.forward.is_finite() && transform.inverse.is_finite()).then_some(transform)
    }

    /// A transform from a pair that [`Self::affine`] and [`Self::inverse_affine`] returned.
    #[must_use]
    pub fn from_inverses(forward: Affine3A, inverse: Affine3A) -> Self {
        Self { forward, inverse }
    }

    /// The transform as glam's affine type.
    #[must_use]
    pub fn affine(&self) -> Affine3A {
        self.forward
    }

    /// The inverse as glam's affine type.
    #[must_use]
    pub fn inverse_affine(&self) -> Affine3A {
        self.inverse
    }

    /// The inverse transform.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self { forward: self.inverse, inverse: self.forward }
    }

    /// The composition: `first`, then this transform.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        Self { forward: self.forward * first.forward, inverse: first.inverse * self.inverse }
    }

    /// Transforms a position.
    #[inline]
    #[must_use]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.forward.transform_point3(p)
    }

    /// Transforms a displacement.
    #[inline]
    #[must_use]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.forward.transform_vector3(v)
    }

    /// Transforms a surface normal by the inverse transpose. The result is not normalised.
    #[inline]
    #[must_use]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let m: &Mat3A = &self.inverse.matrix3;
        Vec3::new(
            Vec3::from(m.x_axis).dot(n),
            Vec3::from(m.y_axis).dot(n),
            Vec3::from(m.z_axis).dot(n),
        )
    }

    /// Transforms a position by the inverse.
    #[inline]
    #[must_use]
    pub fn inverse_point(&self, p: Vec3) -> Vec3 {
        self.inverse.transform_point3(p)
    }

    /// Transforms a displacement by the inverse.
    #[inline]
    #[must_use]
    pub fn inverse_vector(&self, v: Vec3) -> Vec3 {
        self.inverse.transform_vector3(v)
    }

    /// Transforms a ray. Its parameter `t` is preserved.
    #[inline]
    #[must_use]
    pub fn ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.point(ray.origin),
            direction: self.vector(ray.direction),
            t_max: ray.t_max,
        }
    }

    /// The bounding box of a transformed box.
    #[must_use]
    pub fn bounds(&self, bounds: &Bounds3) -> Bounds3 {
        if bounds.is_empty() {
            return Bounds3::EMPTY;
        }
        Bounds3::from_points((0..8).map(|corner| {
            let pick =
                |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 1 { high } else { low };
            self.point(Vec3::new(
                pick(0, bounds.min.x, bounds.max.x),
                pick(1, bounds.min.y, bounds.max.y),
                pick(2, bounds.min.z, bounds.max.z),
            ))
        }))
    }

    /// The determinant of the linear part.
    #[must_use]
    pub fn determinant(&self) -> f32 {
        self.forward.matrix3.determinant()
    }

    /// Whether the transform turns right-handed frames into left-handed ones.
    #[must_use]
    pub fn flips_handedness(&self) -> bool {
        self.determinant() < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat4, DVec3};

    fn example() -> Transform {
        let matrix = DMat4::from_translation(DVec3::new(1.0, -2.0, 3.0))
            * DMat4::from_rotation_y(0.7)
            * DMat4::from_scale(DVec3::new(2.0, 0.5, -1.5));
        Transform::from_matrix(&matrix).expect("the matrix is invertible")
    }

    #[test]
    fn inverse_undoes_and_composition_applies_the_argument_first() {
        let transform = example();
        let p = Vec3::new(0.3, 0.4, -0.9);
        assert!((transform.inverse_point(transform.point(p)) - p).length() < 1e-5);
        let twice = transform.after(&transform);
        assert!((twice.point(p) - transform.point(transform.point(p))).length() < 1e-5);
        assert!((twice.inverse_point(twice.point(p)) - p).length() < 1e-4);
    }

    #[test]
    fn normals_stay_perpendicular_to_the_tangents() {
        let transform = example();
        let (n, tangent) = (Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, -1.0, 2.0));
        assert!(transform.normal(n).dot(transform.vector(tangent)).abs() < 1e-5);
        assert!(transform.flips_handedness());
    }

    #[test]
    fn singular_and_non_finite_matrices_are_rejected() {
        assert!(Transform::from_matrix(&DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))).is_none());
        assert!(Transform::from_matrix(&DMat4::from_scale(DVec3::splat(f64::NAN))).is_none());
        assert!(Transform::from_matrix(&DMat4::from_scale(DVec3::splat(1e300))).is_none());
    }

    #[test]
    fn the_image_of_a_box_contains_the_images_of_its_corners() {
        let transform = example();
        let image = transform.bounds(&Bounds3::new(Vec3::ZERO, Vec3::ONE));
        assert!(
            image.contains(transform.point(Vec3::ONE)) && image.contains(transform.point(Vec3::X))
        );
        assert!(transform.bounds(&Bounds3::EMPTY).is_empty());
    }
}
