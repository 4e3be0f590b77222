//! Checks whether values are usable, whether they come from text or from code.

use crate::transform::transform_problem;
use crate::value::{SpectrumValue, Value};

/// Why a value is unusable, if it is: the same checks that text readers make while reading.
pub(crate) fn value_problem(name: &str, value: &Value) -> Option<String> {
    let is_finite = match value {
        Value::Boolean(_) | Value::Integer(_) | Value::String(_) | Value::Buffer(_) => true,
        Value::Float(number) => number.is_finite(),
        Value::Point(vector) | Value::Vector(vector) | Value::Rgb(vector) => vector.is_finite(),
        Value::Points(points) => points.iter().all(|point| point.is_finite()),
        Value::Blackbody { temperature, scale } => {
            if *temperature <= 0.0 {
                return Some("a temperature must be above 0 kelvin".to_owned());
            }
            temperature.is_finite() && scale.is_finite()
        }
        Value::Spectrum(spectrum) => return spectrum_problem(name, spectrum),
        // A matrix that is not affine has been turned into NaN before.
        Value::Transform(affine) if !affine.is_finite() => {
            return Some(format!("`{name}` must be an affine transform of finite numbers"));
        }
        Value::Transform(affine) => {
            return transform_problem(name, (*affine).into()).map(str::to_owned);
        }
    };
    (!is_finite).then(|| not_finite(name))
}

fn spectrum_problem(name: &str, spectrum: &SpectrumValue) -> Option<String> {
    let is_finite = match spectrum {
        SpectrumValue::Constant(constant) => constant.is_finite(),
        SpectrumValue::File(_) => true,
        SpectrumValue::Samples(samples) => {
            if samples.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
                return Some("wavelengths must ascend".to_owned());
            }
            samples.iter().all(|(wavelength, value)| wavelength.is_finite() && value.is_finite())
        }
    };
    (!is_finite).then(|| not_finite(name))
}

fn not_finite(name: &str) -> String {
    format!("`{name}` must be finite, but holds NaN or an infinity")
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};

    use super::*;

    #[test]
    fn values_that_no_text_could_state_are_refused() {
        let problem = |value: Value| value_problem("x", &value);
        let mut perspective = DMat4::IDENTITY;
        perspective.z_axis.w = 1.0;
        for good in [
            Value::Float(1.0),
            Value::Spectrum(SpectrumValue::Samples(vec![(400.0, 1.0), (500.0, 2.0)])),
            Value::Blackbody { temperature: 5000.0, scale: 1.0 },
            DMat4::from_scale(DVec3::splat(1e-9)).into(),
        ] {
            assert_eq!(problem(good), None);
        }
        let not_finite = Some("`x` must be finite, but holds NaN or an infinity".to_owned());
        assert_eq!(problem(Value::Float(f64::NAN)), not_finite);
        assert_eq!(problem(Value::Rgb(DVec3::INFINITY)), not_finite);
        assert_eq!(problem(Value::Spectrum(SpectrumValue::Constant(f64::NAN))), not_finite);
        for (bad, words) in [
            (Value::Blackbody { temperature: 0.0, scale: 1.0 }, "above 0 kelvin"),
            (Value::Spectrum(SpectrumValue::Samples(vec![(2.0, 0.0), (1.0, 0.0)])), "ascend"),
            (DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)).into(), "singular"),
            (perspective.into(), "affine"),
        ] {
            assert!(problem(bad).is_some_and(|problem| problem.contains(words)), "{words}");
        }
    }
}
