//! `cylinder`: a tube without caps.

use super::{ShapeModel, ShapeSample, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::transform::read_transform;
use crate::manual::{Manual, parameter};
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::{Fault, Parameters};
use etendue_math::polynomial::quadratic_roots;
use etendue_math::{Bounds3, Ray, coordinate_system, rounding_error_bound};
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use std::f32::consts::TAU;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A cylinder between two points, open at both ends.",
    parameters: &[
        parameter("p0", "point", "0, 0, 0", "The middle of one end, before `to_world`."),
        parameter("p1", "point", "0, 0, 1", "The middle of the other end, before `to_world`."),
        parameter("radius", "float", "1", "The radius, before `to_world`."),
        parameter("flip_normals", "boolean", "false", "Let the normals point inwards."),
        parameter(
            "to_world",
            "transform",
            "",
            "Placement; it may stretch the cylinder along its axis, not across.",
        ),
    ],
    sample: r#"<shape type="cylinder"><point name="p1" x="0" y="2" z="0"/><float name="radius" value="0.3"/></shape>"#,
};

/// A cylinder in world space.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    /// World to local space, where the cylinder is x² + y² = 1 for z in [0, 1].
    to_local: DAffine3,
    to_world: DAffine3,
    radius: f64,
    length: f64,
    flip_normals: bool,
}

/// Reads a cylinder.
#[must_use]
pub fn build(_assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Cylinder> {
    let p0 = parameters.point("p0", DVec3::ZERO);
    let p1 = parameters.point("p1", DVec3::Z);
    let radius = parameters.float_in("radius", 1.0, f64::MIN_POSITIVE..=f64::from(f32::MAX));
    let flip_normals = parameters.boolean("flip_normals", false);
    read_transform(parameters, "to_world")?;
    let to_world = parameters.transform("to_world");
    let axis = p1 - p0;
    // The azimuth starts where Mitsuba's does: in local space, before `to_world`.
    let (s, t) = coordinate_system(axis.as_vec3().normalize_or(Vec3::Z));
    let [s, t, axis] =
        [s.as_dvec3(), t.as_dvec3(), axis].map(|vector| to_world.transform_vector3(vector));
    let (length, radius_scale) = (axis.length(), s.length());
    let skew = |a: DVec3, b: DVec3| a.dot(b).abs() / (a.length() * b.length());
    let skews = skew(s, t).max(skew(s, axis)).max(skew(t, axis));
    let is_round = (t.length() / radius_scale - 1.0).abs() < 1e-3 && skews < 1e-3;
    if length.is_nan() || length <= 0.0 || !is_round {
        parameters.error(
            Fault::BadValue,
            "to_world",
            "a cylinder needs two distinct points and must stay round: it cannot be sheared, or \
             scaled unequally across",
        );
        return None;
    }
    // Re-orthogonalise.
    let n = axis / length;
    let s = (s - n * n.dot(s)).normalize();
    let t = n.cross(s) * 1.0_f64.copysign(n.cross(s).dot(t));
    let radius = radius * radius_scale;
    let to_world = DAffine3::from_mat3_translation(
        DMat3::from_cols(s * radius, t * radius, axis),
        to_world.transform_point3(p0),
    );
    Some(Cylinder { to_local: to_world.inverse(), to_world, radius, length, flip_normals })
}

impl ShapeModel for Cylinder {
    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }

    fn intersect(&self, _primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let (t, local) = self.intersect(ray)?;
        Some(PrimitiveHit { t, u: local.x, v: local.y })
    }

    fn surface_point(&self, _ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(Vec2::new(hit.u, hit.v))
    }

    fn area(&self) -> f32 {
        self.area()
    }

    fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        Some(self.sample_area(random))
    }
}

