//! Sums that do not depend on the order of what is added: the arithmetic of films.
//!
//! A picture must come out the same, bit for bit, however its samples are divided over threads,
//! runs and machines. Floating-point addition is not associative; integer addition is. So every
//! value is first cut into whole multiples of two units, by a rule that depends on the value alone, and
//! the multiples are added as integers (the idea of Demmel and Nguyen, *Parallel Reproducible
//! Summation*, 2015, with integers in place of their floating-point bins).
//!
//! # The rule
//!
//! Windows w lie on one fixed grid. In window w the greater unit is `u(w) = 2^(32w − 15)` and the
//! lesser one is `u(w − 1) = u(w) / 2^32`. A value `|v| < 2^31 u(w)` fits window w; there it is cut
//! into
//!
//! - the high digit `h = round(v / u(w))`, and
//! - the low digit `l = round((v − h u(w)) / u(w − 1))`.
//!
//! Both are integers of at most 2^31 in magnitude. A sum has the least window that all of its values
//! fit, and stores Σh and Σl of that window.
//!
//! # Why the order does not matter
//!
//! The least common window is a maximum, so it does not depend on the order. It remains to show that
//! digits of a lower window can be carried over when a greater value arrives. Let v fit window w.
//!
//! - In window w + 1, `|v| / u(w + 1) < 1/2`, so h is 0 and `l = round(v / u(w))`, which was the high
//!   digit. The high sum moves into the low place exactly.
//! - In window w + 2 and above, `|v| / u(w + 1) < 1/2` makes both digits 0. The sums are dropped, exactly
//!   as if each value had been cut in that window.
//!
//! So window, Σh and Σl depend on the set of values alone, not on the order or on how partial sums were
//! merged. No sum overflows below 2^32 additions: 2^32 · 2^31 = 2^63.
//!
//! # What it costs
//!
//! A value is rounded by at most half of u(w − 1). That is 2^−48 if the greatest value of the sum lies
//! between 2^−16 and 2^16, as light mostly does, and never more than 2^−32 of that greatest value.
//! A sum takes 18 bytes, adding a value about twenty machine instructions.

use fearless_simd::{Simd, f64x4, i64x4, prelude::*, u64x4};

/// Many sums whose values may be added in any order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExactSums {
    limits: Vec<u16>,
    digits: Vec<Digits>,
}

/// Σh and Σl.
pub(crate) type Digits = [i64; 2];

/// Some consecutive sums, to add to.
pub(crate) struct SumsMut<'a> {
    limits: &'a mut [u16],
    digits: &'a mut [Digits],
}

/// Bits per digit.
const DIGIT_BITS: u16 = 32;

/// The exponent field of one.
const BIAS: u16 = 1023;

/// The code names a window by its limit: the exponent field of the least power of two that is too
/// large for it. This is the limit of window 0, 2^16.
const LIMIT_OF_WINDOW_0: u16 = BIAS + 16;

/// The lowest window, which an empty sum has. Its limit is 2^−592; smaller values are rounded to its
/// units. Films add products of two single-precision numbers and squares of these, of which only those
/// of the smallest denormals lie below.
const LOWEST_LIMIT: u16 = LIMIT_OF_WINDOW_0 - 19 * DIGIT_BITS;

/// The highest window, which fits every finite value.
const HIGHEST_LIMIT: u16 = LIMIT_OF_WINDOW_0 + 32 * DIGIT_BITS;

/// 1.5 · 2^52. Adding it to a number of magnitude below 2^51 rounds that number to an integer, which is
/// then in the lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// 2^32: the number of low units in a high one.
const UNIT_RATIO: f64 = 4_294_967_296.0;

impl ExactSums {
    /// The bytes of one sum.
    pub const BYTES: u64 = (size_of::<u16>() + size_of::<Digits>()) as u64;

