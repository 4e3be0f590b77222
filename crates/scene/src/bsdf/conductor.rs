//! `conductor`: a smooth metal.

use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::{Manual, ParameterManual, parameter};
use crate::models::bsdf_inputs::{MetalIndex, reflectance};
use crate::models::fresnel;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless, plain};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_math::lanes::{Mask as _, Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

/// The parameters of the complex index, shared with the rough metal.
pub(crate) const MATERIAL: ParameterManual = parameter(
    "material",
    "string",
    "none",
    "A measured metal, such as `Au`, `Ag`, `Al`, `Cu`; `none` is a perfect mirror.",
);
/// See [`MATERIAL`].
pub(crate) const ETA: ParameterManual = parameter(
    "eta",
    "spectrum or texture",
    "",
    "The real part of the index of refraction, instead of a `material`.",
);
/// See [`MATERIAL`].
pub(crate) const K: ParameterManual = parameter(
    "k",
    "spectrum or texture",
    "",
    "The imaginary part of the index of refraction, instead of a `material`.",
);
/// See [`MATERIAL`].
pub(crate) const EXT_ETA: ParameterManual = parameter(
    "ext_eta",
    "float or string",
    "",
    "The index of refraction of what is around the metal, a number or a name; `eta` and `k` are \
     divided by it. Vacuum where it is not given.",
);
/// The reflection factor that most materials have.
pub(crate) const SPECULAR_REFLECTANCE: ParameterManual = parameter(
    "specular_reflectance",
    "spectrum or texture",
    "1",
    "A factor on the specular reflection. Real surfaces have 1.",
);

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A polished metal, or a perfect mirror. Black from behind; see `twosided`.",
    parameters: &[MATERIAL, ETA, K, EXT_ETA, SPECULAR_REFLECTANCE],
    sample: r#"<bsdf type="conductor">
    <string name="material" value="Au"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#),
        lossless(r#"<bsdf type="conductor"/>"#),
    ],
    extreme: &[
        r#"<bsdf type="conductor"><float name="eta" value="0"/><float name="k" value="0"/></bsdf>"#,
        r#"<bsdf type="conductor"><float name="eta" value="1e30"/><float name="k" value="1e30"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#,
        r#"<bsdf type="conductor"/>"#,
        r#"<bsdf type="conductor"><float name="eta" value="0"/><float name="k" value="0"/></bsdf>"#,
        r#"<bsdf type="twosided"><bsdf type="conductor"><texture name="specular_reflectance" type="checkerboard"/></bsdf></bsdf>"#,
    ],
};

/// A smooth metal.
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    index: MetalIndex,
    specular_reflectance: ColorSource,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Conductor> {
    let index = MetalIndex::read(builder, parameters);
    let specular_reflectance = reflectance(builder, parameters, "specular_reflectance", 1.0);
    Some(Conductor { index, specular_reflectance })
}

impl ClosureMaterial for Conductor {
    type Closure<'a> = ConductorClosure;

    const IS_DELTA: bool = true;

    fn transmits(&self) -> bool {
        false
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> ConductorClosure {
        let [eta, k] = self.index.resolve(textures, surface);
        let specular = self.specular_reflectance.eval(textures, surface).into();
        ConductorClosure { eta: eta.into(), k: k.into(), specular }
    }
}

impl LaneMaterial for Conductor {
    type Variant = ();
    type Blank = ConductorClosure;

    fn variant(&self) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn blank((): ()) -> Self::Blank {
        ConductorClosure::default()
    }

    fn is_uniform(&self) -> bool {
        self.index.is_uniform() && self.specular_reflectance.is_constant()
    }
}

/// A resolved smooth metal.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConductorClosure<R = f32> {
    eta: SpectrumLanes<R>,
    k: SpectrumLanes<R>,
    specular: SpectrumLanes<R>,
}

columns!(ConductorClosure { eta, k, specular });

impl<R: Real> LaneClosure<R> for ConductorClosure<R> {
    #[inline(always)]
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        _wo: Vector3<R>,
        _transport: Transport,
    ) -> (SpectrumLanes<R>, R) {
        (SpectrumLanes::grey(wi.z.zero()), wi.z.zero())
    }

    #[inline(always)]
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        _lobe: R,
        _direction: Vector2<R>,
        _transport: Transport,
    ) -> SampleLanes<R> {
        let exists = wi.z.above(0.0);
        if !exists.any() {
            return SampleLanes::none(wi);
        }
        let weight = fresnel::conductor(wi.z, self.eta, self.k) * self.specular;
        let (wo, pdf) = (fresnel::mirror(wi), wi.z.like(1.0));
        SampleLanes { wo, weight, pdf, exists, ..SampleLanes::none(wi) }
    }
}

impl HitClosure for ConductorClosure {
    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
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
    use crate::bsdf::{Lobe, Transport};
    use crate::testing::material::{TestMaterial, assert_finds, assert_same};
    use etendue_document::{Fault, Severity};
    use glam::{Vec2, Vec3};

    #[test]
    fn without_parameters_it_is_a_perfect_mirror() {
        let mirror = TestMaterial::read(r#"<bsdf type="conductor"/>"#);
        let wi = Vec3::new(0.6, 0.0, 0.8);
        let sample = mirror.bsdf(wi).sample(wi, 0.5, Vec2::ZERO, Transport::Radiance);
        let sample = sample.expect("a mirror always reflects");
        assert_eq!((sample.wo, sample.lobe), (Vec3::new(-0.6, 0.0, 0.8), Lobe::Delta));
        assert_eq!(sample.weight.rgb(), [1.0; 3]);
        assert_same(
            r#"<bsdf type="conductor"><string name="material" value="none"/></bsdf>"#,
            r#"<bsdf type="conductor"/>"#,
        );
    }

    #[test]
    fn the_index_outside_divides_both_parts() {
        assert_same(
            r#"<bsdf type="conductor"><float name="eta" value="3"/><float name="k" value="5"/>
               <float name="ext_eta" value="2"/></bsdf>"#,
            r#"<bsdf type="conductor"><float name="eta" value="1.5"/><float name="k" value="2.5"/>
               </bsdf>"#,
        );
    }

    #[test]
    fn unknown_and_superfluous_metals_are_found() {
        assert_finds(
            r#"<bsdf type="conductor"><string name="material" value="Unobtainium"/></bsdf>"#,
            Severity::Error,
            Fault::BadValue,
            "no metal `Unobtainium`",
        );
        assert_finds(
            r#"<bsdf type="conductor"><string name="material" value="Au"/>
               <float name="eta" value="3"/><float name="k" value="5"/></bsdf>"#,
            Severity::Warning,
            Fault::BadValue,
            "no effect",
        );
    }
}
