//! Single-precision helpers with bounded errors.

/// The next representable number above `x`; NaN and infinity are returned unchanged.
#[inline]
#[must_use]
pub fn next_up(x: f32) -> f32 {
    x.next_up()
}

/// The next representable number below `x`; NaN and infinity are returned unchanged.
#[inline]
#[must_use]
pub fn next_down(x: f32) -> f32 {
    x.next_down()
}

/// Higham's γₙ: the relative error after n successive single-precision roundings is at most
/// n·u / (1 − n·u) with u = 2⁻²⁴ (*Accuracy and Stability of Numerical Algorithms*, section 3.1).
#[inline]
#[must_use]
pub const fn rounding_error_bound(operations: u32) -> f32 {
    let product = operations as f32 * (f32::EPSILON * 0.5);
    product / (1.0 - product)
}

/// The square root of `x`, or zero if rounding has made `x` negative.
#[inline]
#[must_use]
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

/// The arc cosine of `x` after clamping to [−1, 1].
#[inline]
#[must_use]
pub fn safe_acos(x: f32) -> f32 {
    x.clamp(-1.0, 1.0).acos()
}
