//! Colour, scalar and index parameters: numbers, spectra or textures.

use super::Builder;
use crate::manual::PLUGINS_PAGE;
use crate::texture::{ColorSource, ScalarSource};
use etendue_document::{Class, Diagnostic, Fault, Parameters, SpectrumValue, Value, list_some};
use etendue_spectrum::{
    SampledSpectrum, Spectrum, SpectrumUse, blackbody_rgb, parse_spd, refractive_index,
    refractive_index_names,
};

/// Words for glass, of which there are many kinds.
const GLASSES: [&str; 4] = ["glass", "glas", "crown glass", "window glass"];

impl Builder<'_> {
    /// A colour parameter: `rgb`, `spectrum`, `blackbody`, a number, or a texture.
    pub fn color(
        &mut self,
        parameters: &Parameters<'_>,
        name: &str,
        default: f32,
        usage: SpectrumUse,
    ) -> ColorSource {
        let default = ColorSource::Constant(Spectrum::splat(default));
        self.optional_color(parameters, name, usage).unwrap_or(default)
    }

    /// A colour parameter that has no default.
    pub fn optional_color(
        &mut self,
        parameters: &Parameters<'_>,
        name: &str,
        usage: SpectrumUse,
    ) -> Option<ColorSource> {
        if let Some(child) = parameters.child(name) {
            // A missing image has been reported. If that is only a warning, grey replaces it.
            let grey = ColorSource::Constant(Spectrum::splat(0.5));
            if self.assets.document.node(child.node).class != Class::Texture {
                parameters.error(Fault::BadValue, name, "expected a colour or a texture");
                return None;
            }
            return Some(self.texture(child.node).map_or(grey, ColorSource::Texture));
        }
        let (value, _) = parameters.value(name)?;
        let color = self.color_of(parameters, name, value, usage)?;
        if !color.is_finite() {
            parameters.error(Fault::BadValue, name, "the colour is not finite");
            return None;
        }
        if !color.has_negative() {
            return Some(ColorSource::Constant(color));
        }
        if !is_limited_below(usage) {
            parameters.error(Fault::BadValue, name, "the colour has a negative component");
            return None;
        }
        let message = "the colour has a negative component, which counts as 0";
        parameters.warning(Fault::BadValue, name, message);
        Some(ColorSource::Constant(color.max(Spectrum::ZERO)))
    }

    /// A colour parameter that cannot be a texture.
    pub fn constant_color(
        &mut self,
        parameters: &Parameters<'_>,
        name: &str,
        default: f32,
        usage: SpectrumUse,
    ) -> Spectrum {
        match self.color(parameters, name, default, usage) {
            ColorSource::Constant(color) => color,
            ColorSource::Texture(_) => {
                parameters.error(
                    Fault::BadValue,
                    name,
                    "expected a colour: no texture can stand here",
                );
                Spectrum::splat(default)
            }
        }
    }

    fn color_of(
        &self,
        parameters: &Parameters<'_>,
        name: &str,
        value: &Value,
        usage: SpectrumUse,
    ) -> Option<Spectrum> {
        match value {
            Value::Rgb(rgb) => Some(Spectrum::from_rgb(rgb.as_vec3().to_array())),
            Value::Float(number) => Some(Spectrum::splat(*number as f32)),
            Value::Integer(number) => Some(Spectrum::splat(*number as f32)),
            Value::Blackbody { temperature, scale } => {
                let rgb = blackbody_rgb(*temperature).map(|x| x * *scale as f32);
                Some(Spectrum::from_rgb(rgb))
            }
            Value::Spectrum(SpectrumValue::Constant(number)) => {
                let constant = etendue_spectrum::SpectrumValue::Constant(*number as f32);
                Some(constant.to_spectrum(usage))
            }
            Value::Spectrum(SpectrumValue::Samples(samples)) => {
                let (wavelengths, values) =
                    samples.iter().map(|(nm, value)| (*nm as f32, *value as f32)).unzip();
                match SampledSpectrum::new(wavelengths, values) {
                    Ok(sampled) => sampled_color(parameters, name, &sampled, usage),
                    Err(error) => {
                        parameters.error(Fault::BadValue, name, error.to_string());
                        None
                    }
                }
            }
            Value::Spectrum(SpectrumValue::File(file)) => {
                self.spectrum_file(parameters, name, file, usage)
            }
            other => {
                let message = format!("expected a colour or a texture, found {}", other.kind());
                parameters.error(Fault::BadValue, name, message);
                None
            }
        }
    }

    fn spectrum_file(
        &self,
        parameters: &Parameters<'_>,
        name: &str,
        file: &str,
        usage: SpectrumUse,
    ) -> Option<Spectrum> {
        let (path, bytes) = self.assets.read_named_file(file, parameters.span_of(name))?;
        match parse_spd(&String::from_utf8_lossy(&bytes)) {
            Ok(sampled) => sampled_color(parameters, name, &sampled, usage),
            Err(error) => {
                parameters.error(Fault::Syntax, name, format!("{}: {error}", path.display()));
                None
            }
        }
    }

    /// A scalar parameter: a number or a texture.
    pub fn scalar(
        &mut self,
        parameters: &Parameters<'_>,
        name: &str,
        default: f32,
    ) -> ScalarSource {
        if let Some(child) = parameters.child(name) {
            return self
                .texture(child.node)
                .map_or(ScalarSource::Constant(0.5), ScalarSource::Texture);
        }
        match parameters.value(name) {
            Some((Value::Float(_) | Value::Integer(_), _)) | None => {
                ScalarSource::Constant(parameters.float(name, f64::from(default)) as f32)
            }
            Some((value, _)) => {
                let color = self.color_of(parameters, name, value, SpectrumUse::Unbounded);
                ScalarSource::Constant(color.map_or(default, Spectrum::luminance))
            }
        }
    }

    /// An index of refraction: a number, or the name of a material.
    pub fn refractive_index(
        &mut self,
        parameters: &Parameters<'_>,
        name: &str,
        default: &str,
    ) -> f32 {
        let fallback = refractive_index(default).unwrap_or(1.0);
        let Some((Value::String(material), _)) = parameters.value(name) else {
            let range = f64::from(f32::MIN_POSITIVE)..=1e3;
            return parameters.float_in(name, f64::from(fallback), range) as f32;
        };
        refractive_index(material).unwrap_or_else(|| {
            let message = format!("there is no dielectric `{material}`");
            let found = Diagnostic::error(Fault::BadValue, parameters.span_of(name), message);
            let is_glass = GLASSES.contains(&material.trim().to_lowercase().as_str());
            let found = if is_glass {
                found.help("common glass is `bk7`, or the number 1.5")
            } else {
                found
            };
            let some = list_some(material, refractive_index_names(), PLUGINS_PAGE);
            parameters.diagnostics().push(found.help(format!("there are {some}")));
            fallback
        })
    }
}

