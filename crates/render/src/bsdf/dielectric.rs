//! `dielectric`: smooth glass, water, and other clear matter.

use super::conductor::SPECULAR_REFLECTANCE;
use super::inputs::{reflectance, relative_index};
use super::{BsdfSample, Closure, Lobe, Transport, fresnel};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, ParameterManual, parameter};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The index on the back, for the materials whose default is glass.
pub(super) const INT_IOR: ParameterManual = parameter(
    "int_ior",
    "float or string",
    "bk7",
    "The index of refraction inside: a number, or a name such as `water`, `bk7` or `diamond`.",
);
/// The index on the side of the normal.
pub(super) const EXT_IOR: ParameterManual = parameter(
    "ext_ior",
    "float or string",
    "air",
    "The index of refraction outside, on the side of the normal.",
);
/// The factor on the transmission.
pub(super) const SPECULAR_TRANSMITTANCE: ParameterManual = parameter(
    "specular_transmittance",
    "spectrum or texture",
    "1",
    "A factor on the specular transmission. Real surfaces have 1.",
);

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A smooth interface between two clear substances, such as glass and air: it reflects \
              and refracts. The normal points outside.",
    parameters: &[INT_IOR, EXT_IOR, SPECULAR_REFLECTANCE, SPECULAR_TRANSMITTANCE],
    sample: r#"<bsdf type="dielectric">
    <string name="int_ior" value="water"/>
    <string name="ext_ior" value="air"/>
</bsdf>"#,
};

/// A smooth dielectric interface.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    eta: f32,
    specular_reflectance: ColorSource,
    specular_transmittance: ColorSource,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Dielectric> {
    Some(Dielectric {
        eta: relative_index(builder, parameters, "bk7"),
        specular_reflectance: reflectance(builder, parameters, "specular_reflectance", 1.0),
        specular_transmittance: reflectance(builder, parameters, "specular_transmittance", 1.0),
    })
}

impl Dielectric {
    /// Reads the textures at a hit.
    #[inline]
    #[must_use]
    pub fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> DielectricClosure {
        DielectricClosure {
            reflectance: self.specular_reflectance.eval(textures, surface),
            transmittance: self.specular_transmittance.eval(textures, surface),
            eta: self.eta,
        }
    }
}

/// A resolved smooth dielectric interface.
#[derive(Clone, Copy, Debug)]
pub struct DielectricClosure {
    reflectance: Spectrum,
    transmittance: Spectrum,
    eta: f32,
}

impl Closure for DielectricClosure {
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
        transport: Transport,
    ) -> Option<BsdfSample> {
        let interface = fresnel::dielectric(wi.z, self.eta);
        if lobe < interface.reflectance {
            return Some(BsdfSample {
                wo: Vec3::new(-wi.x, -wi.y, wi.z),
                weight: self.reflectance,
                pdf: interface.reflectance,
                eta: 1.0,
                lobe: Lobe::Delta,
            });
        }
        let pdf = 1.0 - interface.reflectance;
        let scale = radiance_scale(interface.eta_ti, transport);
        let wo =
            Vec3::new(-interface.eta_ti * wi.x, -interface.eta_ti * wi.y, interface.cos_theta_t);
        let weight = self.transmittance * scale;
        (pdf > 0.0).then_some(BsdfSample {
            wo,
            weight,
            pdf,
            eta: interface.eta_it,
            lobe: Lobe::Delta,
        })
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        let reflected = fresnel::dielectric(wi.z, self.eta).reflectance;
        self.reflectance * reflected + self.transmittance * (1.0 - reflected)
    }
}

/// The factor on what is refracted where the index is `eta_ti` times as high on the side of `wi`
/// as on that of `wo`. Radiance over the squared index is what light keeps (Veach's thesis, 1997,
/// section 5.2).
#[inline]
pub(super) fn radiance_scale(eta_ti: f32, transport: Transport) -> f32 {
    match transport {
        Transport::Radiance => eta_ti * eta_ti,
        Transport::Importance => 1.0,
    }
}
