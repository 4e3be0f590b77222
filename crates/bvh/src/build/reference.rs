//! The references that are sorted into the tree: boxes, and the ids of what they contain.

use crate::error::BuildError;
use crate::error_bounds::transformed_bounds;
use crate::geometry::{GeometryView, TriangleMeshView};
use crate::memory::concatenate;
use etendue_math::Bounds3;
use glam::{Vec3, Vec4};
use std::iter::repeat;
use std::sync::{Mutex, PoisonError};

/// A box and the id of its content, laid out so that a reference fits two SSE registers or one AVX
/// register.
///
/// The ids must be masked out before any arithmetic on such a register. Taken as floats they are
/// denormal, and some processors take 150 cycles for an operation on one: builds were six times
/// slower there.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Reference {
    min: Vec3,
    /// The geometry, with [`Reference::CUSTOM`].
    id: u32,
    max: Vec3,
    /// The triangle, user primitive, or index of the instance.
    primitive: u32,
}

impl Reference {
    /// The number of references per parallel task. Constant, so that no result depends on the
    /// number of threads.
    pub(super) const CHUNK: usize = 16 * 1024;

    /// Set in the geometry of anything but a triangle.
    const CUSTOM: u32 = 1 << 31;
    /// Also set in the geometry of an instance.
    const INSTANCE: u32 = 1 << 30;

    /// Stands for a triangle that is left out.
    const NOTHING: Self = Self {
        min: Vec3::splat(f32::INFINITY),
        id: 0,
        max: Vec3::splat(f32::NEG_INFINITY),
        primitive: 0,
    };

    fn is_nothing(&self) -> bool {
        self.min.x == f32::INFINITY
    }

    fn new(bounds: Bounds3, id: u32, primitive: u32) -> Self {
        Self { min: bounds.min, id, max: bounds.max, primitive }
    }

    pub(super) fn is_custom(&self) -> bool {
        self.id & Self::CUSTOM != 0
    }

    pub(super) fn is_instance(&self) -> bool {
        self.id & Self::INSTANCE != 0
    }

    pub(super) fn geometry(&self) -> u32 {
        self.id & !(Self::CUSTOM | Self::INSTANCE)
    }

    pub(super) fn primitive(&self) -> u32 {
        self.primitive
    }

    pub(super) fn bounds(&self) -> Bounds3 {
        Bounds3::new(self.min, self.max)
    }

    /// The same content with another box.
    pub(super) fn with_bounds(self, bounds: Bounds3) -> Self {
        Self { min: bounds.min, max: bounds.max, ..self }
    }

    /// The minimum and the maximum corner; the fourth components are zero.
    #[inline(always)]
    pub(super) fn corners(&self) -> [Vec4; 2] {
        [self.min.extend(0.0), self.max.extend(0.0)]
    }

    /// The centre of the box; the fourth component is zero.
    #[inline(always)]
    pub(super) fn center(&self) -> Vec4 {
        let [min, max] = self.corners();
        min * 0.5 + max * 0.5
    }
}

/// The references of all geometries: triangles first, then everything else, each in the order of the
/// geometries, except that the last triangles fill the gaps of degenerate ones. Degenerate
/// triangles and empty boxes are left out, because nothing can hit them.
pub(super) fn collect(geometries: &[GeometryView<'_>]) -> Result<Vec<Reference>, BuildError> {
    if geometries.len() >= Reference::INSTANCE as usize {
        return Err(BuildError::TooManyPrimitives);
    }
    let mut references = collect_triangles(geometries)?;
    let mut next_instance = 0..;
    for (geometry, view) in (0_u32..).zip(geometries) {
        match view {
            GeometryView::Triangles(_) => {}
            GeometryView::User(boxes) => collect_boxes(geometry, boxes, &mut references)?,
            GeometryView::Instance { group, to_world } => {
                let index: usize = next_instance.next().unwrap_or(usize::MAX);
                let bounds = transformed_bounds(group.bounds(), *to_world);
                if !bounds.is_empty() {
                    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
                        return Err(BuildError::SingularTransform { geometry });
                    }
                    let id = geometry | Reference::CUSTOM | Reference::INSTANCE;
                    references.push(Reference::new(bounds, id, index as u32));
                }
            }
        }
    }
    Ok(references)
}

