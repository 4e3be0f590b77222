//! `sdfgrid`: the zero set of a signed distance on a grid.
//!
//! A voxel interpolates the samples at its corners trilinearly. Along a ray the value is therefore
//! a cubic, and the surface is at its first root (Hansson-Söderlund, Evans and Akenine-Möller, "Ray
//! Tracing of Signed Distance Function Grids", JCGT 11(3), 2022).

use super::{ShapeModel, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::grid_file;
use crate::inputs::transform::read_transform;
use crate::manual::{Manual, parameter};
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::{Fault, Parameters};
use etendue_math::polynomial::quadratic_roots;
use etendue_math::{Bounds3, Ray, coordinate_system, rounding_error_bound};
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The surface where a signed distance, given at the points of a grid in a `.vol` file of one \
              channel, is zero. The grid's corners lie at those of the unit cube. Distances grow \
              outwards. There are no surface coordinates. As a light it is found by chance only.",
    parameters: &[
        parameter("filename", "string", "", "The file."),
        parameter(
            "normals",
            "string",
            "smooth",
            "Shading normals: `analytic` are those of the surface, `smooth` are blended between \
             voxels.",
        ),
        parameter("to_world", "transform", "", "Placement of the unit cube."),
    ],
    sample: r#"<shape type="sdfgrid"><string name="filename" value="distance.vol"/></shape>"#,
};

/// A signed distance on a grid in world space.
#[derive(Clone, Debug)]
pub struct SdfGrid {
    /// World to grid space, where grid points have integer coordinates.
    to_grid: DAffine3,
    to_world: DAffine3,
    normal_to_world: DMat3,
    /// Grid points along x, y and z.
    size: [u32; 3],
    values: Vec<f32>,
    /// The minimum corners of the voxels that the surface passes through, as indices of values.
    voxels: Vec<u32>,
    has_smooth_normals: bool,
}

/// Reads a grid.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<SdfGrid> {
    let has_smooth_normals = read_normals(parameters);
    let to_world = read_transform(parameters, "to_world")
        .map(|_| DAffine3::from_mat4(parameters.transform("to_world")));
    let (path, bytes) = assets.read_file(parameters, "filename")?;
    let refuse = |fault, problem: String| {
        parameters.error(fault, "filename", format!("{}: {problem}", path.display()));
        None
    };
    let file = match grid_file::read(&bytes) {
        Ok(file) => file,
        Err(error) => {
            let fault = if error.is_unsupported() { Fault::Unsupported } else { Fault::Syntax };
            return refuse(fault, error.to_string());
        }
    };
    if file.channels != 1 || file.size.iter().any(|side| *side < 2) {
        let problem = "a distance takes one channel and at least two points along each axis";
        return refuse(Fault::BadValue, problem.to_owned());
    }
    if file.values.len() > u32::MAX as usize {
        return refuse(Fault::Limit, "there are more grid points than can be numbered".to_owned());
    }
    Some(SdfGrid::new(file.size, file.values, to_world?, has_smooth_normals?))
}

fn read_normals(parameters: &Parameters<'_>) -> Option<bool> {
    match parameters.string("normals", "smooth") {
        "smooth" => Some(true),
        "analytic" => Some(false),
        other => {
            let message =
                format!("there are no `{other}` normals: there are `analytic` and `smooth`");
            parameters.error(Fault::BadValue, "normals", message);
            None
        }
    }
}

/// Interpolates trilinearly between eight corners, x fastest.
///
/// Weights of 0 and 1 give the corner values exactly, so two voxels agree on their shared face.
fn interpolate(corners: &[f64; 8], at: DVec3) -> f64 {
    let mix = |a: f64, b: f64, share: f64| a * (1.0 - share) + b * share;
    let along_x = |i: usize| mix(corners[i], corners[i + 1], at.x);
    let along_y = |i: usize| mix(along_x(i), along_x(i + 2), at.y);
    mix(along_y(0), along_y(4), at.z)
}

impl ShapeModel for SdfGrid {
    fn bounds(&self) -> Bounds3 {
        self.voxels.iter().map(|&voxel| self.voxel_box(voxel)).fold(Bounds3::EMPTY, Bounds3::union)
    }

