//! Points on triangles, one or several at once.

use super::{INTERSECTION_ROUNDINGS, Mesh};
use crate::interaction::SurfacePoint;
use crate::lanes::SurfaceLanes;
use etendue_bvh::Hit;
use etendue_math::lanes::{Frame3, LaneArray, LaneMask, Lanes, Mask, Real, Simd, Vector2, Vector3};
use etendue_math::rounding_error_bound;
use glam::Vec3;

/// The corners of a triangle.
pub(super) struct Corners<R: Real> {
    pub(super) positions: [Vector3<R>; 3],
    /// 1 if the corners are counterclockwise seen from the front, −1 if clockwise.
    pub(super) orientation: R,
    /// The corners' normals, and whether they have any.
    pub(super) normals: (R::Mask, [Vector3<R>; 3]),
}

/// The position of a point on a triangle, and the orientation of the surface there.
pub(super) struct Place<R> {
    pub(super) point: Vector3<R>,
    pub(super) error: Vector3<R>,
    pub(super) normal: Vector3<R>,
    pub(super) shading_normal: Vector3<R>,
}

/// A point on a triangle, with the mesh data of its corners.
pub(super) struct TrianglePoint<R: Real> {
    pub(super) corners: Corners<R>,
    /// Barycentric coordinates of the second and third corner.
    pub(super) barycentric: Vector2<R>,
    /// The corners' texture coordinates, and whether they have any.
    pub(super) uvs: (R::Mask, [Vector2<R>; 3]),
}

/// Where a ray hits a triangle; see [`SurfacePoint`].
pub(super) struct TriangleSurface<R> {
    point: Vector3<R>,
    error: Vector3<R>,
    normal: Vector3<R>,
    shading_normal: Vector3<R>,
    uv: Vector2<R>,
    dp_du: Vector3<R>,
    dp_dv: Vector3<R>,
}

/// Texture coordinates, and the position's derivatives with respect to them.
struct Parametrization<R: Real> {
    uv: Vector2<R>,
    /// Whether the derivatives are independent and finite.
    regular: R::Mask,
    dp_du: Vector3<R>,
    dp_dv: Vector3<R>,
}

/// The weights of the corners, from the barycentric coordinates of the second and third.
#[inline(always)]
pub(super) fn weights<R: Real>(barycentric: Vector2<R>) -> [R; 3] {
    let Vector2 { x, y } = barycentric;
    [-x + 1.0 - y, x, y]
}

/// Below this squared length of the cross product of two edges, rounding to denormal numbers spoils
/// the result.
pub(super) const MIN_SQUARED_LENGTH: f32 = 1e-36;

/// The unit normal of a triangle with these two edges, whatever its size; +z if it has no area.
#[inline(always)]
fn unit_normal<R: Real>(edges: [Vector3<R>; 2]) -> Vector3<R> {
    let normal = edges[0].cross(edges[1]);
    let squared_length = normal.length_squared();
    let unit = normal * squared_length.sqrt().reciprocal();
    let safe = squared_length.above(MIN_SQUARED_LENGTH) & squared_length.is_finite();
    if safe.all() { unit } else { Vector3::select(safe, unit, unit_normal_of_scaled(edges)) }
}

/// The unit normal of a triangle whose edges are so long or so short that the squares of their
/// products leave the range of single precision.
#[cold]
fn unit_normal_of_scaled<R: Real>(edges: [Vector3<R>; 2]) -> Vector3<R> {
    let [a, b] = edges.map(|edge| edge * edge.abs().max_element().reciprocal());
    let (zero, one) = (a.x.zero(), a.x.like(1.0));
    a.cross(b).normalize_or(Vector3::new(zero, zero, one))
}

impl<R: Real> Corners<R> {
    /// The point with the given barycentric coordinates.
    #[inline(always)]
    pub(super) fn place(&self, barycentric: Vector2<R>) -> Place<R> {
        let weights = weights(barycentric);
        let (point, error) = interpolate(self.positions, weights);
        let edges = self.edges();
        let normal = unit_normal(edges) * self.orientation;
        Place { point, error, normal, shading_normal: self.shading_normal(weights, normal) }
    }

