//! `thindielectric`: a pane of glass without thickness.

use super::conductor::SPECULAR_REFLECTANCE;
use super::dielectric::{EXT_IOR, INT_IOR, SPECULAR_TRANSMITTANCE};
use super::inputs::{reflectance, relative_index};
use super::{BsdfSample, Closure, Lobe, Transport, fresnel};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::Manual;
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A thin pane, such as a window, as a single surface: light goes straight through or \
              is mirrored, after any number of reflections between the pane's two faces.",
    parameters: &[INT_IOR, EXT_IOR, SPECULAR_REFLECTANCE, SPECULAR_TRANSMITTANCE],
    sample: r#"<bsdf type="thindielectric">
    <string name="int_ior" value="bk7"/>
</bsdf>"#,
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

impl ThinDielectric {
    /// Reads the textures at a hit.
    #[inline]
    #[must_use]
    pub fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> ThinDielectricClosure {
        ThinDielectricClosure {
            reflectance: self.specular_reflectance.eval(textures, surface),
            transmittance: self.specular_transmittance.eval(textures, surface),
            eta: self.eta,
        }
    }
}

/// A resolved thin dielectric pane.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectricClosure {
    reflectance: Spectrum,
    transmittance: Spectrum,
    eta: f32,
}

impl ThinDielectricClosure {
    /// The share of light that the pane reflects: with R at one face and T = 1 − R, the sum
    /// R + T²R + T²R³ + … = 2R / (1 + R).
    #[inline]
    fn reflected(&self, wi: Vec3) -> f32 {
        let once = fresnel::dielectric(wi.z.abs(), self.eta).reflectance;
        2.0 * once / (1.0 + once)
    }
}

impl Closure for ThinDielectricClosure {
    #[inline]
    fn eval_pdf(&self, _wi: Vec3, _wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        (Spectrum::ZERO, 0.0)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        _direction: Vec2,
        _transport: Transport,
    ) -> Option<BsdfSample> {
        let reflected = self.reflected(wi);
        if lobe < reflected {
            let wo = Vec3::new(-wi.x, -wi.y, wi.z);
            let weight = self.reflectance;
            return Some(BsdfSample { wo, weight, pdf: reflected, eta: 1.0, lobe: Lobe::Delta });
        }
        let pdf = 1.0 - reflected;
        let weight = self.transmittance;
        (pdf > 0.0).then_some(BsdfSample { wo: -wi, weight, pdf, eta: 1.0, lobe: Lobe::Null })
    }

    fn straight(&self, wi: Vec3) -> (Spectrum, f32) {
        let passed = 1.0 - self.reflected(wi);
        (self.transmittance * passed, passed)
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        let reflected = self.reflected(wi);
        self.reflectance * reflected + self.transmittance * (1.0 - reflected)
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::testing::TestMaterial;
    use crate::bsdf::{Lobe, Transport};
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
