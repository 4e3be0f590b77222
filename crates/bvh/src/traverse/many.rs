//! Many rays at once, in packets where the tier has them.

use super::tiers;
use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::simd::Tier;
use etendue_math::Ray;

/// Appends the nearest hit of each ray.
pub(crate) fn intersect_many<P: Primitives>(
    bvh: &Bvh,
    rays: &[Ray],
    primitives: &P,
    hits: &mut Vec<Option<Hit>>,
) {
    match bvh.tier() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a `Bvh` carries only tiers that `Tier::is_available` has found.
        Tier::Avx2 => unsafe { tiers::avx2::intersect_many(bvh, rays, primitives, hits) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { tiers::avx512::intersect_many(bvh, rays, primitives, hits) },
        _ => hits.extend(
            rays.iter().map(|ray| super::intersect(bvh, ray, primitives, Hit::NO_INSTANCE)),
        ),
    }
}

/// Appends for each ray whether there is any hit.
pub(crate) fn occluded_many<P: Primitives>(
    bvh: &Bvh,
    rays: &[Ray],
    primitives: &P,
    occluded: &mut Vec<bool>,
) {
    match bvh.tier() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a `Bvh` carries only tiers that `Tier::is_available` has found.
        Tier::Avx2 => unsafe { tiers::avx2::occluded_many(bvh, rays, primitives, occluded) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { tiers::avx512::occluded_many(bvh, rays, primitives, occluded) },
        _ => occluded
            .extend(rays.iter().map(|ray| super::occluded(bvh, ray, primitives, Hit::NO_INSTANCE))),
    }
}