fn custom_count(view: &GeometryView<'_>) -> usize {
    match view {
        GeometryView::Triangles(_) => 0,
        GeometryView::User(boxes) => boxes.len(),
        GeometryView::Instance { .. } => 1,
    }
}

/// A range of the triangles of one mesh.
struct Chunk<'a> {
    geometry: u32,
    mesh: TriangleMeshView<'a>,
    /// The first triangle.
    first: u32,
    count: usize,
}

impl Chunk<'_> {
    /// One reference per triangle, with a [`Reference::NOTHING`] at the end for each degenerate
    /// one. The lowest invalid triangle is recorded in `invalid`, and is left out, too.
    fn references<'a>(
        &'a self,
        invalid: &'a Mutex<Option<(u32, u32)>>,
    ) -> impl Iterator<Item = Reference> + 'a {
        let first = self.first as usize;
        let triangles = (self.first..).zip(&self.mesh.indices[first..first + self.count]);
        let valid = triangles.filter_map(move |(primitive, indices)| {
            match triangle(self.geometry, primitive, indices, &self.mesh) {
                Ok(reference) => reference,
                Err(_) => {
                    let mut lowest = invalid.lock().unwrap_or_else(PoisonError::into_inner);
                    let this = (self.geometry, primitive);
                    *lowest = Some(lowest.map_or(this, |other| other.min(this)));
                    None
                }
            }
        });
        valid.chain(repeat(Reference::NOTHING)).take(self.count)
    }
}

/// The references of all triangles, with capacity for the other references.
fn collect_triangles(geometries: &[GeometryView<'_>]) -> Result<Vec<Reference>, BuildError> {
    let mut chunks = Vec::new();
    for (geometry, view) in (0_u32..).zip(geometries) {
        let GeometryView::Triangles(mesh) = *view else { continue };
        let end = u32::try_from(mesh.indices.len()).map_err(|_| BuildError::TooManyPrimitives)?;
        chunks.extend((0..end).step_by(Reference::CHUNK).map(|first| {
            let count = Reference::CHUNK.min((end - first) as usize);
            Chunk { geometry, mesh, first, count }
        }));
    }
    let invalid = Mutex::new(None);
    let others = geometries.iter().map(custom_count).sum();
    let mut references =
        concatenate(&chunks, others, |chunk| chunk.count, |chunk| chunk.references(&invalid));
    if let Some((geometry, primitive)) =
        invalid.into_inner().unwrap_or_else(PoisonError::into_inner)
        && let GeometryView::Triangles(mesh) = &geometries[geometry as usize]
    {
        triangle(geometry, primitive, &mesh.indices[primitive as usize], mesh)?;
    }
    // From the end, so that the last reference is always a triangle or one to be removed.
    let mut end = references.len();
    for chunk in chunks.iter().rev() {
        let start = end - chunk.count;
        let left_out = references[start..end].iter().rev().take_while(|r| r.is_nothing()).count();
        for place in (end - left_out..end).rev() {
            references.swap_remove(place);
        }
        end = start;
    }
    Ok(references)
}

/// The reference of one triangle, or `None` if it is degenerate.
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
    if is_degenerate(a, b, c) {
        return Ok(None);
    }
    Ok(Some(Reference::new(Bounds3::new(a.min(b).min(c), a.max(b).max(c)), geometry, primitive)))
}

/// Whether the corners are collinear, in double precision.
fn is_degenerate(a: Vec3, b: Vec3, c: Vec3) -> bool {
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
