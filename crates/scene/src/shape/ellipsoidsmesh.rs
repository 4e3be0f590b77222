//! `ellipsoidsmesh`: many ellipsoids, each represented by a shell of triangles.

use super::{Geometry, ShapeModel, SurfacePoint, cube};
use crate::builder::Assets;
use crate::inputs::ellipsoid_file::{self, Ellipsoid};
use crate::manual::{Manual, parameter};
use crate::models::mesh::{Mesh, MeshOptions};
use crate::plugin::find;
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::{Class, Entry, Fault, Parameters};
use etendue_math::{Bounds3, Ray, Transform};
use etendue_mesh::TriangleMesh;
use glam::{DMat3, DVec3, Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A cloud of ellipsoids, such as Gaussian splats, each in a shell of flat triangles that is \
              scaled until the middle of no triangle lies within the ellipsoid. Rays from within a \
              shell do not see it. No light is sampled on it. See `ellipsoids`, which is round.",
    parameters: &[
        ellipsoid_file::FILENAME,
        ellipsoid_file::SCALE_FACTOR,
        ellipsoid_file::EXTENT,
        ellipsoid_file::EXTENT_ADAPTIVE_CLAMPING,
        parameter(
            "shell",
            "string or shape",
            "ico_sphere",
            "`box` (12 triangles), `ico_sphere` (20; `default` is the same), `uv_sphere` (72), or a \
             nested shape that is a mesh around the origin.",
        ),
        ellipsoid_file::TO_WORLD,
    ],
    sample: r#"<shape type="ellipsoidsmesh">
    <string name="filename" value="ellipsoids.ply"/>
    <string name="shell" value="uv_sphere"/>
</shape>"#,
};

/// The maximum number of triangles. Without it, a small file and a large shell could exhaust
/// memory.
const MOST_TRIANGLES: usize = 1 << 27;

/// The shells in world space.
#[derive(Clone, Debug)]
pub struct EllipsoidsMesh {
    mesh: Mesh,
}

/// Reads ellipsoids and their shell.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<EllipsoidsMesh> {
    let shell = read_shell(assets, parameters).map(Shell::scaled);
    let ellipsoids = ellipsoid_file::read(assets, parameters)?;
    let shell = shell?;
    let triangle_count = shell.triangles.len().saturating_mul(ellipsoids.len());
    let vertex_count = shell.vertices.len().saturating_mul(ellipsoids.len());
    if triangle_count.max(vertex_count) > MOST_TRIANGLES {
        let message = format!(
            "{} ellipsoids with {} triangles each are more than {MOST_TRIANGLES} triangles",
            ellipsoids.len(),
            shell.triangles.len()
        );
        parameters.error(Fault::Limit, "shell", message);
        return None;
    }
    let options = MeshOptions::placement(Transform::IDENTITY, false);
    Mesh::new(shell.around(&ellipsoids), &options).ok().map(|mesh| EllipsoidsMesh { mesh })
}

/// A closed mesh around the unit sphere.
#[derive(Clone, Debug)]
struct Shell {
    vertices: Vec<DVec3>,
    /// Counterclockwise as seen from outside.
    triangles: Vec<[u32; 3]>,
}