    /// So many sums, all zero.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { limits: vec![LOWEST_LIMIT; count], digits: vec![[0; 2]; count] }
    }

    /// How many sums there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.limits.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.limits.is_empty()
    }

    /// Adds a value, which must be finite, to the sum at `index`.
    ///
    /// # Panics
    ///
    /// If there is no such sum.
    #[inline]
    pub fn add(&mut self, index: usize, value: f64) {
        self.slice_mut(index, 1).add(0, value);
    }

    /// Adds other sums one by one. Any tree of merges gives the same sums as adding all values to one.
    ///
    /// # Panics
    ///
    /// If the numbers of sums differ.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!(self.len(), other.len(), "sums of different films");
        for index in 0..self.len() {
            self.merge_one(index, other.raw(index));
        }
    }

    /// The sum at `index`, rounded once.
    ///
    /// # Panics
    ///
    /// If there is no such sum.
    #[must_use]
    pub fn value(&self, index: usize) -> f64 {
        let [high, low] = self.digits[index];
        let units = (i128::from(high) << DIGIT_BITS) + i128::from(low);
        // The conversion rounds; the scaling by a power of two does not.
        units as f64 * power_of_two(self.limits[index] - (DIGIT_BITS - 1) - DIGIT_BITS)
    }

    /// `count` sums from `start` on.
    #[inline]
    pub(crate) fn slice_mut(&mut self, start: usize, count: usize) -> SumsMut<'_> {
        let range = start..start + count;
        SumsMut { limits: &mut self.limits[range.clone()], digits: &mut self.digits[range] }
    }

    /// The windows and the digits of all sums, for files.
    pub(crate) fn raw_parts(&self) -> (&[u16], &[Digits]) {
        (&self.limits, &self.digits)
    }

    /// Window and digits of one sum.
    pub(crate) fn raw(&self, index: usize) -> (u16, Digits) {
        (self.limits[index], self.digits[index])
    }

    /// Adds what [`Self::raw`] gave.
    pub(crate) fn merge_one(&mut self, index: usize, (other_limit, other): (u16, Digits)) {
        let (limit, digits) = (&mut self.limits[index], &mut self.digits[index]);
        let common = (*limit).max(other_limit);
        *digits = carry(*digits, common - *limit);
        *limit = common;
        let other = carry(other, common - other_limit);
        for (digit, other) in digits.iter_mut().zip(other) {
            // Only sums of more than 2^32 values, or forged ones from a file, can overflow.
            *digit = digit.saturating_add(other);
        }
    }

    /// Whether a limit belongs to a window of the grid.
    pub(crate) fn is_limit(limit: u16) -> bool {
        (LOWEST_LIMIT..=HIGHEST_LIMIT).contains(&limit)
            && (limit - LOWEST_LIMIT).is_multiple_of(DIGIT_BITS)
    }
}

impl SumsMut<'_> {
    /// Adds a finite value to one of the sums.
    #[inline(always)]
    pub(crate) fn add(&mut self, index: usize, value: f64) {
        let (limit, digits) = (&mut self.limits[index], &mut self.digits[index]);
        if exponent_field(value) >= *limit {
            raise(limit, digits, exponent_field(value));
        }
        add(*limit, digits, value);
    }

    /// As [`Self::add`] for four sums from `first` on, in SIMD registers: the compiler does not do this
    /// by itself.
    #[inline(always)]
    pub(crate) fn add_four<S: Simd>(&mut self, simd: S, first: usize, values: [f64; 4]) {
        let limits = &mut self.limits[first..first + 4];
        let digits = &mut self.digits[first..first + 4];
        let numbers = f64x4::from_slice(simd, &values);
        let exponents = (numbers.bitcast::<u64x4<S>>() >> 52) & 0x7ff;
        let wide = |limits: &[u16]| {
            let limits = [limits[0], limits[1], limits[2], limits[3]].map(u64::from);
            u64x4::from_slice(simd, &limits)
        };
        if exponents.simd_ge(wide(limits)).any_true() {
            for (value, (limit, digits)) in values.iter().zip(limits.iter_mut().zip(&mut *digits)) {
                raise(limit, digits, exponent_field(*value));
            }
        }
        let one_over_high =
            u64x4::splat(simd, u64::from(2 * BIAS + (DIGIT_BITS - 1))) - wide(limits);
        let scaled = numbers * (one_over_high << 52).bitcast::<f64x4<S>>();
        let (high, rounded) = round_four(scaled);
        let (low, _) = round_four((scaled - rounded) * UNIT_RATIO);
        let sums = digits.as_flattened_mut();
        for (half, added) in [high.zip_low(low), high.zip_high(low)].into_iter().enumerate() {
            let sums = &mut sums[4 * half..4 * half + 4];
            (i64x4::from_slice(simd, sums) + added).store_slice(sums);
        }
    }
}

