//! Component-wise arithmetic of [`Spectrum`] with spectra and numbers.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::Spectrum;

impl Add for Spectrum {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Spectrum {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Spectrum {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Div for Spectrum {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.divisor())
    }
}

impl Neg for Spectrum {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Sum for Spectrum {
    #[inline]
    fn sum<I: Iterator<Item = Self>>(spectra: I) -> Self {
        spectra.fold(Self::ZERO, Add::add)
    }
}

/// Derives the other forms of an operator from `Spectrum ∘ Spectrum`. A number becomes
/// [`Spectrum::splat`], whose spare component is zero, so an infinite factor does not affect it.
macro_rules! derive_operator_forms {
    ($operator:ident, $method:ident, $assign_operator:ident, $assign_method:ident) => {
        impl $operator<f32> for Spectrum {
            type Output = Self;

            #[inline]
            fn $method(self, number: f32) -> Self {
                self.$method(Self::splat(number))
            }
        }

        impl $operator<Spectrum> for f32 {
            type Output = Spectrum;

            #[inline]
            fn $method(self, spectrum: Spectrum) -> Spectrum {
                Spectrum::splat(self).$method(spectrum)
            }
        }

        impl $assign_operator for Spectrum {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }

        impl $assign_operator<f32> for Spectrum {
            #[inline]
            fn $assign_method(&mut self, number: f32) {
                *self = self.$method(number);
            }
        }
    };
}

derive_operator_forms!(Add, add, AddAssign, add_assign);
derive_operator_forms!(Sub, sub, SubAssign, sub_assign);
derive_operator_forms!(Mul, mul, MulAssign, mul_assign);
derive_operator_forms!(Div, div, DivAssign, div_assign);

#[cfg(test)]
mod tests {
    use super::*;

    const LEFT: Spectrum = Spectrum::from_rgb([1.0, 2.0, 3.0]);
    const RIGHT: Spectrum = Spectrum::from_rgb([2.0, 4.0, 8.0]);

    #[test]
    fn operators_are_component_wise() {
        assert_eq!((LEFT + RIGHT).rgb(), [3.0, 6.0, 11.0]);
        assert_eq!((LEFT - RIGHT).rgb(), [-1.0, -2.0, -5.0]);
        assert_eq!((LEFT * RIGHT).rgb(), [2.0, 8.0, 24.0]);
        assert_eq!((LEFT / RIGHT).rgb(), [0.5, 0.5, 0.375]);
        assert_eq!((-LEFT).rgb(), [-1.0, -2.0, -3.0]);
    }

    #[test]
    fn numbers_work_on_either_side() {
        assert_eq!((LEFT + 1.0).rgb(), [2.0, 3.0, 4.0]);
        assert_eq!((1.0 - LEFT).rgb(), [0.0, -1.0, -2.0]);
        assert_eq!(2.0 * LEFT, LEFT * 2.0);
        assert_eq!((8.0 / RIGHT).rgb(), [4.0, 2.0, 1.0]);
        assert_eq!((LEFT / 2.0).rgb(), [0.5, 1.0, 1.5]);
    }

    #[test]
    fn assignment_forms_agree_with_the_operators() {
        let mut value = LEFT;
        value += RIGHT;
        value -= 1.0;
        value *= RIGHT;
        value /= 2.0;
        assert_eq!(value, (LEFT + RIGHT - 1.0) * RIGHT / 2.0);
    }

    #[test]
    fn empty_sums_are_black() {
        assert_eq!([LEFT, RIGHT, LEFT].into_iter().sum::<Spectrum>(), LEFT * 2.0 + RIGHT);
        assert_eq!(std::iter::empty::<Spectrum>().sum::<Spectrum>(), Spectrum::ZERO);
    }

    #[test]
    fn division_by_zero_is_not_hidden() {
        assert_eq!((LEFT / 0.0).rgb(), [f32::INFINITY; 3]);
        assert!((Spectrum::ZERO / Spectrum::ZERO)[1].is_nan());
    }

    #[test]
    fn operators_keep_the_spare_component_zero() {
        let infinite = Spectrum::splat(f32::INFINITY);
        let results = [
            LEFT / Spectrum::ZERO,
            LEFT / 0.0,
            0.0 / Spectrum::ZERO,
            infinite * 0.0,
            LEFT * f32::INFINITY,
            LEFT * f32::NAN,
            infinite - infinite,
            LEFT + 1.0,
            1.0 - LEFT,
            -LEFT,
        ];
        for result in results {
            assert_eq!(result.0.w, 0.0, "{result:?}");
        }
    }
}
