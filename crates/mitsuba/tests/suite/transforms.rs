//! Transforms against numbers worked out by hand or by Mitsuba 3.9.

use etendue_document::Fault::{BadValue, MissingParameter, Syntax, UnknownParameter};
use etendue_document::Severity::{Error, Warning};
use etendue_document::Value;
use glam::{DMat4, DVec3, DVec4};

use super::{clean, load, object, value};

fn named(name: &str, operations: &str) -> DMat4 {
    let document = clean(&format!(
        "<shape type='x'><transform name='{name}'>{operations}</transform></shape>"
    ));
    match value(object(&document, 0), name) {
        Value::Transform(affine) => (*affine).into(),
        other => panic!("{other:?}"),
    }
}

fn read(operations: &str) -> DMat4 {
    named("to_world", operations)
}

#[track_caller]
fn near(found: DVec3, expected: [f64; 3], tolerance: f64) {
    assert!((found - DVec3::from(expected)).length() <= tolerance, "{found} {expected:?}");
}

#[test]
fn operations_apply_one_after_the_other() {
    let matrix = read("<rotate z='1' angle='90'/><scale value='2'/><translate x='1.7' z='-2'/>");
    near(matrix.transform_point3(DVec3::X), [1.7, 2.0, -2.0], 1e-12);
    assert_eq!(read(""), DMat4::IDENTITY);
}

#[test]
fn axes_come_in_both_notations_and_need_not_be_unit() {
    let expected = DMat4::from_axis_angle(DVec3::Z, 15f64.to_radians());
    for rotation in ["value='0, 0, 1'", "value='0 0 7'", "z='1'", "z='0.001'"] {
        assert!(read(&format!("<rotate {rotation} angle='15'/>")).abs_diff_eq(expected, 1e-12));
    }
}

