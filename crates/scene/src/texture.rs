//! Textures: quantities that vary over a surface, and the slots of materials that take them.
//!
//! # Contract
//! - A texture is read at most once per hit and slot, while a material is prepared.
//! - Colours are linear Rec.709 [`Spectrum`]s; scalars of a colour texture are its luminance.
//! - `u` and `v` of a bitmap are Mitsuba's: (0, 0) is the left upper corner of the picture, and v
//!   runs down. Shapes make up for it where their files count from below, as OBJ does.

pub mod bitmap;
pub mod checkerboard;
pub mod gridtexture;
pub mod mesh_attribute;
pub mod rawconstant;
pub mod scale;
pub mod volume;

use crate::ids::TextureId;
use crate::interaction::SurfaceInteraction;
use crate::models::texels::Texels;
use crate::volume::gridvolume::GridVolume;
use etendue_spectrum::Spectrum;
use glam::Vec2;
use std::sync::Arc;

/// A texture of the scene.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Spectrum),
    /// An image.
    Bitmap(bitmap::BitmapTexture),
    /// Two colours in squares.
    Checkerboard(checkerboard::Checkerboard),
    /// What a mesh file says of its vertices or faces.
    MeshAttribute(mesh_attribute::MeshAttribute),
    /// Lines along the edges of squares.
    Grid(gridtexture::GridTexture),
    /// Another texture, times a colour.
    Scale(scale::Scale),
    /// A volume, seen where a surface cuts it.
    Volume(volume::VolumeTexture),
}

impl Texture {
    /// Bytes of memory held beside the texture itself, but for a picture's texels and a volume's grid,
    /// which others may hold as well.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Constant(_)
            | Self::Bitmap(_)
            | Self::Checkerboard(_)
            | Self::Grid(_)
            | Self::Scale(_)
            | Self::Volume(_) => 0,
            Self::MeshAttribute(texture) => texture.memory_bytes(),
        }
    }

    /// The texels of the picture that the texture shows, if it shows one.
    pub(crate) fn texels(&self) -> Option<&Arc<Texels>> {
        match self {
            Self::Bitmap(texture) => Some(texture.texels()),
            _ => None,
        }
    }

    /// Adds the grid that the texture shows, if it shows one.
    pub(crate) fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        if let Self::Volume(texture) = self {
            grids.extend(texture.volume().grid());
        }
    }
}

/// All textures of a scene, addressed by [`TextureId`].
#[derive(Clone, Copy, Debug)]
pub struct Textures<'a>(pub &'a [Texture]);

impl Textures<'_> {
    /// The colour at a surface point.
    #[must_use]
    pub fn eval(&self, id: TextureId, surface: &SurfaceInteraction) -> Spectrum {
        match &self.0[id.index()] {
            Texture::Constant(color) => *color,
            Texture::Bitmap(texture) => texture.eval(surface.uv),
            Texture::Checkerboard(texture) => texture.eval(*self, surface),
            Texture::MeshAttribute(texture) => texture.eval(surface),
            Texture::Grid(texture) => texture.eval(*self, surface),
            Texture::Scale(texture) => texture.eval(*self, surface),
            Texture::Volume(texture) => texture.eval(surface.point),
        }
    }

    /// The scalar at a surface point: the only channel, or the luminance of a colour.
    #[must_use]
    pub fn eval_scalar(&self, id: TextureId, surface: &SurfaceInteraction) -> f32 {
        match &self.0[id.index()] {
            Texture::Constant(color) => color.luminance(),
            Texture::Bitmap(texture) => texture.eval_scalar(surface.uv),
            Texture::Checkerboard(texture) => texture.eval_scalar(*self, surface),
            Texture::MeshAttribute(texture) => texture.eval(surface).luminance(),
            Texture::Grid(texture) => texture.eval(*self, surface).luminance(),
            Texture::Scale(texture) => texture.eval_scalar(*self, surface),
            Texture::Volume(texture) => texture.eval_scalar(surface.point),
        }
    }

    /// The derivatives of the scalar by `u` and `v` at a surface point; zero where the texture is
    /// constant around it.
    #[must_use]
    pub fn gradient(&self, id: TextureId, surface: &SurfaceInteraction) -> Vec2 {
        match &self.0[id.index()] {
            Texture::Constant(_)
            | Texture::Checkerboard(_)
            | Texture::MeshAttribute(_)
            | Texture::Grid(_)
            | Texture::Volume(_) => Vec2::ZERO,
            Texture::Scale(texture) => texture.gradient(*self, surface),
            Texture::Bitmap(texture) => texture.gradient(surface.uv),
        }
    }

    /// The mean colour over the unit square of `uv`.
    #[must_use]
    pub fn mean(&self, id: TextureId) -> Spectrum {
        match &self.0[id.index()] {
            Texture::Constant(color) => *color,
            Texture::Bitmap(texture) => texture.mean(),
            Texture::Checkerboard(texture) => texture.mean(*self),
            Texture::MeshAttribute(texture) => texture.mean(),
            Texture::Grid(texture) => texture.mean(*self),
            Texture::Scale(texture) => texture.mean(*self),
            Texture::Volume(texture) => texture.mean(),
        }
    }
}

/// A colour parameter: constant, or read from a texture.
#[derive(Clone, Copy, Debug)]
pub enum ColorSource {
    /// The same everywhere.
    Constant(Spectrum),
    /// Read from a texture.
    Texture(TextureId),
}

impl ColorSource {
    /// The colour at a surface point.
    #[inline]
    #[must_use]
    pub fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        match *self {
            Self::Constant(color) => color,
            Self::Texture(id) => textures.eval(id, surface),
        }
    }

    /// Whether the colour is the same everywhere.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// The mean colour over the unit square of `uv`.
    #[must_use]
    pub fn mean(&self, textures: Textures<'_>) -> Spectrum {
        match *self {
            Self::Constant(color) => color,
            Self::Texture(id) => textures.mean(id),
        }
    }
}

/// A scalar parameter: constant, or read from a texture.
#[derive(Clone, Copy, Debug)]
pub enum ScalarSource {
    /// The same everywhere.
    Constant(f32),
    /// Read from a texture.
    Texture(TextureId),
}

impl ScalarSource {
    /// The scalar at a surface point.
    #[inline]
    #[must_use]
    pub fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        match *self {
            Self::Constant(value) => value,
            Self::Texture(id) => textures.eval_scalar(id, surface),
        }
    }

    /// Whether the scalar is the same everywhere.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// The mean over the unit square of `uv`.
    #[must_use]
    pub fn mean(&self, textures: Textures<'_>) -> f32 {
        match *self {
            Self::Constant(value) => value,
            Self::Texture(id) => textures.mean(id).luminance(),
        }
    }
}
