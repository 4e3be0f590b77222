//! Curve files: one control point per line, `x y z radius`; an empty line starts a new curve. Version
//! 0.6 writes `x y z` and gives one radius for all.

use crate::builder::Assets;
use crate::inputs::transform::read_transform;
use etendue_document::{Fault, Parameters};
use etendue_math::Transform;
use glam::{Vec3, Vec4};

/// The control points of all curves, and where their segments start.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Curves {
    /// World-space positions and radii.
    pub(crate) points: Vec<Vec4>,
    /// The index of each segment's first control point.
    pub(crate) starts: Vec<u32>,
}

/// Reads the curve file named by `filename`. Each segment has `points_per_segment` control points.
/// Returns `None` after reporting an error.
#[must_use]
pub(crate) fn read(
    assets: &Assets<'_>,
    parameters: &Parameters<'_>,
    points_per_segment: usize,
) -> Option<Curves> {
    let to_world = read_transform(parameters, "to_world");
    let radius = parameters
        .has("radius")
        .then(|| parameters.float_in("radius", 0.0, 0.0..=f64::from(f32::MAX)) as f32);
    let (path, bytes) = assets.read_file(parameters, "filename")?;
    match parse(&bytes, &to_world?, (points_per_segment, radius)) {
        Ok(curves) => Some(curves),
        Err(problem) => {
            let message = format!("{}: {problem}", path.display());
            parameters.error(Fault::Geometry, "filename", message);
            None
        }
    }
}

/// Parses curves from the bytes of a file. As in Mitsuba, `to_world` does not scale the radii.
///
/// # Errors
/// A message with the line number for malformed numbers, negative radii and curves with too few
/// points; also for files without curves.
pub(crate) fn parse(
    bytes: &[u8],
    to_world: &Transform,
    (points_per_segment, radius): (usize, Option<f32>),
) -> Result<Curves, String> {
    let mut curves = Curves::default();
    let mut curve_start = 0;
    for (line, number) in bytes.split(|byte| *byte == b'\n').zip(1..) {
        let line = line.trim_ascii();
        if line.is_empty() {
            curves.end_curve(curve_start, points_per_segment, number)?;
            curve_start = curves.points.len();
        } else {
            let point = control_point(line, radius).ok_or_else(|| {
                format!("line {number} is no control point: it takes x, y, z and a radius ≥ 0")
            })?;
            let position = to_world.point(point.truncate());
            if !position.is_finite() {
                return Err(format!("line {number} lies beyond what single precision can hold"));
            }
            curves.points.push(position.extend(point.w));
        }
        if curves.points.len() > u32::MAX as usize {
            return Err("there are more control points than can be numbered".to_owned());
        }
    }
    let last_line = bytes.split(|byte| *byte == b'\n').count();
    curves.end_curve(curve_start, points_per_segment, last_line)?;
    if curves.points.is_empty() {
        return Err("there are no control points".to_owned());
    }
    curves.points.shrink_to_fit();
    curves.starts.shrink_to_fit();
    Ok(curves)
}

/// Parses the first four numbers of a line, or three if `radius` replaces a missing fourth.
fn control_point(line: &[u8], radius: Option<f32>) -> Option<Vec4> {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let mut numbers = [0.0; 4];
    for (index, number) in numbers.iter_mut().enumerate() {
        let parsed: f32 = match (words.next(), radius) {
            (Some(word), _) => std::str::from_utf8(word).ok()?.parse().ok()?,
            (None, Some(radius)) if index == 3 => radius,
            (None, _) => return None,
        };
        *number = Some(parsed).filter(|parsed| parsed.is_finite())?;
    }
    (numbers[3] >= 0.0).then(|| Vec4::from_array(numbers))
}

impl Curves {
    fn end_curve(&mut self, start: usize, per_segment: usize, line: usize) -> Result<(), String> {
        let count = self.points.len() - start;
        if count == 0 {
            return Ok(());
        }
        if count < per_segment {
            return Err(format!(
                "the curve that ends on line {line} has {count} control points; it takes {per_segment}"
            ));
        }
        self.starts.extend((start..=self.points.len() - per_segment).map(|start| start as u32));
        Ok(())
    }

    /// The position and radius of one control point of a segment.
    #[must_use]
    pub(crate) fn point(&self, segment: u32, index: usize) -> Vec4 {
        self.points[self.starts[segment as usize] as usize + index]
    }

    /// Memory use in bytes.
    #[must_use]
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.points.as_slice()) + size_of_val(self.starts.as_slice())
    }
}

/// The two directions across the unit vector `axis` that define Mitsuba's azimuth: where it is a
/// quarter turn, and where it is zero.
#[must_use]
pub(crate) fn azimuth_frame(axis: Vec3) -> [Vec3; 2] {
    let across = (Vec3::Z - axis * axis.z).try_normalize().unwrap_or(Vec3::Y);
    [across, across.cross(axis)]
}

/// The azimuth of a direction across `axis`, in turns from 0 to 1.
#[must_use]
pub(crate) fn azimuth(axis: Vec3, outwards: Vec3) -> f32 {
    let [quarter, zero] = azimuth_frame(axis);
    let turns = outwards.dot(quarter).atan2(outwards.dot(zero)) / std::f32::consts::TAU;
    if turns < 0.0 { turns + 1.0 } else { turns }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_lines_begin_curves() {
        let text = b"\n0 0 0 1\n1 0 0 .5 \r\n2 0 0 1e-1\n \n\n5 5 5 1\n6 6 6 2";
        let curves = parse(text, &Transform::IDENTITY, (2, None)).expect("the text is right");
        assert_eq!(curves.starts, [0, 1, 3]);
        assert_eq!(curves.point(2, 1), Vec4::new(6.0, 6.0, 6.0, 2.0));
        let bare = parse(b"0 0 0\n1 0 0 2\n", &Transform::IDENTITY, (2, Some(0.5)));
        let bare = bare.expect("the radius is given");
        assert_eq!([bare.point(0, 0).w, bare.point(0, 1).w], [0.5, 2.0]);
        let moved = Transform::from_matrix(&glam::DMat4::from_scale(glam::DVec3::splat(2.0)));
        let curves =
            parse(text, &moved.expect("it has an inverse"), (3, None)).expect_err("too few");
        assert!(curves.contains("line 8 has 2 control points; it takes 3"), "{curves}");
    }

    #[test]
    fn broken_files_are_refused_with_their_line() {
        for (text, line) in [
            ("0 0 0 1\n0 0 1\n", "line 2"),
            ("0 0 0 -1\n", "line 1"),
            ("0 0 nan 1\n", "line 1"),
            ("0 0 1e39 1\n", "line 1"),
            ("0 0 0 1\n\n0 0 0 1\n1 1 1 1", "line 2"),
            ("a b c d", "line 1"),
            ("\u{fe}\n", "line 1"),
            ("\n\n", "no control points"),
        ] {
            let problem = parse(text.as_bytes(), &Transform::IDENTITY, (2, None)).expect_err(text);
            assert!(problem.contains(line), "{text:?}: {problem}");
        }
    }
}
