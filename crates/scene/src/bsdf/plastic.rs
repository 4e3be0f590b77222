//! `plastic`: a smooth clear coat over a matt base.

use super::conductor::SPECULAR_REFLECTANCE;
use super::dielectric::EXT_IOR;
use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::{Manual, ParameterManual, parameter};
use crate::models::bsdf_inputs::{
    ColorShift, coated_base, internal_diffuse_reflectance, reflectance, relative_index,
    specular_probability,
};
use crate::models::fresnel;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless, plain};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_math::lanes::{Mask as _, Real, Vector2, Vector3};
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

/// The matt base, shared with the rough coat.
pub(crate) const DIFFUSE_REFLECTANCE: ParameterManual = parameter(
    "diffuse_reflectance",
    "spectrum or texture",
    "0.5",
    "The share of light that the base under the coat scatters.",
);
/// The index of the coat.
pub(crate) const INT_IOR: ParameterManual = parameter(
    "int_ior",
    "float or string",
    "polypropylene",
    "The index of refraction of the coat: a number, or a name.",
);
/// How internal scattering affects colours.
pub(crate) const NONLINEAR: ParameterManual = parameter(
    "nonlinear",
    "boolean",
    "false",
    "Whether scattering inside the coat shifts the colour of the base, as in reality.",
);

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Polished plastic: a matt base under a smooth clear coat, with all the light that goes \
              back and forth between them. Black from behind; see `twosided`.",
    parameters: &[DIFFUSE_REFLECTANCE, SPECULAR_REFLECTANCE, INT_IOR, EXT_IOR, NONLINEAR],
    sample: r#"<bsdf type="plastic">
    <rgb name="diffuse_reflectance" value="0.1, 0.27, 0.36"/>
    <float name="int_ior" value="1.9"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="plastic"><boolean name="nonlinear" value="true"/></bsdf>"#),
        lossless(r#"<bsdf type="plastic"><float name="diffuse_reflectance" value="1"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="plastic"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/><float name="diffuse_reflectance" value="0"/></bsdf>"#,
        r#"<bsdf type="plastic"><float name="int_ior" value="0.5"/><float name="diffuse_reflectance" value="1"/><boolean name="nonlinear" value="true"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="plastic"/>"#,
        r#"<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0, 0.5, 1"/><boolean name="nonlinear" value="true"/></bsdf>"#,
        r#"<bsdf type="plastic"><float name="diffuse_reflectance" value="0"/><float name="specular_reflectance" value="0"/></bsdf>"#,
        r#"<bsdf type="twosided"><bsdf type="plastic"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/><texture name="diffuse_reflectance" type="checkerboard"/></bsdf></bsdf>"#,
    ],
};

/// A smooth coat over a matt base.
#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    diffuse_reflectance: ColorSource,
    specular_reflectance: ColorSource,
    eta: f32,
    shift: ColorShift,
    /// The fraction of diffuse light that the coat reflects back inside.
    internal_diffuse_reflectance: f32,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Plastic> {
    let eta = relative_index(builder, parameters, "polypropylene");
    Some(Plastic {
        diffuse_reflectance: reflectance(builder, parameters, "diffuse_reflectance", 0.5),
        specular_reflectance: reflectance(builder, parameters, "specular_reflectance", 1.0),
        eta,
        shift: ColorShift::read(parameters),
        internal_diffuse_reflectance: internal_diffuse_reflectance(eta),
    })
}

impl ClosureMaterial for Plastic {
    type Closure<'a> = PlasticClosure;

    fn transmits(&self) -> bool {
        false
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> PlasticClosure {
        let reflectance = self.diffuse_reflectance.eval(textures, surface);
        let base = coated_base(reflectance, self.internal_diffuse_reflectance, self.shift)
            / (self.eta * self.eta);
        PlasticClosure {
            base: base.into(),
            reflectance: reflectance.into(),
            specular: self.specular_reflectance.eval(textures, surface).into(),
            eta: self.eta,
            internal_diffuse_reflectance: self.internal_diffuse_reflectance,
        }
    }
}

impl LaneMaterial for Plastic {
    type Variant = ();
    type Blank = PlasticClosure;

    fn variant(&self) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn blank((): ()) -> Self::Blank {
        PlasticClosure::default()
    }

    fn is_uniform(&self) -> bool {
        self.diffuse_reflectance.is_constant() && self.specular_reflectance.is_constant()
    }
}

/// A resolved smooth coat over a matt base.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlasticClosure<R = f32> {
    /// The base's reflectance with internal reflections, divided by the squared index.
    base: SpectrumLanes<R>,
    /// The base's reflectance alone, used to select lobes.
    reflectance: SpectrumLanes<R>,
    specular: SpectrumLanes<R>,
    eta: R,
    internal_diffuse_reflectance: R,
}

