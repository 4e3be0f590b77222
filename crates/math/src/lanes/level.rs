//! The instruction sets that lanes are compiled for.

use fearless_simd::Level;

/// The greatest number of lanes on any machine, and the length of a
/// [`LaneArray`](super::LaneArray). A multiple of the number of lanes on every machine.
pub const MAX_LANES: usize = 16;

/// The instruction set that every machine of this architecture supports.
#[must_use]
pub fn baseline() -> Level {
    Level::baseline()
}

/// Evaluates an expression with the instruction set of a [`Level`](crate::lanes::Level).
///
/// The identifier is bound to the level's token, from which [`Lanes`](crate::lanes::Lanes) are made.
/// The expression is compiled once per level, and evaluated once.
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