    /// The edges from the first corner to the others.
    #[inline(always)]
    fn edges(&self) -> [Vector3<R>; 2] {
        let [a, b, c] = self.positions;
        [b - a, c - a]
    }

    #[inline(always)]
    fn shading_normal(&self, weights: [R; 3], normal: Vector3<R>) -> Vector3<R> {
        let (smooth, [a, b, c]) = self.normals;
        if !smooth.any() {
            return normal;
        }
        let (unit, exists) = (a * weights[0] + b * weights[1] + c * weights[2]).try_normalize();
        Vector3::select(smooth & exists, unit, normal)
    }
}

impl<R: Real> TrianglePoint<R> {
    #[inline(always)]
    pub(super) fn surface(&self) -> TriangleSurface<R> {
        let Place { point, error, normal, shading_normal } = self.corners.place(self.barycentric);
        let edges = self.corners.edges();
        let Parametrization { uv, regular, dp_du, dp_dv } = self.parametrization(edges);
        let (dp_du, dp_dv) = if regular.all() {
            (dp_du, dp_dv)
        } else {
            let any = Frame3::from_normal(normal);
            (Vector3::select(regular, dp_du, any.s), Vector3::select(regular, dp_dv, any.t))
        };
        TriangleSurface { point, error, normal, shading_normal, uv, dp_du, dp_dv }
    }

    #[inline(always)]
    fn parametrization(&self, edges: [Vector3<R>; 2]) -> Parametrization<R> {
        let (mapped, [a, b, c]) = self.uvs;
        if !mapped.any() {
            let [dp_du, dp_dv] = edges;
            return Parametrization { uv: self.barycentric, regular: mapped, dp_du, dp_dv };
        }
        let (uv_1, uv_2) = (b - a, c - a);
        let uv = a + uv_1 * self.barycentric.x + uv_2 * self.barycentric.y;
        let determinant = uv_1.x * uv_2.y - uv_1.y * uv_2.x;
        let inverse = determinant.reciprocal();
        let dp_du = (edges[0] * uv_2.y - edges[1] * uv_1.y) * inverse;
        let dp_dv = (edges[1] * uv_1.x - edges[0] * uv_2.x) * inverse;
        // Also not finite if the determinant is zero.
        let regular = mapped & inverse.is_finite() & dp_du.is_finite() & dp_dv.is_finite();
        let uv = Vector2::select(mapped, uv, self.barycentric);
        Parametrization { uv, regular, dp_du, dp_dv }
    }
}

/// The point of a triangle with barycentric coordinates `weights`, and a bound on its error.
///
/// The bound has two parts. The first is that of interpolating three vertices by weights that sum
/// to one: γ₇ times the sum of the terms' magnitudes (*Physically Based Rendering*, 4th ed.,
/// section 6.8.5). The second is the error of the intersection test. The test works on vertices
/// relative to the ray's origin, so its distance to the plane is rounded in proportion to how far
/// they are. Without this part, a ray leaving a floor in the plane y = 0, where the first part
/// vanishes, hits the floor again.
#[inline(always)]
fn interpolate<R: Real>([a, b, c]: [Vector3<R>; 3], weights: [R; 3]) -> (Vector3<R>, Vector3<R>) {
    let terms = [a * weights[0], b * weights[1], c * weights[2]];
    let magnitude = terms[0].abs() + terms[1].abs() + terms[2].abs();
    let reach = (b - a).abs().max((c - a).abs()).max_element()
        * rounding_error_bound(INTERSECTION_ROUNDINGS);
    let error = magnitude.map(|term| term * rounding_error_bound(7) + reach);
    (terms[0] + terms[1] + terms[2], error)
}

impl From<TriangleSurface<f32>> for SurfacePoint {
    #[inline(always)]
    fn from(surface: TriangleSurface<f32>) -> Self {
        Self {
            point: surface.point.into(),
            error: surface.error.into(),
            normal: surface.normal.into(),
            shading_normal: surface.shading_normal.into(),
            uv: surface.uv.into(),
            dp_du: surface.dp_du.into(),
            dp_dv: surface.dp_dv.into(),
        }
    }
}

