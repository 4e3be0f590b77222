//! The elements that are named values.

use etendue_document::{Fault, SpectrumValue, Value};
use glam::DVec3;

use crate::element::{Attribute, Element};
use crate::loader::Loader;
use crate::numbers::{self, shorten};

/// `<boolean name="..." value="true"/>`.
pub(crate) fn boolean(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let attribute = element.required("value", loader.diagnostics)?;
    let word = attribute.value.trim();
    if word.eq_ignore_ascii_case("true") {
        return Some(Value::Boolean(true));
    }
    if word.eq_ignore_ascii_case("false") {
        return Some(Value::Boolean(false));
    }
    let message = format!("`{}` is neither `true` nor `false`", shorten(word));
    loader.diagnostics.error(Fault::BadValue, attribute.span, message);
    None
}

/// `<integer name="..." value="16"/>`.
pub(crate) fn integer(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let attribute = element.required("value", loader.diagnostics)?;
    element.read(attribute, numbers::integer, loader.diagnostics).map(Value::Integer)
}

/// `<float name="..." value="0.5"/>`.
pub(crate) fn float(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let attribute = element.required("value", loader.diagnostics)?;
    element.read(attribute, numbers::number, loader.diagnostics).map(Value::Float)
}

/// `<string name="..." value="..."/>`.
pub(crate) fn string(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let attribute = element.required("value", loader.diagnostics)?;
    Some(Value::String(attribute.value.clone().into_owned()))
}

/// `<point name="..." x="0" y="1" z="2"/>` or the same with `value="0, 1, 2"`.
pub(crate) fn point(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    element.vector(None, loader.diagnostics).map(Value::Point)
}

/// `<vector name="..." x="0" y="1" z="2"/>` or the same with `value="0, 1, 2"`.
pub(crate) fn vector(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    element.vector(None, loader.diagnostics).map(Value::Vector)
}

/// `<rgb name="..." value="0.1, 0.2, 0.3"/>`: linear. `#rrggbb` is sRGB in version 3, but linear up
/// to version 0.6.
pub(crate) fn rgb(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let attribute = element.required("value", loader.diagnostics)?;
    check_intent(element, loader);
    match hexadecimal(attribute, loader)? {
        Some(color) if loader.is_old() => Some(Value::Rgb(color)),
        Some(encoded) => Some(Value::Rgb(linear(encoded))),
        None => element.vector_in(attribute, loader.diagnostics).map(Value::Rgb),
    }
}

/// `<srgb name="..." value="0.1, 0.2, 0.3"/>` or `#rrggbb`: with the sRGB curve.
pub(crate) fn srgb(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let attribute = element.required("value", loader.diagnostics)?;
    check_intent(element, loader);
    let encoded = match hexadecimal(attribute, loader)? {
        Some(encoded) => encoded,
        None => element.vector_in(attribute, loader.diagnostics)?,
    };
    Some(Value::Rgb(linear(encoded)))
}

/// `<spectrum name="..." value="..."/>` with one number, `wavelength:value` pairs, or three RGB
/// numbers (version 0.6 reads them so in its usual build); or with a `filename`.
pub(crate) fn spectrum(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    check_intent(element, loader);
    if let Some(file) = element.value("filename") {
        return Some(Value::Spectrum(SpectrumValue::File(file.to_owned())));
    }
    let attribute = element.required("value", loader.diagnostics)?;
    if attribute.value.contains(':') {
        let pairs = element.read(attribute, numbers::pairs, loader.diagnostics)?;
        return Some(Value::Spectrum(SpectrumValue::Samples(pairs)));
    }
    match element.read(attribute, numbers::numbers, loader.diagnostics)?[..] {
        [constant] => Some(Value::Spectrum(SpectrumValue::Constant(constant))),
        [r, g, b] => Some(Value::Rgb(DVec3::new(r, g, b))),
        ref other => {
            let message = format!(
                "one number or pairs `wavelength:value` are expected, not {} numbers",
                other.len()
            );
            element.report_count(attribute, message, loader.diagnostics);
            None
        }
    }
}

/// `<blackbody name="..." temperature="5000"/>`, in kelvin, with an optional `scale`. A `K` after
/// the number is accepted, because version 0.6 writes it.
pub(crate) fn blackbody(loader: &mut Loader<'_>, element: &Element<'_>) -> Option<Value> {
    let attribute = element.required("temperature", loader.diagnostics)?;
    let kelvin = |text: &str| numbers::number(text.trim_end().trim_end_matches(['K', 'k']));
    let temperature = element.read(attribute, kelvin, loader.diagnostics)?;
    if temperature <= 0.0 {
        let message = "a temperature must be above 0 kelvin";
        loader.diagnostics.error(Fault::BadValue, attribute.span, message);
        return None;
    }
    let scale = match element.attribute("scale") {
        Some(attribute) => element.read(attribute, numbers::number, loader.diagnostics)?,
        None => 1.0,
    };
    Some(Value::Blackbody { temperature, scale })
}

/// Warns of an `intent` that version 0.6 does not know. The two that it knows make no difference in
/// RGB, because both of its whites are (1, 1, 1) there.
fn check_intent(element: &Element<'_>, loader: &Loader<'_>) {
    let Some(intent) = element.attribute("intent") else { return };
    if !["reflectance", "illuminant"].contains(&intent.value.trim().to_lowercase().as_str()) {
        let message = "an intent is `reflectance` or `illuminant`";
        loader.diagnostics.warning(Fault::BadValue, intent.span, message);
    }
}

/// The colour `#rrggbb` or `#rgb` in 0 to 1, without any decoding; `Some(None)` if the value does
/// not start with `#`, `None` after reporting an error. An alpha after the colour is left out.
fn hexadecimal(attribute: &Attribute<'_>, loader: &Loader<'_>) -> Option<Option<DVec3>> {
    let Some(digits) = attribute.value.trim().strip_prefix('#') else {
        return Some(None);
    };
    let values: Option<Vec<u32>> = digits.chars().map(|digit| digit.to_digit(16)).collect();
    let channels: Vec<u32> = match values {
        Some(values) if matches!(values.len(), 3 | 4) => {
            values.iter().map(|digit| 17 * digit).collect()
        }
        Some(values) if matches!(values.len(), 6 | 8) => {
            values.chunks(2).map(|pair| 16 * pair[0] + pair[1]).collect()
        }
        _ => {
            let message = format!("`#{}` is not a colour `#rrggbb`", shorten(digits));
            loader.diagnostics.error(Fault::BadValue, attribute.span, message);
            return None;
        }
    };
    if channels.len() == 4 {
        let message = "the alpha of this colour is left out";
        loader.diagnostics.warning(Fault::BadValue, attribute.span, message);
    }
    let channel = |index: usize| f64::from(channels[index]) / 255.0;
    Some(Some(DVec3::new(channel(0), channel(1), channel(2))))
}

/// From sRGB to linear, IEC 61966-2-1.
fn linear(encoded: DVec3) -> DVec3 {
    let channel = |c: f64| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    DVec3::new(channel(encoded.x), channel(encoded.y), channel(encoded.z))
}
