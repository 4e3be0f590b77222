//! Special functions for p-values: gamma, incomplete gamma and beta, normal, Student's t.

/// The maximum number of terms in series and continued fractions. It grows as the square root of the
/// argument, so this suffices for tens of millions of degrees of freedom.
const MAX_ITERATIONS: u32 = 100_000;
const PRECISION: f64 = 1e-15;
/// Replaces a vanishing denominator in Lentz's method.
const TINY: f64 = 1e-300;

/// The natural logarithm of Γ(`x`) for `x` > 0, to about 14 digits.
///
/// Stirling's series, after the recurrence has raised the argument above 15 (NIST *Digital Library
/// of Mathematical Functions*, 5.5.1 and 5.11.1).
#[must_use]
pub(crate) fn ln_gamma(x: f64) -> f64 {
    let mut shifted = x;
    let mut product = 1.0;
    while shifted < 15.0 {
        product *= shifted;
        shifted += 1.0;
    }
    let inverse = 1.0 / shifted;
    let square = inverse * inverse;
    let series = inverse
        * (1.0 / 12.0
            - square
                * (1.0 / 360.0
                    - square * (1.0 / 1260.0 - square * (1.0 / 1680.0 - square / 1188.0))));
    (shifted - 0.5) * shifted.ln() - shifted + 0.5 * std::f64::consts::TAU.ln() + series
        - product.ln()
}

/// The regularised upper incomplete gamma function Q(`a`, `x`) for `a` > 0 and `x` ≥ 0.
///
/// The series below `a` + 1, and Legendre's continued fraction above (*Numerical Recipes*, 6.2).
#[must_use]
pub(crate) fn gamma_q(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        1.0
    } else if x.is_infinite() {
        0.0
    } else if x < a + 1.0 {
        1.0 - gamma_p_series(a, x)
    } else {
        gamma_q_fraction(a, x)
    }
}

fn gamma_p_series(a: f64, x: f64) -> f64 {
    let mut term = 1.0 / a;
    let mut sum = term;
    let mut denominator = a;
    for _ in 0..MAX_ITERATIONS {
        denominator += 1.0;
        term *= x / denominator;
        sum += term;
        if term < sum * PRECISION {
            break;
        }
    }
    sum * (a * x.ln() - x - ln_gamma(a)).exp()
}

fn gamma_q_fraction(a: f64, x: f64) -> f64 {
    // Lentz's method as modified by Thompson and Barnett.
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for index in 1..=MAX_ITERATIONS {
        let index = f64::from(index);
        let numerator = -index * (index - a);
        b += 2.0;
        d = 1.0 / away_from_zero(numerator * d + b);
        c = away_from_zero(b + numerator / c);
        let change = c * d;
        fraction *= change;
        if (change - 1.0).abs() < PRECISION {
            break;
        }
    }
    fraction * (a * x.ln() - x - ln_gamma(a)).exp()
}

fn away_from_zero(x: f64) -> f64 {
    if x.abs() < TINY { TINY } else { x }
}

/// The probability that a χ² variable with `degrees` degrees of freedom exceeds `statistic`.
#[must_use]
pub(crate) fn chi_square_tail(degrees: f64, statistic: f64) -> f64 {
    gamma_q(0.5 * degrees, 0.5 * statistic)
}

/// The probability that a standard normal variable exceeds `z`.
#[must_use]
pub fn normal_tail(z: f64) -> f64 {
    let both = gamma_q(0.5, 0.5 * z * z);
    if z >= 0.0 { 0.5 * both } else { 1.0 - 0.5 * both }
}

/// The probability that |T| exceeds |`t`|, for Student's T with `degrees` degrees of freedom.
///
/// By the incomplete beta function I(ν/2, 1/2) at ν / (ν + t²) (DLMF 8.17).
#[must_use]
pub(crate) fn student_two_sided(degrees: f64, t: f64) -> f64 {
    if t.is_infinite() {
        return 0.0;
    }
    beta_regularised(0.5 * degrees, 0.5, degrees / (degrees + t * t))
}

