//! Triangle meshes, the result of `obj`, `ply`, `serialized`, `rectangle`, `cube` and `revsurface`.

mod light;
mod parallelogram;
mod picture;
mod triangle;

pub use light::{LightPoint, LightPointBatch};
pub use parallelogram::{Parallelogram, ParallelogramBatch};
pub use picture::Glow;
pub use triangle::TriangleBatch;

use crate::interaction::SurfaceInteraction;
use crate::interaction::{ShapeSample, SurfacePoint};
use etendue_document::Parameters;
use etendue_math::lanes::{Vector2, Vector3};
use etendue_math::{Bounds3, Transform, rounding_error_bound};
use etendue_mesh::{Attribute, MeshError, TriangleMesh};
use etendue_sampling::{AliasTable, warp};
use glam::{Vec2, Vec3};
use parallelogram::{Coordinates, MappedParallelogram};
use std::sync::Arc;
use triangle::{Corners, MIN_SQUARED_LENGTH, Place, TrianglePoint, weights};

/// A mesh in world space, with the data for sampling points on it. Clones share its arrays.
///
/// Tried and lost: position, normal and texture coordinates of a vertex side by side in 32 bytes.
/// Neighbouring hits share cache lines of the separate arrays more often than one hit needs all
/// three. Renders were 3 to 10 % slower.
#[derive(Clone, Debug)]
pub struct Mesh {
    positions: Arc<[Vec3]>,
    /// Per vertex, unit; empty if the mesh is faceted.
    normals: Arc<[Vec3]>,
    /// Per vertex; empty if there are none.
    uvs: Arc<[Vec2]>,
    indices: Arc<[[u32; 3]]>,
    attributes: Vec<Arc<Attribute>>,
    /// 1 if the vertices of a triangle are counterclockwise seen from the front, −1 if clockwise.
    orientation: f32,
    area: f32,
    /// How points are sampled; only for meshes that emit light.
    sampling: Option<AreaSampling>,
}

/// The roundings in series from the vertices to the hit distance in the tree's triangle test:
/// translation, shear and projection, products, sums, and the division.
const INTERSECTION_ROUNDINGS: u32 = 12;

/// How points are sampled: uniformly by area, except on textured lights.
#[derive(Clone, Debug)]
enum AreaSampling {
    /// Selects a triangle by area, then a point in it.
    Triangles(AliasTable),
    /// The two triangles form a flat parallelogram. One smooth map keeps well-distributed random
    /// numbers well distributed, and needs no vertices.
    Parallelogram(MappedParallelogram),
    /// A textured parallelogram.
    Slide(Box<picture::Slide>),
    /// Any other textured mesh.
    Mosaic(picture::Mosaic),
}

/// The parameters common to all meshes.
#[derive(Clone, Copy, Debug)]
pub struct MeshOptions {
    /// The transform to world space.
    pub to_world: Transform,
    /// Ignore vertex normals.
    pub face_normals: bool,
    /// Swap front and back.
    pub flip_normals: bool,
    /// Edges sharper than this many degrees get separate normals on both sides.
    pub max_smooth_angle: Option<f32>,
    /// Whether a mesh without normals gets smooth ones.
    pub compute_normals: bool,
}

impl MeshOptions {
    /// A placement and an orientation, for meshes with their own normals.
    #[must_use]
    pub fn placement(to_world: Transform, flip_normals: bool) -> Self {
        Self {
            to_world,
            face_normals: false,
            flip_normals,
            max_smooth_angle: None,
            compute_normals: false,
        }
    }

    /// Reads the parameters; `None` after reporting a transform that has no inverse.
    #[must_use]
    pub fn read(parameters: &Parameters<'_>) -> Option<Self> {
        let face_normals = parameters.boolean("face_normals", false);
        let flip_normals = parameters.boolean("flip_normals", false);
        let max_smooth_angle =
            parameters.optional_float("max_smooth_angle").map(|angle| angle as f32);
        let to_world = crate::inputs::transform::read_transform(parameters, "to_world")?;
        let compute_normals = !face_normals;
        Some(Self { to_world, face_normals, flip_normals, max_smooth_angle, compute_normals })
    }
}

