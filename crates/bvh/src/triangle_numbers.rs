//! One number for each triangle of all geometries, so that blocks hold four bytes per triangle
//! instead of eight.

use crate::geometry::GeometryView;

/// Every geometry's numbers begin at a multiple of this, in the order of the geometries. So numbers
/// are ordered as (geometry, triangle), and a table with an entry for so many finds the geometry.
const CHUNK: u32 = 64;

/// Which numbers belong to which geometry.
#[derive(Clone, Debug, Default)]
pub(crate) struct TriangleNumbers {
    /// The first number of each geometry.
    first: Vec<u32>,
    /// The geometry of each [`CHUNK`] of numbers.
    geometries: Vec<u32>,
}

impl TriangleNumbers {
    /// `None` where there are more triangles than numbers.
    pub(crate) fn new(geometries: &[GeometryView<'_>]) -> Option<Self> {
        let mut names = Self::default();
        for (geometry, view) in (0_u32..).zip(geometries) {
            let count = match view {
                GeometryView::Triangles(mesh) => mesh.indices.len(),
                GeometryView::User(_) | GeometryView::Instance { .. } => 0,
            };
            let chunks = names.geometries.len();
            names.first.push(u32::try_from(chunks).ok()?.checked_mul(CHUNK)?);
            let end = chunks.checked_add(count.div_ceil(CHUNK as usize))?;
            if end > (u32::MAX / CHUNK) as usize {
                return None;
            }
            names.geometries.resize(end, geometry);
        }
        names.first.shrink_to_fit();
        names.geometries.shrink_to_fit();
        Some(names)
    }

    /// The number of a triangle.
    pub(crate) fn name(&self, geometry: u32, triangle: u32) -> u32 {
        self.first[geometry as usize] + triangle
    }

    /// The geometry and the triangle of a number.
    #[inline]
    pub(crate) fn resolve(&self, name: u32) -> (u32, u32) {
        let geometry = self.geometries[(name / CHUNK) as usize];
        (geometry, name - self.first[geometry as usize])
    }

    /// A number such that just the lower ones are those of triangles before this primitive, in the
    /// order (geometry, primitive): a triangle's own.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, reason = "for packets"))]
    pub(crate) fn bound(&self, geometry: u32, primitive: u32) -> u32 {
        let end = match self.first.get(geometry as usize + 1) {
            Some(&next) => next,
            None => self.geometries.len() as u32 * CHUNK,
        };
        // User primitives have no numbers, and their geometry ends where it begins.
        self.first[geometry as usize].saturating_add(primitive).min(end)
    }

    /// The memory that the tables hold.
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.first.as_slice()) + size_of_val(self.geometries.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriangleMeshView;

    #[test]
    fn numbers_lead_back_to_triangles_in_their_order() {
        let counts = [0, 1, 64, 65, 0, 200];
        let indices = vec![[0; 3]; 200];
        let view = |&count: &usize| {
            let indices = &indices[..count];
            GeometryView::Triangles(TriangleMeshView { positions: &[], indices })
        };
        let views: Vec<GeometryView<'_>> = counts.iter().map(view).collect();
        let names = TriangleNumbers::new(&views).expect("few");
        // Before any triangle of the next geometry that has some.
        assert_eq!([0, 7].map(|primitive| names.bound(4, primitive)), [names.name(5, 0); 2]);
        let mut last = None;
        for (geometry, &count) in (0_u32..).zip(&counts) {
            for triangle in 0..count as u32 {
                let name = names.name(geometry, triangle);
                assert!(last.is_none_or(|last| name > last));
                last = Some(name);
                assert_eq!(names.resolve(name), (geometry, triangle));
                assert_eq!(names.bound(geometry, triangle), name);
            }
        }
    }
}