fn read_shell(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Shell> {
    if let Some(Entry::Child(child)) = parameters.entry("shell") {
        let node = assets.document.node(child.node);
        // A shell made of shells would recurse without end.
        if node.class != Class::Shape || node.plugin == "ellipsoidsmesh" {
            parameters.error(Fault::BadValue, "shell", "a shell is a mesh");
            return None;
        }
        let nested = assets.document.parameters(child.node, assets.diagnostics);
        let geometry = find(super::SHAPES, &nested)?(assets, &nested)?;
        let Geometry::Mesh(mesh) = geometry else {
            let message = format!("a shell is a mesh; `{}` has no triangles", nested.plugin());
            parameters.error(Fault::BadValue, "shell", message);
            return None;
        };
        nested.finish();
        return Some(Shell::of_mesh(mesh.positions(), mesh.triangles()));
    }
    let choices = [("box", 0), ("default", 1), ("ico_sphere", 1), ("uv_sphere", 2)];
    Some(match parameters.choice("shell", 1, &choices) {
        0 => {
            let cube = cube::unit_cube();
            Shell::of_mesh(&cube.positions, &cube.indices)
        }
        1 => Shell::icosahedron(),
        _ => Shell::globe(),
    })
}

/// A ring of vertices at one latitude of the unit sphere.
#[derive(Clone, Copy)]
struct Ring {
    /// The height of the ring.
    y: f64,
    /// The azimuth of the first vertex in degrees, from x to z.
    start: f64,
}

impl Shell {
    fn of_mesh(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        Self {
            vertices: positions.iter().map(|position| position.as_dvec3()).collect(),
            triangles: triangles.to_vec(),
        }
    }

    /// The icosahedron, with vertices on the y axis.
    fn icosahedron() -> Self {
        let y = 0.2_f64.sqrt();
        Self::from_rings(&[Ring { y: -y, start: 36.0 }, Ring { y, start: 72.0 }], 5)
    }

    /// A UV sphere with nine meridians and four circles of latitude 36° apart.
    fn globe() -> Self {
        let rings = [144.0_f64, 108.0, 72.0, 36.0];
        let rings = rings.map(|angle| Ring { y: angle.to_radians().cos(), start: -90.0 });
        Self::from_rings(&rings, 9)
    }

    /// Builds a sphere from its poles and rings of `count` vertices, from the lowest to the
    /// highest.
    fn from_rings(rings: &[Ring], count: u32) -> Self {
        let mut shell = Self { vertices: vec![DVec3::NEG_Y], triangles: Vec::new() };
        for ring in rings {
            let radius = (1.0 - ring.y * ring.y).sqrt();
            shell.vertices.extend((0..count).map(|index| {
                let degrees = ring.start + 360.0 * f64::from(index) / f64::from(count);
                let (sin, cos) = degrees.to_radians().sin_cos();
                DVec3::new(radius * cos, ring.y, radius * sin)
            }));
        }
        shell.vertices.push(DVec3::Y);
        let top = shell.vertices.len() as u32 - 1;
        let last = top - count;
        for index in 0..count {
            let next = (index + 1) % count;
            shell.triangles.push([0, 1 + index, 1 + next]);
            for low in (1..last).step_by(count as usize) {
                let high = low + count;
                shell.triangles.push([low + index, high + index, low + next]);
                shell.triangles.push([high + index, high + next, low + next]);
            }
            shell.triangles.push([last + index, top, last + next]);
        }
        shell
    }

    /// Scales the shell so that all vertices and triangle centroids are on or outside the unit
    /// sphere, and at least one is on it.
    fn scaled(mut self) -> Self {
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| self.vertices[vertex as usize]);
        let least = self
            .triangles
            .iter()
            .map(corners)
            .flat_map(|[a, b, c]| [a, b, c, (a + b + c) / 3.0].map(|point| point.length()));
        let least = least.fold(f64::INFINITY, f64::min).max(f64::from(f32::MIN_POSITIVE));
        self.vertices.iter_mut().for_each(|vertex| *vertex /= least);
        self
    }

    /// Places a shell around each ellipsoid.
    fn around(&self, ellipsoids: &[Ellipsoid]) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        mesh.positions.reserve_exact(ellipsoids.len() * self.vertices.len());
        mesh.indices.reserve_exact(ellipsoids.len() * self.triangles.len());
        for ellipsoid in ellipsoids {
            let first = mesh.positions.len() as u32;
            let half = ellipsoid.axes() * DMat3::from_diagonal(ellipsoid.half_axes.as_dvec3());
            let center = ellipsoid.center.as_dvec3();
            mesh.positions.extend(self.vertices.iter().map(|v| (center + half * *v).as_vec3()));
            mesh.indices.extend(self.triangles.iter().map(|corners| corners.map(|v| first + v)));
        }
        mesh
    }
}

