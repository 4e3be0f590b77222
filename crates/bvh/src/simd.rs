//! Eight-lane SIMD arithmetic, with one implementation per instruction set.

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
pub(crate) mod portable;
#[cfg(target_arch = "x86_64")]
pub(crate) mod wide;
#[cfg(target_arch = "x86_64")]
mod wide_avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) mod wide_avx512;

use crate::node::{F32x8, WIDTH};

/// The instruction set that the traversal uses. Hits do not depend on it.
///
/// Arm uses the portable tier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Tier {
    /// What every machine supports.
    Portable,
    /// x86-64 with AVX2, FMA, BMI1 and BMI2.
    Avx2,
    /// As `Avx2`, plus AVX-512 F, VL, DQ and BW. Single rays use the same eight lanes with twice as
    /// many registers, which makes any-hit queries 5 % faster and nearest-hit queries no faster.
    /// Packets have sixteen rays instead of eight.
    Avx512,
}

impl Tier {
    /// The fastest tier of this machine.
    #[must_use]
    pub fn detect() -> Self {
        let tiers = [Self::Avx512, Self::Avx2];
        tiers.into_iter().find(|tier| tier.is_available()).unwrap_or(Self::Portable)
    }

    /// Whether this machine has the instructions.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("lzcnt")
                    && is_x86_feature_detected!("popcnt")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512bw")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }
}

/// Eight-lane operations of one tier. All round to nearest. All but [`Simd::multiply_add`] give the
/// same bits in every tier.
pub(crate) trait Simd {
    /// Eight floats.
    type Vector: Copy;
    /// Eight booleans.
    type Mask: Copy;

    /// The same value in all lanes.
    fn splat(value: f32) -> Self::Vector;
    /// Loads eight floats.
    fn load(lanes: &F32x8) -> Self::Vector;
    /// Stores eight floats.
    fn store(vector: Self::Vector) -> F32x8;
    /// `a + b`.
    fn add(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a - b`.
    fn subtract(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a · b`.
    fn multiply(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a / b`.
    fn divide(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a · b + c`, with one rounding or two.
    fn multiply_add(a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// The lesser of the two, or `b` if either is NaN.
    fn min(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The greater of the two, or `b` if either is NaN.
    fn max(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `|a|`.
    fn abs(a: Self::Vector) -> Self::Vector;
    /// Where `a < b`.
    fn less(a: Self::Vector, b: Self::Vector) -> Self::Mask;
    /// Where `a ≤ b`.
    fn less_equal(a: Self::Vector, b: Self::Vector) -> Self::Mask;
    /// Where both masks are set.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Where `a` is set and `b` is not.
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// One bit per lane, the first lane in the lowest bit.
    fn bitmask(mask: Self::Mask) -> u32;
    /// `a` where the mask is set, `b` elsewhere.
    fn select(mask: Self::Mask, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The minimum of the eight lanes, none of which may be NaN.
    fn reduce_min(vector: Self::Vector) -> f32;
    /// Packs the words whose bit is set in `mask` to the front, and writes eight words to `to`. The
    /// words after the packed ones are unspecified.
    ///
    /// # Safety
    ///
    /// `to` must be valid for writes of eight words.
    unsafe fn compress(words: &[u32; WIDTH], mask: u32, to: *mut u32);
}

/// For each bitmask, the indices of its set lanes in ascending order, padded with 0.
pub(crate) static COMPRESSED_LANES: [[u8; WIDTH]; 256] = {
    let mut places = [[0; WIDTH]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < WIDTH {
            if mask >> lane & 1 != 0 {
                places[mask][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    places
};
