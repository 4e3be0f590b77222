//! The profile of a surface of revolution: a chain of cubic Bézier segments in the (x, y) plane.

use glam::DVec2;

/// One cubic segment, given by its Bézier control points.
pub type Segment = [DVec2; 4];

/// The cubic segments of a uniform B-spline with these control points. Every four consecutive
/// points give one segment. Empty for fewer than four.
///
/// The knots are at the integers, and the curve does not reach its end points unless they are
/// tripled (Bartels, Beatty and Barsky, *An Introduction to Splines*, chapter 4).
#[must_use]
pub fn from_b_spline(points: &[DVec2]) -> Vec<Segment> {
    points
        .windows(4)
        .map(|p| {
            let third = |a: DVec2, b: DVec2| (a * 2.0 + b) / 3.0;
            let joint = |a: DVec2, b: DVec2, c: DVec2| (a + b * 4.0 + c) / 6.0;
            [joint(p[0], p[1], p[2]), third(p[1], p[2]), third(p[2], p[1]), joint(p[1], p[2], p[3])]
        })
        .collect()
}

/// The Bézier segments with these control points. Each segment starts at the end of the previous
/// one. `None` unless there are 3n + 1 points.
#[must_use]
pub fn from_bezier(points: &[DVec2]) -> Option<Vec<Segment>> {
    if points.len() < 4 || points.len() % 3 != 1 {
        return None;
    }
    let segments = (0..points.len() - 1).step_by(3);
    Some(segments.map(|i| [points[i], points[i + 1], points[i + 2], points[i + 3]]).collect())
}

/// The point of a segment at parameter `s` in [0, 1].
#[must_use]
pub fn point(segment: &Segment, s: f64) -> DVec2 {
    let [a, b, c, d] = *segment;
    let (ab, bc, cd) = (a.lerp(b, s), b.lerp(c, s), c.lerp(d, s));
    ab.lerp(bc, s).lerp(bc.lerp(cd, s), s)
}

/// The derivative of a segment with respect to its parameter.
#[must_use]
pub fn derivative(segment: &Segment, s: f64) -> DVec2 {
    let [a, b, c, d] = *segment;
    let (ab, bc, cd) = (b - a, c - b, d - c);
    ab.lerp(bc, s).lerp(bc.lerp(cd, s), s) * 3.0
}

/// A unit tangent of a segment at parameter `s`. If the derivative vanishes, this is the limit of
/// its direction.
#[must_use]
pub fn tangent(segment: &Segment, s: f64) -> DVec2 {
    let [a, b, c, d] = *segment;
    let size = [b - a, c - b, d - c].iter().map(|v| v.length()).fold(0.0, f64::max);
    let derivative = |s: f64| derivative(segment, s);
    // A tripled control point makes the derivative vanish at the end of a segment.
    let towards_middle = if s < 0.5 { 1.0 } else { -1.0 };
    [0.0, 1e-6, 1e-3, 0.25]
        .into_iter()
        .map(|step| derivative(s + towards_middle * step))
        .find(|v| v.length() > 1e-9 * size)
        .map_or(DVec2::Y, DVec2::normalize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b_spline_segments_join_smoothly() {
        let points = [(0.0, 0.0), (1.0, 0.5), (1.5, 2.0), (0.5, 3.0), (1.0, 4.0)];
        let segments = from_b_spline(&points.map(|(x, y)| DVec2::new(x, y)));
        assert_eq!(segments.len(), 2);
        assert!((point(&segments[0], 1.0) - point(&segments[1], 0.0)).length() < 1e-15);
        assert!((tangent(&segments[0], 1.0) - tangent(&segments[1], 0.0)).length() < 1e-12);
        // The uniform basis at a knot is (1, 4, 1) / 6.
        let knot = (DVec2::new(0.0, 0.0) + DVec2::new(1.0, 0.5) * 4.0 + DVec2::new(1.5, 2.0)) / 6.0;
        assert!((point(&segments[0], 0.0) - knot).length() < 1e-15);
    }

    #[test]
    fn bezier_chains_have_one_point_more_than_three_a_segment() {
        let points = [DVec2::ZERO; 7];
        assert_eq!(from_bezier(&points).map(|s| s.len()), Some(2));
        assert!(from_bezier(&points[..6]).is_none() && from_bezier(&points[..1]).is_none());
    }

    #[test]
    fn a_vanishing_derivative_still_has_a_tangent() {
        let segment = [DVec2::ZERO, DVec2::ZERO, DVec2::ZERO, DVec2::X];
        assert!((tangent(&segment, 0.0) - DVec2::X).length() < 1e-12);
    }
}
