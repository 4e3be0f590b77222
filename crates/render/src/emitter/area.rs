//! `area`: a shape that glows.

use super::{DirectionSample, SAMPLING_WEIGHT, Target};
use crate::builder::Builder;
use crate::ids::ShapeId;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::scene::Scene;
use crate::shape::mesh::{Glow, Mesh};
use crate::texture::{ColorSource, Texture};
use etendue_document::Parameters;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Makes the shape that it is nested in a diffuse light: radiance leaves its front, the same \
              in all directions. A picture on a mesh is sampled in proportion to its light.",
    parameters: &[
        parameter(
            "radiance",
            "spectrum or texture",
            "1",
            "Radiance that leaves the surface, W·m⁻²·sr⁻¹.",
        ),
        SAMPLING_WEIGHT,
    ],
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

    /// Lets points of the light's mesh follow the picture that it shows, if it shows one.
    pub(crate) fn let_follow(&self, mesh: &mut Mesh, textures: &[Texture]) {
        let ColorSource::Texture(id) = self.radiance else { return };
        if let Texture::Bitmap(picture) = &textures[id.index()] {
            let luminance = |uv: Vec2| picture.eval(uv).luminance();
            mesh.follow(Glow { luminance: &luminance, resolution: picture.resolution() });
        }
    }

    /// The shape and what it sends out.
    pub(super) fn source(&self) -> (ShapeId, ColorSource) {
        (self.shape, self.radiance)
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
                let surface = sample.interaction(self.shape, -direction);
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
