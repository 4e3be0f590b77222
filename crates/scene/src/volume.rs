//! Volumes: quantities that vary in space, for media, phase functions and the `volume` texture.
//!
//! # Contract
//! - Points are in world space. A volume has a value everywhere. A medium made of it is empty
//!   outside its [`bounds`](Volume::bounds).
//! - A volume's local space is the unit cube, which `to_world` places.
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

/// The list of volumes. Each line is one plugin: its XML `type`, which is also its module, and its
/// type in the scene, which implements [`VolumeModel`].
macro_rules! volume_list {
    ($macro:ident) => {
        $macro! {
            constvolume => Constant(constvolume::ConstVolume);
            gridvolume => Grid(Arc<gridvolume::GridVolume>);
        }
    };
}

/// The operations of a volume plugin; see the module's contract.
pub(crate) trait VolumeModel {
    /// See [`Volume::eval`].
    fn eval(&self, point: Vec3) -> Spectrum;

    /// See [`Volume::eval_scalar`]; the luminance of the colour unless there is only one channel.
    fn eval_scalar(&self, point: Vec3) -> f32 {
        self.eval(point).luminance()
    }

    /// See [`Volume::as_constant`]; `None` unless the volume is constant.
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

/// Generates the enum of volumes, its dispatch and the registry from the list.
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

/// The unit cube, which every volume fills in local space.
pub(crate) const UNIT_CUBE: Bounds3 = Bounds3 { min: Vec3::ZERO, max: Vec3::ONE };

impl Volume {
    /// A constant colour within the unit cube.
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

    /// The colour, if the volume is constant.
    #[must_use]
    pub fn as_constant(&self) -> Option<Spectrum> {
        with_volume!(self, volume => volume.as_constant())
    }

    /// The world-space box outside of which a medium of this volume is empty.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        with_volume!(self, volume => volume.bounds())
    }

    /// The minimum and maximum over all channels.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        with_volume!(self, volume => volume.range())
    }

    /// The mean of the values, as a colour.
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        with_volume!(self, volume => volume.mean())
    }

    /// Values per cell; a constant counts as a colour.
    #[must_use]
    pub fn channels(&self) -> usize {
        with_volume!(self, volume => volume.channels())
    }

    /// The volume with zero in place of negative values.
    #[must_use]
    pub(crate) fn without_negative(self) -> Self {
        match self {
            Self::Grid(grid) => Self::Grid(Arc::new(grid.without_negative())),
            constant @ Self::Constant(_) => constant,
        }
    }

    /// The grid, if the volume is one.
    #[must_use]
    pub fn grid(&self) -> Option<&Arc<gridvolume::GridVolume>> {
        match self {
            Self::Grid(grid) => Some(grid),
            Self::Constant(_) => None,
        }
    }
}
