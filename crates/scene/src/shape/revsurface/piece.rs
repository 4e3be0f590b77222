//! Pieces of a profile: short, monotone in x and y, and nearly straight.

use super::line::Line;
use super::roots::{Bernstein, Derivatives, each_root, no_roots, root_between};
use super::tree::Extent;
use crate::models::profile::{self, Segment};
use etendue_math::polynomial::quadratic_roots;
use glam::DVec2;

/// Pieces are halved until their control points are this close to the chord. This keeps boxes tight
/// and leaves at most one root on most pieces. For wine glasses of 23 segments, values from 10⁻⁴ to
/// 2·10⁻² are equally fast.
const STRAIGHTNESS: f64 = 5e-3;
/// The maximum number of halvings of one monotone part.
const MAX_HALVINGS: u32 = 6;
/// A profile of size one whose end is this close to the axis ends on it.
const ON_AXIS: f64 = 1e-12;
/// The minimum parameter distance between cuts.
const SHORTEST_CUT: f64 = 1e-9;

/// A piece of a segment. Both of its coordinates are cubic polynomials in Bernstein form.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    x: [f64; 4],
    y: [f64; 4],
    /// x² in Bernstein form.
    x_squared: Bernstein,
    /// Which segment this is a piece of.
    pub(super) segment: u32,
    /// Its range in the segment's parameter.
    pub(super) range: [f64; 2],
}

/// A crossing of a line with the surface of one piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// The piece's parameter.
    pub(super) s: f64,
    /// The t on the line.
    pub(super) t: f64,
}

/// Splits a chain of segments into pieces. Each piece starts bit for bit where the previous one
/// ends.
pub(super) fn split(segments: &[Segment]) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for (index, segment) in segments.iter().enumerate() {
        let mut rest = *segment;
        let mut start = 0.0;
        for cut in cuts(segment) {
            let (part, after) = divide(&rest, (cut - start) / (1.0 - start));
            halve_until_straight(&part, (index as u32, [start, cut], 0), &mut pieces);
            (rest, start) = (after, cut);
        }
        halve_until_straight(&rest, (index as u32, [start, 1.0], 0), &mut pieces);
    }
    // Pieces that lie entirely on the axis have no surface.
    pieces.retain(|piece| piece.x.iter().any(|x| *x != 0.0));
    pieces
}

/// Where a segment is cut, in ascending order: at extrema of x and y, and on the axis.
fn cuts(segment: &Segment) -> Vec<f64> {
    let [a, b, c, d] = *segment;
    let mut cuts = Vec::new();
    // The derivative's coefficients, first in Bernstein form, then in powers.
    let (ab, bc, cd) = (b - a, c - b, d - c);
    let (quadratic, linear) = (ab - bc * 2.0 + cd, (bc - ab) * 2.0);
    for (a, b, c) in [(quadratic.x, linear.x, ab.x), (quadratic.y, linear.y, ab.y)] {
        cuts.extend(quadratic_roots(a, b, c).into_iter().flat_map(|(low, high)| [low, high]));
    }
    let mut ends = vec![0.0, 1.0];
    ends.extend(cuts.iter().copied().filter(|s| *s > 0.0 && *s < 1.0));
    ends.sort_by(f64::total_cmp);
    for pair in ends.windows(2) {
        let x = |s: f64| profile::point(segment, s).x;
        let rising = x(pair[0]) < 0.0;
        if rising != (x(pair[1]) < 0.0) {
            // Plain bisection: no slope is needed.
            cuts.push(root_between([pair[0], pair[1]], f64::NAN, rising, |s| (x(s), f64::NAN)));
        }
    }
    cuts.retain(|s| *s > SHORTEST_CUT && *s < 1.0 - SHORTEST_CUT);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|b, a| *b - *a < SHORTEST_CUT);
    cuts
}

/// Splits a segment in two (de Casteljau).
fn divide(segment: &Segment, s: f64) -> (Segment, Segment) {
    let [a, b, c, d] = *segment;
    let (ab, bc, cd) = (a.lerp(b, s), b.lerp(c, s), c.lerp(d, s));
    let (abc, bcd) = (ab.lerp(bc, s), bc.lerp(cd, s));
    let middle = abc.lerp(bcd, s);
    ([a, ab, abc, middle], [middle, bcd, cd, d])
}

fn halve_until_straight(
    part: &Segment,
    (segment, range, halvings): (u32, [f64; 2], u32),
    pieces: &mut Vec<Piece>,
) {
    let [a, b, c, d] = *part;
    let bend = (b - a.lerp(d, 1.0 / 3.0)).length().max((c - a.lerp(d, 2.0 / 3.0)).length());
    if bend <= STRAIGHTNESS || halvings == MAX_HALVINGS {
        pieces.push(Piece::new(part, segment, range));
        return;
    }
    let (left, right) = divide(part, 0.5);
    let middle = 0.5 * (range[0] + range[1]);
    halve_until_straight(&left, (segment, [range[0], middle], halvings + 1), pieces);
    halve_until_straight(&right, (segment, [middle, range[1]], halvings + 1), pieces);
}