/// Whether negative values count as zero. Measured data are sometimes slightly negative; negative
/// light is a mistake.
fn is_limited_below(usage: SpectrumUse) -> bool {
    matches!(usage, SpectrumUse::Reflectance | SpectrumUse::MeasuredIndex)
}

/// The colour of a measured spectrum. Reports values that the conversion would clamp silently:
/// negative ones, and reflectances above one.
fn sampled_color(
    parameters: &Parameters<'_>,
    name: &str,
    sampled: &SampledSpectrum,
    usage: SpectrumUse,
) -> Option<Spectrum> {
    if sampled.values().iter().any(|value| *value < 0.0) {
        if !is_limited_below(usage) {
            parameters.error(Fault::BadValue, name, "the spectrum has a negative value");
            return None;
        }
        let message = "the spectrum has a negative value: its colour is limited to 0";
        parameters.warning(Fault::BadValue, name, message);
    }
    if usage == SpectrumUse::Reflectance && sampled.values().iter().any(|value| *value > 1.0) {
        let message = "the spectrum is above 1 in places: its colour is limited to 1";
        parameters.warning(Fault::BadValue, name, message);
    }
    let color = Spectrum::from_rgb(sampled.to_rgb(usage));
    Some(if is_limited_below(usage) { color.max(Spectrum::ZERO) } else { color })
}
