//! `null`: a surface that light passes straight through, wholly or in part.

use super::{BsdfSample, Closure, ClosureMaterial, Lobe, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::Manual;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "No surface at all: light goes straight through. It marks where a medium ends.",
    parameters: &[],
    sample: r#"<bsdf type="null"/>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        lossless(r#"<bsdf type="null"/>"#),
    ],
    extreme: &[
        r#"<bsdf type="mask"><float name="opacity" value="1e-30"/><bsdf type="null"/></bsdf>"#,
    ],
    batched: &[],
};

/// A surface that deflects no light: either invisible or a filter.
#[derive(Clone, Copy, Debug)]
pub struct Null {
    transmittance: ColorSource,
    /// A factor on the transmittance.
    share: f32,
}

/// Reads the parameters: there are none.
pub fn build(_builder: &mut Builder<'_>, _parameters: &Parameters<'_>) -> Option<Null> {
    Some(Null { transmittance: ColorSource::Constant(Spectrum::ONE), share: 1.0 })
}

impl Null {
    /// A filter that passes the fraction `share` of a transmittance.
    #[must_use]
    pub fn filter(transmittance: ColorSource, share: f32) -> Self {
        Self { transmittance, share }
    }
}

impl ClosureMaterial for Null {
    type Closure<'a> = NullClosure;

    const IS_DELTA: bool = true;

    fn transmits(&self) -> bool {
        true
    }

    #[inline]
    fn resolve<'a>(&'a self, textures: Textures<'a>, surface: &SurfaceInteraction) -> NullClosure {
        NullClosure { transmittance: self.transmittance.eval(textures, surface) * self.share }
    }
}

/// Light passes straight through, scaled by the transmittance.
#[derive(Clone, Copy, Debug)]
pub struct NullClosure {
    transmittance: Spectrum,
}

impl NullClosure {
    /// All light passes straight through.
    pub const CLEAR: Self = Self { transmittance: Spectrum::ONE };
}

impl Closure for NullClosure {
    #[inline]
    fn eval_pdf(&self, _wi: Vec3, _wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        (Spectrum::ZERO, 0.0)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        _lobe: f32,
        _direction: Vec2,
        _transport: Transport,
    ) -> Option<BsdfSample> {
        let weight = self.transmittance;
        Some(BsdfSample { wo: -wi, weight, pdf: 1.0, eta: 1.0, lobe: Lobe::Null })
    }

    #[inline]
    fn null_transmission(&self, _wi: Vec3) -> (Spectrum, f32) {
        (self.transmittance, 1.0)
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }

    fn albedo(&self, _wi: Vec3) -> Spectrum {
        self.transmittance
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::{Lobe, Transport};
    use crate::testing::material::TestMaterial;
    use etendue_spectrum::Spectrum;
    use glam::{Vec2, Vec3};

    #[test]
    fn light_goes_straight_on() {
        let material = TestMaterial::read(r#"<bsdf type="null"/>"#);
        let wi = Vec3::new(0.6, 0.0, -0.8);
        let bsdf = material.bsdf(wi);
        assert!(!bsdf.has_smooth_lobe());
        let sample = bsdf.sample(wi, 0.5, Vec2::ZERO, Transport::Radiance).expect("a sample");
        assert_eq!((sample.wo, sample.lobe, sample.pdf), (-wi, Lobe::Null, 1.0));
        assert_eq!(bsdf.null_transmission(wi), (Spectrum::ONE, 1.0));
    }
}
