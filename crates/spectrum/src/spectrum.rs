//! [`Spectrum`]: the representation of light, reflectance and transmittance.

use std::ops::Index;

use glam::{Vec3, Vec4};

use crate::color::LUMINANCE_WEIGHTS;

/// A colour-dependent quantity: radiance, reflectance, a scattering coefficient.
///
/// Three components in one SIMD register, which has a fourth, spare one. Today, they are linear
/// Rec. 709 red, green and blue. The spare component is zero, and every operation keeps it zero,
/// even if another component becomes infinite or NaN. Code outside this crate does not depend on
/// the meaning of the components, so that four wavelengths can replace them later.
///
/// Arithmetic is component-wise and follows IEEE 754: a component divided by zero is infinite or
/// NaN. [`Spectrum::safe_div`] gives zero instead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Spectrum(pub(crate) Vec4);

impl Spectrum {
    /// Zero in every component: no light.
    pub const ZERO: Self = Self(Vec4::ZERO);

    /// One in every component: light that passes unchanged.
    pub const ONE: Self = Self::splat(1.0);

    /// The number of components, and the bound of the index in `spectrum[component]`.
    pub const LANES: usize = 3;

    /// The same value in every component.
    #[inline]
    #[must_use]
    pub const fn splat(value: f32) -> Self {
        Self(Vec4::new(value, value, value, 0.0))
    }

    /// A spectrum from linear Rec. 709 components.
    #[inline]
    #[must_use]
    pub const fn from_rgb(rgb: [f32; 3]) -> Self {
        Self(Vec4::new(rgb[0], rgb[1], rgb[2], 0.0))
    }

    /// The linear Rec. 709 components.
    #[inline]
    #[must_use]
    pub fn rgb(self) -> [f32; 3] {
        self.xyz().to_array()
    }

    /// The components.
    #[inline(always)]
    pub(crate) fn components(self) -> [f32; Self::LANES] {
        self.xyz().to_array()
    }

    /// A spectrum from its components.
    #[inline(always)]
    pub(crate) const fn from_components([a, b, c]: [f32; Self::LANES]) -> Self {
        Self(Vec4::new(a, b, c, 0.0))
    }

    /// The maximum component. If one is NaN, the result is any component or NaN.
    #[inline]
    #[must_use]
    pub fn max_component(self) -> f32 {
        self.xyz().max_element()
    }

    /// The minimum component. If one is NaN, the result is any component or NaN.
    #[inline]
    #[must_use]
    pub fn min_component(self) -> f32 {
        self.xyz().min_element()
    }

    /// The mean of the components.
    #[inline]
    #[must_use]
    pub fn mean(self) -> f32 {
        self.xyz().element_sum() / Self::LANES as f32
    }

    /// The relative luminance (CIE Y) of a Rec. 709 colour: 1 for [`Spectrum::ONE`].
    #[inline]
    #[must_use]
    pub fn luminance(self) -> f32 {
        self.xyz().dot(Vec3::from_array(LUMINANCE_WEIGHTS))
    }

    /// Whether every component is exactly zero. NaN is not black.
    #[inline]
    #[must_use]
    pub fn is_black(self) -> bool {
        self.0 == Vec4::ZERO
    }

    /// Whether no component is infinite or NaN.
    #[inline]
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Whether any component is negative. NaN is not.
    #[inline]
    #[must_use]
    pub fn has_negative(self) -> bool {
        self.0.cmplt(Vec4::ZERO).any()
    }

    /// The square root of each component; NaN if the component is negative.
    #[inline]
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    /// The exponential of each component, as in the transmittance exp(−σ·t).
    #[inline]
    #[must_use]
    pub fn exp(self) -> Self {
        self.map(f32::exp)
    }

    /// The absolute value of each component.
    #[inline]
    #[must_use]
    pub fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// The component-wise minimum. NaN in `self` is kept, so that it is detected later.
    #[inline]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self(Vec4::select(self.0.cmpgt(other.0), other.0, self.0))
    }

    /// The component-wise maximum. NaN in `self` is kept, so that it is detected later.
    #[inline]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self(Vec4::select(self.0.cmplt(other.0), other.0, self.0))
    }

    /// Clamps each component to `low..=high`. NaN is kept, so that it is detected later.
    #[inline]
    #[must_use]
    pub fn clamp(self, low: f32, high: f32) -> Self {
        self.max(Self::splat(low)).min(Self::splat(high))
    }

    /// Linear interpolation: exactly `self` at `t` = 0, and exactly `other` at `t` = 1.
    #[inline]
    #[must_use]
    pub fn lerp(self, other: Self, t: f32) -> Self {
        self * (1.0 - t) + other * t
    }

    /// The component-wise quotient, or zero where the divisor is zero.
    #[inline]
    #[must_use]
    pub fn safe_div(self, divisor: Self) -> Self {
        let is_zero = divisor.0.cmpeq(Vec4::ZERO);
        Self(Vec4::select(is_zero, Vec4::ZERO, self.0 / divisor.0))
    }

    /// Applies a function to each component.
    #[inline]
    #[must_use]
    pub fn map(self, function: impl Fn(f32) -> f32) -> Self {
        Self::from_rgb(self.rgb().map(function))
    }

    /// The components without the spare one.
    #[inline]
    fn xyz(self) -> Vec3 {
        self.0.truncate()
    }

    /// This spectrum as a divisor: its spare component is 1, so that of the quotient is 0 / 1 = 0.
    #[inline]
    pub(crate) fn divisor(self) -> Vec4 {
        self.0.with_w(1.0)
    }
}