impl Mesh {
    /// Places a mesh in the world.
    ///
    /// If the file has normals, they decide which side is the front, and a mirrored mesh keeps its
    /// front outside. If they are computed, the winding in world space decides, as in Mitsuba: a
    /// mirrored mesh then has its front inside.
    ///
    /// # Errors
    /// If splitting sharp edges exceeds the maximum number of vertices.
    pub fn new(mut mesh: TriangleMesh, options: &MeshOptions) -> Result<Self, MeshError> {
        if options.face_normals {
            mesh.normals = Vec::new();
        }
        let to_world = &options.to_world;
        let mirrored = to_world.flips_handedness() && !mesh.normals.is_empty();
        if *to_world != Transform::IDENTITY {
            mesh.positions.iter_mut().for_each(|position| *position = to_world.point(*position));
            mesh.normals.iter_mut().for_each(|normal| *normal = to_world.normal(*normal));
        }
        if let (Some(angle), false) = (options.max_smooth_angle, options.face_normals) {
            mesh.split_sharp_edges(angle)?;
        } else if options.compute_normals && mesh.normals.is_empty() {
            mesh.compute_vertex_normals();
        }
        let sign = if options.flip_normals { -1.0 } else { 1.0 };
        let normals = mesh.normals.iter().map(|normal| normal.normalize_or_zero() * sign);
        let mut placed = Self {
            orientation: if mirrored { -sign } else { sign },
            normals: normals.collect(),
            positions: mesh.positions.into(),
            uvs: mesh.uvs.into(),
            indices: mesh.indices.into(),
            attributes: mesh.attributes.into_iter().map(Arc::new).collect(),
            area: 0.0,
            sampling: None,
        };
        placed.area = placed.triangle_areas().map(f64::from).sum::<f64>() as f32;
        Ok(placed)
    }

    /// Prepares the mesh for use as a light.
    pub fn prepare_sampling(&mut self) {
        self.sampling = self.flat_sheet().map(AreaSampling::Parallelogram).or_else(|| {
            let areas: Vec<f32> = self.triangle_areas().collect();
            AliasTable::new(&areas).ok().map(AreaSampling::Triangles)
        });
    }

    /// Makes point sampling follow the light's texture. The mesh must already be prepared as a
    /// light.
    pub fn follow(&mut self, glow: Glow<'_>) {
        let following = match self.flat_sheet() {
            Some(sheet) => {
                picture::Slide::new(sheet, glow).map(|slide| AreaSampling::Slide(Box::new(slide)))
            }
            None => picture::Mosaic::new(self, glow).map(AreaSampling::Mosaic),
        };
        self.sampling = following.or(self.sampling.take());
    }

    /// The density per area of a point sampled by [`Self::sample_area`].
    #[inline]
    #[must_use]
    pub fn pdf_area(&self, surface: &SurfaceInteraction) -> f32 {
        match &self.sampling {
            Some(AreaSampling::Slide(slide)) => slide.pdf(surface.uv),
            Some(AreaSampling::Mosaic(mosaic)) => mosaic.pdf(surface.primitive),
            _ => 1.0 / self.area,
        }
    }

    /// The mesh as a parallelogram (a, b, c, d), if it consists of its two triangles (a, b, c) and
    /// (a, c, d), with one normal and globally affine texture coordinates.
    fn flat_sheet(&self) -> Option<MappedParallelogram> {
        let &[[a, b, c], [a_again, c_again, d]] = &*self.indices else { return None };
        let vertices = [a, b, c, d].map(|vertex| vertex as usize);
        let corners = vertices.map(|vertex| self.positions[vertex]);
        let uvs = vertices.map(|vertex| self.uvs.get(vertex).copied().unwrap_or_default());
        let same_normal = self.normals.windows(2).all(|pair| pair[0].dot(pair[1]) > 1.0 - 1e-6);
        let size = (corners[2] - corners[0]).abs().max_element();
        let skew = (corners[0] + corners[2] - corners[1] - corners[3]).abs().max_element();
        let skew_uv = (uvs[0] + uvs[2] - uvs[1] - uvs[3]).abs().max_element();
        if (a, c) != (a_again, c_again) || !same_normal || skew > 1e-5 * size || skew_uv > 1e-5 {
            return None;
        }
        let middle = self.light_point(0, Vec2::new(0.0, 0.5));
        let magnitude = corners.iter().fold(Vec3::ZERO, |sum, corner| sum.max(corner.abs()));
        let reach = Vec3::splat(size * rounding_error_bound(INTERSECTION_ROUNDINGS));
        let shape = Parallelogram {
            corner: corners[0].into(),
            edges: [(corners[1] - corners[0]).into(), (corners[3] - corners[0]).into()],
            error: (magnitude * rounding_error_bound(16) + reach).into(),
            normal: middle.normal.into(),
            shading_normal: middle.shading_normal.into(),
            pdf: middle.pdf,
        };
        let edges = [uvs[1] - uvs[0], uvs[3] - uvs[0]];
        Some(MappedParallelogram { shape, uv: Coordinates { corner: uvs[0], edges } })
    }

