//! `area`: a shape that glows.

use super::{DirectionSample, Target};
use crate::builder::Builder;
use crate::ids::ShapeId;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::scene::Scene;
use crate::texture::ColorSource;
use etendue_document::Parameters;
use etendue_math::Frame;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Makes the shape that it is nested in a diffuse light: radiance leaves its front, the same \
              in all directions.",
    parameters: &[parameter(
        "radiance",
        "spectrum or texture",
        "1",
        "Radiance that leaves the surface, W·m⁻²·sr⁻¹.",
    )],
    sample: r#"<shape type="sphere"><emitter type="area"><rgb name="radiance" value="5, 4, 3"/></emitter></shape>"#,
};

/// A glowing shape.
#[derive(Clone, Debug)]
pub struct Area {
    shape: ShapeId,
    radiance: ColorSource,
}

/// Reads an area emitter for `shape`.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>, shape: ShapeId) -> Area {
    Area { shape, radiance: builder.color(parameters, "radiance", 1.0, SpectrumUse::Emission) }
}

impl Area {
    /// The radiance that leaves towards `surface.wi`: none at the back.
    #[inline]
    pub(super) fn radiance(&self, scene: &Scene, surface: &SurfaceInteraction) -> Spectrum {
        if surface.wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        self.radiance.eval(scene.textures(), surface)
    }

    #[inline(always)]
    pub(super) fn sample_direction(
        &self,
        scene: &Scene,
        reference: Vec3,
        random: Vec2,
    ) -> Option<DirectionSample> {
        let sample = scene.shape(self.shape).sample_direction(reference, random)?;
        let direction = (sample.point - reference).try_normalize()?;
        if direction.dot(sample.shading_normal) >= 0.0 {
            return None;
        }
        let radiance = match self.radiance {
            ColorSource::Constant(radiance) => radiance,
            ColorSource::Texture(_) => {
                let shading = Frame::from_normal(sample.shading_normal);
                let surface = SurfaceInteraction {
                    point: sample.point,
                    wi: shading.to_local(-direction),
                    shape: self.shape,
                    ..SurfaceInteraction::at_uv(sample.uv, shading)
                };
                self.radiance.eval(scene.textures(), &surface)
            }
        };
        Some(DirectionSample {
            direction,
            radiance,
            pdf: sample.pdf,
            delta: false,
            target: Target::Point {
                point: sample.point,
                error: sample.error,
                normal: sample.normal,
            },
        })
    }

    #[inline]
    pub(super) fn pdf_direction(
        &self,
        scene: &Scene,
        reference: Vec3,
        surface: &SurfaceInteraction,
    ) -> f32 {
        scene.shape(self.shape).pdf_direction(reference, surface)
    }
}
