//! A single integer id for every triangle of all geometries, so that blocks store four bytes per
//! triangle instead of eight.

/// The ids of every geometry start at a multiple of this, in the order of the geometries. So ids
/// are ordered like (geometry, triangle), and a table with one entry per chunk finds the geometry.
const CHUNK: u32 = 64;

/// The mapping between triangle ids and (geometry, triangle).
#[derive(Clone, Debug, Default)]
pub(crate) struct TriangleIds {
    /// The first id of each geometry.
    first: Vec<u32>,
    /// The geometry of each [`CHUNK`] of ids.
    geometries: Vec<u32>,
}

impl TriangleIds {
    /// Takes the number of triangles in each geometry. `None` if there are more triangles than ids.
    pub(crate) fn new(triangle_counts: impl Iterator<Item = usize>) -> Option<Self> {
        let mut ids = Self::default();
        for (geometry, count) in (0_u32..).zip(triangle_counts) {
            let chunks = ids.geometries.len();
            ids.first.push(u32::try_from(chunks).ok()?.checked_mul(CHUNK)?);
            let end = chunks.checked_add(count.div_ceil(CHUNK as usize))?;
            if end > (u32::MAX / CHUNK) as usize {
                return None;
            }
            ids.geometries.resize(end, geometry);
        }
        ids.first.shrink_to_fit();
        ids.geometries.shrink_to_fit();
        Some(ids)
    }

    /// The id of a triangle.
    pub(crate) fn id(&self, geometry: u32, triangle: u32) -> u32 {
        self.first[geometry as usize] + triangle
    }

    /// The geometry and the triangle of an id.
    #[inline]
    pub(crate) fn resolve(&self, id: u32) -> (u32, u32) {
        let geometry = self.geometries[(id / CHUNK) as usize];
        (geometry, id - self.first[geometry as usize])
    }

    /// The lower bound of the ids at or after a primitive, in the order (geometry, primitive). For
    /// a triangle, this is its id.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, reason = "for packets"))]
    #[inline]
    pub(crate) fn lower_bound(&self, geometry: u32, primitive: u32) -> u32 {
        let end = match self.first.get(geometry as usize + 1) {
            Some(&next) => next,
            None => self.geometries.len() as u32 * CHUNK,
        };
        // User primitives have no ids, so the range of their geometry is empty.
        self.first[geometry as usize].saturating_add(primitive).min(end)
    }

    /// The size of the tables in bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.first.as_slice()) + size_of_val(self.geometries.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_resolve_to_their_triangles_in_order() {
        let counts = [0, 1, 64, 65, 0, 200];
        let ids = TriangleIds::new(counts.into_iter()).expect("few triangles");
        // Geometry 4 has no triangles, so its bounds are the first id of geometry 5.
        assert_eq!([0, 7].map(|primitive| ids.lower_bound(4, primitive)), [ids.id(5, 0); 2]);
        let mut last = None;
        for (geometry, &count) in (0_u32..).zip(&counts) {
            for triangle in 0..count as u32 {
                let id = ids.id(geometry, triangle);
                assert!(last.is_none_or(|last| id > last));
                last = Some(id);
                assert_eq!(ids.resolve(id), (geometry, triangle));
                assert_eq!(ids.lower_bound(geometry, triangle), id);
            }
        }
    }
}
