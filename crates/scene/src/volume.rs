//! Volumes: quantities that vary in space, for media, phase functions and the `volume` texture.
//!
//! # Contract
//! - Points are in world space. A volume has a value everywhere; its [`bounds`](Volume::bounds) are
//!   the box outside of which a medium made of it is empty.
//! - A volume's own space is the unit cube, which `to_world` places.
//! - Colours are linear Rec. 709; the scalar of a colour is its luminance.

pub mod constvolume;
pub mod gridvolume;

use crate::builder::Builder;
use crate::plugin::{Plugin, plugin};
use etendue_document::Parameters;
use etendue_math::{Bounds3, Transform};
use etendue_spectrum::Spectrum;
use glam::Vec3;
use std::sync::Arc;

/// The list of volumes: one line is one plugin, its XML `type`, which is its module as well, and what
/// the scene holds of it, which is a [`VolumeModel`].
macro_rules! volume_list {
    ($macro:ident) => {
        $macro! {
            constvolume => Constant(constvolume::ConstVolume);
            gridvolume => Grid(Arc<gridvolume::GridVolume>);
        }
    };
}

/// What a volume plugin computes; see the module's contract.
pub(crate) trait VolumeModel {
    /// See [`Volume::eval`].
    fn eval(&self, point: Vec3) -> Spectrum;

    /// See [`Volume::eval_scalar`]; the luminance of the colour unless there is only one channel.
    fn eval_scalar(&self, point: Vec3) -> f32 {
        self.eval(point).luminance()
    }

    /// See [`Volume::as_constant`]; `None` unless the volume is the same everywhere.
    fn as_constant(&self) -> Option<Spectrum> {
        None
    }

    /// See [`Volume::bounds`].
    fn bounds(&self) -> Bounds3;

    /// See [`Volume::range`].
    fn range(&self) -> [f32; 2];

    /// See [`Volume::mean`].
    fn mean(&self) -> Spectrum;

    /// See [`Volume::channels`].
    fn channels(&self) -> usize;
}

/// Makes the enum of volumes, its dispatch and the registry from the list.
macro_rules! volumes {
    ($($module:ident => $name:ident($type:ty);)*) => {
        /// A quantity that varies in space.
        #[derive(Clone, Debug)]
        pub enum Volume {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($type),)*
        }

        /// Every volume.
        pub static VOLUMES: &[Plugin<BuildVolume>] = &[
            $(plugin(stringify!($module), &$module::MANUAL, |builder, parameters| {
                let volume = $module::build(builder, parameters)?;
                Some(Volume::$name(volume.into()))
            }),)*
        ];

        /// Runs `$work` with the [`VolumeModel`] of a volume.
        macro_rules! with_volume {
            ($volume:expr, $model:ident => $work:expr) => {
                match $volume {
                    $(Volume::$name($model) => $work,)*
                }
            };
        }
    };
}

volume_list!(volumes);

/// Builds a volume.
pub type BuildVolume = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Volume>;

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
        with_volume!(self, volume => volume.eval(point))
    }

    /// The scalar at a point: the only channel, or the luminance of a colour.
    #[inline]
    #[must_use]
    pub fn eval_scalar(&self, point: Vec3) -> f32 {
        with_volume!(self, volume => volume.eval_scalar(point))
    }

    /// The colour, if it is the same everywhere.
    #[must_use]
    pub fn as_constant(&self) -> Option<Spectrum> {
        with_volume!(self, volume => volume.as_constant())
    }

    /// The box in world space outside of which a medium of this volume is empty.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        with_volume!(self, volume => volume.bounds())
    }

    /// The least and the greatest value of all channels.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        with_volume!(self, volume => volume.range())
    }

    /// The mean of the values, as a colour.
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        with_volume!(self, volume => volume.mean())
    }

    /// How many values a cell has; a constant counts as a colour.
    #[must_use]
    pub fn channels(&self) -> usize {
        with_volume!(self, volume => volume.channels())
    }

    /// The grid, if it is one.
    #[must_use]
    pub fn grid(&self) -> Option<&Arc<gridvolume::GridVolume>> {
        match self {
            Self::Grid(grid) => Some(grid),
            Self::Constant(_) => None,
        }
    }
}
