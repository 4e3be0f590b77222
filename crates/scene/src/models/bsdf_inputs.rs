//! Parameters that several materials share, with the checks of their ranges.

use super::fresnel;
use super::microfacet::{Distribution, Microfacets, NormalSampling};
use crate::builder::Builder;
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::manual::PLUGINS_PAGE;
use crate::texture::{ColorSource, ScalarSource, Textures};
use etendue_document::{Class, Diagnostic, Fault, Parameters, Value, list_some};
use etendue_math::lanes::Real;
use etendue_spectrum::{
    Spectrum, SpectrumLanes, SpectrumUse, metal, metal_names, refractive_index,
};
use glam::Vec2;
use std::ops::RangeInclusive;

/// Clamps a number. NaN, which a texture may contain, becomes the lower bound.
#[inline]
pub(crate) fn limited(value: f32, low: f32, high: f32) -> f32 {
    if value > low { value.min(high) } else { low }
}

/// A reflectance or transmittance: a colour from 0 to 1. Larger values create energy; they are
/// kept, with a warning.
pub(crate) fn reflectance(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    name: &str,
    default: f32,
) -> ColorSource {
    let source = builder.color(parameters, name, default, SpectrumUse::Reflectance);
    if let ColorSource::Constant(color) = source
        && color.max_component() > 1.0
    {
        let message =
            format!("`{name}` is above 1: the surface reflects more light than it receives");
        let found = Diagnostic::warning(Fault::BadValue, parameters.span_of(name), message);
        parameters.diagnostics().push(match in_bytes(color) {
            Some(hexadecimal) => found.help(format!(
                "components go from 0 to 1, not to 255: as in pictures, this is `<srgb \
                 value=\"{hexadecimal}\"/>`"
            )),
            None => found,
        });
    }
    source
}

/// A colour whose components look as if they went from 0 to 255, in hexadecimal.
fn in_bytes(color: Spectrum) -> Option<String> {
    let is_byte = |value: f32| value.fract() == 0.0 && (0.0..=255.0).contains(&value);
    let bytes = color.rgb().into_iter().all(is_byte) && color.max_component() > 1.0;
    let [r, g, b] = color.rgb().map(|value| value as u8);
    bytes.then(|| format!("#{r:02x}{g:02x}{b:02x}"))
}

/// A scalar. A constant outside `bounds`, or NaN, is an error, and the default is returned. Texture
/// values are clamped on lookup.
pub(crate) fn scalar_within(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    name: &str,
    default: f32,
    bounds: RangeInclusive<f32>,
) -> ScalarSource {
    let source = builder.scalar(parameters, name, default);
    match source {
        ScalarSource::Constant(value) if !bounds.contains(&value) => {
            let (low, high) = (bounds.start(), bounds.end());
            let message =
                format!("`{name}` is {value}, but must be at least {low} and at most {high}");
            parameters.error(Fault::BadValue, name, message);
            ScalarSource::Constant(default)
        }
        source => source,
    }
}

/// A fraction from 0 to 1. Values outside are clamped with a warning, because existing scenes
/// contain them.
pub(crate) fn fraction(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    name: &str,
    default: f32,
) -> ScalarSource {
    match builder.scalar(parameters, name, default) {
        ScalarSource::Constant(value) if !(0.0..=1.0).contains(&value) => {
            let message = format!("`{name}` is {value}, and is clamped to the range from 0 to 1");
            parameters.warning(Fault::BadValue, name, message);
            ScalarSource::Constant(limited(value, 0.0, 1.0))
        }
        source => source,
    }
}

/// The index inside over the index outside, from `int_ior` and `ext_ior`; from 0.001 to 1000.
pub(crate) fn relative_index(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    default_inside: &str,
) -> f32 {
    let inside = builder.refractive_index(parameters, "int_ior", default_inside);
    let outside = builder.refractive_index(parameters, "ext_ior", "air");
    let eta = inside / outside;
    if (1e-3..=1e3).contains(&eta) {
        return eta;
    }
    let message = format!("`int_ior` is {eta} times `ext_ior`, which must be from 0.001 to 1000");
    parameters.error(Fault::BadValue, "int_ior", message);
    1.5
}

/// As above, for a rough interface; `None` if both indices are equal, because all of its
/// transmission would pass straight through.
pub(crate) fn rough_relative_index(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    default_inside: &str,
) -> Option<f32> {
    let eta = relative_index(builder, parameters, default_inside);
    if eta == 1.0 {
        let message = "the indices of refraction inside and outside must differ";
        parameters.error(Fault::BadValue, "int_ior", message);
        return None;
    }
    Some(eta)
}

