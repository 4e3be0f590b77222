//! Floats and integers in SIMD lanes.
//!
//! A *lane* is one of the numbers in a SIMD register. In a batch, each lane belongs to one path.
//! Code that does the same for all paths is written once, generic over [`Real`]:
//!
//! * [`Lanes`] is a register of `f32`, as wide as the machine has: one lane per path.
//! * A plain `f32` is the one-lane case. The scalar code is the generic code, instantiated for
//!   `f32`.
//!
//! Every operation gives each lane the same bits that it gives an `f32`, on every machine: nothing
//! is fused, and no function of a maths library is called. So the result for a path does not depend
//! on the other paths of its batch.
//!
//! A *mask* holds one boolean per lane (`bool` in the one-lane case). Branches become masks: both
//! sides are computed, and [`Real::select`] picks one in each lane. Constants stand on the right
//! (`x * 2.0`, `-x + 1.0`), where the left operand determines their number of lanes.
//!
//! A [`Level`] is an instruction set that the machine supports, detected at run time.
//! [`with_lanes!`](crate::with_lanes) compiles a loop once per level and runs the version for a
//! given one. Everything here is inlined into that loop: a function that is not inlined would be
//! compiled for the baseline instruction set. The same happens to closures with more than one or
//! two operations, whose operations then become calls; use `#[inline(always)]` methods instead.
//!
//! [`Word32`] and [`Word64`] are the integer counterparts, for hashes and bit manipulation.

mod float;
mod integer;
mod level;
mod mask;
mod real;
mod table;
mod vector;

pub use fearless_simd::{Level, Simd};
pub use float::{LaneArray, Lanes};
pub use integer::{Word, Word32, Word64, WordArray32, WordArray64, WordLanes32, WordLanes64};
pub use level::{MAX_LANES, baseline};
pub use mask::{LaneMask, Mask};
pub use real::Real;
pub use table::TABLE_ENTRIES;
pub use vector::{Frame3, Vector2, Vector3};

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[doc(hidden)]
pub use fearless_simd::dispatch;

#[cfg(test)]
mod tests;
