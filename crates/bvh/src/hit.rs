//! The result of a closest-hit query.

/// Where a ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter: the hit is at `origin + t · direction`.
    pub t: f32,
    /// The barycentric coordinate of the triangle's vertex 1, or the value that a user primitive
    /// reported.
    pub u: f32,
    /// The barycentric coordinate of the triangle's vertex 2, or the value that a user primitive
    /// reported.
    pub v: f32,
    /// The index of the geometry in the list that the hierarchy, or the instance's group, was built
    /// from.
    pub geometry: u32,
    /// The index of the triangle or user primitive in its geometry.
    pub primitive: u32,
    /// The index of the geometry that is the instance, or [`Hit::NO_INSTANCE`].
    pub instance: u32,
}

impl Hit {
    /// The `instance` of hits outside of instances.
    pub const NO_INSTANCE: u32 = u32::MAX;

    /// Of hits at equal distances, the one with the lowest rank wins.
    pub(crate) fn rank(&self) -> (u32, u32, u32) {
        (self.instance, self.geometry, self.primitive)
    }
}
