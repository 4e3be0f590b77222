//! `volume`: a volume evaluated on a surface.

use super::{TextureModel, Textures};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::volume::Volume;
use crate::volume::gridvolume::GridVolume;
use etendue_document::Parameters;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::Vec3;
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A volume as a texture: a surface has the values of the points in the world that it \
              passes, so that it needs no texture coordinates.",
    parameters: &[parameter(
        "volume",
        "float, spectrum or volume",
        "0.75",
        "The volume; its `to_world` places it beside the surface.",
    )],
    sample: r#"<texture type="volume">
    <volume name="volume" type="gridvolume"><string name="filename" value="smoke.vol"/></volume>
</texture>"#,
};

/// A volume evaluated on a surface.
#[derive(Clone, Debug)]
pub struct VolumeTexture {
    volume: Volume,
    mean: Spectrum,
}

/// Reads the texture.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<VolumeTexture> {
    let volume = builder.volume_or_color(parameters, "volume", 0.75, SpectrumUse::Unbounded)?;
    Some(VolumeTexture { mean: volume.mean(), volume })
}

impl TextureModel for VolumeTexture {
    fn eval(&self, _textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        self.eval(surface.point)
    }

    fn eval_scalar(&self, _textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        self.eval_scalar(surface.point)
    }

    fn mean(&self, _textures: Textures<'_>) -> Spectrum {
        self.mean()
    }

    fn grid(&self) -> Option<&Arc<GridVolume>> {
        self.volume.grid()
    }
}

impl VolumeTexture {
    /// The colour at a world-space point.
    #[inline]
    #[must_use]
    pub fn eval(&self, point: Vec3) -> Spectrum {
        self.volume.eval(point)
    }

    /// The scalar at a world-space point.
    #[inline]
    #[must_use]
    pub fn eval_scalar(&self, point: Vec3) -> f32 {
        self.volume.eval_scalar(point)
    }

    /// The mean of the volume's values.
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        self.mean
    }
}
