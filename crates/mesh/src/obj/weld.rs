//! Merges corners with the same position, texture coordinate and normal into one vertex.

use crate::error::MeshError;
use crate::triangle_mesh::check_vertex_count;
use std::collections::HashMap;

/// Stands for no index.
pub(crate) const NONE: u32 = u32::MAX;

/// The number of vertices at one position that are searched linearly. Further ones are hashed, so
/// that a file with a million normals at one position does not take quadratic time.
const MAX_CHAIN_LENGTH: u32 = 16;

/// The corner of a face: zero-based indices into the file's three lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Corner {
    /// The position.
    pub(crate) position: u32,
    /// The texture coordinate, or [`NONE`].
    pub(crate) uv: u32,
    /// The normal, or [`NONE`].
    pub(crate) normal: u32,
}

/// A vertex, and the next vertex at the same position.
#[derive(Clone, Copy)]
struct Entry {
    corner: Corner,
    next: u32,
}

/// The vertices made so far.
///
/// Most positions belong to one or two vertices. A chain per position finds them with one or two
/// memory accesses, and without hashing.
#[derive(Default)]
pub(crate) struct Weld {
    /// The first vertex at each position, or [`NONE`].
    first_at: Vec<u32>,
    entries: Vec<Entry>,
    /// The vertices beyond full chains.
    overflow: HashMap<Corner, u32>,
}

impl Weld {
    /// The vertex of this corner, added if it is new. There are `position_count` positions so far,
    /// including the corner's.
    #[inline]
    pub(crate) fn vertex(
        &mut self,
        corner: Corner,
        position_count: usize,
    ) -> Result<u32, MeshError> {
        if self.first_at.len() < position_count {
            self.first_at.resize(position_count, NONE);
            // Typically, there are about as many vertices.
            self.entries.reserve(position_count.saturating_sub(self.entries.len()));
        }
        let first = self.first_at[corner.position as usize];
        if first == NONE {
            let vertex = self.push(corner)?;
            self.first_at[corner.position as usize] = vertex;
            return Ok(vertex);
        }
        if self.entries[first as usize].corner == corner {
            return Ok(first);
        }
        self.vertex_behind(first, corner)
    }

    /// The vertex of a corner, if that is not the first one at its position.
    fn vertex_behind(&mut self, first: u32, corner: Corner) -> Result<u32, MeshError> {
        let mut last = first;
        for _ in 1..MAX_CHAIN_LENGTH {
            let next = self.entries[last as usize].next;
            if next == NONE {
                let vertex = self.push(corner)?;
                self.entries[last as usize].next = vertex;
                return Ok(vertex);
            }
            if self.entries[next as usize].corner == corner {
                return Ok(next);
            }
            last = next;
        }
        if let Some(&vertex) = self.overflow.get(&corner) {
            return Ok(vertex);
        }
        let vertex = self.push(corner)?;
        self.overflow.insert(corner, vertex);
        Ok(vertex)
    }

    #[inline]
    fn push(&mut self, corner: Corner) -> Result<u32, MeshError> {
        let vertex = self.entries.len();
        check_vertex_count(vertex as u64 + 1)?;
        self.entries.push(Entry { corner, next: NONE });
        Ok(vertex as u32)
    }

    /// The corner of a vertex.
    #[inline]
    pub(crate) fn corner(&self, vertex: u32) -> Option<Corner> {
        self.entries.get(vertex as usize).map(|entry| entry.corner)
    }

    /// The corners of all vertices, in order.
    pub(crate) fn corners(&self) -> impl Iterator<Item = Corner> + Clone {
        self.entries.iter().map(|entry| entry.corner)
    }

    /// Frees the memory that only [`Weld::vertex`] needs.
    pub(crate) fn seal(self) -> Self {
        Self { entries: self.entries, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_triples_share_a_vertex_however_many_are_at_a_position() {
        let mut weld = Weld::default();
        let corner = |position, normal| Corner { position, uv: NONE, normal };
        for round in 0..2 {
            for normal in 0..100 {
                for position in 0..3 {
                    let vertex = weld.vertex(corner(position, normal), 3);
                    assert_eq!(vertex, Ok(3 * normal + position), "round {round}");
                }
            }
        }
        assert_eq!(weld.corner(299), Some(corner(2, 99)));
        assert_eq!(weld.corner(300), None);
        assert_eq!(weld.seal().corners().nth(4), Some(corner(1, 1)));
    }
}
