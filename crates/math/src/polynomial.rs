//! Roots of polynomials of low degree.

/// `a·b − c·d` with an error of at most 1.5 ulps, without catastrophic cancellation.
///
/// Kahan's algorithm; Jeannerod, Louvet and Muller, "Further analysis of Kahan's algorithm",
/// Mathematics of Computation 82, 2013.
#[inline]
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let error = (-c).mul_add(d, product);
    a.mul_add(b, -product) + error
}

/// The real roots of `a·x² + b·x + c` in ascending order; a double root is returned twice.
///
/// The discriminant is computed without cancellation, and the root of smaller magnitude from the
/// product of the roots, so both are accurate to nearly full precision. The root of a linear
/// equation is returned twice. `None` if there are no real roots, or if all coefficients are zero.
#[inline]
#[must_use]
pub fn quadratic_roots(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
    if a == 0.0 {
        let root = -c / b;
        return (b != 0.0).then_some((root, root));
    }
    let discriminant = difference_of_products(b, b, 4.0 * a, c);
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    if q == 0.0 {
        return Some((0.0, 0.0));
    }
    let (first, second) = (q / a, c / q);
    Some(if first <= second { (first, second) } else { (second, first) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_products_of_linear_factors_are_found() {
        for (r1, r2) in [(1.0, 2.0), (-3.0, 1e-9), (1e8, 1e-8), (-2.0, -2.0), (0.0, 0.0)] {
            let (low, high) =
                quadratic_roots(2.0, -2.0 * (r1 + r2), 2.0 * r1 * r2).expect("both roots are real");
            assert!((low - f64::min(r1, r2)).abs() <= 1e-14 * f64::min(r1, r2).abs());
            assert!((high - f64::max(r1, r2)).abs() <= 1e-14 * f64::max(r1, r2).abs());
        }
    }

    #[test]
    fn nearly_double_roots_are_accurate() {
        // (x − 1)(x − (1 + 2⁻²⁵)): the naive discriminant is pure rounding noise.
        let d = 2.0_f64.powi(-25);
        let (low, high) = quadratic_roots(1.0, -(2.0 + d), 1.0 + d).expect("both roots are real");
        assert!((low - 1.0).abs() < 1e-15 && (high - 1.0 - d).abs() < 1e-15, "{low} {high}");
    }

    #[test]
    fn linear_and_rootless_cases() {
        assert_eq!(quadratic_roots(0.0, 2.0, -1.0), Some((0.5, 0.5)));
        assert_eq!(quadratic_roots(0.0, 0.0, 1.0), None);
        assert_eq!(quadratic_roots(1.0, 0.0, 1.0), None);
        assert_eq!(quadratic_roots(f64::NAN, 0.0, 1.0), None);
    }
}
