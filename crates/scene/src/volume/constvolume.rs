//! `constvolume`: a constant value.

use super::{UNIT_CUBE, VolumeModel};
use crate::builder::Builder;
use crate::inputs::transform::read_transform;
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;
use etendue_math::{Bounds3, Transform};
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::Vec3;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The same value everywhere. A number or a colour in the place of a volume means this \
              one. As the extinction of a `heterogeneous` medium it fills a box: the unit cube, \
              placed by `to_world`.",
    parameters: &[
        parameter("value", "float or spectrum", "1", "The value."),
        parameter("to_world", "transform", "", "Places the unit cube."),
    ],
    sample: r#"<volume type="constvolume"><rgb name="value" value="0.99, 0.8, 0.8"/></volume>"#,
};

/// A constant value.
#[derive(Clone, Copy, Debug)]
pub struct ConstVolume {
    color: Spectrum,
    bounds: Bounds3,
}

/// Reads the volume.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<ConstVolume> {
    let color = builder.constant_color(parameters, "value", 1.0, SpectrumUse::Unbounded);
    Some(ConstVolume::new(color, &read_transform(parameters, "to_world")?))
}

impl ConstVolume {
    /// A constant colour in the unit cube, placed by `to_world`.
    #[must_use]
    pub fn new(color: Spectrum, to_world: &Transform) -> Self {
        Self { color, bounds: to_world.bounds(&UNIT_CUBE) }
    }
}

impl VolumeModel for ConstVolume {
    #[inline]
    fn eval(&self, _point: Vec3) -> Spectrum {
        self.color
    }

    fn as_constant(&self) -> Option<Spectrum> {
        Some(self.color)
    }

    fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    fn range(&self) -> [f32; 2] {
        [self.color.min_component(), self.color.max_component()]
    }

    fn mean(&self) -> Spectrum {
        self.color
    }

    /// A constant counts as a colour.
    fn channels(&self) -> usize {
        Spectrum::LANES
    }
}
