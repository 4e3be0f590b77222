//! Null transmission through thin sheets.

use etendue_scene::{ShapeId, SurfaceInteraction};
use glam::Vec3;

/// The thin sheet that a path is passing through, if any: a surface together with its back face if
/// that is very close.
///
/// Blinds and leaves are often modelled as thin boxes with a `mask`. Their opacity is meant for the
/// whole sheet, not for each face. Mitsuba renders it so because its rays start 1,500 rounding
/// errors beyond the front face. Ours start right behind it, so we need an explicit rule: a second
/// hit on the same shape within that distance is ignored.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ThinSheet(Option<Inside>);

#[derive(Clone, Copy, Debug)]
struct Inside {
    shape: ShapeId,
    /// How much of the sheet may still lie ahead.
    thickness: f32,
}

impl ThinSheet {
    /// The path passes straight through a face of `shape`.
    #[inline]
    pub(crate) fn enter(&mut self, shape: ShapeId, point: Vec3) {
        let thickness = (1.0 + point.abs().max_element()) * 1500.0 * (0.5 * f32::EPSILON);
        self.0 = Some(Inside { shape, thickness });
    }

    /// Whether the path is inside a sheet.
    #[inline(always)]
    pub(crate) fn is_entered(&self) -> bool {
        self.0.is_some()
    }

    /// Whether a surface that the path hits is the sheet's other face and must be ignored. If it is
    /// not, the path has left the sheet.
    #[inline]
    pub(crate) fn holds(&mut self, surface: &SurfaceInteraction) -> bool {
        let Some(inside) = &mut self.0 else { return false };
        inside.thickness -= surface.t;
        let holds = surface.shape == inside.shape && inside.thickness >= 0.0;
        if !holds {
            self.0 = None;
        }
        holds
    }

    /// The path is scattered.
    #[inline]
    pub(crate) fn leave(&mut self) {
        self.0 = None;
    }
}
