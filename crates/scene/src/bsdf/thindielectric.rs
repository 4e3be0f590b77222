//! `thindielectric`: a glass pane of zero thickness.

use super::conductor::SPECULAR_REFLECTANCE;
use super::dielectric::{EXT_IOR, INT_IOR, SPECULAR_TRANSMITTANCE};
use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::Manual;
use crate::models::bsdf_inputs::{reflectance, relative_index};
use crate::models::fresnel;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A thin pane, such as a window, as a single surface: light goes straight through or \
              is mirrored, after any number of reflections between the pane's two faces.",
    parameters: &[INT_IOR, EXT_IOR, SPECULAR_REFLECTANCE, SPECULAR_TRANSMITTANCE],
    sample: r#"<bsdf type="thindielectric">
    <string name="int_ior" value="bk7"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        lossless(r#"<bsdf type="thindielectric"/>"#),
    ],
    extreme: &[
        r#"<bsdf type="thindielectric"><float name="int_ior" value="1000"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="thindielectric"/>"#,
        r#"<bsdf type="thindielectric"><string name="int_ior" value="diamond"/></bsdf>"#,
        r#"<bsdf type="thindielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/></bsdf>"#,
        r#"<bsdf type="thindielectric"><texture name="specular_reflectance" type="checkerboard"/></bsdf>"#,
    ],
};

/// A thin dielectric pane.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric {
    eta: f32,
    specular_reflectance: ColorSource,
    specular_transmittance: ColorSource,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<ThinDielectric> {
    Some(ThinDielectric {
        eta: relative_index(builder, parameters, "bk7"),
        specular_reflectance: reflectance(builder, parameters, "specular_reflectance", 1.0),
        specular_transmittance: reflectance(builder, parameters, "specular_transmittance", 1.0),
    })
}

impl ClosureMaterial for ThinDielectric {
    type Closure<'a> = ThinDielectricClosure;

    const IS_DELTA: bool = true;

    fn transmits(&self) -> bool {
        true
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> ThinDielectricClosure {
        ThinDielectricClosure {
            reflectance: self.specular_reflectance.eval(textures, surface).into(),
            transmittance: self.specular_transmittance.eval(textures, surface).into(),
            eta: self.eta,
        }
    }
}

impl LaneMaterial for ThinDielectric {
    type Variant = ();
    type Blank = ThinDielectricClosure;

    fn variant(&self) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn blank((): ()) -> Self::Blank {
        ThinDielectricClosure::default()
    }

    fn is_uniform(&self) -> bool {
        self.specular_reflectance.is_constant() && self.specular_transmittance.is_constant()
    }
}

/// A resolved thin dielectric pane.
#[derive(Clone, Copy, Debug, Default)]
pub struct ThinDielectricClosure<R = f32> {
    reflectance: SpectrumLanes<R>,
    transmittance: SpectrumLanes<R>,
    eta: R,
}

columns!(ThinDielectricClosure { reflectance, transmittance, eta });

impl<R: Real> ThinDielectricClosure<R> {
    /// The fraction of light that the pane reflects at a cosine. With R at one face and T = 1 − R,
    /// the sum is R + T²R + T²R³ + … = 2R / (1 + R).
    #[inline(always)]
    fn reflected(&self, cosine: R) -> R {
        let once = fresnel::dielectric(cosine.abs(), self.eta).reflectance;
        once * 2.0 / (once + 1.0)
    }
}

impl<R: Real> LaneClosure<R> for ThinDielectricClosure<R> {
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
        lobe: R,
        _direction: Vector2<R>,
        _transport: Transport,
    ) -> SampleLanes<R> {
        let reflected = self.reflected(wi.z);
        let reflects = lobe.lt(reflected);
        let passed = -reflected + 1.0;
        SampleLanes {
            wo: Vector3::select(reflects, fresnel::mirror(wi), -wi),
            weight: SpectrumLanes::select(reflects, self.reflectance, self.transmittance),
            pdf: R::select(reflects, reflected, passed),
            exists: reflects | passed.above(0.0),
            null: !reflects,
            ..SampleLanes::none(wi)
        }
    }
}

impl HitClosure for ThinDielectricClosure {
    fn null_transmission(&self, wi: Vec3) -> (Spectrum, f32) {
        let passed = 1.0 - self.reflected(wi.z);
        ((self.transmittance * passed).into(), passed)
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        let reflected = self.reflected(wi.z);
        (self.reflectance * reflected + self.transmittance * (1.0 - reflected)).into()
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::{Lobe, Transport};
    use crate::testing::material::TestMaterial;
    use glam::{Vec2, Vec3};

    #[test]
    fn the_bounces_within_the_pane_add_up() {
        let pane = TestMaterial::read(
            r#"<bsdf type="thindielectric"><float name="int_ior" value="1.5"/>
               <float name="ext_ior" value="1"/></bsdf>"#,
        );
        // One face reflects 4 %: R + T² R (1 + R² + R⁴ + …).
        let series =
            (0..20).fold(0.04, |sum, bounce| sum + 0.96 * 0.96 * 0.04_f64.powi(2 * bounce + 1));
        for wi in [Vec3::Z, -Vec3::Z] {
            let sample = pane.bsdf(wi).sample(wi, 0.0, Vec2::ZERO, Transport::Radiance);
            let sample = sample.expect("a reflection");
            assert!((f64::from(sample.pdf) - series).abs() < 1e-6);
            let through = pane.bsdf(wi).sample(wi, 0.9, Vec2::ZERO, Transport::Radiance);
            let through = through.expect("a transmission");
            assert_eq!((through.wo, through.lobe, through.eta), (-wi, Lobe::Null, 1.0));
        }
    }
}