#[test]
fn scales_come_with_one_number_or_three_or_by_axis() {
    let scales = |operation: &str| read(operation).transform_vector3(DVec3::ONE);
    assert_eq!(scales("<scale value='10'/>"), DVec3::splat(10.0));
    assert_eq!(scales("<scale value='1, 2, 3'/>"), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(scales("<scale y='5'/>"), DVec3::new(1.0, 5.0, 1.0), "the others stay");
}

#[test]
fn matrices_are_written_row_by_row() {
    let matrix = read("<matrix value='-1 0 0 5 0 1 0 6 0 0 -1 6.8 0 0 0 1'/>");
    assert_eq!(matrix.w_axis, DVec4::new(5.0, 6.0, 6.8, 1.0));
    let matrix = read("<matrix value='1 2 3 4 5 6 7 8 10'/>");
    assert_eq!(matrix.transform_vector3(DVec3::X), DVec3::new(1.0, 4.0, 7.0));
    assert_eq!(matrix.w_axis, DVec4::W);
}

#[test]
fn nine_numbers_for_uv_are_a_plane_with_its_offset() {
    let matrix = named("to_uv", "<matrix value='2 0 0.25 0 4 0.5 0 0 1'/>");
    assert_eq!(matrix.transform_point3(DVec3::new(1.0, 1.0, 0.0)), DVec3::new(2.25, 4.5, 0.0));
    assert_eq!(named("to_uv", "<scale value='0'/>").x_axis, DVec4::ZERO, "a uv may collapse");
}

#[test]
fn look_at_agrees_with_mitsuba() {
    for element in ["lookat", "lookAt"] {
        let matrix = read(&format!("<{element} origin='1, 2, 3' target='4 -1 7' up='0, 1, 0.2'/>"));
        near(matrix.x_axis.truncate(), [0.832656, 0.108607, -0.543036], 1e-6);
        near(matrix.y_axis.truncate(), [0.204886, 0.850587, 0.484276], 1e-6);
        near(matrix.z_axis.truncate(), [0.514496, -0.514496, 0.685994], 1e-6);
        near(matrix.w_axis.truncate(), [1.0, 2.0, 3.0], 0.0);
    }
    let any_up = read("<lookat origin='0 0 0' target='0 1 0'/>");
    near(any_up.z_axis.truncate(), [0.0, 1.0, 0.0], 1e-12);
    assert!((any_up.determinant() - 1.0).abs() < 1e-12);
}

#[test]
fn tiny_and_exporter_matrices_are_not_singular() {
    read("<scale value='1e-9'/>");
    read(
        "<matrix value='-4.37114e-008 1 4.37114e-008 0 0 -8.74228e-008 2 0 1 4.37114e-008 1.91069e-015 0 0 0 0 1'/>",
    );
    read("<scale x='1e-6' y='1e6' z='1'/>");
}

#[test]
fn transforms_that_cannot_be_used_are_errors_and_leave_no_value() {
    let cases = [
        ("<scale value='0'/>", BadValue, "singular"),
        ("<scale value='1 0 0'/>", BadValue, "singular"),
        ("<matrix value='1 2 3 2 4 6 0 0 0'/>", BadValue, "singular"),
        ("<scale value='1e300'/>", BadValue, "singular"),
        ("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1'/>", BadValue, "last row"),
        ("<matrix value='1 2 3'/>", BadValue, "16 or 9 numbers, not 3"),
        ("<matrix/>", MissingParameter, "`value`"),
        ("<rotate x='0' angle='10'/>", BadValue, "axis"),
        ("<rotate x='1'/>", MissingParameter, "`angle`"),
        ("<translate x='a'/>", BadValue, "`a` is not a number"),
        ("<lookat origin='0 0 0' target='0 0 0'/>", BadValue, "same point"),
        ("<lookat origin='0 0 0' target='0 0 1' up='0 0 2'/>", BadValue, "parallel"),
        ("<lookat origin='0 0 0'/>", MissingParameter, "`target`"),
        ("<shear x='1'/>", Syntax, "not an operation"),
    ];
    for (operations, fault, words) in cases {
        let loaded = load(&format!(
            "<shape type='x'><transform name='to_world'>\n{operations}\n</transform></shape>"
        ));
        assert_eq!(loaded.findings(), [(Error, fault, 3)], "{operations}");
        assert!(loaded.messages()[0].contains(words), "{:?}", loaded.messages());
        assert!(object(&loaded.document, 0).parameters.is_empty());
    }
}

#[test]
fn a_flat_transform_is_thickened() {
    for operations in [
        "<scale x='1' y='0'/>",
        "<matrix value='1 2 3 2 4 6 0 0 1'/>",
        "<scale value='1 1 0'/><rotate x='1' angle='30'/><scale value='2'/>",
    ] {
        let loaded = load(&format!(
            "<shape type='x'><transform name='to_world'>{operations}</transform></shape>"
        ));
        assert_eq!(loaded.findings(), [(Warning, BadValue, 2)], "{operations}");
        let Value::Transform(matrix) = value(object(&loaded.document, 0), "to_world") else {
            panic!("a transform");
        };
        assert!(matrix.inverse().is_finite());
    }
}

#[test]
fn only_shapes_may_be_flat() {
    let loaded =
        load("<sensor type='x'><transform name='to_world'>\n<scale z='0'/>\n</transform></sensor>");
    assert_eq!(loaded.findings(), [(Error, BadValue, 3)]);
}

#[test]
fn what_does_nothing_is_a_warning() {
    let loaded = load(
        "<shape type='x'><transform name='to_world'>
            <rotate value='0 0 0' angle='0'/>
            <translate w='1'/></transform></shape>",
    );
    assert_eq!(loaded.findings(), [(Warning, BadValue, 3), (Warning, UnknownParameter, 4)]);
    let expected = Value::transform(DMat4::IDENTITY);
    assert_eq!(value(object(&loaded.document, 0), "to_world"), &expected);
}

#[test]
fn operations_that_overflow_together_are_an_error() {
    let scales = "<scale value='1e90'/>".repeat(5);
    let loaded = load(&format!(
        "<shape type='x'>\n<transform name='to_world'>\n{scales}</transform></shape>"
    ));
    assert_eq!(loaded.findings(), [(Error, BadValue, 3)]);
    assert!(loaded.messages()[0].contains("beyond all bounds"), "{:?}", loaded.messages());
}
