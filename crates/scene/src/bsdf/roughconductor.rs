//! `roughconductor`: a rough metal with microfacets.

use super::conductor::{ETA, EXT_ETA, K, MATERIAL, SPECULAR_REFLECTANCE};
use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::{Manual, ParameterManual, parameter};
use crate::models::bsdf_inputs::{MetalIndex, Roughness, reflectance};
use crate::models::fresnel;
use crate::models::microfacet::{Distribution, Microfacets};
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_math::lanes::{Mask as _, Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

/// The roughness parameters, shared with the other rough materials.
pub(crate) const ALPHA: ParameterManual = parameter(
    "alpha",
    "float or texture",
    "0.1",
    "The roughness, from 0.001 (nearly smooth) over 0.1 to 0.7 (very rough). For Beckmann's \
     distribution it is √2 times the root mean square of the slope.",
);
/// See [`ALPHA`].
pub(crate) const ALPHA_U: ParameterManual =
    parameter("alpha_u", "float or texture", "", "The roughness along the tangent.");
/// See [`ALPHA`].
pub(crate) const ALPHA_V: ParameterManual =
    parameter("alpha_v", "float or texture", "", "The roughness along the bitangent.");
/// See [`ALPHA`].
pub(crate) const DISTRIBUTION: ParameterManual = parameter(
    "distribution",
    "string",
    "beckmann",
    "How microfacet normals are distributed: `beckmann` or `ggx`.",
);
/// See [`ALPHA`].
pub(crate) const SAMPLE_VISIBLE: ParameterManual = parameter(
    "sample_visible",
    "boolean",
    "true",
    "Whether only those normals are sampled that can be seen. Without it pictures are noisier.",
);

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A rough metal: a microfacet surface (Walter et al., *Microfacet Models for Refraction \
              through Rough Surfaces*, 2007). Black from behind; see `twosided`.",
    parameters: &[
        MATERIAL,
        ETA,
        K,
        EXT_ETA,
        SPECULAR_REFLECTANCE,
        ALPHA,
        ALPHA_U,
        ALPHA_V,
        DISTRIBUTION,
        SAMPLE_VISIBLE,
    ],
    sample: r#"<bsdf type="roughconductor">
    <string name="material" value="Al"/>
    <string name="distribution" value="ggx"/>
    <float name="alpha_u" value="0.05"/>
    <float name="alpha_v" value="0.3"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="roughconductor"><string name="material" value="Cu"/><float name="alpha" value="0.02"/></bsdf>"#),
        plain(r#"<bsdf type="roughconductor"><float name="alpha" value="0.3"/></bsdf>"#),
        plain(r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.6"/></bsdf>"#),
        plain(r#"<bsdf type="roughconductor"><float name="alpha" value="0.4"/><boolean name="sample_visible" value="false"/></bsdf>"#),
        plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.05"/></bsdf>"#),
        plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.7"/></bsdf>"#),
        plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value="0.5"/><float name="alpha_v" value="0.1"/></bsdf>"#),
        plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.3"/><boolean name="sample_visible" value="false"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="roughconductor"><float name="alpha" value="0"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><float name="alpha" value="0.001"/><string name="material" value="Au"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><float name="alpha" value="10000"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><float name="alpha_u" value="0"/><float name="alpha_v" value="5"/><string name="distribution" value="ggx"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><float name="alpha" value="0.001"/><string name="distribution" value="ggx"/><float name="eta" value="0"/><float name="k" value="0"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><float name="alpha" value="100"/><string name="distribution" value="ggx"/><float name="eta" value="1e30"/><float name="k" value="1e30"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><float name="alpha" value="0.001"/><boolean name="sample_visible" value="false"/><float name="eta" value="1"/><float name="k" value="0"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="roughconductor"><string name="distribution" value="beckmann"/><string name="material" value="Cu"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><string name="distribution" value="beckmann"/><float name="alpha" value="0"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><string name="distribution" value="beckmann"/><float name="alpha_u" value="0.001"/><float name="alpha_v" value="10000"/></bsdf>"#,
        r#"<bsdf type="twosided"><bsdf type="roughconductor"><string name="distribution" value="beckmann"/><float name="alpha_u" value="0.3"/><texture name="alpha_v" type="checkerboard"/></bsdf></bsdf>"#,
        r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><string name="material" value="Cu"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value="0.001"/><float name="alpha_v" value="10000"/></bsdf>"#,
        r#"<bsdf type="twosided"><bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value="0.3"/><texture name="alpha_v" type="checkerboard"/></bsdf></bsdf>"#,
    ],
};

/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor {
    index: MetalIndex,
    specular_reflectance: ColorSource,
    roughness: Roughness,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<RoughConductor> {
    let index = MetalIndex::read(builder, parameters);
    let specular_reflectance = reflectance(builder, parameters, "specular_reflectance", 1.0);
    let roughness = Roughness::read(builder, parameters);
    Some(RoughConductor { index, specular_reflectance, roughness })
}

impl ClosureMaterial for RoughConductor {
    type Closure<'a> = RoughConductorClosure;

    fn transmits(&self) -> bool {
        false
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> RoughConductorClosure {
        let [eta, k] = self.index.resolve(textures, surface);
        RoughConductorClosure {
            eta: eta.into(),
            k: k.into(),
            specular: self.specular_reflectance.eval(textures, surface).into(),
            microfacets: self.roughness.resolve(textures, surface),
        }
    }
}

impl LaneMaterial for RoughConductor {
    type Variant = Distribution;
    type Blank = RoughConductorClosure;

    fn variant(&self) -> Option<Distribution> {
        self.roughness.visible_distribution()
    }

    #[inline(always)]
    fn blank(distribution: Distribution) -> Self::Blank {
        let [eta, k, specular] = Default::default();
        RoughConductorClosure { eta, k, specular, microfacets: Microfacets::visible(distribution) }
    }

    fn is_uniform(&self) -> bool {
        self.index.is_uniform()
            && self.specular_reflectance.is_constant()
            && self.roughness.is_uniform()
    }
}

/// A resolved rough metal.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductorClosure<R = f32> {
    eta: SpectrumLanes<R>,
    k: SpectrumLanes<R>,
    specular: SpectrumLanes<R>,
    microfacets: Microfacets<R>,
}

columns!(RoughConductorClosure { eta, k, specular, microfacets });

impl<R: Real> RoughConductorClosure<R> {
    /// The value and density for microfacets of normal `m` between `wi` and `wo`; zero unless both
    /// are `above` the surface.
    #[inline(always)]
    fn eval_pdf_at(
        &self,
        above: R::Mask,
        wi: Vector3<R>,
        wo: Vector3<R>,
        m: Vector3<R>,
    ) -> (SpectrumLanes<R>, R) {
        let reflection = self.microfacets.reflection(wi, wo, m);
        let value = R::select(above, reflection.value, reflection.value.zero());
        let pdf = R::select(above, reflection.pdf, reflection.pdf.zero());
        let cosine = wi.dot(m);
        let cosine = cosine.max(cosine.zero()).min(cosine.like(1.0));
        (fresnel::conductor(cosine, self.eta, self.k) * self.specular * value, pdf)
    }
}

impl<R: Real> LaneClosure<R> for RoughConductorClosure<R> {
    #[inline(always)]
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        _transport: Transport,
    ) -> (SpectrumLanes<R>, R) {
        let above = wi.z.above(0.0) & wo.z.above(0.0);
        if !above.any() {
            return (SpectrumLanes::grey(wi.z.zero()), wi.z.zero());
        }
        self.eval_pdf_at(above, wi, wo, (wi + wo).normalize_or_zero())
    }

    #[inline(always)]
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        _lobe: R,
        direction: Vector2<R>,
        _transport: Transport,
    ) -> SampleLanes<R> {
        let above = wi.z.above(0.0);
        if !above.any() {
            return SampleLanes::none(wi);
        }
        let m = self.microfacets.sample(wi, direction);
        let wo = fresnel::reflect_lanes(wi, m);
        let above = above & wo.z.above(0.0);
        if !above.any() {
            return SampleLanes::none(wi);
        }
        let (value, pdf) = self.eval_pdf_at(above, wi, wo, m);
        let exists = pdf.above(0.0);
        SampleLanes { wo, weight: value * pdf.reciprocal(), pdf, exists, ..SampleLanes::smooth(wi) }
    }
}

impl HitClosure for RoughConductorClosure {
    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        if wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        (fresnel::conductor(wi.z, self.eta, self.k) * self.specular).into()
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::material::{assert_finds, assert_same};
    use etendue_document::{Fault, Severity};

    #[test]
    fn both_directions_default_to_alpha() {
        assert_same(
            r#"<bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf>"#,
            r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.2"/>
               <float name="alpha_v" value="0.2"/></bsdf>"#,
        );
        assert_same(
            r#"<bsdf type="roughconductor"><float name="alpha" value="0.1"/>
               <string name="distribution" value="beckmann"/></bsdf>"#,
            r#"<bsdf type="roughconductor"/>"#,
        );
    }

    #[test]
    fn old_distributions_are_approximated_aloud() {
        for name in ["phong", "as"] {
            assert_finds(
                &format!(
                    r#"<bsdf type="roughconductor"><string name="distribution" value="{name}"/></bsdf>"#
                ),
                Severity::Warning,
                Fault::Approximation,
                "beckmann",
            );
        }
    }

    #[test]
    fn roughness_out_of_range_is_found() {
        for value in ["-0.1", "1e9", "1e39"] {
            assert_finds(
                &format!(
                    r#"<bsdf type="roughconductor"><float name="alpha" value="{value}"/></bsdf>"#
                ),
                Severity::Error,
                Fault::BadValue,
                "alpha",
            );
        }
    }

    #[test]
    fn one_direction_alone_or_all_three_are_found() {
        assert_finds(
            r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.2"/></bsdf>"#,
            Severity::Error,
            Fault::MissingParameter,
            "alpha_v",
        );
        assert_finds(
            r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.2"/>
               <float name="alpha_v" value="0.2"/><float name="alpha" value="0.2"/></bsdf>"#,
            Severity::Error,
            Fault::BadValue,
            "either",
        );
    }
}
