//! The field of view: an angle along one axis of the film, or a focal length.

use crate::manual::{ParameterManual, parameter};
use etendue_document::{Fault, Parameters, Value};
use glam::DVec2;
use std::ops::Bound;

pub(crate) const FOV: ParameterManual = parameter(
    "fov",
    "float",
    "",
    "The field of view in degrees, between 0 and 180, along `fov_axis`; instead of `focal_length`.",
);
pub(crate) const FOV_AXIS: ParameterManual = parameter(
    "fov_axis",
    "string",
    "x",
    "What `fov` is measured along: `x`, `y`, `diagonal`, or the `smaller` or `larger` of x and y.",
);
pub(crate) const FOCAL_LENGTH: ParameterManual = parameter(
    "focal_length",
    "string",
    "50mm",
    "The focal length in millimetres of a lens that sees the same diagonal on 35 mm film \
     (36 × 24 mm).",
);

/// The film axis along which the angle is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Axis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}

const AXES: [(&str, Axis); 5] = [
    ("x", Axis::X),
    ("y", Axis::Y),
    ("diagonal", Axis::Diagonal),
    ("smaller", Axis::Smaller),
    ("larger", Axis::Larger),
];

/// The diagonal of 35 mm film, √(36² + 24²), in millimetres.
const FILM_DIAGONAL: f64 = 43.266_615_305_567_87;
/// The smallest angle that single precision can resolve.
const MIN_DEGREES: f64 = 1e-5;
/// The longest focal length, in millimetres: about the smallest angle.
const MAX_FOCAL_LENGTH: f64 = 1e8;
/// The shortest focal length: the view covers almost a hemisphere.
const MIN_FOCAL_LENGTH: f64 = 1e-5;
/// The default focal length, in millimetres.
const DEFAULT_FOCAL_LENGTH: f64 = 50.0;

/// Reads the field of view of a film with this aspect ratio (width over height). Returns half the
/// width and half the height that it covers at distance one; `None` after reporting an error.
pub(crate) fn read_half_size(parameters: &Parameters<'_>, aspect: f64) -> Option<DVec2> {
    let angle_range = (Bound::Included(MIN_DEGREES), Bound::Excluded(180.0));
    let axis = parameters.choice("fov_axis", Axis::X, &AXES);
    let both = (parameters.value("fov").is_some(), parameters.value("focal_length").is_some());
    let (tangent, axis) = match both {
        (true, true) => {
            let message = "`fov` and `focal_length` say the same thing: give one of them";
            parameters.error(Fault::BadValue, "focal_length", message);
            return None;
        }
        (true, false) => {
            let degrees = parameters.float_in("fov", 45.0, angle_range);
            ((0.5 * degrees).to_radians().tan(), axis)
        }
        (false, _) => (0.5 * FILM_DIAGONAL / read_focal_length(parameters)?, Axis::Diagonal),
    };
    Some(half_size(tangent, axis, aspect))
}

/// Half the width and half the height, from the tangent of half the angle along an axis.
fn half_size(tangent: f64, axis: Axis, aspect: f64) -> DVec2 {
    let half_width = match axis {
        Axis::X => tangent,
        Axis::Y => tangent * aspect,
        Axis::Diagonal => tangent * aspect / aspect.hypot(1.0),
        Axis::Smaller => tangent * aspect.max(1.0),
        Axis::Larger => tangent * aspect.min(1.0),
    };
    DVec2::new(half_width, half_width / aspect)
}

/// Parses the focal length in millimetres: a number, or text with or without a unit.
fn read_focal_length(parameters: &Parameters<'_>) -> Option<f64> {
    let millimetres = match parameters.value("focal_length") {
        None => return Some(DEFAULT_FOCAL_LENGTH),
        Some((Value::String(text), _)) => {
            let text = text.trim();
            text.strip_suffix("mm").unwrap_or(text).trim_end().parse().ok()
        }
        Some((Value::Float(number), _)) => Some(*number),
        Some((Value::Integer(number), _)) => Some(*number as f64),
        Some(_) => None,
    };
    let range = MIN_FOCAL_LENGTH..=MAX_FOCAL_LENGTH;
    let valid = millimetres.filter(|length| range.contains(length));
    if valid.is_none() {
        let message = "a focal length is a positive number of millimetres, such as `50mm`";
        parameters.error(Fault::BadValue, "focal_length", message);
    }
    valid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::Class;

    fn node() -> TestNode {
        TestNode::new(Class::Sensor, "perspective")
    }

    fn degrees(half: f64) -> f64 {
        2.0 * half.atan().to_degrees()
    }

    #[test]
    fn an_angle_is_found_again_along_its_axis() {
        for aspect in [1.5, 0.4] {
            let read = |axis: &str| {
                let node = node().float("fov", 40.0).string("fov_axis", axis);
                node.build_cleanly(|_, parameters| read_half_size(parameters, aspect))
            };
            for (axis, expected) in [
                ("x", degrees(read("x").x)),
                ("y", degrees(read("y").y)),
                ("diagonal", degrees(read("diagonal").length())),
                ("smaller", degrees(read("smaller").min_element())),
                ("larger", degrees(read("larger").max_element())),
            ] {
                assert!((expected - 40.0).abs() < 1e-12, "{axis} at {aspect}: {expected}");
                let size = read(axis);
                assert!((size.x / size.y - aspect).abs() < 1e-12, "{axis}: {size}");
            }
        }
    }

    #[test]
    fn focal_lengths_come_with_and_without_a_unit() {
        for length in ["85mm", "85", " 85.0 mm "] {
            let node = node().string("focal_length", length);
            let size = node.build_cleanly(|_, parameters| read_half_size(parameters, 1.5));
            let expected = DVec2::new(18.0, 12.0) / 85.0;
            assert!((size - expected).length() < 1e-12, "{length}: {size}");
        }
        let number = node().float("focal_length", 36.0);
        let size = number.build_cleanly(|_, parameters| read_half_size(parameters, 1.5));
        assert!((size.x - 0.5).abs() < 1e-12);
    }

    #[test]
    fn hostile_values_are_errors() {
        let angles = [0.0, 1e-300, 180.0, -40.0, f64::NAN, f64::INFINITY]
            .map(|fov| node().float("fov", fov));
        let lengths = ["0mm", "-5mm", "abc", "", "nan", "infmm", "0.05m", "1e300mm"]
            .map(|length| node().string("focal_length", length));
        let others = [
            node().float("fov", 40.0).string("focal_length", "50mm"),
            node().float("fov", 40.0).string("fov_axis", "z"),
            node().with("focal_length", Value::Boolean(true)),
        ];
        for node in angles.into_iter().chain(lengths).chain(others) {
            node.build(|_, parameters| read_half_size(parameters, 1.5));
            let faults: Vec<Fault> = node.findings().iter().map(|found| found.fault).collect();
            assert_eq!(faults, [Fault::BadValue], "{:?}", node.findings());
        }
    }
}