impl ShapeModel for EllipsoidsMesh {
    fn bounds(&self) -> Bounds3 {
        super::union(self.boxes())
    }

    fn primitive_boxes(&self) -> Vec<Bounds3> {
        self.boxes()
    }

    fn primitive_count(&self) -> usize {
        self.triangle_count()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let (t, local) = self.intersect(primitive, ray)?;
        Some(PrimitiveHit { t, u: local.x, v: local.y })
    }

    fn surface_point(&self, _ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(hit.primitive, Vec2::new(hit.u, hit.v))
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl EllipsoidsMesh {
    /// The distance at which the ray hits a triangle from outside, and the barycentric coordinates
    /// of the second and third vertex. Edges count as part of the triangle, and the
    /// double-precision arithmetic leaves no gaps that a single-precision ray could find.
    ///
    /// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, with culling.
    #[must_use]
    pub fn intersect(&self, triangle: u32, ray: &Ray) -> Option<(f32, Vec2)> {
        let [a, b, c] = self.corners(triangle as usize);
        let (edge_1, edge_2) = (b - a, c - a);
        let direction = ray.direction.as_dvec3();
        let across = direction.cross(edge_2);
        let determinant = edge_1.dot(across);
        if determinant <= 0.0 {
            return None;
        }
        let from_a = ray.origin.as_dvec3() - a;
        let u = from_a.dot(across) / determinant;
        let around = from_a.cross(edge_1);
        let v = direction.dot(around) / determinant;
        let t = (edge_2.dot(around) / determinant) as f32;
        let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (is_inside && t > 0.0 && t < ray.t_max).then_some((t, Vec2::new(u as f32, v as f32)))
    }

    /// The surface point at the barycentric coordinates of the second and third vertex.
    #[must_use]
    pub fn surface_point(&self, triangle: u32, barycentric: Vec2) -> SurfacePoint {
        self.mesh.surface_point(triangle, barycentric)
    }

    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        let positions = self.mesh.positions();
        self.mesh.triangles()[triangle].map(|vertex| positions[vertex as usize].as_dvec3())
    }

    /// The bounding box of each triangle.
    #[must_use]
    pub fn boxes(&self) -> Vec<Bounds3> {
        let positions = self.mesh.positions();
        let triangles = self.mesh.triangles().iter();
        let corners = |corners: &[u32; 3]| corners.map(|vertex| positions[vertex as usize]);
        triangles.map(|triangle| Bounds3::from_points(corners(triangle))).collect()
    }

    /// The number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.mesh.triangles().len()
    }

    /// Memory use in bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.mesh.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shells_are_closed_and_look_outwards() {
        let cube = cube::unit_cube();
        let cube = Shell::of_mesh(&cube.positions, &cube.indices);
        for (shell, count) in [(cube, 12), (Shell::icosahedron(), 20), (Shell::globe(), 72)] {
            let shell = shell.scaled();
            assert_eq!(shell.triangles.len(), count);
            // By the divergence theorem, the area vectors of a closed surface sum to zero.
            let mut sum = DVec3::ZERO;
            let mut nearest = f64::INFINITY;
            for corners in &shell.triangles {
                let [a, b, c] = corners.map(|vertex| shell.vertices[vertex as usize]);
                let area = (b - a).cross(c - a);
                assert!(area.dot(a + b + c) > 0.0, "{corners:?}");
                nearest = nearest.min((a + b + c).length() / 3.0);
                sum += area;
            }
            assert!(sum.length() < 1e-12, "{sum}");
            assert!((nearest - 1.0).abs() < 1e-12, "{nearest}");
        }
    }
}
