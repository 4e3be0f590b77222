//! The lobes and terms of Disney's model, shared by `principled` and `principledthin`.
//!
//! Burley, "Physically Based Shading at Disney", SIGGRAPH 2012 courses, and "Extending the Disney
//! BRDF to a BSDF with Integrated Subsurface Scattering", SIGGRAPH 2015 courses.

use super::bsdf_inputs::{fraction, limited, scalar_within};
use super::microfacet::{Distribution, Microfacets, NormalSampling};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{ParameterManual, parameter};
use crate::texture::{ColorSource, ScalarSource, Textures};
use etendue_document::Parameters;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

pub(crate) const BASE_COLOR: ParameterManual =
    parameter("base_color", "spectrum or texture", "0.5", "The colour of the material.");
pub(crate) const ROUGHNESS: ParameterManual = parameter(
    "roughness",
    "float or texture",
    "0.5",
    "The roughness of the specular lobes, 0 to 1; its square is the `alpha` of a GGX distribution.",
);
pub(crate) const ANISOTROPIC: ParameterManual = parameter(
    "anisotropic",
    "float or texture",
    "0",
    "How much longer highlights are along the tangent: 0 (not) to 1.",
);
pub(crate) const SPEC_TINT: ParameterManual = parameter(
    "spec_tint",
    "float or texture",
    "0",
    "How much of the base colour the dielectric reflection takes on, 0 to 1.",
);
pub(crate) const SHEEN: ParameterManual = parameter(
    "sheen",
    "float or texture",
    "0",
    "The strength of a glow at grazing angles, as of cloth: 0 to 1; more than that is allowed.",
);
pub(crate) const SHEEN_TINT: ParameterManual = parameter(
    "sheen_tint",
    "float or texture",
    "0",
    "How much of the base colour the sheen takes on, 0 to 1.",
);
pub(crate) const FLATNESS: ParameterManual = parameter(
    "flatness",
    "float or texture",
    "0",
    "From the diffuse lobe (0) to an imitation of subsurface scattering (1), which is flatter.",
);

/// The strength of an additional lobe. The model's range is 0 to 1; larger values only scale it.
pub(crate) fn strength(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    name: &str,
) -> ScalarSource {
    scalar_within(builder, parameters, name, 0.0, 0.0..=1e4)
}

/// The relative sampling rate of a lobe.
pub(crate) fn sampling_rate(parameters: &Parameters<'_>, name: &str) -> f32 {
    parameters.float_in(name, 1.0, 0.0..=1e6) as f32
}

/// The parameters that both materials have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BaseParameters {
    base_color: ColorSource,
    roughness: ScalarSource,
    anisotropic: ScalarSource,
    spec_tint: ScalarSource,
    sheen: ScalarSource,
    sheen_tint: ScalarSource,
    flatness: ScalarSource,
    spec_trans: ScalarSource,
    metallic: ScalarSource,
}

impl BaseParameters {
    /// Reads the parameters, except `metallic`, which thin sheets do not have.
    pub(crate) fn read(
        builder: &mut Builder<'_>,
        parameters: &Parameters<'_>,
        metallic: ScalarSource,
    ) -> Self {
        Self {
            base_color: builder.color(parameters, "base_color", 0.5, SpectrumUse::Reflectance),
            roughness: fraction(builder, parameters, "roughness", 0.5),
            anisotropic: fraction(builder, parameters, "anisotropic", 0.0),
            spec_tint: fraction(builder, parameters, "spec_tint", 0.0),
            sheen: strength(builder, parameters, "sheen"),
            sheen_tint: fraction(builder, parameters, "sheen_tint", 0.0),
            flatness: fraction(builder, parameters, "flatness", 0.0),
            spec_trans: fraction(builder, parameters, "spec_trans", 0.0),
            metallic,
        }
    }

    /// Whether light may pass through the surface without scattering below it.
    pub(crate) fn transmits(&self) -> bool {
        !matches!(self.spec_trans, ScalarSource::Constant(0.0))
    }

