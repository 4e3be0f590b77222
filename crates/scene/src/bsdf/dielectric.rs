//! `dielectric`: smooth glass, water, and other clear materials.

use super::conductor::SPECULAR_REFLECTANCE;
use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::{Manual, ParameterManual, parameter};
use crate::models::bsdf_inputs::{reflectance, relative_index};
use crate::models::fresnel;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless, plain};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

/// The index on the back, for materials that default to glass.
pub(crate) const INT_IOR: ParameterManual = parameter(
    "int_ior",
    "float or string",
    "bk7",
    "The index of refraction inside: a number, or a name such as `water`, `bk7` or `diamond`.",
);
/// The index on the side of the normal.
pub(crate) const EXT_IOR: ParameterManual = parameter(
    "ext_ior",
    "float or string",
    "air",
    "The index of refraction outside, on the side of the normal.",
);
/// The transmission factor.
pub(crate) const SPECULAR_TRANSMITTANCE: ParameterManual = parameter(
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

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        lossless(r#"<bsdf type="dielectric"/>"#),
        plain(r#"<bsdf type="dielectric"><string name="int_ior" value="water"/><rgb name="specular_transmittance" value="0.3, 0.5, 0.8"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="dielectric"/>"#,
        r#"<bsdf type="dielectric"><string name="int_ior" value="water"/><string name="ext_ior" value="diamond"/></bsdf>"#,
        r#"<bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/></bsdf>"#,
        r#"<bsdf type="dielectric"><texture name="specular_transmittance" type="checkerboard"/></bsdf>"#,
    ],
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

impl ClosureMaterial for Dielectric {
    type Closure<'a> = DielectricClosure;

    const IS_DELTA: bool = true;

    fn transmits(&self) -> bool {
        true
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> DielectricClosure {
        DielectricClosure {
            reflectance: self.specular_reflectance.eval(textures, surface).into(),
            transmittance: self.specular_transmittance.eval(textures, surface).into(),
            eta: self.eta,
        }
    }
}

impl LaneMaterial for Dielectric {
    type Variant = ();
    type Blank = DielectricClosure;

    fn variant(&self) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn blank((): ()) -> Self::Blank {
        DielectricClosure::default()
    }

    fn is_uniform(&self) -> bool {
        self.specular_reflectance.is_constant() && self.specular_transmittance.is_constant()
    }
}

/// A resolved smooth dielectric interface.
#[derive(Clone, Copy, Debug, Default)]
pub struct DielectricClosure<R = f32> {
    reflectance: SpectrumLanes<R>,
    transmittance: SpectrumLanes<R>,
    eta: R,
}

columns!(DielectricClosure { reflectance, transmittance, eta });

impl<R: Real> LaneClosure<R> for DielectricClosure<R> {
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
        transport: Transport,
    ) -> SampleLanes<R> {
        let interface = fresnel::dielectric(wi.z, self.eta);
        let reflects = lobe.lt(interface.reflectance);
        let passed = -interface.reflectance + 1.0;
        let eta_ti = interface.eta_ti;
        let refracted = Vector3::new(-eta_ti * wi.x, -eta_ti * wi.y, interface.cos_theta_t);
        let transmitted = self.transmittance * radiance_scale(eta_ti, transport);
        SampleLanes {
            wo: Vector3::select(reflects, fresnel::mirror(wi), refracted),
            weight: SpectrumLanes::select(reflects, self.reflectance, transmitted),
            pdf: R::select(reflects, interface.reflectance, passed),
            eta: R::select(reflects, passed.like(1.0), interface.eta_it),
            exists: reflects | passed.above(0.0),
            ..SampleLanes::none(wi)
        }
    }
}

impl HitClosure for DielectricClosure {
    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        let reflected = fresnel::dielectric(wi.z, self.eta).reflectance;
        (self.reflectance * reflected + self.transmittance * (1.0 - reflected)).into()
    }
}

/// The radiance scale on refraction, where `eta_ti` is the index on the side of `wi` over that on
/// the side of `wo`. Refraction preserves radiance divided by the squared index (Veach's thesis,
/// 1997, section 5.2).
#[inline(always)]
pub(crate) fn radiance_scale<R: Real>(eta_ti: R, transport: Transport) -> R {
    match transport {
        Transport::Radiance => eta_ti * eta_ti,
        Transport::Importance => eta_ti.like(1.0),
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::{Lobe, Transport};
    use crate::testing::material::{TestMaterial, assert_finds, assert_same};
    use etendue_document::{Fault, Severity};
    use glam::{Vec2, Vec3};

    #[test]
    fn radiance_is_scaled_on_the_way_through_and_importance_is_not() {
        let glass = TestMaterial::read(
            r#"<bsdf type="dielectric"><float name="int_ior" value="1.5"/>
               <float name="ext_ior" value="1"/></bsdf>"#,
        );
        for (wi, eta) in [(Vec3::Z, 1.5_f32), (-Vec3::Z, 1.0 / 1.5)] {
            let [radiance, importance] =
                [Transport::Radiance, Transport::Importance].map(|transport| {
                    glass
                        .bsdf(wi)
                        .sample(wi, 0.5, Vec2::ZERO, transport)
                        .expect("light goes through")
                });
            assert_eq!((radiance.wo, radiance.lobe), (-wi, Lobe::Delta));
            assert!((radiance.eta - eta).abs() < 1e-6);
            assert!((radiance.weight[0] - 1.0 / (eta * eta)).abs() < 1e-6);
            assert_eq!(importance.weight[0], 1.0);
            assert!((radiance.pdf - 0.96).abs() < 1e-6);
        }
    }

    #[test]
    fn beyond_the_critical_angle_all_is_reflected() {
        let glass = TestMaterial::read(r#"<bsdf type="dielectric"/>"#);
        let wi = Vec3::new(0.8, 0.0, -0.6);
        let sample = glass.bsdf(wi).sample(wi, 0.999, Vec2::ZERO, Transport::Radiance);
        let sample = sample.expect("a reflection");
        assert_eq!((sample.wo, sample.pdf, sample.eta), (Vec3::new(-0.8, 0.0, -0.6), 1.0, 1.0));
    }

    #[test]
    fn names_and_numbers_mean_the_same() {
        assert_same(
            r#"<bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf>"#,
            r#"<bsdf type="dielectric"><float name="int_ior" value="1.333"/>
               <string name="ext_ior" value="air"/></bsdf>"#,
        );
    }

    #[test]
    fn indices_out_of_range_are_found() {
        for value in ["0", "-1.5", "1e39"] {
            assert_finds(
                &format!(
                    r#"<bsdf type="dielectric"><float name="int_ior" value="{value}"/></bsdf>"#
                ),
                Severity::Error,
                Fault::BadValue,
                "int_ior",
            );
        }
        assert_finds(
            r#"<bsdf type="dielectric"><float name="ext_ior" value="1e-20"/></bsdf>"#,
            Severity::Error,
            Fault::BadValue,
            "from 0.001 to 1000",
        );
    }
}
