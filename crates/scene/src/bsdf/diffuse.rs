//! `diffuse`: the ideal matt surface.

use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::reflectance;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless, plain};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The ideal matt surface (Lambert's): it looks equally bright from everywhere. \
              Black from behind; see `twosided`.",
    parameters: &[parameter(
        "reflectance",
        "spectrum or texture",
        "0.5",
        "The share of light that is scattered. `diffuse_reflectance` is taken too.",
    )],
    sample: r#"<bsdf type="diffuse">
    <rgb name="reflectance" value="0.2, 0.25, 0.7"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.8"/></bsdf>"#),
        lossless(r#"<bsdf type="diffuse"><float name="reflectance" value="1"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.8"/></bsdf>"#,
        r#"<bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf>"#,
        r#"<bsdf type="diffuse"><texture name="reflectance" type="checkerboard"/></bsdf>"#,
        r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#,
    ],
};

/// A Lambertian surface.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    reflectance: ColorSource,
}

impl Diffuse {
    /// Scatters nothing.
    pub(crate) const BLACK: Self = Self { reflectance: ColorSource::Constant(Spectrum::ZERO) };
}

impl Default for Diffuse {
    fn default() -> Self {
        Self { reflectance: ColorSource::Constant(Spectrum::splat(0.5)) }
    }
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Diffuse> {
    // The second name is the coated materials' one. Some scenes use it here too.
    let name = match parameters.has("reflectance") || !parameters.has("diffuse_reflectance") {
        true => "reflectance",
        false => "diffuse_reflectance",
    };
    Some(Diffuse { reflectance: reflectance(builder, parameters, name, 0.5) })
}

impl ClosureMaterial for Diffuse {
    type Closure<'a> = DiffuseClosure;

    fn transmits(&self) -> bool {
        false
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> DiffuseClosure {
        DiffuseClosure { reflectance: self.reflectance.eval(textures, surface).into() }
    }
}

impl LaneMaterial for Diffuse {
    type Variant = ();
    type Blank = DiffuseClosure;

    fn variant(&self) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn blank((): ()) -> Self::Blank {
        DiffuseClosure::default()
    }

    fn is_uniform(&self) -> bool {
        self.reflectance.is_constant()
    }
}

/// A resolved Lambertian surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiffuseClosure<R = f32> {
    reflectance: SpectrumLanes<R>,
}

columns!(DiffuseClosure { reflectance });

impl<R: Real> LaneClosure<R> for DiffuseClosure<R> {
    #[inline(always)]
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        _transport: Transport,
    ) -> (SpectrumLanes<R>, R) {
        let pdf = cosine_hemisphere::pdf_lanes(wo);
        let pdf = R::select(wi.z.above(0.0), pdf, pdf.zero());
        (self.reflectance * pdf, pdf)
    }

    #[inline(always)]
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        _lobe: R,
        direction: Vector2<R>,
        _transport: Transport,
    ) -> SampleLanes<R> {
        let wo = cosine_hemisphere::sample_lanes(direction);
        let pdf = cosine_hemisphere::pdf_lanes(wo);
        let exists = wi.z.above(0.0) & pdf.above(0.0);
        let weight = self.reflectance;
        SampleLanes { wo, weight, pdf, exists, ..SampleLanes::smooth(wi) }
    }
}

impl HitClosure for DiffuseClosure {
    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        if wi.z > 0.0 { self.reflectance.into() } else { Spectrum::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::material::{assert_finds, assert_same};
    use etendue_document::{Fault, Severity};

    #[test]
    fn the_name_of_the_coated_materials_is_taken_too() {
        assert_same(
            r#"<bsdf type="diffuse"><rgb name="diffuse_reflectance" value="0.1, 0.2, 0.3"/></bsdf>"#,
            r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.1, 0.2, 0.3"/></bsdf>"#,
        );
        assert_same(
            r#"<bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf>"#,
            r#"<bsdf type="diffuse"/>"#,
        );
    }

    #[test]
    fn reflectances_out_of_range_are_found() {
        assert_finds(
            r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.5, 1.5, 0.5"/></bsdf>"#,
            Severity::Warning,
            Fault::BadValue,
            "above 1",
        );
        assert_finds(
            r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.5, -0.5, 0.5"/></bsdf>"#,
            Severity::Warning,
            Fault::BadValue,
            "negative",
        );
    }
}
