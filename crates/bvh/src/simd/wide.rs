//! One number for each ray of a packet, by the instructions that the machine has.

use crate::node::F32x8;

/// The most rays of a packet.
pub(crate) const MOST: usize = 16;

/// One number for each ray of a packet; tiers of fewer lanes use the first.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Row<T = f32>(pub(crate) [T; MOST]);

/// The operations of one tier on a number for each ray. Sets of lanes are words with a bit for each
/// lane, the first in the lowest. All operations round as those of [`Simd`](super::Simd) do, and treat what is
/// not a number alike.
pub(crate) trait Wide {
    /// How many lanes there are, at most [`MOST`].
    const LANES: usize;
    /// A number for each lane.
    type Vector: Copy;
    /// One of the three axes for each lane.
    type Axes: Copy;
    /// One vertex of all triangles of a block.
    type Vertex<'a>: Copy;

    /// The same number in all lanes.
    fn splat(value: f32) -> Self::Vector;
    /// Numbers from memory.
    fn load(row: &Row) -> Self::Vector;
    /// Numbers to memory.
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
    /// The lesser of the two, and `b` if either is not a number.
    fn least(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The greater of the two, and `b` if either is not a number.
    fn greatest(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `|a|`.
    fn absolute(a: Self::Vector) -> Self::Vector;
    /// `|size|` with the sign of `sign`.
    fn with_sign(size: Self::Vector, sign: Self::Vector) -> Self::Vector;
    /// The next number towards zero; of zero, what is not a number.
    fn step_down(a: Self::Vector) -> Self::Vector;
    /// Where `a < b`.
    fn less(a: Self::Vector, b: Self::Vector) -> u32;
    /// Where `a ≤ b`.
    fn less_equal(a: Self::Vector, b: Self::Vector) -> u32;
    /// `yes` in some lanes and `no` in the others.
    fn select(lanes: u32, yes: Self::Vector, no: Self::Vector) -> Self::Vector;
    /// Writes a word to some lanes of a row.
    fn set_words(row: &mut Row<u32>, lanes: u32, word: u32);
    /// The axes of the lanes: y in some, z in others, x elsewhere.
    fn axes(y: u32, z: u32) -> Self::Axes;
    /// The coordinates x, y and z of one vertex of the triangles of a block.
    fn vertex(coordinates: &[F32x8; 3]) -> Self::Vertex<'_>;
    /// A coordinate of a triangle's vertex, in each lane on its axis.
    fn coordinate(vertex: Self::Vertex<'_>, triangle: usize, axes: Self::Axes) -> Self::Vector;
}
