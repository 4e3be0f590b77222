//! What is sorted into the tree: a box and the name of what is inside.

use crate::error::BuildError;
use crate::geometry::{GeometryView, TriangleMeshView};
use crate::instance::world_bounds;
use crate::memory::vector_with_capacity;
use etendue_math::Bounds3;
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// A box and what it holds. The fourth components carry the names, as bits, so that a reference is
/// two SIMD registers, or one.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Reference {
    /// The least corner; w: the geometry, with [`Reference::CUSTOM`].
    pub(super) min: Vec4,
    /// The greatest corner; w: the triangle, user primitive, or index of the instance.
    pub(super) max: Vec4,
}

/// The part of a mesh that one task turns into references.
const CHUNK: usize = 16 * 1024;

impl Reference {
    /// Set in the geometry of what is not a triangle.
    const CUSTOM: u32 = 1 << 31;
    /// Set, besides, in the geometry of an instance.
    const INSTANCE: u32 = 1 << 30;

    /// Stands in for a triangle that is left out.
    const NOTHING: Self =
        Self { min: Vec4::splat(f32::INFINITY), max: Vec4::splat(f32::NEG_INFINITY) };

    fn is_nothing(&self) -> bool {
        self.min.x == f32::INFINITY
    }

    fn new(bounds: Bounds3, geometry: u32, primitive: u32) -> Self {
        Self {
            min: bounds.min.extend(f32::from_bits(geometry)),
            max: bounds.max.extend(f32::from_bits(primitive)),
        }
    }

    pub(super) fn is_custom(&self) -> bool {
        self.min.w.to_bits() & Self::CUSTOM != 0
    }

    pub(super) fn is_instance(&self) -> bool {
        self.min.w.to_bits() & Self::INSTANCE != 0
    }

    pub(super) fn geometry(&self) -> u32 {
        self.min.w.to_bits() & !(Self::CUSTOM | Self::INSTANCE)
    }

    pub(super) fn primitive(&self) -> u32 {
        self.max.w.to_bits()
    }

    pub(super) fn bounds(&self) -> Bounds3 {
        Bounds3::new(self.min.truncate(), self.max.truncate())
    }

    /// The same with another box.
    pub(super) fn with_bounds(self, bounds: Bounds3) -> Self {
        Self { min: bounds.min.extend(self.min.w), max: bounds.max.extend(self.max.w) }
    }

    /// The centre of the box; the fourth component means nothing.
    #[inline(always)]
    pub(super) fn center(&self) -> Vec4 {
        self.min * 0.5 + self.max * 0.5
    }
}

/// The references of all geometries, in order. Triangles without area and empty boxes, which
/// nothing can hit, are left out.
pub(super) fn collect(geometries: &[GeometryView<'_>]) -> Result<Vec<Reference>, BuildError> {
    if geometries.len() >= Reference::INSTANCE as usize {
        return Err(BuildError::TooManyPrimitives);
    }
    let mut references = vector_with_capacity(geometries.iter().map(primitive_count).sum());
    let mut next_instance = 0..;
    for (geometry, view) in (0_u32..).zip(geometries) {
        match view {
            GeometryView::Triangles(mesh) => collect_triangles(geometry, mesh, &mut references)?,
            GeometryView::User(boxes) => collect_boxes(geometry, boxes, &mut references)?,
            GeometryView::Instance { group, to_world } => {
                let index: usize = next_instance.next().unwrap_or(usize::MAX);
                let bounds = world_bounds(group.bounds(), *to_world);
                if !bounds.is_empty() {
                    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
                        return Err(BuildError::SingularTransform { geometry });
                    }
                    let name = geometry | Reference::CUSTOM | Reference::INSTANCE;
                    references.push(Reference::new(bounds, name, index as u32));
                }
            }
        }
    }
    Ok(references)
}

fn primitive_count(view: &GeometryView<'_>) -> usize {
    match view {
        GeometryView::Triangles(mesh) => mesh.indices.len(),
        GeometryView::User(boxes) => boxes.len(),
        GeometryView::Instance { .. } => 1,
    }
}

fn collect_triangles(
    geometry: u32,
    mesh: &TriangleMeshView<'_>,
    references: &mut Vec<Reference>,
) -> Result<(), BuildError> {
    if u32::try_from(mesh.indices.len()).is_err() {
        return Err(BuildError::TooManyPrimitives);
    }
    let start = references.len();
    references.resize(start + mesh.indices.len(), Reference::NOTHING);
    let outcomes: Vec<Result<usize, BuildError>> = references[start..]
        .par_chunks_mut(CHUNK)
        .zip(mesh.indices.par_chunks(CHUNK))
        .enumerate()
        .map(|(chunk, (references, indices))| {
            let mut left_out = 0;
            for (primitive, (reference, indices)) in
                ((chunk * CHUNK) as u32..).zip(references.iter_mut().zip(indices))
            {
                match triangle(geometry, primitive, indices, mesh)? {
                    Some(triangle) => *reference = triangle,
                    None => left_out += 1,
                }
            }
            Ok(left_out)
        })
        .collect();
    let mut left_out = 0;
    for outcome in outcomes {
        left_out += outcome?;
    }
    if left_out > 0 {
        let mut place = 0..;
        references.retain(|reference| place.next() < Some(start) || !reference.is_nothing());
    }
    Ok(())
}

/// One triangle's reference, or `None` where it has no area.
fn triangle(
    geometry: u32,
    primitive: u32,
    indices: &[u32; 3],
    mesh: &TriangleMeshView<'_>,
) -> Result<Option<Reference>, BuildError> {
    let mut corners = [Vec3::ZERO; 3];
    for (corner, &index) in corners.iter_mut().zip(indices) {
        let vertex_count = mesh.positions.len();
        *corner = *mesh.positions.get(index as usize).ok_or(BuildError::IndexOutOfRange {
            geometry,
            primitive,
            index,
            vertex_count,
        })?;
        if !corner.is_finite() {
            return Err(BuildError::NonFiniteVertex { geometry, primitive });
        }
    }
    let [a, b, c] = corners;
    if has_no_area(a, b, c) {
        return Ok(None);
    }
    Ok(Some(Reference::new(Bounds3::new(a.min(b).min(c), a.max(b).max(c)), geometry, primitive)))
}

/// Whether the corners are on one line, as far as double precision can tell.
fn has_no_area(a: Vec3, b: Vec3, c: Vec3) -> bool {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    (b - a).cross(c - a) == glam::DVec3::ZERO
}

fn collect_boxes(
    geometry: u32,
    boxes: &[Bounds3],
    references: &mut Vec<Reference>,
) -> Result<(), BuildError> {
    if u32::try_from(boxes.len()).is_err() {
        return Err(BuildError::TooManyPrimitives);
    }
    for (primitive, bounds) in (0_u32..).zip(boxes) {
        if bounds.is_empty() {
            continue;
        }
        if !(bounds.min.is_finite() && bounds.max.is_finite()) {
            return Err(BuildError::NonFiniteBounds { geometry, primitive });
        }
        references.push(Reference::new(*bounds, geometry | Reference::CUSTOM, primitive));
    }
    Ok(())
}