columns!(PlasticClosure { base, reflectance, specular, eta, internal_diffuse_reflectance });

impl<R: Real> PlasticClosure<R> {
    /// The fraction of light that the coat transmits.
    #[inline(always)]
    fn transmitted(&self, cosine: R) -> R {
        -fresnel::dielectric(cosine, self.eta).reflectance + 1.0
    }

    /// The probability of sampling the mirror, given the fraction `entering` that the coat
    /// transmits.
    #[inline(always)]
    fn specular_probability(&self, entering: R) -> R {
        specular_probability(self.specular, self.reflectance, -entering + 1.0)
    }

    /// The base's value and density. `wi` is above the surface; the coat transmits the fraction
    /// `entering` of its light.
    #[inline(always)]
    fn eval_pdf_entering(&self, entering: R, wo: Vector3<R>) -> (SpectrumLanes<R>, R) {
        let cosine = cosine_hemisphere::pdf_lanes(wo);
        let value = self.base * (cosine * entering * self.transmitted(wo.z));
        (value, cosine * (-self.specular_probability(entering) + 1.0))
    }
}

impl<R: Real> LaneClosure<R> for PlasticClosure<R> {
    #[inline(always)]
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        _transport: Transport,
    ) -> (SpectrumLanes<R>, R) {
        let above = wi.z.above(0.0) & wo.z.above(0.0);
        let nothing = (SpectrumLanes::grey(wi.z.zero()), wi.z.zero());
        if !above.any() {
            return nothing;
        }
        let (value, pdf) = self.eval_pdf_entering(self.transmitted(wi.z), wo);
        (SpectrumLanes::select(above, value, nothing.0), R::select(above, pdf, nothing.1))
    }

    #[inline(always)]
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        lobe: R,
        direction: Vector2<R>,
        _transport: Transport,
    ) -> SampleLanes<R> {
        let above = wi.z.above(0.0);
        if !above.any() {
            return SampleLanes::none(wi);
        }
        let entering = self.transmitted(wi.z);
        let probability = self.specular_probability(entering);
        let is_specular = lobe.lt(probability);
        let weight = self.specular * ((-entering + 1.0) / probability);
        let (wo, pdf, exists) = (fresnel::mirror(wi), probability, above);
        let mirrored = SampleLanes { wo, weight, pdf, exists, ..SampleLanes::none(wi) };
        if is_specular.all() {
            return mirrored;
        }
        let wo = cosine_hemisphere::sample_lanes(direction);
        let (value, pdf) = self.eval_pdf_entering(entering, wo);
        let (weight, exists) = (value * pdf.reciprocal(), above & pdf.above(0.0));
        let base = SampleLanes { wo, weight, pdf, exists, ..SampleLanes::smooth(wi) };
        SampleLanes::select(is_specular, mirrored, base)
    }
}

impl HitClosure for PlasticClosure {
    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        if wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let entering = self.transmitted(wi.z);
        // The diffuse light that leaves through the coat: 1 − F from inside, and η² because `base`
        // is already divided by it.
        let leaving = (1.0 - self.internal_diffuse_reflectance) * self.eta * self.eta;
        (self.specular * (1.0 - entering) + self.base * (entering * leaving)).into()
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::testing::material::TestMaterial;
    use glam::Vec3;

    #[test]
    fn scattering_inside_darkens_and_saturates() {
        let base = r#"<rgb name="diffuse_reflectance" value="0.2, 0.5, 0.8"/>"#;
        let value = |nonlinear: bool| {
            let xml = format!(
                r#"<bsdf type="plastic">{base}<boolean name="nonlinear" value="{nonlinear}"/></bsdf>"#
            );
            TestMaterial::read(&xml).bsdf(Vec3::Z).eval_pdf(Vec3::Z, Vec3::Z, Transport::Radiance).0
        };
        let (kept, shifted) = (value(false), value(true));
        assert!((kept[2] / kept[0] - 4.0).abs() < 1e-4);
        assert!(shifted[2] / shifted[0] > 4.5);
        assert!((kept - shifted).min_component() > 0.0);
    }

    #[test]
    fn a_coat_of_the_outer_index_is_not_there() {
        let bare = TestMaterial::read(
            r#"<bsdf type="plastic"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/>
               </bsdf>"#,
        );
        let matt = TestMaterial::read(r#"<bsdf type="diffuse"/>"#);
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let [bare, matt] = [&bare, &matt]
            .map(|material| material.bsdf(Vec3::Z).eval_pdf(Vec3::Z, wo, Transport::Radiance));
        assert!((bare.0 - matt.0).abs().max_component() < 1e-6);
        assert!((bare.1 - matt.1).abs() < 1e-6);
    }
}
