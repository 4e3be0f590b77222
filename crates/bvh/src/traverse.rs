//! Closest-hit and any-hit traversal: one body for every tier.

mod any;
mod closest;
pub(crate) mod many;
#[cfg(target_arch = "x86_64")]
mod packet;
pub(crate) mod ray;
mod tiers;

use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::simd::Tier;
use etendue_math::Ray;

/// How many children can wait at once. The builder bounds the depth of the hierarchy
/// (`build::MAX_DEPTH`) so that they cannot be more, and `Bvh` has no other constructor.
pub(crate) const STACK_SIZE: usize = crate::build::MAX_DEPTH * (crate::node::WIDTH - 1) + 16;

/// The nearest hit. `instance` is what hits carry as such.
#[inline]
pub(crate) fn intersect<P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
) -> Option<Hit> {
    match bvh.tier() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a `Bvh` carries only tiers that `Tier::is_available` has found.
        Tier::Avx2 => unsafe { tiers::avx2::intersect(bvh, ray, primitives, instance) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { tiers::avx512::intersect(bvh, ray, primitives, instance) },
        _ => tiers::portable::intersect(bvh, ray, primitives, instance),
    }
}

/// Whether there is any hit.
#[inline]
pub(crate) fn occluded<P: Primitives>(bvh: &Bvh, ray: &Ray, primitives: &P, instance: u32) -> bool {
    match bvh.tier() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a `Bvh` carries only tiers that `Tier::is_available` has found.
        Tier::Avx2 => unsafe { tiers::avx2::occluded(bvh, ray, primitives, instance) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { tiers::avx512::occluded(bvh, ray, primitives, instance) },
        _ => tiers::portable::occluded(bvh, ray, primitives, instance),
    }
}
