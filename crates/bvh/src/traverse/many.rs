//! Many rays at once: the choice of the tier, the call and the way back once for all of them, and
//! one ray's last steps overlap the next one's first.

use super::{any::any, closest::closest};
use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::simd::{Tier, portable::Portable};
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
        Tier::Avx2 => unsafe { intersect_many_avx2(bvh, rays, primitives, hits) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { intersect_many_avx512(bvh, rays, primitives, hits) },
        _ => hits.extend(
            rays.iter().map(|ray| closest::<Portable, P>(bvh, ray, primitives, Hit::NO_INSTANCE)),
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
        Tier::Avx2 => unsafe { occluded_many_avx2(bvh, rays, primitives, occluded) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Tier::Avx512 => unsafe { occluded_many_avx512(bvh, rays, primitives, occluded) },
        _ => occluded.extend(
            rays.iter().map(|ray| any::<Portable, P>(bvh, ray, primitives, Hit::NO_INSTANCE)),
        ),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn intersect_many_avx2<P: Primitives>(
    bvh: &Bvh,
    rays: &[Ray],
    primitives: &P,
    hits: &mut Vec<Option<Hit>>,
) {
    use crate::simd::avx2::Avx2;
    hits.reserve(rays.len());
    for ray in rays {
        hits.push(closest::<Avx2, P>(bvh, ray, primitives, Hit::NO_INSTANCE));
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn occluded_many_avx2<P: Primitives>(
    bvh: &Bvh,
    rays: &[Ray],
    primitives: &P,
    occluded: &mut Vec<bool>,
) {
    use crate::simd::avx2::Avx2;
    occluded.reserve(rays.len());
    for ray in rays {
        occluded.push(any::<Avx2, P>(bvh, ray, primitives, Hit::NO_INSTANCE));
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn intersect_many_avx512<P: Primitives>(
    bvh: &Bvh,
    rays: &[Ray],
    primitives: &P,
    hits: &mut Vec<Option<Hit>>,
) {
    use crate::simd::avx2::Avx2;
    hits.reserve(rays.len());
    for ray in rays {
        hits.push(closest::<Avx2, P>(bvh, ray, primitives, Hit::NO_INSTANCE));
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn occluded_many_avx512<P: Primitives>(
    bvh: &Bvh,
    rays: &[Ray],
    primitives: &P,
    occluded: &mut Vec<bool>,
) {
    use crate::simd::avx2::Avx2;
    occluded.reserve(rays.len());
    for ray in rays {
        occluded.push(any::<Avx2, P>(bvh, ray, primitives, Hit::NO_INSTANCE));
    }
}