/// A roughness. Values above one are kept, with a warning: they are often meant as a percentage or an
/// exponent.
pub(crate) fn roughness(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    name: &str,
) -> ScalarSource {
    let source = scalar_within(builder, parameters, name, 0.1, 0.0..=1e4);
    if let ScalarSource::Constant(alpha) = source
        && alpha > 1.0
    {
        let message =
            format!("`{name}` is {alpha}: a roughness is from 0 to 1, and more is duller still");
        parameters.warning(Fault::BadValue, name, message);
    }
    source
}

/// The roughness of a microfacet surface: `alpha`, `alpha_u`, `alpha_v`, `distribution` and
/// `sample_visible`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Roughness {
    alpha_u: ScalarSource,
    alpha_v: ScalarSource,
    distribution: Distribution,
    sampling: NormalSampling,
}

impl Roughness {
    /// Reads the parameters. The roughness along each axis may be textured.
    pub(crate) fn read(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Self {
        let (distribution, sampling) = distribution(parameters);
        let mut read = |name: &str| roughness(builder, parameters, name);
        let (alpha_u, alpha_v) = if parameters.has("alpha_u") || parameters.has("alpha_v") {
            for name in ["alpha_u", "alpha_v"] {
                if !parameters.has(name) {
                    let message = format!("`{name}` is missing: it goes with the other direction");
                    parameters.error(Fault::MissingParameter, "alpha", message);
                }
            }
            if parameters.has("alpha") {
                let message = "give either `alpha`, or `alpha_u` and `alpha_v`";
                parameters.error(Fault::BadValue, "alpha", message);
                read("alpha");
            }
            (read("alpha_u"), read("alpha_v"))
        } else {
            let alpha = read("alpha");
            (alpha, alpha)
        };
        Self { alpha_u, alpha_v, distribution, sampling }
    }

    /// Whether it is the same everywhere.
    pub(crate) fn is_uniform(&self) -> bool {
        self.alpha_u.is_constant() && self.alpha_v.is_constant()
    }

    /// The distribution where visible normals are sampled.
    pub(crate) fn visible_distribution(&self) -> Option<Distribution> {
        (self.sampling == NormalSampling::Visible).then_some(self.distribution)
    }

    /// The distribution of normals at a hit.
    #[inline]
    pub(crate) fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> Microfacets {
        let alpha =
            Vec2::new(self.alpha_u.eval(textures, surface), self.alpha_v.eval(textures, surface));
        Microfacets::new(self.distribution, self.sampling, alpha)
    }
}

/// `distribution` and `sample_visible`.
pub(crate) fn distribution(parameters: &Parameters<'_>) -> (Distribution, NormalSampling) {
    let choices = [
        ("beckmann", Distribution::Beckmann),
        ("ggx", Distribution::Ggx),
        // Names of version 0.x. Phong's distribution is close to Beckmann's at the same alpha;
        // Ashikhmin and Shirley's is its anisotropic form.
        ("phong", Distribution::Beckmann),
        ("as", Distribution::Beckmann),
    ];
    let distribution = parameters.choice("distribution", Distribution::Beckmann, &choices);
    let typed = parameters.value("distribution").map(|(value, _)| value);
    if matches!(typed, Some(Value::String(name)) if name == "phong" || name == "as") {
        let message = "this distribution is rendered as `beckmann`, which is close to it";
        parameters.warning(Fault::Approximation, "distribution", message);
    }
    let sampling = match parameters.boolean("sample_visible", true) {
        true => NormalSampling::Visible,
        false => NormalSampling::All,
    };
    (distribution, sampling)
}

/// The complex index of refraction of a metal: `material`, or `eta` and `k`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetalIndex {
    eta: ColorSource,
    k: ColorSource,
    /// The index of the surrounding medium, which divides both.
    outside: f32,
}