/// The corners of triangles, one per lane, stored in columns.
#[derive(Clone, Debug, Default)]
pub(super) struct CornerBatch {
    positions: [[LaneArray; 3]; 3],
    normals: [[LaneArray; 3]; 3],
    orientation: LaneArray,
    /// A bit for each lane whose corners have normals.
    smooth: u32,
}

impl CornerBatch {
    /// Stores the corners at these vertices of `mesh` in a lane.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, mesh: &Mesh, vertices: [usize; 3]) {
        for (corner, vertex) in vertices.into_iter().enumerate() {
            Vector3::from(mesh.positions[vertex]).put(&mut self.positions[corner], lane);
        }
        let bit = 1 << lane;
        self.smooth &= !bit;
        if !mesh.normals.is_empty() {
            self.smooth |= bit;
            for (corner, vertex) in vertices.into_iter().enumerate() {
                Vector3::from(mesh.normals[vertex]).put(&mut self.normals[corner], lane);
            }
        }
        self.orientation.0[lane] = mesh.orientation;
    }

    /// The corners, starting at lane `first`.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, first: usize) -> Corners<Lanes<S>> {
        let smooth = LaneMask::from_bits(simd, self.smooth >> first);
        Corners {
            positions: self.positions.each_ref().map(|corner| Vector3::load(simd, corner, first)),
            orientation: Lanes::load(simd, &self.orientation, first),
            normals: (smooth, self.normals.each_ref().map(|n| Vector3::load(simd, n, first))),
        }
    }
}

/// Points on triangles, one per lane, stored in columns.
#[derive(Clone, Debug, Default)]
pub struct TriangleBatch {
    corners: CornerBatch,
    uvs: [[LaneArray; 2]; 3],
    barycentric: [LaneArray; 2],
    /// The directions of the incoming rays.
    directions: [LaneArray; 3],
    /// A bit for each lane whose corners have texture coordinates.
    mapped: u32,
}

impl TriangleBatch {
    /// The directions of the incoming rays, starting at lane `first`.
    #[inline(always)]
    #[must_use]
    pub fn directions<S: Simd>(&self, simd: S, first: usize) -> Vector3<Lanes<S>> {
        Vector3::load(simd, &self.directions, first)
    }

    /// Stores in a lane where a ray with this direction hit a triangle of `mesh`.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, mesh: &Mesh, hit: &Hit, direction: Vec3) {
        let vertices = mesh.indices[hit.primitive as usize].map(|vertex| vertex as usize);
        self.corners.set(lane, mesh, vertices);
        let bit = 1 << lane;
        self.mapped &= !bit;
        if !mesh.uvs.is_empty() {
            self.mapped |= bit;
            for (corner, vertex) in vertices.into_iter().enumerate() {
                let [u, v] = &mut self.uvs[corner];
                (u.0[lane], v.0[lane]) = mesh.uvs[vertex].into();
            }
        }
        let [x, y] = &mut self.barycentric;
        (x.0[lane], y.0[lane]) = (hit.u, hit.v);
        Vector3::from(direction).put(&mut self.directions, lane);
    }

    /// The surfaces, starting at lane `first`.
    #[inline(always)]
    #[must_use]
    pub fn surfaces<S: Simd>(&self, simd: S, first: usize) -> SurfaceLanes<Lanes<S>> {
        let mapped = LaneMask::from_bits(simd, self.mapped >> first);
        let point = TrianglePoint {
            corners: self.corners.load(simd, first),
            barycentric: Vector2::load(simd, &self.barycentric, first),
            uvs: (mapped, self.uvs.each_ref().map(|uv| Vector2::load(simd, uv, first))),
        };
        let TriangleSurface { point, error, normal, shading_normal, uv, dp_du, dp_dv } =
            point.surface();
        let shading = Frame3::from_normal_and_tangent(shading_normal, dp_du);
        let wi = shading.to_local(-Vector3::load(simd, &self.directions, first));
        SurfaceLanes { point, error, normal, shading, uv, dp_du, dp_dv, wi }
    }
}
