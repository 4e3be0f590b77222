//! Volumes: quantities that vary in space, for media, phase functions and the `volume` texture.
//!
//! # Contract
//! - Points are in world space. A volume has a value everywhere; its [`bounds`](Volume::bounds) are
//!   the box outside of which a medium made of it is empty.
//! - A volume's own space is the unit cube, which `to_world` places.
//! - Colours are linear Rec. 709; the scalar of a colour is its luminance.

pub mod constvolume;
pub mod gridvolume;

use etendue_math::{Bounds3, Transform};
use etendue_spectrum::Spectrum;
use glam::Vec3;
use std::sync::Arc;

/// A quantity that varies in space.
#[derive(Clone, Debug)]
pub enum Volume {
    /// The same everywhere.
    Constant(constvolume::ConstVolume),
    /// Values on a grid.
    Grid(Arc<gridvolume::GridVolume>),
}

/// The unit cube, which every volume fills in its own space.
pub(crate) const UNIT_CUBE: Bounds3 = Bounds3 { min: Vec3::ZERO, max: Vec3::ONE };

impl Volume {
    /// The same colour everywhere, within the unit cube.
    #[must_use]
    pub fn constant(color: Spectrum) -> Self {
        Self::Constant(constvolume::ConstVolume::new(color, &Transform::IDENTITY))
    }

    /// The colour at a point.
    #[inline]
    #[must_use]
    pub fn eval(&self, point: Vec3) -> Spectrum {
        match self {
            Self::Constant(volume) => volume.color(),
            Self::Grid(volume) => volume.eval(point),
        }
    }

    /// The scalar at a point: the only channel, or the luminance of a colour.
    #[inline]
    #[must_use]
    pub fn eval_scalar(&self, point: Vec3) -> f32 {
        match self {
            Self::Constant(volume) => volume.color().luminance(),
            Self::Grid(volume) => volume.eval_scalar(point),
        }
    }

    /// The colour, if it is the same everywhere.
    #[must_use]
    pub fn as_constant(&self) -> Option<Spectrum> {
        match self {
            Self::Constant(volume) => Some(volume.color()),
            Self::Grid(_) => None,
        }
    }

    /// The box in world space outside of which a medium of this volume is empty.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        match self {
            Self::Constant(volume) => volume.bounds(),
            Self::Grid(volume) => volume.bounds(),
        }
    }

    /// The least and the greatest value of all channels.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        match self {
            Self::Constant(volume) => {
                [volume.color().min_component(), volume.color().max_component()]
            }
            Self::Grid(volume) => volume.range(),
        }
    }

    /// The mean of the values, as a colour.
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        match self {
            Self::Constant(volume) => volume.color(),
            Self::Grid(volume) => volume.mean(),
        }
    }

    /// How many values a cell has; a constant counts as a colour.
    #[must_use]
    pub fn channels(&self) -> usize {
        match self {
            Self::Constant(_) => Spectrum::LANES,
            Self::Grid(volume) => volume.channels(),
        }
    }

    /// The grid, if it is one.
    #[must_use]
    pub fn grid(&self) -> Option<&Arc<gridvolume::GridVolume>> {
        match self {
            Self::Constant(_) => None,
            Self::Grid(grid) => Some(grid),
        }
    }
}