    /// Reads the textures at a hit.
    pub(crate) fn resolve(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Base {
        let share = |source: &ScalarSource| share_at(source, textures, surface);
        Base {
            color: self.base_color.eval(textures, surface),
            roughness: share(&self.roughness),
            anisotropic: share(&self.anisotropic),
            spec_tint: share(&self.spec_tint),
            sheen: limited(self.sheen.eval(textures, surface), 0.0, 1e4),
            sheen_tint: share(&self.sheen_tint),
            flatness: share(&self.flatness),
            spec_trans: share(&self.spec_trans),
            metallic: share(&self.metallic),
        }
    }
}

/// A parameter at a hit. Texture values are clamped to 0 to 1.
#[inline]
pub(crate) fn share_at(
    source: &ScalarSource,
    textures: Textures<'_>,
    surface: &SurfaceInteraction,
) -> f32 {
    limited(source.eval(textures, surface), 0.0, 1.0)
}

/// The resolved parameters that both materials share. Every closure takes as much space as the
/// largest one. This struct is limited to 48 bytes, so it omits what does not vary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Base {
    pub(crate) color: Spectrum,
    roughness: f32,
    anisotropic: f32,
    pub(crate) spec_tint: f32,
    sheen: f32,
    sheen_tint: f32,
    flatness: f32,
    pub(crate) spec_trans: f32,
    /// Zero for thin sheets.
    pub(crate) metallic: f32,
}

impl Base {
    /// The distribution of normals, with the roughness multiplied by `factor`.
    #[inline]
    pub(crate) fn microfacets(&self, factor: f32) -> Microfacets {
        let squared = (self.roughness * factor) * (self.roughness * factor);
        let aspect = (1.0 - 0.9 * self.anisotropic).sqrt();
        let alpha = Vec2::new(squared / aspect, squared * aspect).max(Vec2::splat(1e-3));
        Microfacets::new(Distribution::Ggx, NormalSampling::Visible, alpha)
    }

    /// The hue of the base colour, at luminance one; white if the base colour is black.
    #[inline]
    pub(crate) fn hue(&self) -> Spectrum {
        let luminance = self.color.luminance();
        if luminance > 0.0 { self.color / luminance } else { Spectrum::ONE }
    }

    /// The diffuse lobe with retro-reflection, or the approximation of subsurface scattering, times
    /// the cosine. `cos_d` is between either direction and the half vector.
    ///
    /// Burley 2015, section 2 (diffuse and retro-reflection); Burley 2012, section 5.3 (flatness,
    /// after Hanrahan and Krueger).
    #[inline]
    pub(crate) fn diffuse(&self, cos_i: f32, cos_o: f32, cos_d: f32) -> Spectrum {
        let (grazing_i, grazing_o) = (schlick_weight(cos_i), schlick_weight(cos_o));
        let retro = 2.0 * self.roughness * cos_d * cos_d;
        let lambert = (1.0 - 0.5 * grazing_i) * (1.0 - 0.5 * grazing_o);
        let back = retro * (grazing_o + grazing_i + grazing_o * grazing_i * (retro - 1.0));
        let mut shape = lambert + back;
        if self.flatness > 0.0 {
            let towards = |grazing: f32| 1.0 + grazing * (0.5 * retro - 1.0);
            let both = towards(grazing_i) * towards(grazing_o);
            let flat = 1.25 * (both * (1.0 / (cos_i + cos_o) - 0.5) + 0.5);
            shape += self.flatness * (flat - shape);
        }
        self.color * (shape * cos_o * FRAC_1_PI)
    }

    /// The sheen at grazing angles, times the cosine.
    #[inline]
    pub(crate) fn sheen(&self, cos_o: f32, cos_d: f32) -> Spectrum {
        if self.sheen == 0.0 {
            return Spectrum::ZERO;
        }
        let tint = Spectrum::ONE.lerp(self.hue(), self.sheen_tint);
        tint * (self.sheen * schlick_weight(cos_d.abs()) * cos_o)
    }
}

/// (1 − cos θ)⁵.
#[inline]
pub(crate) fn schlick_weight(cosine: f32) -> f32 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    (m * m) * (m * m) * m
}