impl Cylinder {
    /// The distance at which the ray first hits the surface, with the azimuth over 2π and the
    /// height over the length.
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, Vec2)> {
        let origin = self.to_local.transform_point3(ray.origin.as_dvec3());
        let direction = self.to_local.transform_vector3(ray.direction.as_dvec3());
        let a = direction.truncate().length_squared();
        let b = 2.0 * origin.truncate().dot(direction.truncate());
        let (low, high) = quadratic_roots(a, b, origin.truncate().length_squared() - 1.0)?;
        [low, high].into_iter().find_map(|t| {
            let local = origin + direction * t;
            let rounded = t as f32;
            let inside = rounded > 0.0 && rounded < ray.t_max && (0.0..=1.0).contains(&local.z);
            inside.then(|| {
                let azimuth = local.y.atan2(local.x) / std::f64::consts::TAU;
                let azimuth = if azimuth < 0.0 { azimuth + 1.0 } else { azimuth };
                (rounded, Vec2::new(azimuth as f32, local.z as f32))
            })
        })
    }

    /// The surface point at `uv`.
    #[must_use]
    pub fn surface_point(&self, uv: Vec2) -> SurfacePoint {
        let (sin, cos) = (f64::from(uv.x) * std::f64::consts::TAU).sin_cos();
        let point = self.to_world.transform_point3(DVec3::new(cos, sin, f64::from(uv.y))).as_vec3();
        let outwards = self
            .to_world
            .transform_vector3(DVec3::new(cos, sin, 0.0))
            .as_vec3()
            .normalize_or(Vec3::Z);
        let normal = if self.flip_normals { -outwards } else { outwards };
        SurfacePoint {
            point,
            // The azimuth is single precision, which moves the point along the surface. Off the
            // surface, only the last rounding matters.
            error: point.abs() * rounding_error_bound(3)
                + Vec3::splat((self.radius * 1e-12) as f32),
            normal,
            shading_normal: normal,
            uv,
            dp_du: self.to_world.transform_vector3(DVec3::new(-sin, cos, 0.0)).as_vec3() * TAU,
            dp_dv: self.to_world.transform_vector3(DVec3::Z).as_vec3(),
        }
    }

    /// The bounding box, rounded outwards.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        let axes = self.to_world.matrix3;
        // A circle with radius vectors a and b extends √(aᵢ² + bᵢ²) along each axis i.
        let reach = (axes.x_axis * axes.x_axis + axes.y_axis * axes.y_axis).map(f64::sqrt);
        let ends = [self.to_world.translation, self.to_world.translation + axes.z_axis];
        let bounds = Bounds3::from_points(
            ends.into_iter().flat_map(|end| [end - reach, end + reach]).map(|p| p.as_vec3()),
        );
        Bounds3::new(bounds.min.map(f32::next_down), bounds.max.map(f32::next_up))
    }

    /// The surface area.
    #[must_use]
    pub fn area(&self) -> f32 {
        (std::f64::consts::TAU * self.radius * self.length) as f32
    }

    /// Samples a point uniform in area.
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> ShapeSample {
        let surface = self.surface_point(random);
        ShapeSample {
            point: surface.point,
            error: surface.error,
            normal: surface.normal,
            shading_normal: surface.normal,
            uv: surface.uv,
            pdf: 1.0 / self.area(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::{Class, Fault, Value};
    use glam::DMat4;

    fn node(to_world: DMat4) -> TestNode {
        TestNode::new(Class::Shape, "cylinder").with("to_world", Value::transform(to_world))
    }

    /// Taken from Mitsuba 3.9.1: the point, its coordinates, the normal and ∂point/∂u.
    #[test]
    fn places_are_those_of_mitsuba_whatever_the_placement() {
        let turned =
            DMat4::from_rotation_y(30_f64.to_radians()) * DMat4::from_scale(DVec3::splat(2.0));
        let turned = node(turned)
            .with("p0", Value::Point(DVec3::X))
            .with("p1", Value::Point(DVec3::new(1.0, 2.0, 3.0)))
            .float("radius", 0.5);
        let mirrored = node(DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
        let cases = [
            (
                &turned,
                [0.945_538, 0.635_581],
                [4.547_67, 2.263_12, 1.992_76],
                [0.908_88, -0.279_2, -0.309_814],
                [0.184_294, 4.924_81, -3.897_52],
            ),
            (
                &mirrored,
                [0.468_584, 0.794_173],
                [0.980_578, 0.196_116, 0.794_173],
                [0.980_581, 0.196_116, 0.0],
                [1.232_23, -6.161_16, 0.0],
            ),
        ];
        for (node, uv, point, normal, dp_du) in cases {
            let cylinder =
                node.build_cleanly(|builder, parameters| build(builder.assets, parameters));
            let found = cylinder.surface_point(Vec2::from(uv));
            assert!((found.point - Vec3::from(point)).length() < 1e-4, "{found:?}");
            assert!((found.normal - Vec3::from(normal)).length() < 1e-4, "{found:?}");
            assert!((found.dp_du - Vec3::from(dp_du)).length() < 1e-3, "{found:?}");
        }
    }

    #[test]
    fn it_may_be_stretched_but_stays_round() {
        let long = node(DMat4::from_scale(DVec3::new(1.5, 1.5, 4.0)));
        let cylinder = long.build_cleanly(|builder, parameters| build(builder.assets, parameters));
        assert!((cylinder.area() - 2.0 * std::f32::consts::PI * 1.5 * 4.0).abs() < 1e-4);
        let flat = node(DMat4::from_scale(DVec3::new(1.5, 1.0, 1.0)));
        assert!(flat.build(|builder, parameters| build(builder.assets, parameters)).is_none());
        assert_eq!(flat.findings()[0].fault, Fault::BadValue);
    }
}
