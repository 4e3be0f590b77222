//! All roots in [0, 1] of a polynomial of degree six in Bernstein form.
//!
//! The number of sign changes among the coefficients bounds that of the roots, and is exact where
//! it is 0 or 1 (Descartes' rule in Bernstein form; Farouki, "The Bernstein polynomial basis: a
//! centennial retrospective", CAGD 29, 2012, section 6). Intervals with more are searched for an
//! extremum between two roots, or halved.
//!
//! A root is where the sign changes, zero counting as positive. Signs at the ends of an interval are
//! never computed twice, so the roots of neighbouring intervals fit together: their number is even
//! or odd as the signs at the outer ends say, whatever rounding does in between.

/// The coefficients of a polynomial on an interval.
pub(super) type Bernstein = [f64; 7];

/// What is to be solved, at a parameter: value, first and second derivative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives {
    pub(super) value: f64,
    pub(super) first: f64,
    pub(super) second: f64,
}

/// Intervals are halved this often before two roots so close are left alone, or a change of sign
/// taken for one root.
const MAX_HALVINGS: u32 = 40;
/// Steps and intervals shorter than this end a search.
const CONVERGED: f64 = 1e-10;
/// What may be left between a root and Newton's last step: that converges quadratically, so after
/// steps a and b about b³/a² is left.
const LEFT: f64 = 1e-13;
/// More steps than bisection alone would need.
const MAX_STEPS: u32 = 80;

/// Whether the coefficients have no change of sign, and hence the polynomial no root.
#[inline]
pub(super) fn no_roots(coefficients: &Bernstein) -> bool {
    let negative = coefficients.iter().filter(|c| **c < 0.0).count();
    negative == 0 || negative == coefficients.len()
}

fn sign_changes(values: &[f64]) -> usize {
    values.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count()
}

/// An interval, with the polynomial's coefficients on it.
struct Search {
    low: f64,
    high: f64,
    coefficients: Bernstein,
    halvings: u32,
}

/// Calls `found` with each root in [0, 1], in no particular order. `coefficients` locate the roots;
/// `evaluate`, the same polynomial in a form that cancels less, gives their digits.
pub(super) fn each_root(
    coefficients: Bernstein,
    evaluate: &impl Fn(f64) -> Derivatives,
    found: &mut impl FnMut(f64),
) {
    search(&Search { low: 0.0, high: 1.0, coefficients, halvings: 0 }, evaluate, found);
}

fn search(interval: &Search, evaluate: &impl Fn(f64) -> Derivatives, found: &mut impl FnMut(f64)) {
    let Search { low, high, coefficients, halvings } = interval;
    let (low, high) = (*low, *high);
    let changes = sign_changes(coefficients);
    let rising = coefficients[0] < 0.0;
    let value = |s| {
        let at = evaluate(s);
        (at.value, at.first)
    };
    if changes == 0 {
        return;
    }
    if changes == 1 {
        let guess = low + (high - low) * crossing(coefficients);
        found(root_between([low, high], guess, rising, value));
        return;
    }
    let slopes: [f64; 6] = std::array::from_fn(|i| coefficients[i + 1] - coefficients[i]);
    if changes == 2 && sign_changes(&slopes) == 1 {
        let guess = low + (high - low) * crossing(&slopes);
        if let Some((middle, at)) = other_side([low, high], guess, rising, evaluate) {
            let reach = (-2.0 * at.value / at.second).sqrt();
            found(root_between([low, middle], middle - reach, rising, value));
            found(root_between([middle, high], middle + reach, !rising, value));
        }
        return;
    }
    if *halvings == MAX_HALVINGS {
        if rising != (coefficients[6] < 0.0) {
            found(0.5 * (low + high));
        }
        return;
    }
    let middle = 0.5 * (low + high);
    let (left, right) = halve(coefficients);
    let halvings = halvings + 1;
    search(&Search { low, high: middle, coefficients: left, halvings }, evaluate, found);
    search(&Search { low: middle, high, coefficients: right, halvings }, evaluate, found);
}

/// Where the control polygon first crosses zero, as a share of its length.
fn crossing(values: &[f64]) -> f64 {
    let pair = values.windows(2).position(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).unwrap_or(0);
    let share = values[pair] / (values[pair] - values[pair + 1]);
    (pair as f64 + share) / (values.len() - 1) as f64
}

/// The coefficients on both halves (de Casteljau).
fn halve(coefficients: &Bernstein) -> (Bernstein, Bernstein) {
    let mut row = *coefficients;
    let (mut left, mut right) = (row, row);
    for level in 1..row.len() {
        for i in 0..row.len() - level {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
        left[level] = row[0];
        right[row.len() - 1 - level] = row[row.len() - 1 - level];
    }
    (left, right)
}

/// A parameter where the value has the other sign than at both ends, between which it has one
/// extremum; `None` where there is none, and the two roots are not real.
fn other_side(
    [mut low, mut high]: [f64; 2],
    guess: f64,
    negative_ends: bool,
    evaluate: &impl Fn(f64) -> Derivatives,
) -> Option<(f64, Derivatives)> {
    let mut s = guess;
    for _ in 0..MAX_STEPS {
        if !(s > low && s < high) {
            s = 0.5 * (low + high);
        }
        let at = evaluate(s);
        if (at.value < 0.0) != negative_ends {
            return Some((s, at));
        }
        if (at.first > 0.0) == negative_ends {
            low = s
        } else {
            high = s
        }
        let step = at.first / at.second;
        s -= step;
        if step.abs() < CONVERGED || high - low < CONVERGED * CONVERGED {
            break;
        }
    }
    // The last step counts: a root twice over is missed where it is a rounding away.
    let at = evaluate(s);
    (low < s && s < high && (at.value < 0.0) != negative_ends).then_some((s, at))
}

/// The root between two parameters where the signs differ: Newton's method, and bisection where that
/// leaves the interval.
pub(super) fn root_between(
    [mut low, mut high]: [f64; 2],
    guess: f64,
    rising: bool,
    evaluate: impl Fn(f64) -> (f64, f64),
) -> f64 {
    let mut s = guess;
    // No step yet that could tell how fast it converges.
    let mut last_step = 0.0;
    for _ in 0..MAX_STEPS {
        if !(s > low && s < high) {
            s = 0.5 * (low + high);
            last_step = 0.0;
        }
        let (value, slope) = evaluate(s);
        if (value < 0.0) == rising {
            low = s
        } else {
            high = s
        }
        let step = value / slope;
        let next = s - step;
        let is_close = (step * step * step).abs() < LEFT * last_step * last_step;
        if is_close || step.abs() < CONVERGED || high - low < CONVERGED * CONVERGED {
            return if next >= low && next <= high { next } else { s };
        }
        (s, last_step) = (next, step);
    }
    s
}
