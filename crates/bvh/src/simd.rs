//! Eight numbers at a time, by the instructions that the machine has.

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

/// Which instructions the traversal uses. The hits do not depend on it.
///
/// Arm is served by the portable tier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Tier {
    /// What every machine has.
    Portable,
    /// x86-64 with AVX2, FMA, BMI1 and BMI2.
    Avx2,
    /// What `Avx2` says, and AVX-512 with F, VL, DQ and BW: for one ray the same eight lanes, with
    /// twice the registers, by which any hit is found a twentieth faster and the nearest no faster;
    /// packets have sixteen rays instead of eight.
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

/// The operations of one tier on eight lanes. All round to nearest; all but [`Simd::multiply_add`] give the same bits in
/// every tier.
pub(crate) trait Simd {
    /// Eight numbers.
    type Vector: Copy;
    /// Eight answers.
    type Mask: Copy;

    /// The same number in all lanes.
    fn splat(value: f32) -> Self::Vector;
    /// Eight numbers from memory.
    fn load(lanes: &F32x8) -> Self::Vector;
    /// Eight numbers to memory.
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
    /// The lesser of the two, and `b` if either is not a number.
    fn least(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The greater of the two, and `b` if either is not a number.
    fn greatest(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `|a|`.
    fn absolute(a: Self::Vector) -> Self::Vector;
    /// Where `a < b`.
    fn less(a: Self::Vector, b: Self::Vector) -> Self::Mask;
    /// Where `a ≤ b`.
    fn less_equal(a: Self::Vector, b: Self::Vector) -> Self::Mask;
    /// Where both are so.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Where `a` is so and `b` is not.
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// A bit for each lane, the first lane in the lowest bit.
    fn bits(mask: Self::Mask) -> u32;
    /// `a` where the mask is so, and `b` elsewhere.
    fn select(mask: Self::Mask, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The least of the eight, all of which must be numbers.
    fn least_lane(vector: Self::Vector) -> f32;
    /// Writes those of eight words that the mask names, in order, to eight words from `to` on; what
    /// the others become is not said.
    ///
    /// # Safety
    ///
    /// There must be room for eight words at `to`.
    unsafe fn compress(words: &[u32; WIDTH], mask: u32, to: *mut u32);
}

/// For each set of lanes, their numbers in order; the rest is 0.
pub(crate) static PLACES: [[u8; WIDTH]; 256] = {
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
