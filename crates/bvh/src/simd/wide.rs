//! SIMD arithmetic for packets of rays, with one implementation per instruction set.

use crate::node::F32x8;

/// The maximum number of rays in a packet.
pub(crate) const MAX_LANES: usize = 16;

/// One value per ray of a packet. Tiers with fewer lanes use the first ones.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Row<T = f32>(pub(crate) [T; MAX_LANES]);

/// Operations of one tier on one value per ray. A set of lanes is a word with one bit per lane, the
/// first lane in the lowest bit. All operations round, and treat NaN, as those of
/// [`Simd`](super::Simd) do.
pub(crate) trait Wide {
    /// The number of lanes, at most [`MAX_LANES`].
    const LANES: usize;
    /// A float per lane.
    type Vector: Copy;
    /// One of the three axes per lane.
    type Axes: Copy;
    /// One vertex of all triangles in a block.
    type Vertex<'a>: Copy;

    /// The same value in all lanes.
    fn splat(value: f32) -> Self::Vector;
    /// Loads one float per lane.
    fn load(row: &Row) -> Self::Vector;
    /// Stores one float per lane.
    fn store(vector: Self::Vector) -> Row;
    /// `a + b`.
    fn add(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a - b`.
    fn subtract(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a · b`.
    fn multiply(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a / b`.
    fn divide(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a · b + c`, with one rounding.
    fn multiply_add(a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// The lesser of the two, or `b` if either is NaN.
    fn min(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The greater of the two, or `b` if either is NaN.
    fn max(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `|a|`.
    fn abs(a: Self::Vector) -> Self::Vector;
    /// `|magnitude|` with the sign of `sign`.
    fn copysign(magnitude: Self::Vector, sign: Self::Vector) -> Self::Vector;
    /// The next float towards zero; NaN for zero.
    fn step_down(a: Self::Vector) -> Self::Vector;
    /// Where `a < b`.
    fn less(a: Self::Vector, b: Self::Vector) -> u32;
    /// Where `a ≤ b`.
    fn less_equal(a: Self::Vector, b: Self::Vector) -> u32;
    /// `yes` in the given lanes and `no` in the others.
    fn select(lanes: u32, yes: Self::Vector, no: Self::Vector) -> Self::Vector;
    /// Writes a word to the given lanes of a row.
    fn set_words(row: &mut Row<u32>, lanes: u32, word: u32);
    /// An axis per lane: y in the lanes of `y`, z in those of `z`, x elsewhere.
    fn axes(y: u32, z: u32) -> Self::Axes;
    /// Loads the x, y and z coordinates of one vertex of all triangles in a block.
    fn vertex(coordinates: &[F32x8; 3]) -> Self::Vertex<'_>;
    /// The coordinate of one triangle's vertex along each lane's axis.
    fn coordinate(vertex: Self::Vertex<'_>, triangle: usize, axes: Self::Axes) -> Self::Vector;
}
