//! `tent`: the weight of a sample falls linearly with distance.

use super::{Profile, ReconstructionFilter};
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The triangle filter: weights fall linearly from the pixel's centre. Cheap, without \
              ringing, a little blurred.",
    parameters: &[parameter(
        "radius",
        "float",
        "1",
        "The distance at which the weight reaches zero, in pixels.",
    )],
    sample: r#"<rfilter type="tent"><float name="radius" value="1.25"/></rfilter>"#,
};

/// 1 − |x| / radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tent {
    radius: f32,
}

impl Default for Tent {
    fn default() -> Self {
        Self { radius: 1.0 }
    }
}

/// Reads the filter.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<ReconstructionFilter> {
    let radius = parameters.float_in("radius", 1.0, super::RADII) as f32;
    Some(ReconstructionFilter::new(Tent { radius }.into()))
}

impl Tent {
    pub(super) fn radius(self) -> f32 {
        self.radius
    }

    pub(super) fn eval(self, distance: f32) -> f32 {
        1.0 - distance / self.radius
    }
}

impl From<Tent> for Profile {
    fn from(filter: Tent) -> Self {
        Self::Tent(filter)
    }
}
