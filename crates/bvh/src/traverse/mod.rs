//! Closest-hit and any-hit traversal: one body for every tier.

mod any;
mod closest;
pub(crate) mod many;
pub(crate) mod ray;

use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::simd::{Tier, portable::Portable};
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
        Tier::Avx2 => unsafe { intersect_avx2(bvh, ray, primitives, instance) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { intersect_avx512(bvh, ray, primitives, instance) },
        _ => intersect_portable(bvh, ray, primitives, instance),
    }
}

/// Whether there is any hit.
#[inline]
pub(crate) fn occluded<P: Primitives>(bvh: &Bvh, ray: &Ray, primitives: &P, instance: u32) -> bool {
    match bvh.tier() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a `Bvh` carries only tiers that `Tier::is_available` has found.
        Tier::Avx2 => unsafe { occluded_avx2(bvh, ray, primitives, instance) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { occluded_avx512(bvh, ray, primitives, instance) },
        _ => occluded_portable(bvh, ray, primitives, instance),
    }
}

// Out of line, so that the choice of the tier is a jump and not a frame of its own.
#[inline(never)]
fn intersect_portable<P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
) -> Option<Hit> {
    closest::closest::<Portable, P>(bvh, ray, primitives, instance)
}

#[inline(never)]
fn occluded_portable<P: Primitives>(bvh: &Bvh, ray: &Ray, primitives: &P, instance: u32) -> bool {
    any::any::<Portable, P>(bvh, ray, primitives, instance)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn intersect_avx2<P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
) -> Option<Hit> {
    closest::closest::<crate::simd::avx2::Avx2, P>(bvh, ray, primitives, instance)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn occluded_avx2<P: Primitives>(bvh: &Bvh, ray: &Ray, primitives: &P, instance: u32) -> bool {
    any::any::<crate::simd::avx2::Avx2, P>(bvh, ray, primitives, instance)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn intersect_avx512<P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
) -> Option<Hit> {
    closest::closest::<crate::simd::avx2::Avx2, P>(bvh, ray, primitives, instance)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn occluded_avx512<P: Primitives>(bvh: &Bvh, ray: &Ray, primitives: &P, instance: u32) -> bool {
    any::any::<crate::simd::avx2::Avx2, P>(bvh, ray, primitives, instance)
}