    fn triangle_areas(&self) -> impl Iterator<Item = f32> + '_ {
        (0..self.indices.len()).map(|triangle| {
            let [a, b, c] = self.corners(triangle);
            0.5 * parallelogram_area(b - a, c - a)
        })
    }

    #[inline]
    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.indices[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// The vertex positions.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// The vertex indices of each triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.indices
    }

    /// Additional mesh attributes.
    #[must_use]
    pub fn attributes(&self) -> &[Arc<Attribute>] {
        &self.attributes
    }

    /// Drops unused attributes.
    pub(crate) fn retain_attributes(&mut self, wanted: impl Fn(&Attribute) -> bool) {
        self.attributes.retain(|attribute| wanted(attribute));
        self.attributes.shrink_to_fit();
    }

    /// The bounding box of the mesh.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        Bounds3::from_points(self.positions.iter().copied())
    }

    /// The total area of the triangles.
    #[must_use]
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Bytes of memory used.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.uvs)
            + size_of_val(&*self.indices)
            + self.attributes.iter().map(|a| size_of_val(a.values.as_slice())).sum::<usize>()
    }

    /// The surface at `barycentric`, the barycentric coordinates of the second and third vertex.
    #[inline(always)]
    #[must_use]
    pub fn surface_point(&self, triangle: u32, barycentric: Vec2) -> SurfacePoint {
        let vertices = self.indices[triangle as usize].map(|vertex| vertex as usize);
        let mapped = !self.uvs.is_empty();
        let none = [Vector2::from(Vec2::ZERO); 3];
        let uvs = if mapped { vertices.map(|v| self.uvs[v].into()) } else { none };
        let point = TrianglePoint::<f32> {
            corners: self.corners_at(vertices),
            barycentric: barycentric.into(),
            uvs: (mapped, uvs),
        };
        point.surface().into()
    }

    #[inline(always)]
    fn corners_at(&self, vertices: [usize; 3]) -> Corners<f32> {
        let smooth = !self.normals.is_empty();
        let none = [Vector3::from(Vec3::ZERO); 3];
        let normals = if smooth { vertices.map(|v| self.normals[v].into()) } else { none };
        Corners {
            positions: vertices.map(|vertex| self.positions[vertex].into()),
            orientation: self.orientation,
            normals: (smooth, normals),
        }
    }

    /// A point, uniform by area unless it follows a texture; `None` if the mesh is empty or not
    /// prepared as a light.
    #[inline(always)]
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        match self.sampling.as_ref()? {
            AreaSampling::Parallelogram(sheet) => Some(sheet.sample(random)),
            AreaSampling::Slide(slide) => Some(slide.sample(random)),
            AreaSampling::Mosaic(mosaic) => Some(mosaic.sample(self, random)),
            AreaSampling::Triangles(table) => {
                let (triangle, rest) = choose_triangle(table, random);
                Some(self.light_point(triangle, warp::uniform_triangle::sample(rest)))
            }
        }
    }

    /// [`Self::sample_area`] for a flat parallelogram without a texture.
    #[inline(always)]
    pub(crate) fn sample_parallelogram(&self, random: Vec2) -> Option<ShapeSample> {
        match &self.sampling {
            Some(AreaSampling::Parallelogram(sheet)) => Some(sheet.sample(random)),
            _ => None,
        }
    }

    /// The mesh as a flat parallelogram that [`Self::sample_area`] samples uniformly.
    #[must_use]
    pub fn parallelogram(&self) -> Option<&Parallelogram<f32>> {
        match &self.sampling {
            Some(AreaSampling::Parallelogram(sheet)) => Some(&sheet.shape),
            _ => None,
        }
    }

    /// The part of [`Self::surface_point`] that lights need: no tangents.
    #[inline(always)]
    fn light_point(&self, triangle: usize, barycentric: Vec2) -> ShapeSample {
        let vertices = self.indices[triangle].map(|vertex| vertex as usize);
        let place = self.corners_at(vertices).place(barycentric.into());
        let Place { point, error, normal, shading_normal } = place;
        let uv = if self.uvs.is_empty() {
            barycentric
        } else {
            let weights = weights(barycentric.into());
            let [a, b, c] = vertices.map(|vertex| self.uvs[vertex]);
            a * weights[0] + b * weights[1] + c * weights[2]
        };
        ShapeSample {
            point: point.into(),
            error: error.into(),
            normal: normal.into(),
            shading_normal: shading_normal.into(),
            uv,
            pdf: 1.0 / self.area,
        }
    }
}

/// The area of the parallelogram with these edges, whatever their length.
pub(crate) fn parallelogram_area(a: Vec3, b: Vec3) -> f32 {
    let squared = a.cross(b).length_squared();
    if squared.is_finite() && squared > MIN_SQUARED_LENGTH {
        return squared.sqrt();
    }
    a.as_dvec3().cross(b.as_dvec3()).length() as f32
}

/// Selects a triangle, and returns the unused part of the two random numbers. One number has enough
/// bits for a few thousand triangles. More need the upper half of the other number as well.
#[inline]
fn choose_triangle(table: &AliasTable, random: Vec2) -> (usize, Vec2) {
    let (choice, y) = if table.len() <= 4096 {
        (table.sample(random.x), random.y)
    } else {
        (table.sample_2d(random), (random.y * 4096.0).fract())
    };
    (choice.index, Vec2::new(choice.rest, y))
}
