//! Emitters: version 0.6's white spectra; its `sky`, `sun` and `sunsky` become one `sunsky` with +z
//! up.

use etendue_document::{FlatNode, Parameter, SpectrumValue, Value};
use glam::{DMat4, DVec4};

use super::approximation::Approximations;
use super::entries::{find, number, take};

/// Maps the sky's space to that of version 0.6, where +y is up, −z north and +x east. In version 3,
/// +z is up, +x south and +y west.
const UP: DMat4 = DMat4::from_cols(
    DVec4::new(0.0, 0.0, 1.0, 0.0),
    DVec4::new(-1.0, 0.0, 0.0, 0.0),
    DVec4::new(0.0, 1.0, 0.0, 0.0),
    DVec4::W,
);
/// The default ground albedo in the code of version 0.6; its manual says 0.15.
const ALBEDO: f64 = 0.2;
/// The angular size of the sun in degrees.
const APERTURE: f64 = 0.5358;
/// A sun of size zero gets this fraction of the real size, because it cannot be a point.
const LEAST_RADIUS: f64 = 0.01;
/// Parameters that controlled how version 0.6 rasterised its sky.
const WITHOUT_MEANING: [&str; 2] = ["resolution", "sampling_weight"];
/// Time and place, which a direction of the sun overrides in version 0.6.
const TIME_AND_PLACE: [&str; 9] =
    ["latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"];

/// Upgrades an emitter; `is_old` where its file is of version 0.x.
pub(super) fn upgrade(node: &mut FlatNode, is_old: bool) {
    if is_old {
        whiten(node);
    }
    let (own_scales, absent): (&[&str], _) = match node.plugin.as_str() {
        "sky" => (&["sky_scale"], Some("sun_scale")),
        "sun" => (&["sun_scale"], Some("sky_scale")),
        "sunsky" if is_old => (&["sun_scale", "sky_scale"], None),
        _ => return,
    };
    node.plugin = "sunsky".into();
    if let Some(scale) = take(node, "scale") {
        for name in own_scales {
            if find(node, name).is_none() {
                node.parameters.push(Parameter { name: (*name).into(), ..scale.clone() });
            }
        }
    }
    if let Some(absent) = absent {
        set(node, absent, Value::Float(0.0));
    }
    if find(node, "sun_direction").is_some() {
        TIME_AND_PLACE.iter().for_each(|name| drop(take(node, name)));
    }
    for name in WITHOUT_MEANING {
        take(node, name);
    }
    if let Some(radius) = take(node, "sun_radius_scale").and_then(|p| number(&p.value)) {
        set(node, "sun_aperture", Value::Float(APERTURE * radius.max(LEAST_RADIUS)));
    }
    if find(node, "albedo").is_none() {
        set(node, "albedo", Value::Float(ALBEDO));
    }
    let to_world = match find(node, "to_world").map(|parameter| &parameter.value) {
        Some(Value::Transform(affine)) => (*affine).into(),
        _ => DMat4::IDENTITY,
    };
    set(node, "to_world", Value::transform(to_world * UP));
}

/// A spectrum of one number is that multiple of the white D65 in version 0.6, not of the spectrum of
/// equal energy: in RGB, a plain number.
fn whiten(node: &mut FlatNode) {
    for parameter in &mut node.parameters {
        if let Value::Spectrum(SpectrumValue::Constant(number)) = parameter.value {
            parameter.value = Value::Float(number);
        }
    }
}

/// Turns a `timed_sunsky`, whose sun moves, into the `sunsky` of its first day at the middle of its
/// hours.
pub(super) fn stop_the_clock(node: &mut FlatNode, approximations: &mut Approximations) {
    if node.plugin != "timed_sunsky" {
        return;
    }
    let message =
        "`timed_sunsky` is rendered as `sunsky`, on its first day halfway through its hours";
    approximations.add(message, node.span);
    node.plugin = "sunsky".into();
    let hour =
        |name, default| find(node, name).and_then(|time| number(&time.value)).unwrap_or(default);
    let middle = 0.5 * (hour("window_start_time", 7.0) + hour("window_end_time", 19.0));
    for (old, new) in [("start_year", "year"), ("start_month", "month"), ("start_day", "day")] {
        if let Some(start) = take(node, old) {
            set(node, new, start.value);
        }
    }
    for name in TIME_PARAMETERS {
        take(node, name);
    }
    set(node, "hour", Value::Float(middle));
}

/// The time parameters of a `timed_sunsky`.
const TIME_PARAMETERS: [&str; 7] = [
    "window_start_time",
    "window_end_time",
    "end_year",
    "end_month",
    "end_day",
    "shutter_open",
    "shutter_close",
];

/// Sets a parameter at the position of the one it replaces, or of the node.
fn set(node: &mut FlatNode, name: &str, value: Value) {
    let span = take(node, name).map_or(node.span, |old| old.span);
    let (name, original_name) = (name.into(), name.into());
    node.parameters.push(Parameter { name, original_name, value, span });
}