/// The regularised incomplete beta function I(`a`, `b`) at `x` in [0, 1] (*Numerical Recipes*, 6.4).
#[must_use]
pub(crate) fn beta_regularised(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let logarithm = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p();
    let front = logarithm.exp();
    // The fraction converges fast on one side of the mean; the symmetry covers the other.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * beta_fraction(a, b, x) / a
    } else {
        1.0 - front * beta_fraction(b, a, 1.0 - x) / b
    }
}

fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for index in 1..=MAX_ITERATIONS {
        let m = f64::from(index);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for numerator in [even, odd] {
            d = 1.0 / away_from_zero(1.0 + numerator * d);
            c = away_from_zero(1.0 + numerator / c);
            change = c * d;
            fraction *= change;
        }
        if (change - 1.0).abs() < PRECISION {
            break;
        }
    }
    fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(actual: f64, expected: f64) {
        let error = (actual - expected).abs() / expected.abs().max(1e-30);
        assert!(error < 1e-12, "{actual} differs from {expected} by {error:e}");
    }

    #[test]
    fn gamma_of_integers_and_one_half() {
        let mut factorial = 1.0_f64;
        for n in 3..20 {
            factorial *= f64::from(n - 1);
            assert_close(ln_gamma(f64::from(n)), factorial.ln());
        }
        assert_close(ln_gamma(0.5), std::f64::consts::PI.sqrt().ln());
    }

    #[test]
    fn chi_square_tail_matches_closed_forms() {
        // Two degrees: exp(−x/2). Four degrees: exp(−x/2)(1 + x/2).
        for x in [0.1_f64, 1.0, 3.7, 12.0, 80.0] {
            assert_close(chi_square_tail(2.0, x), (-0.5 * x).exp());
            assert_close(chi_square_tail(4.0, x), (-0.5 * x).exp() * (1.0 + 0.5 * x));
        }
        assert_eq!(chi_square_tail(3.0, 0.0), 1.0);
        assert_eq!(chi_square_tail(3.0, f64::INFINITY), 0.0);
    }

    #[test]
    fn chi_square_tail_of_many_degrees_approaches_the_normal() {
        // Wilson and Hilferty's approximation, accurate to a few 10⁻⁵ here.
        let degrees = 20_000.0_f64;
        for z in [-2.0, 0.0, 2.5] {
            let base = 1.0 - 2.0 / (9.0 * degrees) + z * (2.0 / (9.0 * degrees)).sqrt();
            let tail = chi_square_tail(degrees, degrees * base.powi(3));
            assert!((tail - normal_tail(z)).abs() < 1e-4);
        }
    }

    #[test]
    fn normal_tail_matches_tables() {
        assert_close(normal_tail(0.0), 0.5);
        assert_close(normal_tail(1.0), 0.158_655_253_931_457_05);
        assert_close(normal_tail(-1.0), 1.0 - 0.158_655_253_931_457_05);
        assert_close(normal_tail(5.0), 2.866_515_718_791_939e-7);
    }

    #[test]
    fn student_tail_matches_closed_forms() {
        // One degree is Cauchy's distribution; two degrees: 1 − t / √(2 + t²).
        for t in [0.2_f64, 1.0, 3.0, 40.0] {
            let cauchy = 1.0 - 2.0 * t.atan() / std::f64::consts::PI;
            assert!((student_two_sided(1.0, t) - cauchy).abs() < 1e-13);
            let two = 1.0 - t / (2.0 + t * t).sqrt();
            assert!((student_two_sided(2.0, t) - two).abs() < 1e-13);
        }
        assert_eq!(student_two_sided(5.0, 0.0), 1.0);
        assert!((student_two_sided(1e6, 1.96) - 2.0 * normal_tail(1.96)).abs() < 1e-6);
    }
}
