//! All roots in [0, 1] of a polynomial of degree six in Bernstein form.
//!
//! The number of sign changes among the coefficients is an upper bound on the number of roots, and
//! exact if it is 0 or 1 (Descartes' rule in Bernstein form; Farouki, "The Bernstein polynomial
//! basis: a centennial retrospective", CAGD 29, 2012, section 6). Intervals with more sign changes
//! are searched for an extremum between two roots, or halved.
//!
//! A root is a change of sign, where zero counts as positive. The sign at the end of an interval is
//! computed only once, so the roots of adjacent intervals are consistent: the parity of their
//! number matches the signs at the outer ends, whatever the rounding errors in between.

/// The coefficients of a polynomial on an interval.
pub(super) type Bernstein = [f64; 7];

/// The function to solve, at one parameter: value, first and second derivative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives {
    pub(super) value: f64,
    pub(super) first: f64,
    pub(super) second: f64,
}

/// The maximum number of halvings. Beyond it, two roots this close are ignored, and a change of
/// sign counts as one root.
const MAX_HALVINGS: u32 = 40;
/// A search ends when a step or interval is shorter than this.
const CONVERGED: f64 = 1e-10;
/// The allowed error after Newton's last step. Newton's method converges quadratically, so after
/// steps a and b the error is about b³/a².
const LEFT: f64 = 1e-13;
/// An upper limit on steps; more than bisection alone needs.
const MAX_STEPS: u32 = 80;

/// Whether the coefficients have no change of sign, so that the polynomial has no root.
#[inline]
pub(super) fn no_roots(coefficients: &Bernstein) -> bool {
    let negative = coefficients.iter().filter(|c| **c < 0.0).count();
    negative == 0 || negative == coefficients.len()
}

fn sign_changes(values: &[f64]) -> usize {
    values.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count()
}

/// An interval and the polynomial's coefficients on it.
struct Search {
    low: f64,
    high: f64,
    coefficients: Bernstein,
    halvings: u32,
}

/// Calls `found` with each root in [0, 1], in no particular order. `coefficients` isolate the
/// roots. `evaluate` computes the same polynomial with less cancellation and refines them.
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

/// Where the control polygon first crosses zero, as a fraction of its length.
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

/// A parameter where the sign differs from that at both ends. Between the ends the value has one
/// extremum. Returns `None` if there is no such parameter, so that the two roots are not real.
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
    // Check the last step too: rounding can hide a double root.
    let at = evaluate(s);
    (low < s && s < high && (at.value < 0.0) != negative_ends).then_some((s, at))
}

/// The root between two parameters with different signs. Uses Newton's method, and bisection when a
/// step leaves the interval.
pub(super) fn root_between(
    [mut low, mut high]: [f64; 2],
    guess: f64,
    rising: bool,
    evaluate: impl Fn(f64) -> (f64, f64),
) -> f64 {
    let mut s = guess;
    // Zero: no previous step to judge the convergence by.
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
