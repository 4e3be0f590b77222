//! Numbers for several paths at once.
//!
//! What happens to all paths alike is written once, over any [`Real`]: a plain `f32`, or [`Lanes`]
//! of them, one lane to a path, in the widest registers that the machine has. Every operation here
//! gives each lane the bits that it would give an `f32`, on every machine: nothing is fused, and no
//! function is the library's. A path's light therefore does not depend on who it travels with.
//!
//! Branches become masks: both sides are computed, and [`Real::select`] takes one for each lane.
//! Constants stand on the right (`x * 2.0`, `-x + 1.0`), where their lanes are known from the left.
//!
//! Everything is inlined into the loop behind [`with_lanes!`](crate::with_lanes), which is compiled
//! once for each set of instructions; a function that is not inlined would lose them. So would a
//! closure with more than an operation or two in it, by which every one of them becomes a call:
//! methods, marked like the rest, take their place.
//!
//! What hashes and mixes bits is written over [`Word32`] and [`Word64`] in the same way.

mod float;
mod functions;
mod integer;
mod mask;
mod table;
mod vector;

pub use fearless_simd::{Level, Simd};
pub use float::{LaneArray, Lanes, Real};
pub use integer::{Word, Word32, Word64, WordArray32, WordArray64, WordLanes32, WordLanes64};
pub use mask::{LaneMask, Mask};
pub use table::TABLE_ENTRIES;
pub use vector::{Frame3, Vector2, Vector3};

/// The most lanes that any machine has, and the length of a [`LaneArray`]. A multiple of the lanes
/// of every machine.
pub const MAX_LANES: usize = 16;

/// What every machine of this architecture has.
#[must_use]
pub fn baseline() -> Level {
    Level::baseline()
}

/// Evaluates an expression with the instructions that a [`Level`] names; within it, the identifier
/// stands for them and is what [`Lanes`] are made with. The expression is compiled once for each
/// level and may be evaluated only once.
#[macro_export]
macro_rules! with_lanes {
    ($level:expr, $simd:ident => $work:expr) => {{
        let level: $crate::lanes::Level = $level;
        $crate::with_lanes!(@levels level, $simd => $work, [as_avx512, as_avx2, as_sse2] [as_neon])
    }};
    (@levels $level:ident, $simd:ident => $work:expr, [$($x86:ident),*] [$($arm:ident),*]) => {{
        #[allow(unused_imports)]
        use $crate::lanes::Simd as _;
        #[cfg(target_arch = "x86_64")]
        {
            $(if let Some($simd) = $level.$x86() {
                $simd.vectorize(#[inline(always)] || $work)
            } else)* {
                unreachable!("every machine of the architecture has the last level")
            }
        }
        #[cfg(target_arch = "aarch64")]
        {
            $(if let Some($simd) = $level.$arm() {
                $simd.vectorize(#[inline(always)] || $work)
            } else)* {
                unreachable!("every machine of the architecture has the last level")
            }
        }
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        {
            $crate::lanes::dispatch!($level, $simd => $work)
        }
    }};
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
pub use fearless_simd::dispatch;

#[cfg(test)]
mod tests;
