//! Light that may arrive at several points.

use super::SurfaceLanes;
use etendue_math::lanes::{Mask, Real, Vector3};
use etendue_math::{RayLanes, offset_origin_lanes};
use etendue_spectrum::SpectrumLanes;

/// Light that may arrive at points, one per lane; see [`DirectionSample`](crate::emitter::DirectionSample).
#[derive(Clone, Copy, Debug)]
pub struct LightLanes<R: Real> {
    /// The unit directions from the reference points towards the light.
    pub direction: Vector3<R>,
    /// The unoccluded radiance; for delta emitters, irradiance on a surface that faces the light.
    pub radiance: SpectrumLanes<R>,
    /// The density in solid angle, of all emitters together.
    pub pdf: R,
    /// Whether only emitter sampling can find the light.
    pub delta: R::Mask,
    /// Whether there is light. Otherwise, the other fields have no meaning.
    pub exists: R::Mask,
    /// The ends of the shadow rays.
    pub target: TargetLanes<R>,
}

/// The ends of shadow rays, one per lane; see [`Target`](crate::emitter::Target).
#[derive(Clone, Copy, Debug)]
pub struct TargetLanes<R: Real> {
    /// The point.
    pub point: Vector3<R>,
    /// A bound on the absolute error of each coordinate of `point`.
    pub error: Vector3<R>,
    /// The unit geometric normal, or zero.
    pub normal: Vector3<R>,
    /// Whether the ray goes to infinity. If so, `point` has no meaning.
    pub afar: R::Mask,
}

impl<R: Real> LightLanes<R> {
    /// Selects `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        let (to, other) = (yes.target, no.target);
        Self {
            direction: Vector3::select(mask, yes.direction, no.direction),
            radiance: SpectrumLanes::select(mask, yes.radiance, no.radiance),
            pdf: R::select(mask, yes.pdf, no.pdf),
            delta: either(mask, yes.delta, no.delta),
            exists: either(mask, yes.exists, no.exists),
            target: TargetLanes {
                point: Vector3::select(mask, to.point, other.point),
                error: Vector3::select(mask, to.error, other.error),
                normal: Vector3::select(mask, to.normal, other.normal),
                afar: either(mask, to.afar, other.afar),
            },
        }
    }

    /// The shadow rays from the surfaces to the light.
    #[inline(always)]
    #[must_use]
    pub fn shadow_rays(&self, surface: &SurfaceLanes<R>) -> RayLanes<R> {
        let origin = surface.ray_origin(self.direction);
        let TargetLanes { point, error, normal, afar } = self.target;
        let target = offset_origin_lanes(point, error, normal, -self.direction);
        let near = shadow_segment(origin, target);
        if !afar.any() {
            return near;
        }
        let unbounded = near.t_max.like(f32::INFINITY);
        RayLanes {
            origin,
            direction: Vector3::select(afar, self.direction, near.direction),
            t_max: R::select(afar, unbounded, near.t_max),
        }
    }
}

/// Selects `yes` where the mask is true, `no` elsewhere.
#[inline(always)]
fn either<M: Mask>(mask: M, yes: M, no: M) -> M {
    mask & yes | !mask & no
}

/// Shadow rays end this fraction of their length before the target, because the distance to the
/// target has rounding errors.
pub(crate) const SHADOW_RAY_LENGTH: f32 = 1.0 - 2e-5;

/// The shadow rays between two points that are offset from their surfaces.
#[inline(always)]
pub(crate) fn shadow_segment<R: Real>(origin: Vector3<R>, target: Vector3<R>) -> RayLanes<R> {
    RayLanes { origin, direction: target - origin, t_max: origin.x.like(SHADOW_RAY_LENGTH) }
}