/// As [`round`], four times.
#[inline(always)]
fn round_four<S: Simd>(values: f64x4<S>) -> (i64x4<S>, f64x4<S>) {
    let shifted = values + ROUNDER;
    let integers = shifted.bitcast::<i64x4<S>>() - ROUNDER.to_bits().cast_signed();
    (integers, shifted - ROUNDER)
}

/// Adds a value to a sum whose window it fits.
#[inline(always)]
fn add(limit: u16, digits: &mut Digits, value: f64) {
    debug_assert!(value.is_finite());
    // One over the high unit: 2^31 over the limit.
    let scaled = value * power_of_two(2 * BIAS + (DIGIT_BITS - 1) - limit);
    let (high, rounded) = round(scaled);
    let (low, _) = round((scaled - rounded) * UNIT_RATIO);
    digits[0] += high;
    digits[1] += low;
}

/// Moves a sum to the least window that a value with this exponent field fits, unless it already fits.
/// This is rare: it happens for the first value, and for values far greater than all before.
#[cold]
#[inline(never)]
fn raise(limit: &mut u16, digits: &mut Digits, exponent: u16) {
    if exponent < *limit {
        return;
    }
    let above_lowest = exponent + 1 - LOWEST_LIMIT;
    let raised = LOWEST_LIMIT + above_lowest.next_multiple_of(DIGIT_BITS);
    *digits = carry(*digits, raised - *limit);
    *limit = raised;
}

/// The digits after raising the limit by so many powers of two.
fn carry([high, low]: Digits, raised: u16) -> Digits {
    match raised / DIGIT_BITS {
        0 => [high, low],
        1 => [0, high],
        _ => [0, 0],
    }
}

/// The nearest integer to a number of magnitude below 2^51, as an `i64` and as an `f64`.
#[inline(always)]
fn round(value: f64) -> (i64, f64) {
    let shifted = value + ROUNDER;
    let integer = shifted.to_bits().wrapping_sub(ROUNDER.to_bits()).cast_signed();
    (integer, shifted - ROUNDER)
}

#[inline(always)]
fn exponent_field(value: f64) -> u16 {
    (value.to_bits() >> 52) as u16 & 0x7ff
}

/// The power of two with this exponent field.
#[inline(always)]
fn power_of_two(exponent_field: u16) -> f64 {
    f64::from_bits(u64::from(exponent_field) << 52)
}

#[cfg(test)]
mod tests {
    use etendue_math::lanes::{Level, baseline};
    use etendue_math::with_lanes;
    use proptest::prelude::*;

    use super::*;

    fn sum(values: &[f64]) -> ExactSums {
        let mut sums = ExactSums::new(1);
        values.iter().for_each(|&value| sums.add(0, value));
        sums
    }

    /// Products of two single-precision numbers and their squares, of every magnitude, and many of
    /// like magnitude.
    fn value() -> impl Strategy<Value = f64> {
        let single = || any::<f32>().prop_filter("finite", |value| value.is_finite());
        let any_product = (single(), single()).prop_map(|(a, b)| f64::from(a) * f64::from(b));
        prop_oneof![
            any_product.clone(),
            any_product.prop_map(|product| product * product),
            -2.0..2.0_f64,
            (0.0..1e7_f64).prop_map(f64::sqrt),
            (-40..40_i32).prop_map(|power| 2.0_f64.powi(power)),
            Just(0.0),
            Just(-0.0),
            Just(65_536.0),
            Just(65_535.999_999_999_99),
            Just(f64::MAX),
        ]
    }

