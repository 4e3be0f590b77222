//! `roughplastic`: a rough clear coat over a matt base.

use super::conductor::SPECULAR_REFLECTANCE;
use super::dielectric::EXT_IOR;
use super::plastic::{DIFFUSE_REFLECTANCE, INT_IOR, NONLINEAR};
use super::roughconductor::{ALPHA, DISTRIBUTION, SAMPLE_VISIBLE};
use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::{Manual, ParameterManual};
use crate::models::bsdf_inputs::{
    ColorShift, coated_base, distribution, reflectance, rough_relative_index, roughness,
    specular_probability,
};
use crate::models::coat::{Coat, CoatTable, Coats};
use crate::models::fresnel;
use crate::models::microfacet::{Distribution, Microfacets};
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use crate::texture::{ColorSource, ScalarSource, Textures};
use etendue_document::{Fault, Parameters};
use etendue_math::lanes::{Mask as _, Real, Vector2, Vector3};
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Plastic with a rough surface: a matt base under a clear coat of microfacets. Black \
              from behind; see `twosided`.",
    parameters: &[
        DIFFUSE_REFLECTANCE,
        SPECULAR_REFLECTANCE,
        INT_IOR,
        EXT_IOR,
        NONLINEAR,
        ParameterManual { kind: "float", ..ALPHA },
        DISTRIBUTION,
        SAMPLE_VISIBLE,
    ],
    sample: r#"<bsdf type="roughplastic">
    <string name="distribution" value="beckmann"/>
    <float name="int_ior" value="1.61"/>
    <rgb name="diffuse_reflectance" value="0, 0, 0"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="roughplastic"><float name="alpha" value="0.1"/><boolean name="nonlinear" value="true"/></bsdf>"#),
        plain(r#"<bsdf type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value="0.4"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="roughplastic"><float name="alpha" value="0.001"/><string name="distribution" value="ggx"/></bsdf>"#,
        r#"<bsdf type="roughplastic"><float name="alpha" value="0"/><float name="int_ior" value="100"/><float name="diffuse_reflectance" value="1"/><boolean name="nonlinear" value="true"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="roughplastic"><string name="distribution" value="beckmann"/></bsdf>"#,
        r#"<bsdf type="roughplastic"><string name="distribution" value="beckmann"/><float name="alpha" value="0.001"/><rgb name="diffuse_reflectance" value="0, 0.5, 1"/><boolean name="nonlinear" value="true"/></bsdf>"#,
        r#"<bsdf type="roughplastic"><string name="distribution" value="beckmann"/><float name="alpha" value="0.6"/><float name="diffuse_reflectance" value="0"/><float name="specular_reflectance" value="0"/></bsdf>"#,
        r#"<bsdf type="twosided"><bsdf type="roughplastic"><string name="distribution" value="beckmann"/><float name="alpha" value="0.3"/><texture name="diffuse_reflectance" type="checkerboard"/></bsdf></bsdf>"#,
        r#"<bsdf type="roughplastic"><string name="distribution" value="ggx"/></bsdf>"#,
        r#"<bsdf type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value="0.001"/><rgb name="diffuse_reflectance" value="0, 0.5, 1"/><boolean name="nonlinear" value="true"/></bsdf>"#,
        r#"<bsdf type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value="0.6"/><float name="diffuse_reflectance" value="0"/><float name="specular_reflectance" value="0"/></bsdf>"#,
        r#"<bsdf type="twosided"><bsdf type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value="0.3"/><texture name="diffuse_reflectance" type="checkerboard"/></bsdf></bsdf>"#,
    ],
};