    fn primitive_boxes(&self) -> Vec<Bounds3> {
        self.boxes()
    }

    fn primitive_count(&self) -> usize {
        self.voxel_count()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let t = self.intersect(primitive, ray)?;
        Some(PrimitiveHit { t, u: 0.0, v: 0.0 })
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(hit.primitive, ray, hit.t)
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl SdfGrid {
    /// Builds the surface from the `values` at the points of a grid of this `size`, x fastest.
    /// `to_world` maps the unit cube to the grid's box. Each side has at least two points.
    fn new(size: [u32; 3], values: Vec<f32>, to_world: DAffine3, has_smooth_normals: bool) -> Self {
        let steps = DVec3::from_array(size.map(|side| f64::from(side - 1)));
        let to_world = to_world * DAffine3::from_scale(steps.recip());
        let to_grid = to_world.inverse();
        let mut grid = Self {
            to_grid,
            to_world,
            normal_to_world: to_grid.matrix3.transpose(),
            size,
            values,
            voxels: Vec::new(),
            has_smooth_normals,
        };
        let [width, height, depth] = size;
        for z in 0..depth - 1 {
            for y in 0..height - 1 {
                for x in 0..width - 1 {
                    let index = (z * height + y) * width + x;
                    let corners = grid.corners(index);
                    let inside = corners.iter().filter(|value| **value < 0.0).count();
                    if inside != 0 && inside != 8 {
                        grid.voxels.push(index);
                    }
                }
            }
        }
        grid
    }

    fn value(&self, [x, y, z]: [u32; 3]) -> f64 {
        f64::from(self.values[((z * self.size[1] + y) * self.size[0] + x) as usize])
    }

    /// The values at the corners of a voxel, x fastest.
    fn corners(&self, least: u32) -> [f64; 8] {
        let [width, height, _] = self.size.map(|side| side as usize);
        std::array::from_fn(|i| {
            let offset = ((i >> 2) * height + (i >> 1 & 1)) * width + (i & 1);
            f64::from(self.values[least as usize + offset])
        })
    }

    /// The grid coordinates of a voxel's minimum corner.
    fn place(&self, least: u32) -> [u32; 3] {
        let [width, height, _] = self.size;
        [least % width, least / width % height, least / width / height]
    }

    /// The distance at which the ray first hits the surface within a voxel.
    #[must_use]
    pub fn intersect(&self, voxel: u32, ray: &Ray) -> Option<f32> {
        let least = self.voxels[voxel as usize];
        let low = DVec3::from_array(self.place(least).map(f64::from));
        let origin = self.to_grid.transform_point3(ray.origin.as_dvec3());
        let direction = self.to_grid.transform_vector3(ray.direction.as_dvec3());
        // When the ray passes which faces. On an axis along which it does not move, it is either
        // between the faces or outside.
        let mut span = [(0.0, None), (f64::from(ray.t_max), None)];
        for axis in 0..3 {
            if direction[axis] == 0.0 {
                if origin[axis] < low[axis] || origin[axis] > low[axis] + 1.0 {
                    return None;
                }
                continue;
            }
            let to_face = |side: f64| (low[axis] + side - origin[axis]) / direction[axis];
            let first = if direction[axis] > 0.0 { 0.0 } else { 1.0 };
            let (enter, leave) = (to_face(first), to_face(1.0 - first));
            if enter > span[0].0 {
                span[0] = (enter, Some((axis, first)));
            }
            if leave < span[1].0 {
                span[1] = (leave, Some((axis, 1.0 - first)));
            }
        }
        let corners = self.corners(least);
        let [start, end] = span.map(|(t, _)| t);
        if start >= end {
            return None;
        }
        let value = |t: f64| interpolate(&corners, origin + direction * t - low);
        let [at_start, at_end] = span.map(|(t, face)| {
            let mut at = (origin + direction * t - low).clamp(DVec3::ZERO, DVec3::ONE);
            if let Some((axis, side)) = face {
                at[axis] = side;
            }
            interpolate(&corners, at)
        });
        let share = first_root([at_start, at_end], |share| value(start + (end - start) * share))?;
        let t = (start + (end - start) * share) as f32;
        (t > 0.0 && t < ray.t_max).then_some(t)
    }

    /// The surface point within a voxel that `ray` hits at distance `t`.
    #[inline(never)]
    #[must_use]
    pub fn surface_point(&self, voxel: u32, ray: &Ray, t: f32) -> SurfacePoint {
        let least = self.voxels[voxel as usize];
        let low = DVec3::from_array(self.place(least).map(f64::from));
        let corners = self.corners(least);
        let origin = self.to_grid.transform_point3(ray.origin.as_dvec3());
        let direction = self.to_grid.transform_vector3(ray.direction.as_dvec3());
        let mut t = f64::from(t);
        let slack = t * f64::from(f32::EPSILON);
        let rounded = t;
        for _ in 0..2 {
            // Restores the digits lost to single precision; grazing rays keep their distance.
            let at = origin + direction * t - low;
            let step = interpolate(&corners, at) / gradient(&corners, at).dot(direction);
            if step.abs() <= slack {
                t = (t - step).clamp(rounded - slack, rounded + slack);
            }
        }
        let place = origin + direction * t;
        let to_unit = |gradient: DVec3| {
            (self.normal_to_world * gradient).normalize_or(DVec3::Z).as_vec3().normalize()
        };
        let normal = to_unit(gradient(&corners, place - low));
        let shading_normal = if self.has_smooth_normals {
            to_unit(self.smooth_gradient(place, self.place(least)))
        } else {
            normal
        };
        let point = self.to_world.transform_point3(place).as_vec3();
        let (dp_du, dp_dv) = coordinate_system(shading_normal);
        // The side of a voxel is the scale of the roots' rounding error.
        let voxel_size =
            self.to_world.matrix3.to_cols_array().map(f64::abs).into_iter().sum::<f64>();
        SurfacePoint {
            point,
            error: point.abs() * rounding_error_bound(2) + Vec3::splat((voxel_size * 1e-7) as f32),
            normal,
            shading_normal,
            uv: Vec2::ZERO,
            dp_du,
            dp_dv,
        }
    }

    /// A gradient direction that is continuous across voxels. Blends the gradients of the eight
    /// voxels around the nearest grid point, weighted by how near their centres are. A voxel's
    /// gradient is the difference between values interpolated at the same place on opposite faces
    /// (section 5 of the paper). Voxels outside the grid are ignored.
    fn smooth_gradient(&self, place: DVec3, cell: [u32; 3]) -> DVec3 {
        let mut slopes = [[0.0; 2]; 3];
        let mut shares = [0.0; 3];
        for axis in 0..3 {
            let last = i64::from(self.size[axis]) - 2;
            let lower = place[axis].round() as i64 - 1;
            shares[axis] = if lower < 0 {
                1.0
            } else if lower + 1 > last {
                0.0
            } else {
                (place[axis] - lower as f64 - 0.5).clamp(0.0, 1.0)
            };
            for (side, slope) in (0_i64..).zip(&mut slopes[axis]) {
                let voxel = (lower + side).clamp(0, last) as u32;
                *slope = self.on_plane(axis, voxel + 1, place, cell)
                    - self.on_plane(axis, voxel, place, cell);
            }
        }
        let mut sum = DVec3::ZERO;
        for corner in 0..8_usize {
            let side = |axis: usize| corner >> axis & 1;
            let weight =
                |axis: usize| if side(axis) == 1 { shares[axis] } else { 1.0 - shares[axis] };
            let slope = DVec3::from_array(std::array::from_fn(|axis| slopes[axis][side(axis)]));
            sum += self.world_direction(slope) * (weight(0) * weight(1) * weight(2));
        }
        sum
    }

    /// Scales a gradient per grid step to unit length, as measured in the unit cube.
    fn world_direction(&self, slope: DVec3) -> DVec3 {
        let steps = DVec3::from_array(self.size.map(|side| f64::from(side - 1)));
        (slope * steps).normalize_or_zero() / steps
    }

    /// The value on the grid plane `index` across `axis`, at `place` along the other two axes.
    fn on_plane(&self, axis: usize, index: u32, place: DVec3, cell: [u32; 3]) -> f64 {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let at = |i: u32, j: u32| {
            let mut point = [0; 3];
            (point[axis], point[b], point[c]) = (index, cell[b] + i, cell[c] + j);
            self.value(point)
        };
        let (s, t) = (place[b] - f64::from(cell[b]), place[c] - f64::from(cell[c]));
        let mix = |a: f64, b: f64, share: f64| a * (1.0 - share) + b * share;
        mix(mix(at(0, 0), at(1, 0), s), mix(at(0, 1), at(1, 1), s), t)
    }

    /// The bounding box of each voxel that the surface passes through.
    #[must_use]
    pub fn boxes(&self) -> Vec<Bounds3> {
        self.voxels.iter().map(|&voxel| self.voxel_box(voxel)).collect()
    }

    /// The bounding box of the voxel with this minimum corner.
    fn voxel_box(&self, least: u32) -> Bounds3 {
        let low = DVec3::from_array(self.place(least).map(f64::from));
        let corners = (0..8_u32).map(|i| {
            let offset = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
            self.to_world.transform_point3(low + offset).as_vec3()
        });
        let bounds = Bounds3::from_points(corners);
        Bounds3::new(bounds.min.map(f32::next_down), bounds.max.map(f32::next_up))
    }

    /// The number of voxels that the surface passes through.
    #[must_use]
    pub fn voxel_count(&self) -> usize {
        self.voxels.len()
    }

    /// Memory use in bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.values.as_slice()) + size_of_val(self.voxels.as_slice())
    }
}

/// The gradient of [`interpolate`].
fn gradient(corners: &[f64; 8], at: DVec3) -> DVec3 {
    let difference = |axis: usize| {
        let (mut low, mut high) = (at, at);
        (low[axis], high[axis]) = (0.0, 1.0);
        interpolate(corners, high) - interpolate(corners, low)
    };
    DVec3::new(difference(0), difference(1), difference(2))
}

/// The first place in [0, 1] where a cubic changes sign; zero counts as positive. The end values
/// are passed in, so that adjacent voxels agree on them.
fn first_root([at_start, at_end]: [f64; 2], value: impl Fn(f64) -> f64) -> Option<f64> {
    // Fits the cubic through four of its points, in powers from the start.
    let [a, b, c, d] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(&value);
    let linear = 0.5 * (-11.0 * a + 18.0 * b - 9.0 * c + 2.0 * d);
    let quadratic = 4.5 * (2.0 * a - 5.0 * b + 4.0 * c - d);
    let cubic = 4.5 * (-a + 3.0 * b - 3.0 * c + d);
    let extrema = quadratic_roots(3.0 * cubic, 2.0 * quadratic, linear);
    let inner = extrema.map_or([f64::NAN; 2], |(first, second)| [first, second]);
    let mut low = (0.0, at_start);
    let ends = inner.into_iter().filter(|s| *s > 0.0 && *s < 1.0).map(|s| (s, value(s)));
    for high in ends.chain([(1.0, at_end)]) {
        if (low.1 < 0.0) != (high.1 < 0.0) {
            return Some(root_between(low, high, value));
        }
        low = high;
    }
    None
}

/// The root between two places with different signs: regula falsi (Illinois variant), with
/// bisection in every third step.
fn root_between(mut low: (f64, f64), mut high: (f64, f64), value: impl Fn(f64) -> f64) -> f64 {
    for step in 0..100 {
        if high.0 - low.0 < 1e-14 {
            break;
        }
        let falsi = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
        let is_inside = falsi > low.0 && falsi < high.0;
        let s = if step % 3 < 2 && is_inside { falsi } else { 0.5 * (low.0 + high.0) };
        let at = value(s);
        if at == 0.0 {
            return s;
        }
        if (at < 0.0) == (low.1 < 0.0) {
            low = (s, at);
            high.1 *= 0.5;
        } else {
            high = (s, at);
            low.1 *= 0.5;
        }
    }
    0.5 * (low.0 + high.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_math::offset_ray_origin;
    use etendue_testkit::TestRng;

    fn grid(size: [u32; 3], value: impl Fn(DVec3) -> f64, smooth: bool) -> SdfGrid {
        let steps = DVec3::from_array(size.map(|side| f64::from(side - 1)));
        let mut values = Vec::new();
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let at = DVec3::from_array([x, y, z].map(f64::from)) / steps;
                    values.push(value(at) as f32);
                }
            }
        }
        SdfGrid::new(size, values, DAffine3::IDENTITY, smooth)
    }

    fn nearest(grid: &SdfGrid, ray: &Ray) -> Option<(u32, f32)> {
        (0..grid.voxels.len() as u32)
            .filter_map(|voxel| Some((voxel, grid.intersect(voxel, ray)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn ball(at: DVec3) -> f64 {
        (at - 0.5).length() - 0.3
    }

    #[test]
    fn a_plane_is_met_exactly_on_any_grid() {
        let plane = |at: DVec3| at.dot(DVec3::new(0.6, 0.0, 0.8)) - 0.7;
        let grid = grid([4, 7, 5], plane, true);
        let mut random = TestRng::new(1);
        let mut hits = 0;
        for _ in 0..2000 {
            let target = Vec3::new(random.next_f32(), random.next_f32(), random.next_f32());
            let origin = target + random.unit_vector() * 3.0;
            let ray = Ray::new(origin, (target - origin).normalize());
            let Some((voxel, t)) = nearest(&grid, &ray) else { continue };
            hits += 1;
            let at = grid.surface_point(voxel, &ray, t);
            assert!(plane(at.point.as_dvec3()).abs() < 1e-6, "{at:?}");
            for normal in [at.normal, at.shading_normal] {
                assert!((normal - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-5, "{at:?}");
            }
        }
        assert!(hits > 500, "{hits}");
    }

    #[test]
    fn rays_pass_through_a_ball_twice() {
        let grid = grid([9, 8, 10], ball, true);
        let mut random = TestRng::new(2);
        for _ in 0..2000 {
            let origin = Vec3::splat(0.5) + random.unit_vector() * 2.0;
            let target = Vec3::splat(0.5) + random.unit_vector() * 0.25;
            let mut ray = Ray::new(origin, (target - origin).normalize());
            for side in [-1.0, 1.0] {
                let (voxel, t) = nearest(&grid, &ray).expect("the ball is there");
                let at = grid.surface_point(voxel, &ray, t);
                assert!(ball(at.point.as_dvec3()).abs() < 0.02, "{at:?}");
                assert!(at.normal.dot(ray.direction) * side > 0.0, "{at:?} {side}");
                assert!(at.normal.dot(at.shading_normal) > 0.9, "{at:?}");
                let origin = offset_ray_origin(at.point, at.error, at.normal, ray.direction);
                ray = Ray::new(origin, ray.direction);
            }
            assert!(nearest(&grid, &ray).is_none(), "{ray:?}");
        }
    }

    /// Rays along grid lines and planes, where voxels meet.
    #[test]
    fn rays_along_faces_do_not_slip_through() {
        let grid = grid([9, 9, 9], ball, false);
        for step in 0..=8_u8 {
            for other in 0..=8_u8 {
                let [a, b] = [step, other].map(|step| f32::from(step) / 8.0);
                if DVec3::new(f64::from(a), f64::from(b), 0.5).distance(DVec3::splat(0.5)) > 0.25 {
                    continue;
                }
                for (origin, direction) in [
                    (Vec3::new(a, b, -1.0), Vec3::Z),
                    (Vec3::new(-1.0, a, b), Vec3::X),
                    (Vec3::new(b, 2.0, a), Vec3::NEG_Y),
                ] {
                    let ray = Ray::new(origin, direction);
                    assert!(nearest(&grid, &ray).is_some(), "{ray:?}");
                }
            }
        }
    }

    #[test]
    fn smooth_normals_do_not_jump_between_voxels() {
        let grid = grid([6, 6, 6], ball, true);
        let mut last: Option<Vec3> = None;
        for step in 0..2000 {
            let x = 0.25 + 0.5 * step as f32 / 2000.0;
            let ray = Ray::new(Vec3::new(x, 0.47, -1.0), Vec3::Z);
            let (voxel, t) = nearest(&grid, &ray).expect("the ball is there");
            let normal = grid.surface_point(voxel, &ray, t).shading_normal;
            assert!(last.is_none_or(|last| last.dot(normal) > 0.9999), "{x}");
            last = Some(normal);
        }
    }
}
