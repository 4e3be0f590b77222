//! The error function and its inverse in single precision.

use etendue_math::lanes::{Mask as _, Real};

/// 2/√π ∫₀ˣ exp(−t²) dt, where `exp_minus_square` is exp(−x²); absolute error below 3e-7.
///
/// Abramowitz and Stegun, *Handbook of Mathematical Functions*, 7.1.26. Callers already have the
/// exponential, which is most of the work.
#[inline(always)]
pub(crate) fn erf_given_exponential<R: Real>(x: R, exp_minus_square: R) -> R {
    const COEFFICIENTS: [f32; 5] =
        [0.254_829_6, -0.284_496_73, 1.421_413_8, -1.453_152, 1.061_405_4];
    let t = (x.abs() * 0.327_591_1 + 1.0).reciprocal();
    let polynomial = t.polynomial(&COEFFICIENTS) * t;
    (-polynomial * exp_minus_square + 1.0).copysign(x)
}

/// The inverse of [`erf_given_exponential`]; finite for every input.
///
/// Giles, "Approximating the erfinv Function", *GPU Computing Gems Jade Edition*, 2011, chapter 10.
#[inline(always)]
pub(crate) fn erf_inverse<R: Real>(y: R) -> R {
    // Excludes the numbers just below one, at which the logarithm would be infinite.
    let y = y.min(y.like(0.999_999_94)).max(y.like(-0.999_999_94));
    let w = -((-y + 1.0) * (y + 1.0)).ln();
    let is_central = w.below(5.0);
    if is_central.all() {
        return central(w) * y;
    }
    R::select(is_central, central(w), tail(w)) * y
}

/// The inverse divided by y, for w = −ln (1 − y²) below five.
#[inline(always)]
fn central<R: Real>(w: R) -> R {
    (w - 2.5).polynomial(&[
        1.501_409_4,
        0.246_640_73,
        -0.004_177_681_6,
        -0.001_253_725_1,
        0.000_218_580_87,
        -4.391_506_6e-6,
        -3.523_387_7e-6,
        3.432_739_4e-7,
        2.810_226_4e-8,
    ])
}

/// The inverse divided by y, for larger w.
#[inline(always)]
fn tail<R: Real>(w: R) -> R {
    (w.sqrt() - 3.0).polynomial(&[
        2.832_976_8,
        1.001_674,
        0.009_438_87,
        -0.007_622_461_3,
        0.005_739_508,
        -0.003_673_428_4,
        0.001_349_343_2,
        0.000_100_950_56,
        -0.000_200_214_26,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn erf(x: f32) -> f32 {
        erf_given_exponential(x, f32::exp(-x * x))
    }

    #[test]
    fn the_error_function_has_its_tabulated_values() {
        // Abramowitz and Stegun, table 7.1.
        let table = [(0.0, 0.0), (0.1, 0.112_462_9), (0.5, 0.520_499_9), (1.0, 0.842_700_8)];
        for (x, expected) in table.into_iter().chain([(1.5, 0.966_105_1), (2.0, 0.995_322_3)]) {
            assert!(f32::abs(erf(x) - expected) < 4e-7, "{x}");
            assert!(f32::abs(erf(-x) + expected) < 4e-7, "{x}");
        }
        assert_eq!(erf(f32::INFINITY), 1.0);
    }

    #[test]
    fn the_inverse_undoes_it() {
        for step in -299..=299_i16 {
            let y = f32::from(step) / 300.0;
            assert!(f32::abs(erf(erf_inverse(y)) - y) < 1e-6, "{y}");
        }
        for y in [-1.0, 1.0, 7.0] {
            assert!(f32::is_finite(erf_inverse(y)));
        }
    }
}