/// A rough coat over a matt base.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    diffuse_reflectance: ColorSource,
    specular_reflectance: ColorSource,
    eta: f32,
    shift: ColorShift,
    microfacets: Microfacets,
    table: Arc<CoatTable>,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<RoughPlastic> {
    let eta = rough_relative_index(builder, parameters, "polypropylene");
    let (distribution, sampling) = distribution(parameters);
    let alpha = constant_alpha(builder, parameters);
    let diffuse_reflectance = reflectance(builder, parameters, "diffuse_reflectance", 0.5);
    let specular_reflectance = reflectance(builder, parameters, "specular_reflectance", 1.0);
    let shift = ColorShift::read(parameters);
    let eta = eta?;
    Some(RoughPlastic {
        diffuse_reflectance,
        specular_reflectance,
        eta,
        shift,
        microfacets: Microfacets::new(distribution, sampling, Vec2::splat(alpha)),
        table: builder.coats.of(Coat { distribution, alpha, eta }),
    })
}

/// The coat's table holds one roughness. For a texture it uses the mean, with a warning.
fn constant_alpha(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> f32 {
    match roughness(builder, parameters, "alpha") {
        ScalarSource::Constant(alpha) => alpha,
        source @ ScalarSource::Texture(_) => {
            let message = "`alpha` cannot vary over this material: the texture's mean is taken";
            parameters.warning(Fault::Approximation, "alpha", message);
            source.mean(Textures(&builder.textures))
        }
    }
}

impl ClosureMaterial for RoughPlastic {
    type Closure<'a> = RoughPlasticClosure<&'a CoatTable>;

    fn transmits(&self) -> bool {
        false
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> RoughPlasticClosure<&'a CoatTable> {
        let reflectance = self.diffuse_reflectance.eval(textures, surface);
        let base = coated_base(reflectance, self.table.internal_diffuse_reflectance, self.shift);
        RoughPlasticClosure {
            base: (base / (self.eta * self.eta)).into(),
            reflectance: reflectance.into(),
            specular: self.specular_reflectance.eval(textures, surface).into(),
            microfacets: self.microfacets,
            eta: self.eta,
            coat: &*self.table,
        }
    }
}

impl LaneMaterial for RoughPlastic {
    type Variant = Distribution;
    type Blank = RoughPlasticClosure<&'static CoatTable>;

    const HAS_COAT: bool = true;

    fn variant(&self) -> Option<Distribution> {
        self.microfacets.visible_distribution()
    }

    #[inline(always)]
    fn blank(distribution: Distribution) -> Self::Blank {
        let [base, reflectance, specular] = Default::default();
        let microfacets = Microfacets::visible(distribution);
        RoughPlasticClosure {
            base,
            reflectance,
            specular,
            microfacets,
            eta: 1.0,
            coat: &CoatTable::BLACK,
        }
    }

    fn is_uniform(&self) -> bool {
        self.diffuse_reflectance.is_constant() && self.specular_reflectance.is_constant()
    }

    #[inline(always)]
    fn coat(&self) -> &CoatTable {
        &self.table
    }
}

/// A resolved rough coat over a matt base. `C` looks up the coat's transmission.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoughPlasticClosure<C, R = f32> {
    /// The base's reflectance with internal reflections, divided by the squared index.
    base: SpectrumLanes<R>,
    /// The base's reflectance alone, used to select lobes.
    reflectance: SpectrumLanes<R>,
    specular: SpectrumLanes<R>,
    microfacets: Microfacets<R>,
    eta: R,
    coat: C,
}

columns!(RoughPlasticClosure { base, reflectance, specular, microfacets, eta; coat });

impl<C: Coats<R>, R: Real> RoughPlasticClosure<C, R> {
    /// The probability of sampling the coat, given the fraction `entering` that it transmits.
    #[inline(always)]
    fn specular_probability(&self, entering: R) -> R {
        specular_probability(self.specular, self.reflectance, -entering + 1.0)
    }