/// The square of a cubic in Bernstein form.
#[inline]
fn squared([a, b, c, d]: [f64; 4]) -> Bernstein {
    [
        a * a,
        a * b,
        (2.0 * (a * c) + 3.0 * (b * b)) * 0.2,
        (a * d + 9.0 * (b * c)) * 0.1,
        (2.0 * (b * d) + 3.0 * (c * c)) * 0.2,
        c * d,
        d * d,
    ]
}

/// The coefficients of a cubic in powers of s, ascending.
#[inline]
fn powers([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [a, 3.0 * (b - a), 3.0 * ((a - b) + (c - b)), (d - a) + 3.0 * (b - c)]
}

/// Value, first and second derivative of a cubic in powers.
#[inline]
fn evaluate([a, b, c, d]: [f64; 4], s: f64) -> [f64; 3] {
    let (cd, d3) = (d * s + c, 3.0 * d * s);
    [(cd * s + b) * s + a, (d3 + 2.0 * c) * s + b, 2.0 * (d3 + c)]
}

impl Piece {
    fn new(part: &Segment, segment: u32, range: [f64; 2]) -> Self {
        let mut x = part.map(|p| p.x);
        for end in [0, 3] {
            if x[end].abs() < ON_AXIS {
                x[end] = 0.0;
            }
        }
        Self { x, y: part.map(|p| p.y), x_squared: squared(x), segment, range }
    }

    /// The control points.
    pub(super) fn control(&self) -> Segment {
        std::array::from_fn(|i| DVec2::new(self.x[i], self.y[i]))
    }

    /// The bounding box, from the control points.
    pub(super) fn extent(&self) -> Extent {
        let range = |values: [f64; 4]| {
            let least = values.into_iter().fold(f64::INFINITY, f64::min);
            [least, values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
        };
        let distances = range(self.x);
        let [a, b] = distances.map(|x| x * x);
        let least = if distances[0] <= 0.0 && distances[1] >= 0.0 { 0.0 } else { a.min(b) };
        Extent { heights: range(self.y), squares: [least, a.max(b)] }
    }

    /// Calls `found` with each crossing, in no particular order.
    #[inline]
    pub(super) fn each_crossing(&self, line: &Line, found: &mut impl FnMut(Root)) {
        if line.rise == 0.0 {
            self.each_level_crossing(line, found);
            return;
        }
        let coefficients = self.coefficients(line);
        if no_roots(&coefficients) {
            return;
        }
        self.each_root(line, coefficients, found);
    }

    /// The polynomial of [`Line`]'s hyperbola along the piece. It is positive where the profile is
    /// farther from the axis than the line at the same height.
    #[inline]
    fn coefficients(&self, line: &Line) -> Bernstein {
        let squares = squared(self.y.map(|y| y - line.height));
        let rise_squared = line.rise * line.rise;
        let mut coefficients: Bernstein = std::array::from_fn(|i| {
            rise_squared * (self.x_squared[i] - line.nearest_squared) - line.across * squares[i]
        });
        // A profile point on the axis is never farther from it than the line, even if the line
        // passes through that point. Without this, such a line could slip through where two pieces
        // or two ends meet.
        for (end, coefficient) in [(0, 0), (3, 6)] {
            if self.x[end] == 0.0 {
                coefficients[coefficient] = coefficients[coefficient].min(-f64::MIN_POSITIVE);
            }
        }
        coefficients
    }

    #[inline(never)]
    fn each_root(&self, line: &Line, coefficients: Bernstein, found: &mut impl FnMut(Root)) {
        let (x, y) = (powers(self.x), powers(self.y));
        let (rise_squared, across) = (line.rise * line.rise, line.across);
        let side = |s: f64| {
            let ([x, dx, ddx], [y, dy, ddy]) = (evaluate(x, s), evaluate(y, s));
            let y = y - line.height;
            Derivatives {
                value: rise_squared * (x * x - line.nearest_squared) - across * (y * y),
                first: 2.0 * (rise_squared * (x * dx) - across * (y * dy)),
                second: 2.0 * (rise_squared * (dx * dx + x * ddx) - across * (dy * dy + y * ddy)),
            }
        };
        each_root(coefficients, &side, &mut |s| {
            let t = line.parameter(evaluate(x, s)[0], evaluate(y, s)[0]);
            found(Root { s, t });
        });
    }

    /// The piece is monotone, so a level line meets it at one height: twice or not at all.
    #[inline(never)]
    fn each_level_crossing(&self, line: &Line, found: &mut impl FnMut(Root)) {
        let rising = self.y[0] - line.height < 0.0;
        if rising == (self.y[3] - line.height < 0.0) {
            return;
        }
        let y = powers(self.y);
        let guess = (line.height - self.y[0]) / (self.y[3] - self.y[0]);
        let s = root_between([0.0, 1.0], guess, rising, |s| {
            let [y, dy, _] = evaluate(y, s);
            (y - line.height, dy)
        });
        let x = evaluate(powers(self.x), s)[0];
        let beyond = x * x - line.nearest_squared;
        if beyond >= 0.0 {
            let half = line.half_chord(beyond);
            found(Root { s, t: line.nearest - half });
            found(Root { s, t: line.nearest + half });
        }
    }
}
