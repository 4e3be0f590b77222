//! Textures: quantities that vary over a surface, and the material parameters that take them.
//!
//! # Contract
//! - A texture is evaluated at most once per hit and parameter, while a material is prepared.
//! - Colours are linear Rec.709 [`Spectrum`]s. The scalar of a colour texture is its luminance.
//! - `u` and `v` of a bitmap follow Mitsuba: (0, 0) is the upper left corner, and v runs down.
//!   Shapes convert from file formats that count from below, such as OBJ.

pub mod bitmap;
pub mod checkerboard;
pub mod gridtexture;
pub mod mesh_attribute;
pub mod rawconstant;
pub mod scale;
pub mod volume;

use crate::builder::Builder;
use crate::ids::TextureId;
use crate::inputs::texels::Texels;
use crate::interaction::SurfaceInteraction;
use crate::plugin::{Plugin, plugin};
use crate::volume::gridvolume::GridVolume;
use etendue_document::Parameters;
use etendue_spectrum::Spectrum;
use glam::Vec2;
use std::sync::Arc;

/// The list of textures. Each line is one plugin: its XML `type`, which is also its module, and its
/// type in the scene, which implements [`TextureModel`].
macro_rules! texture_list {
    ($macro:ident) => {
        $macro! {
            bitmap => Bitmap(bitmap::BitmapTexture);
            checkerboard => Checkerboard(checkerboard::Checkerboard);
            gridtexture => Grid(gridtexture::GridTexture);
            mesh_attribute => MeshAttribute(mesh_attribute::MeshAttribute);
            rawconstant => Constant(Spectrum);
            scale => Scale(scale::Scale);
            volume => Volume(volume::VolumeTexture);
        }
    };
}

/// The operations of a texture plugin; see the module's contract.
pub(crate) trait TextureModel {
    /// See [`Textures::eval`].
    fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum;

    /// See [`Textures::eval_scalar`]; the luminance of the colour unless there is only one channel.
    fn eval_scalar(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        self.eval(textures, surface).luminance()
    }

    /// See [`Textures::gradient`]; zero if the texture is piecewise constant.
    fn gradient(&self, _textures: Textures<'_>, _surface: &SurfaceInteraction) -> Vec2 {
        Vec2::ZERO
    }

    /// See [`Textures::mean`].
    fn mean(&self, textures: Textures<'_>) -> Spectrum;

    /// See [`Texture::memory_bytes`].
    fn memory_bytes(&self) -> usize {
        0
    }

    /// The texels of the picture that the texture uses, if any.
    fn texels(&self) -> Option<&Arc<Texels>> {
        None
    }

    /// The grid that the texture uses, if any.
    fn grid(&self) -> Option<&Arc<GridVolume>> {
        None
    }
}

/// Generates the enum of textures, its dispatch and the registry from the list.
macro_rules! textures {
    ($($module:ident => $name:ident($type:ty);)*) => {
        /// A texture of the scene.
        #[derive(Clone, Debug)]
        pub enum Texture {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($type),)*
        }

        /// Every texture.
        pub static TEXTURES: &[Plugin<BuildTexture>] = &[
            $(plugin(stringify!($module), &$module::MANUAL, |builder, parameters| {
                $module::build(builder, parameters).map(Texture::$name)
            }),)*
        ];

        /// Runs `$work` with the [`TextureModel`] of a texture.
        macro_rules! with_texture {
            ($texture:expr, $model:ident => $work:expr) => {
                match $texture {
                    $(Texture::$name($model) => $work,)*
                }
            };
        }
    };
}

texture_list!(textures);

/// Builds a texture.
pub type BuildTexture = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Texture>;

impl Texture {
    /// Memory use in bytes, excluding the texture itself and data that may be shared: a picture's
    /// texels and a volume's grid.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        with_texture!(self, texture => TextureModel::memory_bytes(texture))
    }

    /// The texels of the picture that the texture uses, if any.
    pub(crate) fn texels(&self) -> Option<&Arc<Texels>> {
        with_texture!(self, texture => TextureModel::texels(texture))
    }

    /// Adds the grid that the texture uses, if any.
    pub(crate) fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        grids.extend(with_texture!(self, texture => TextureModel::grid(texture)));
    }
}

/// All textures of a scene, indexed by [`TextureId`].
#[derive(Clone, Copy, Debug)]
pub struct Textures<'a>(pub &'a [Texture]);

impl Textures<'_> {
    /// The colour at a surface point.
    #[must_use]
    pub fn eval(&self, id: TextureId, surface: &SurfaceInteraction) -> Spectrum {
        with_texture!(&self.0[id.index()], texture => TextureModel::eval(texture, *self, surface))
    }

    /// The scalar at a surface point: the only channel, or the luminance of a colour.
    #[must_use]
    pub fn eval_scalar(&self, id: TextureId, surface: &SurfaceInteraction) -> f32 {
        let texture = &self.0[id.index()];
        with_texture!(texture, texture => TextureModel::eval_scalar(texture, *self, surface))
    }

    /// The derivatives of the scalar by `u` and `v` at a surface point; zero if the texture is
    /// constant around it.
    #[must_use]
    pub fn gradient(&self, id: TextureId, surface: &SurfaceInteraction) -> Vec2 {
        let texture = &self.0[id.index()];
        with_texture!(texture, texture => TextureModel::gradient(texture, *self, surface))
    }

    /// The mean colour over the unit square of `uv`.
    #[must_use]
    pub fn mean(&self, id: TextureId) -> Spectrum {
        with_texture!(&self.0[id.index()], texture => TextureModel::mean(texture, *self))
    }
}

/// A colour parameter: constant, or read from a texture.
#[derive(Clone, Copy, Debug)]
pub enum ColorSource {
    /// The same value everywhere.
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

    /// Whether the colour is constant.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// Whether the colour is constant and black.
    #[must_use]
    pub fn is_black(&self) -> bool {
        matches!(self, Self::Constant(color) if color.is_black())
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
    /// The same value everywhere.
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

    /// Whether the scalar is constant.
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