    /// The value and density, given the fraction `entering` of light from `wi` that the coat
    /// transmits.
    #[inline(always)]
    fn eval_pdf_entering(
        &self,
        entering: R,
        wi: Vector3<R>,
        wo: Vector3<R>,
    ) -> (SpectrumLanes<R>, R) {
        let above = wi.z.above(0.0) & wo.z.above(0.0);
        let nothing = (SpectrumLanes::grey(wi.z.zero()), wi.z.zero());
        if !above.any() {
            return nothing;
        }
        let probability = self.specular_probability(entering);
        let m = (wi + wo).normalize_or_zero();
        let reflection = self.microfacets.reflection(wi, wo, m);
        let reflected = fresnel::dielectric(wi.dot(m), self.eta).reflectance;
        let cosine = cosine_hemisphere::pdf_lanes(wo);
        let value = self.specular * (reflected * reflection.value)
            + self.base * (cosine * entering * self.coat.entering(wo.z));
        let pdf = probability * reflection.pdf + (-probability + 1.0) * cosine;
        (SpectrumLanes::select(above, value, nothing.0), R::select(above, pdf, nothing.1))
    }
}

impl<C: Coats<R>, R: Real> LaneClosure<R> for RoughPlasticClosure<C, R> {
    #[inline(always)]
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        _transport: Transport,
    ) -> (SpectrumLanes<R>, R) {
        self.eval_pdf_entering(self.coat.entering(wi.z), wi, wo)
    }

    #[inline(always)]
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        lobe: R,
        direction: Vector2<R>,
        _transport: Transport,
    ) -> SampleLanes<R> {
        if !wi.z.above(0.0).any() {
            return SampleLanes::none(wi);
        }
        let entering = self.coat.entering(wi.z);
        let is_specular = lobe.lt(self.specular_probability(entering));
        let mut wo = wi;
        if is_specular.any() {
            // Lanes that sample the base need no search.
            let x = R::select(is_specular, direction.x, direction.x.like(0.5));
            let m = self.microfacets.sample(wi, Vector2::new(x, direction.y));
            wo = fresnel::reflect_lanes(wi, m);
        }
        if !is_specular.all() {
            wo = Vector3::select(is_specular, wo, cosine_hemisphere::sample_lanes(direction));
        }
        let (value, pdf) = self.eval_pdf_entering(entering, wi, wo);
        let exists = pdf.above(0.0);
        SampleLanes { wo, weight: value * pdf.reciprocal(), pdf, exists, ..SampleLanes::smooth(wi) }
    }
}

impl HitClosure for RoughPlasticClosure<&CoatTable> {
    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        if wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let entering = self.coat.entering(wi.z);
        // The diffuse light that leaves through the coat: 1 − F from inside, and η² because `base`
        // is already divided by it.
        let leaving = (1.0 - self.coat.internal_diffuse_reflectance) * self.eta * self.eta;
        (self.specular * (1.0 - entering) + self.base * (entering * leaving)).into()
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::material::{TestMaterial, assert_finds};
    use crate::texture::Texture;
    use etendue_document::{Fault, Severity};
    use glam::Vec3;

    #[test]
    fn a_texture_of_the_roughness_is_averaged_aloud() {
        assert_finds(
            r#"<bsdf type="roughplastic"><texture name="alpha" type="checkerboard"/></bsdf>"#,
            Severity::Warning,
            Fault::Approximation,
            "mean",
        );
    }

    #[test]
    fn textures_are_read_at_the_hit() {
        let mut material = TestMaterial::read(
            r#"<bsdf type="roughplastic"><texture name="diffuse_reflectance" type="checkerboard"/></bsdf>"#,
        );
        let bright = material.bsdf(Vec3::Z).albedo(Vec3::Z);
        material.textures = vec![Texture::Constant(etendue_spectrum::Spectrum::ZERO)];
        let black = material.bsdf(Vec3::Z).albedo(Vec3::Z);
        // Without its base, the coat alone reflects about 4 %.
        assert!(black[0] > 0.03 && black[0] < 0.05 && bright[0] > 0.2, "{black:?} {bright:?}");
    }
}
