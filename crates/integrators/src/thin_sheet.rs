//! Thin sheets that let light straight through.

use etendue_scene::{ShapeId, SurfaceInteraction};
use glam::Vec3;

/// A surface that lets light straight through: its back face, if it has one close by, is part of it.
///
/// Blinds and leaves are often modelled as thin boxes with a `mask`. Their opacity is meant for the
/// sheet, not for each face of it, and Mitsuba renders it so, because its rays start 1,500 roundings
/// beyond the front face. Ours start right behind it, so the rule is stated: the same shape, met
/// again within that distance, is not met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ThinSheet {
    shape: ShapeId,
    thickness: f32,
}

impl ThinSheet {
    /// The sheet that a point of a shape belongs to.
    pub(crate) fn new(shape: ShapeId, point: Vec3) -> Self {
        let thickness = (1.0 + point.abs().max_element()) * 1500.0 * (0.5 * f32::EPSILON);
        Self { shape, thickness }
    }

    /// Whether the sheet's other face is met within the thickness that is left, which shrinks.
    pub(crate) fn holds(&mut self, surface: &SurfaceInteraction) -> bool {
        self.thickness -= surface.t;
        surface.shape == self.shape && self.thickness >= 0.0
    }
}
