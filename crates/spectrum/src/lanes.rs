//! Spectra in SIMD lanes.

use crate::Spectrum;
use etendue_math::lanes::{LaneArray, Lanes, Real, Simd};
use std::ops::{Add, Div, Mul, Sub};

/// A [`Spectrum`] over any [`Real`]: one spectrum per lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpectrumLanes<R>([R; Spectrum::LANES]);

// The array methods do not inline the closures passed to them, so the components are listed one by
// one.
impl<R: Real> SpectrumLanes<R> {
    /// Applies a function to each component.
    #[inline(always)]
    #[must_use]
    pub fn map(self, function: impl Fn(R) -> R) -> Self {
        self.convert(function)
    }

    /// Applies a function to each component, which may change the number type.
    #[inline(always)]
    #[must_use]
    pub fn convert<T: Real>(self, mut function: impl FnMut(R) -> T) -> SpectrumLanes<T> {
        let [a, b, c] = self.0;
        SpectrumLanes([function(a), function(b), function(c)])
    }

    /// Applies a function to each pair of components.
    #[inline(always)]
    #[must_use]
    pub fn zip(self, other: Self, function: impl Fn(R, R) -> R) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([function(a, x), function(b, y), function(c, z)])
    }

    /// The same value in all components.
    #[inline(always)]
    #[must_use]
    pub fn grey(value: R) -> Self {
        Self([value; Spectrum::LANES])
    }

    /// The maximum component.
    #[inline(always)]
    #[must_use]
    pub fn max_component(self) -> R {
        let [a, b, c] = self.0;
        a.max(b).max(c)
    }

    /// The mean of the components.
    #[inline(always)]
    #[must_use]
    pub fn mean(self) -> R {
        let [a, b, c] = self.0;
        (a + b + c) * (1.0 / Spectrum::LANES as f32)
    }

    /// The square root of each component.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        self.map(R::sqrt)
    }

    /// Clamps each component to `low..=high`. NaN is kept, so that it is detected later.
    #[inline(always)]
    #[must_use]
    pub fn clamp(self, low: f32, high: f32) -> Self {
        let low = Self::grey(self.0[0].like(low));
        let high = Self::grey(self.0[0].like(high));
        high.zip(low.zip(self, R::max), R::min)
    }

    /// The quotient of each pair of components, or zero where the divisor is zero.
    #[inline(always)]
    #[must_use]
    pub fn safe_div(self, divisor: Self) -> Self {
        let is_zero = |divisor: R| divisor.equals(divisor.zero());
        self.zip(divisor, |a, b| R::select(is_zero(b), b.zero(), a / b))
    }

    /// Whether all components are zero.
    #[inline(always)]
    #[must_use]
    pub fn is_black(self) -> R::Mask {
        let [a, b, c] = self.0;
        a.equals(a.zero()) & b.equals(b.zero()) & c.equals(c.zero())
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        yes.zip(no, |yes, no| R::select(mask, yes, no))
    }
}

impl<S: Simd> SpectrumLanes<Lanes<S>> {
    /// The same spectrum in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, spectrum: Spectrum) -> Self {
        let [a, b, c] = spectrum.components();
        Self([Lanes::splat(simd, a), Lanes::splat(simd, b), Lanes::splat(simd, c)])
    }

    /// Loads from one array per component; see [`Lanes::load`].
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, arrays: &[LaneArray; Spectrum::LANES], first: usize) -> Self {
        let [a, b, c] = arrays;
        Self([
            Lanes::load(simd, a, first),
            Lanes::load(simd, b, first),
            Lanes::load(simd, c, first),
        ])
    }

    /// Stores to one array per component; see [`Lanes::store`].
    #[inline(always)]
    pub fn store(self, arrays: &mut [LaneArray; Spectrum::LANES], first: usize) {
        for (component, array) in self.0.into_iter().zip(arrays) {
            component.store(array, first);
        }
    }
}

impl SpectrumLanes<f32> {
    /// Writes the spectrum to one lane of the columns.
    #[inline(always)]
    pub fn put(self, arrays: &mut [LaneArray; Spectrum::LANES], lane: usize) {
        for (component, array) in self.0.into_iter().zip(arrays) {
            array.0[lane] = component;
        }
    }

    /// Reads the spectrum in one lane of the columns.
    #[inline(always)]
    #[must_use]
    pub fn take(arrays: &[LaneArray; Spectrum::LANES], lane: usize) -> Self {
        Self(arrays.each_ref().map(|array| array.0[lane]))
    }
}

impl From<Spectrum> for SpectrumLanes<f32> {
    #[inline(always)]
    fn from(spectrum: Spectrum) -> Self {
        Self(spectrum.components())
    }
}

impl From<SpectrumLanes<f32>> for Spectrum {
    #[inline(always)]
    fn from(spectrum: SpectrumLanes<f32>) -> Self {
        Self::from_components(spectrum.0)
    }
}

macro_rules! arithmetic {
    ($($operation:ident $function:ident $operator:tt;)*) => {
        $(impl<R: Real> $operation for SpectrumLanes<R> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        })*
    };
}

arithmetic! {
    Add add +;
    Sub sub -;
    Mul mul *;
    Div div /;
}

impl<R: Real> Mul<R> for SpectrumLanes<R> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        self.map(|component| component * factor)
    }
}

impl<R: Real> Div<R> for SpectrumLanes<R> {
    type Output = Self;

    #[inline(always)]
    fn div(self, divisor: R) -> Self {
        self.map(|component| component / divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_lane_equals_a_spectrum() {
        let (a, b) = (Spectrum::from([0.1, 0.7, 3.0]), Spectrum::from([0.3, 0.0, 2.0]));
        let (x, y) = (SpectrumLanes::<f32>::from(a), SpectrumLanes::<f32>::from(b));
        assert_eq!(Spectrum::from(x * y), a * b);
        assert_eq!(Spectrum::from(x + y), a + b);
        assert_eq!(Spectrum::from(x - y), a - b);
        assert_eq!(Spectrum::from(x * 0.3), a * 0.3);
        assert_eq!(Spectrum::from(y / x), b / a);
        assert_eq!(x.max_component(), a.max_component());
        assert!((x.mean() - a.mean()).abs() < 1e-6);
        assert!(!y.is_black() && SpectrumLanes::<f32>::from(Spectrum::ZERO).is_black());
    }
}
