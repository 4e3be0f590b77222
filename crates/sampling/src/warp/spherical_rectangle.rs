//! Points of a rectangle, uniform in the solid angle under which another point sees it.
//!
//! Ureña, Fajardo and King, *An Area-Preserving Parametrization for Spherical Rectangles*, 2013.

use crate::hash::ONE_MINUS_EPSILON;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

/// A rectangle as seen from a point. Set it up once per point. It works in double precision, because the
/// solid angle is a small difference of large angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalRectangle {
    origin: DVec3,
    /// The axes: along the edges, and from the rectangle's plane towards the point.
    axes: [DVec3; 3],
    /// The two corners in those axes, relative to the point; the plane lies at −`distance`.
    low: DVec2,
    high: DVec2,
    distance: f64,
    /// The z components of the edge planes' normals at the lower and the upper edge.
    edge_normals: DVec2,
    /// The sum of the two left dihedral angles, less 2π.
    left_angle: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle spanned at `corner` by the perpendicular edges `edge_x` and `edge_y`, seen from
    /// `origin`. `None` where it is seen edge-on, is degenerate, or is not finite.
    #[must_use]
    pub fn new(origin: Vec3, corner: Vec3, edge_x: Vec3, edge_y: Vec3) -> Option<Self> {
        let origin = origin.as_dvec3();
        let relative = corner.as_dvec3() - origin;
        let (edge_x, edge_y) = (edge_x.as_dvec3(), edge_y.as_dvec3());
        let size = DVec2::new(edge_x.length(), edge_y.length());
        let (x_axis, y_axis) = (edge_x.try_normalize()?, edge_y.try_normalize()?);
        let mut z_axis = x_axis.cross(y_axis).try_normalize()?;
        let mut height = relative.dot(z_axis);
        if height > 0.0 {
            (height, z_axis) = (-height, -z_axis);
        }
        let low = DVec2::new(relative.dot(x_axis), relative.dot(y_axis));
        let high = low + size;
        let distance = -height;
        let sine = |offset: f64| offset / offset.hypot(distance);
        let normals = [-sine(low.y), sine(high.x), sine(high.y), -sine(low.x)];
        // The dihedral angles between successive edge planes: lower, right, upper, left.
        let dihedral = |a: usize, b: usize| (-normals[a] * normals[b]).acos();
        let right_angles = dihedral(0, 1) + dihedral(1, 2);
        let left_angles = dihedral(2, 3) + dihedral(3, 0);
        let solid_angle = right_angles + left_angles - TAU;
        let usable = distance > 0.0 && solid_angle > 0.0 && solid_angle.is_finite();
        usable.then_some(Self {
            origin,
            axes: [x_axis, y_axis, z_axis],
            low,
            high,
            distance,
            edge_normals: DVec2::new(normals[0], normals[2]),
            left_angle: left_angles - TAU,
            solid_angle,
        })
    }

    /// The solid angle in steradians.
    #[inline]
    #[must_use]
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// The density per solid angle of every direction towards the rectangle.
    #[inline]
    #[must_use]
    pub fn pdf(&self) -> f32 {
        (1.0 / self.solid_angle) as f32
    }

    /// A point of the rectangle, in the space of the corner.
    #[must_use]
    pub fn sample(&self, uniform: Vec2) -> Vec3 {
        let x = self.sample_x(f64::from(uniform.x));
        let across = x.hypot(self.distance);
        let (low, high) = self.heights(across);
        let height = low + f64::from(uniform.y) * (high - low);
        let rest = 1.0 - height * height;
        let y = if rest > 0.0 { height * across / rest.sqrt() } else { self.high.y };
        let local = DVec3::new(x, y.clamp(self.low.y, self.high.y), -self.distance);
        let [x_axis, y_axis, z_axis] = self.axes;
        (self.origin + x_axis * local.x + y_axis * local.y + z_axis * local.z).as_vec3()
    }

    /// The uniform numbers that [`Self::sample`] maps to a point, or to its projection on the rectangle.
    #[must_use]
    pub fn invert(&self, point: Vec3) -> Vec2 {
        let relative = point.as_dvec3() - self.origin;
        let [x_axis, y_axis, z_axis] = self.axes;
        let depth = -relative.dot(z_axis);
        let scale = if depth > 0.0 { self.distance / depth } else { 1.0 };
        let x = (relative.dot(x_axis) * scale).clamp(self.low.x, self.high.x);
        let y = (relative.dot(y_axis) * scale).clamp(self.low.y, self.high.y);
        let across = x.hypot(self.distance);
        let (low, high) = self.heights(across);
        let height = y / y.hypot(across);
        let share = if high > low { (height - low) / (high - low) } else { 0.5 };
        let uniform = DVec2::new(self.area_left_of(x) / self.solid_angle, share).as_vec2();
        uniform.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
    }

    /// The abscissa left of which the share `uniform` of the solid angle lies (equations 13 to 15).
    fn sample_x(&self, uniform: f64) -> f64 {
        let (sine, cosine) = (uniform * self.solid_angle - self.left_angle).sin_cos();
        let (low, high) = (self.edge_normals.x, self.edge_normals.y);
        let slope = (cosine * low - high) / sine;
        let normal = (slope * slope + low * low).sqrt().recip().clamp(0.0, 1.0).copysign(slope);
        // `max` keeps x finite where an edge plane contains the normal.
        let x = normal * self.distance / (1.0 - normal * normal).sqrt().max(f64::MIN_POSITIVE);
        x.clamp(self.low.x, self.high.x)
    }

    /// The solid angle of the part of the rectangle left of the abscissa `x`.
    fn area_left_of(&self, x: f64) -> f64 {
        let normal = x / x.hypot(self.distance);
        let dihedral = |edge: f64| (-edge * normal).acos();
        dihedral(self.edge_normals.x) + dihedral(self.edge_normals.y) + self.left_angle
    }

    /// The sines of the elevations of the lower and the upper edge, `across` from the point.
    fn heights(&self, across: f64) -> (f64, f64) {
        (self.low.y / self.low.y.hypot(across), self.high.y / self.high.y.hypot(across))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng};

    /// A case: the point, and a corner with two perpendicular edges.
    type Case = (Vec3, [Vec3; 3]);

    fn cases() -> [Case; 4] {
        let turn = glam::Quat::from_rotation_arc(Vec3::Z, Vec3::new(0.48, -0.6, 0.64));
        [
            (Vec3::ZERO, [Vec3::new(-1.0, -1.0, 1.0), 2.0 * Vec3::X, 2.0 * Vec3::Y]),
            (Vec3::ZERO, [Vec3::new(-0.3, -3.0, -0.1), Vec3::X, 5.0 * Vec3::Y]),
            (turn * Vec3::X, [turn * Vec3::new(2.0, 1.0, 0.5), turn * Vec3::X, turn * Vec3::Y]),
            (Vec3::ONE, [Vec3::new(0.5, 5.0, 0.5), 3.0 * Vec3::Z, 2.0 * Vec3::X]),
        ]
    }

    fn seen((origin, [corner, edge_x, edge_y]): Case) -> SphericalRectangle {
        SphericalRectangle::new(origin, corner, edge_x, edge_y).unwrap()
    }

    /// The rectangle's own coordinates of the point seen in `direction`, if it is in front.
    fn coordinates((origin, [corner, edge_x, edge_y]): Case, direction: Vec3) -> Option<Vec2> {
        let normal = edge_x.cross(edge_y);
        let distance = (corner - origin).dot(normal) / direction.dot(normal);
        let place = origin + distance * direction - corner;
        let shares = [edge_x, edge_y].map(|edge| place.dot(edge) / edge.length_squared());
        (distance > 0.0).then_some(Vec2::from(shares))
    }

    #[test]
    fn a_face_of_a_cube_is_a_sixth_of_the_sphere() {
        let face = seen(cases()[0]);
        assert!((face.solid_angle() - 2.0 * std::f32::consts::TAU / 6.0).abs() < 1e-6);
    }

    #[test]
    fn samples_follow_the_density() {
        for case in cases() {
            let rectangle = seen(case);
            let inside = |direction: Vec3| {
                let slack = 1e-5;
                coordinates(case, direction).is_some_and(|place| {
                    place.min_element() >= -slack && place.max_element() <= 1.0 + slack
                })
            };
            ChiSquare::one_of(4)
                .sphere(
                    |random| Some((rectangle.sample(random.next_vec2()) - case.0).normalize()),
                    |direction| if inside(direction) { rectangle.pdf() } else { 0.0 },
                )
                .assert();
        }
    }

    #[test]
    fn far_and_small_rectangles_keep_their_solid_angle() {
        for distance in [1e2_f32, 1e3, 1e4] {
            let corner = Vec3::new(0.0, 0.0, distance);
            let rectangle = seen((Vec3::ZERO, [corner, Vec3::X, Vec3::Y]));
            let error = rectangle.solid_angle() * distance * distance - 1.0;
            assert!(error.abs() < 2e-4, "{distance}: {error}");
            let place = rectangle.sample(Vec2::new(0.25, 0.75));
            assert!(place.distance(Vec3::new(0.25, 0.75, distance)) < 0.01);
        }
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        let mut random = TestRng::new(5);
        for case in cases() {
            let rectangle = seen(case);
            for _ in 0..5000 {
                let uniform = random.next_vec2();
                let back = rectangle.invert(rectangle.sample(uniform));
                assert!(back.distance(uniform) < 5e-6, "{uniform} {back}");
            }
        }
    }

    #[test]
    fn edge_on_and_broken_rectangles_are_refused() {
        let refused = |origin, edge_x, edge_y| {
            SphericalRectangle::new(origin, Vec3::ZERO, edge_x, edge_y).is_none()
        };
        assert!(refused(Vec3::new(2.0, 3.0, 0.0), Vec3::X, Vec3::Y));
        assert!(refused(Vec3::Z, Vec3::ZERO, Vec3::Y));
        assert!(refused(Vec3::Z, Vec3::X, 2.0 * Vec3::X));
        assert!(refused(Vec3::NAN, Vec3::X, Vec3::Y));
        assert!(refused(Vec3::Z, Vec3::INFINITY, Vec3::Y));
    }
}