impl From<[f32; 3]> for Spectrum {
    #[inline]
    fn from(rgb: [f32; 3]) -> Self {
        Self::from_rgb(rgb)
    }
}

/// Access to one component, for estimators that choose one at random.
///
/// # Panics
///
/// If the index is not below [`Spectrum::LANES`].
impl Index<usize> for Spectrum {
    type Output = f32;

    #[inline]
    fn index(&self, component: usize) -> &f32 {
        &self.0.as_ref()[..Self::LANES][component]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLOUR: Spectrum = Spectrum::from_rgb([0.25, 0.5, 2.0]);

    #[test]
    fn components_round_trip() {
        assert_eq!(COLOUR.rgb(), [0.25, 0.5, 2.0]);
        assert_eq!(Spectrum::from([0.25, 0.5, 2.0]), COLOUR);
        assert_eq!([COLOUR[0], COLOUR[1], COLOUR[2]], COLOUR.rgb());
    }

    #[test]
    #[should_panic(expected = "out of bounds")]
    fn the_spare_component_cannot_be_indexed() {
        let _ = COLOUR[Spectrum::LANES];
    }

    #[test]
    fn reductions_ignore_the_spare_component() {
        let negative = Spectrum::splat(-2.0);
        assert_eq!(negative.max_component(), -2.0);
        assert_eq!(Spectrum::splat(3.0).min_component(), 3.0);
        assert_eq!(Spectrum::splat(3.0).mean(), 3.0);
        assert_eq!(COLOUR.max_component(), 2.0);
        assert_eq!(COLOUR.min_component(), 0.25);
    }

    #[test]
    fn white_has_luminance_one_and_green_is_brightest() {
        assert!((Spectrum::ONE.luminance() - 1.0).abs() < 1e-6);
        assert_eq!(Spectrum::from_rgb([0.0, 2.0, 0.0]).luminance(), 2.0 * LUMINANCE_WEIGHTS[1]);
    }

    #[test]
    fn black_non_finite_and_negative_spectra_are_distinguished() {
        let not_a_number = Spectrum::from_rgb([0.0, f32::NAN, 0.0]);
        assert!(Spectrum::ZERO.is_black() && (-Spectrum::ZERO).is_black());
        assert!(!not_a_number.is_black() && !not_a_number.is_finite());
        assert!(!not_a_number.has_negative());
        assert!(!Spectrum::from_rgb([0.0, 0.0, 1e-30]).is_black());
        assert!(!Spectrum::splat(f32::INFINITY).is_finite() && COLOUR.is_finite());
        assert!(Spectrum::from_rgb([1.0, 1.0, -1e-30]).has_negative());
        assert!(!(-Spectrum::ZERO).has_negative());
    }

    #[test]
    fn functions_apply_to_each_component() {
        assert_eq!(Spectrum::from_rgb([4.0, 9.0, 0.25]).sqrt().rgb(), [2.0, 3.0, 0.5]);
        assert_eq!(Spectrum::ZERO.exp(), Spectrum::ONE);
        assert_eq!((-COLOUR).abs(), COLOUR);
        assert_eq!(COLOUR.clamp(0.3, 1.0).rgb(), [0.3, 0.5, 1.0]);
        assert_eq!(COLOUR.map(|x| x + 1.0).rgb(), [1.25, 1.5, 3.0]);
        assert_eq!(COLOUR.min(Spectrum::ONE).rgb(), [0.25, 0.5, 1.0]);
        assert_eq!(COLOUR.max(Spectrum::ONE).rgb(), [1.0, 1.0, 2.0]);
    }

    #[test]
    fn clamping_does_not_hide_nan() {
        let not_a_number = Spectrum::from_rgb([0.5, f32::NAN, 7.0]);
        let results = [
            not_a_number.clamp(0.0, 1.0),
            not_a_number.min(Spectrum::ONE),
            not_a_number.max(Spectrum::ZERO),
        ];
        for result in results {
            assert!(result[0] == 0.5 && result[1].is_nan() && result[2] >= 1.0, "{result:?}");
        }
    }

    #[test]
    fn interpolation_is_exact_at_its_ends() {
        let other = Spectrum::from_rgb([0.1, 1e7, -3.0]);
        assert_eq!(COLOUR.lerp(other, 0.0), COLOUR);
        assert_eq!(COLOUR.lerp(other, 1.0), other);
        assert_eq!(Spectrum::ZERO.lerp(COLOUR, 0.5), COLOUR * 0.5);
    }

    #[test]
    fn safe_division_by_zero_gives_zero() {
        let divisor = Spectrum::from_rgb([0.0, 0.25, -0.0]);
        assert_eq!(COLOUR.safe_div(divisor).rgb(), [0.0, 2.0, 0.0]);
    }

    #[test]
    fn functions_keep_the_spare_component_zero() {
        let hostile = Spectrum::from_rgb([f32::INFINITY, f32::NAN, -1.0]);
        let results = [
            hostile.sqrt(),
            hostile.exp(),
            hostile.abs(),
            hostile.clamp(1.0, 2.0),
            hostile.lerp(COLOUR, f32::INFINITY),
            hostile.safe_div(Spectrum::ZERO),
            hostile.map(|_| 1.0),
        ];
        for result in results {
            assert_eq!(result.0.w, 0.0, "{result:?}");
        }
    }
}