    proptest! {
        #[test]
        fn any_order_and_any_tree_of_merges_gives_the_same_bits(
            values in prop::collection::vec(value(), 0..40),
            shuffled in any::<prop::sample::Index>(),
            cuts in prop::collection::vec(any::<prop::sample::Index>(), 3),
        ) {
            let whole = sum(&values);
            let mut other = values.clone();
            other.reverse();
            other.rotate_left(if values.is_empty() { 0 } else { shuffled.index(values.len()) });
            prop_assert_eq!(&whole, &sum(&other));

            let mut places: Vec<_> = cuts.iter().map(|cut| cut.index(values.len() + 1)).collect();
            places.sort_unstable();
            let [a, b, c] = [places[0], places[1], places[2]];
            let mut left = sum(&values[..a]);
            left.merge(&sum(&values[a..b]));
            let mut right = sum(&values[c..]);
            right.merge(&sum(&values[b..c]));
            right.merge(&left);
            prop_assert_eq!(&whole, &right);
        }

        #[test]
        fn the_error_stays_within_what_is_promised(
            values in prop::collection::vec(-1e30..1e30_f64, 1..50),
            scale in -60..60_i32,
        ) {
            let values: Vec<f64> = values.iter().map(|value| value * 10_f64.powi(scale)).collect();
            let greatest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let total = sum(&values).value(0);
            let plain: f64 = values.iter().sum();
            let count = values.len() as f64;
            // The plain sum has its own rounding: half a unit of 2^−52 per addition.
            let bound = count * greatest * 2.0_f64.powi(-32) + count * count * greatest * 2e-16;
            prop_assert!((total - plain).abs() <= bound, "{total} for {plain}");
        }
    }

    #[test]
    fn light_of_usual_brightness_is_exact_to_the_last_bit_of_single_precision() {
        let values: Vec<f64> = (1..5000_u32).map(|i| f64::from(1.0 / i as f32)).collect();
        // Of the numbers from 1/5000 to 1, none has bits below 2^−36: all fit 2^−47.
        let exact: f64 = values.iter().sum();
        assert_eq!(sum(&values).value(0), exact);
    }

    proptest! {
        #[test]
        fn four_side_by_side_are_four_one_by_one(
            values in prop::collection::vec([value(), value(), value(), value()], 1..20),
        ) {
            for level in [baseline(), Level::new()] {
                let (mut together, mut alone) = (ExactSums::new(6), ExactSums::new(6));
                for &values in &values {
                    with_lanes!(level, simd => together.slice_mut(1, 5).add_four(simd, 0, values));
                    for (sum, value) in values.into_iter().enumerate() {
                        alone.slice_mut(1, 5).add(sum, value);
                    }
                }
                prop_assert_eq!(&together, &alone);
            }
        }
    }

    #[test]
    fn cancellation_is_exact() {
        assert_eq!(sum(&[0.1, 1e20, -0.1, -1e20, 3.0, -3.0]).value(0), 0.0);
        assert_eq!(sum(&[]).value(0), 0.0);
    }

    #[test]
    fn faint_pictures_keep_their_digits() {
        let third = f64::from(1.0_f32 / 3.0) * 1e-30;
        let total = sum(&[third; 3]).value(0);
        assert!((total / (3.0 * third) - 1.0).abs() < 1e-9, "{total}");
    }

    #[test]
    fn the_greatest_number_of_additions_does_not_overflow() {
        let mut sums = ExactSums::new(1);
        sums.add(0, 65_535.999_999_999_99);
        // 2^31 times itself, by doubling.
        for _ in 0..31 {
            let copy = sums.clone();
            sums.merge(&copy);
        }
        assert!((sums.value(0) / 65536.0 - 2.0_f64.powi(31)).abs() < 1.0);
    }

    #[test]
    fn windows_lie_on_their_grid() {
        for value in [1e-300, 1e-20, 1.0, 65535.0, 65536.0, 1e300, f64::MAX] {
            let (limit, _) = sum(&[value]).raw(0);
            assert!(ExactSums::is_limit(limit), "{value}: {limit}");
        }
        assert!(!ExactSums::is_limit(0) && !ExactSums::is_limit(u16::MAX));
        assert!(!ExactSums::is_limit(LOWEST_LIMIT + 1));
    }
}