impl MetalIndex {
    /// Reads the parameters.
    pub(crate) fn read(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Self {
        let [eta, k] = ["eta", "k"]
            .map(|name| builder.optional_color(parameters, name, SpectrumUse::MeasuredIndex));
        let named = named_metal(parameters);
        if eta.is_some() && k.is_some() && parameters.has("material") {
            let message = "`eta` and `k` are given, so `material` has no effect";
            parameters.warning(Fault::BadValue, "material", message);
        }
        // Version 0.x only. Otherwise the index is relative to vacuum, as in Mitsuba 3.
        let outside = match parameters.has("ext_eta") {
            true => builder.refractive_index(parameters, "ext_eta", "air"),
            false => 1.0,
        };
        Self { eta: eta.unwrap_or(named[0]), k: k.unwrap_or(named[1]), outside }
    }

    /// Whether it is the same everywhere.
    pub(crate) fn is_uniform(&self) -> bool {
        self.eta.is_constant() && self.k.is_constant()
    }

    /// η and k at a hit.
    #[inline]
    pub(crate) fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> [Spectrum; 2] {
        // The upper bound keeps the fourth powers in Fresnel's equations finite.
        [self.eta, self.k].map(|part| (part.eval(textures, surface) / self.outside).clamp(0.0, 1e4))
    }
}

/// η and k of the metal named by `material`; those of a perfect mirror by default.
fn named_metal(parameters: &Parameters<'_>) -> [ColorSource; 2] {
    let mirror = [Spectrum::ZERO, Spectrum::ONE].map(ColorSource::Constant);
    let Some(name) = parameters.optional_string("material") else { return mirror };
    let Some(metal) = metal(name) else {
        let message = format!("there is no metal `{name}`");
        let mut found = Diagnostic::error(Fault::BadValue, parameters.span_of("material"), message);
        if refractive_index(name).is_some() {
            found = found.help("it is a dielectric: write `<bsdf type=\"dielectric\">`");
        }
        let some = list_some(name, metal_names(), PLUGINS_PAGE);
        parameters.diagnostics().push(found.help(format!("there are {some}")));
        return mirror;
    };
    [metal.eta_rgb(), metal.k_rgb()].map(|rgb| ColorSource::Constant(Spectrum::from_rgb(rgb)))
}

/// The reflectance of a diffuse base under a coat, including the light that the coat reflects back
/// to it. `internal_diffuse_reflectance` is the fraction that the coat reflects from inside.
#[inline]
pub(crate) fn coated_base(
    base: Spectrum,
    internal_diffuse_reflectance: f32,
    shift: ColorShift,
) -> Spectrum {
    match shift {
        ColorShift::Nonlinear => base.safe_div(Spectrum::ONE - base * internal_diffuse_reflectance),
        ColorShift::None => base / (1.0 - internal_diffuse_reflectance),
    }
}

/// Whether scattering inside a coat shifts the colour of its base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColorShift {
    /// Light reflected back is tinted at every bounce, which makes it darker and more saturated.
    Nonlinear,
    /// Light reflected back keeps the base's colour.
    None,
}

impl ColorShift {
    /// Reads `nonlinear`.
    pub(crate) fn read(parameters: &Parameters<'_>) -> Self {
        match parameters.boolean("nonlinear", false) {
            true => Self::Nonlinear,
            false => Self::None,
        }
    }
}

/// The probability of sampling the specular lobe of a coated surface whose coat reflects the
/// fraction `reflected`.
#[inline(always)]
pub(crate) fn specular_probability<R: Real>(
    specular: SpectrumLanes<R>,
    base: SpectrumLanes<R>,
    reflected: R,
) -> R {
    let specular = specular.mean() * reflected;
    let diffuse = base.mean() * (-reflected + 1.0);
    let total = specular + diffuse;
    R::select(total.above(0.0), specular / total, total.zero())
}

/// The cosine-weighted mean of [`fresnel::dielectric`] over the inside of an interface.
pub(crate) fn internal_diffuse_reflectance(eta: f32) -> f32 {
    fresnel::diffuse_reflectance(1.0 / eta)
}

/// The nested materials of a wrapper that takes `allowed` of them; `None` after reporting a wrong
/// count or an invalid material.
pub(crate) fn nested(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    allowed: RangeInclusive<usize>,
) -> Option<Vec<MaterialId>> {
    let count = parameters.children_of(Class::Bsdf).len();
    let materials = builder.nested_materials(parameters);
    if allowed.contains(&count) {
        return (materials.len() == count).then_some(materials);
    }
    let wanted = match (allowed.start(), allowed.end()) {
        (1, 1) => "one material".to_owned(),
        (low, high) if low == high => format!("{low} materials"),
        (low, high) => format!("{low} or {high} materials"),
    };
    let fault = if count < *allowed.start() { Fault::MissingParameter } else { Fault::BadValue };
    let message = format!("`{}` needs {wanted} inside it, not {count}", parameters.plugin());
    parameters.error(fault, "", message);
    None
}