/// Schlick's approximation at the cosine `cosine` ≥ 0 on the side with relative index `eta`. If
/// `eta` is below 1, it uses the refracted angle, which keeps it continuous up to total internal
/// reflection.
#[inline]
pub(crate) fn schlick(normal: Spectrum, cosine: f32, eta: f32) -> Spectrum {
    let cosine = if eta > 1.0 {
        cosine
    } else {
        (1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0).sqrt()
    };
    normal.lerp(Spectrum::ONE, schlick_weight(cosine))
}

/// The reflectance at normal incidence.
#[inline]
pub(crate) fn normal_reflectance(eta: f32) -> f32 {
    let root = (eta - 1.0) / (eta + 1.0);
    root * root
}

/// The distribution of normals of the clear coat: GTR with exponent 1, isotropic.
///
/// Burley 2012, appendix B.2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoatNormals {
    alpha: f32,
}

/// The roughness in the clear coat's masking term, independent of its gloss.
const COAT_MASKING_ALPHA: f32 = 0.25;

impl CoatNormals {
    /// `gloss` from 0 (satin) to 1.
    #[inline]
    pub(crate) fn new(gloss: f32) -> Self {
        Self { alpha: 0.1 + gloss * (0.001 - 0.1) }
    }

    /// D(m) for m above the surface.
    #[inline]
    pub(crate) fn density(self, m: Vec3) -> f32 {
        let alpha2 = self.alpha * self.alpha;
        // 1 + (α² − 1) cos²θ without the cancellation near the normal.
        let spread = m.truncate().length_squared() + alpha2 * m.z * m.z;
        (alpha2 - 1.0) / (PI * alpha2.ln() * spread)
    }

    /// Samples a normal with the density D(m) cos θ.
    #[inline]
    pub(crate) fn sample(self, uniform: Vec2) -> Vec3 {
        let alpha2 = self.alpha * self.alpha;
        let sin2 = (alpha2.powf(1.0 - uniform.y) - alpha2) / (1.0 - alpha2);
        let sin2 = sin2.clamp(0.0, 1.0);
        (Vec2::from_angle(TAU * uniform.x) * sin2.sqrt()).extend((1.0 - sin2).sqrt())
    }

    /// Smith's masking for both directions. They and their half vector are above the surface.
    #[inline]
    pub(crate) fn masking(wi: Vec3, wo: Vec3) -> f32 {
        let one = |v: Vec3| {
            let tan2 = v.truncate().length_squared() / (v.z * v.z);
            2.0 / (1.0 + (1.0 + COAT_MASKING_ALPHA * COAT_MASKING_ALPHA * tan2).sqrt())
        };
        one(wi) * one(wo)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::quadrature::integrate_hemisphere;
    use etendue_testkit::{ChiSquare, TestRng};

    #[test]
    fn the_coat_covers_the_surface_once() {
        for gloss in [0.0, 0.5] {
            let coat = CoatNormals::new(gloss);
            let area = integrate_hemisphere(|m| f64::from(coat.density(m) * m.z), 1e-5);
            assert!((area - 1.0).abs() < 1e-3, "{gloss}: {area}");
        }
    }

    #[test]
    fn normals_of_the_coat_follow_their_density() {
        for gloss in [0.0, 0.3] {
            let coat = CoatNormals::new(gloss);
            let sample = |random: &mut TestRng| Some(coat.sample(random.next_vec2()));
            let pdf = |m: Vec3| if m.z > 0.0 { coat.density(m) * m.z } else { 0.0 };
            let outcome = ChiSquare::one_of(2).sphere(sample, pdf);
            assert!(outcome.accepted(), "{gloss}: {outcome}");
        }
    }

    #[test]
    fn schlick_is_total_beyond_the_critical_angle() {
        let inside = schlick(Spectrum::splat(0.04), 0.2, 1.0 / 1.5);
        assert_eq!(inside, Spectrum::ONE);
        assert_eq!(schlick(Spectrum::splat(0.04), 1.0, 1.5), Spectrum::splat(0.04));
    }
}
