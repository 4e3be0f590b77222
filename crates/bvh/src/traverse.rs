//! Closest-hit and any-hit queries. One generic implementation is compiled for every tier.

mod any;
mod closest;
mod many;
#[cfg(target_arch = "x86_64")]
mod packet;
pub(crate) mod ray;
mod tiers;

use crate::bvh::Bvh;
use crate::geometry::Primitives;
use crate::hit::Hit;
use crate::simd::Tier;
use etendue_math::Ray;

impl Bvh {
    /// The nearest hit with `0 < t < ray.t_max`.
    ///
    /// The direction need not be normalised. A ray hits nothing if a coordinate is not finite or if
    /// all components of its direction are zero or subnormal. Of hits at equal distances, the one
    /// with the lowest (instance, geometry, primitive) wins.
    #[inline]
    #[must_use]
    pub fn intersect<P: Primitives>(&self, ray: &Ray, primitives: &P) -> Option<Hit> {
        self.intersect_as(ray, primitives, Hit::NO_INSTANCE)
    }

    /// Whether there is any hit with `0 < t < ray.t_max`: cheaper than [`Bvh::intersect`], and true
    /// exactly if that finds a hit.
    #[inline]
    #[must_use]
    pub fn occluded<P: Primitives>(&self, ray: &Ray, primitives: &P) -> bool {
        self.occluded_as(ray, primitives, Hit::NO_INSTANCE)
    }

    /// As [`Bvh::intersect`]. The ray is in the space of this hierarchy, which is the group of
    /// `instance`.
    #[inline]
    pub(crate) fn intersect_as<P: Primitives>(
        &self,
        ray: &Ray,
        primitives: &P,
        instance: u32,
    ) -> Option<Hit> {
        match self.tier() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Bvh` has only tiers for which `Tier::is_available` holds.
            Tier::Avx2 => unsafe { tiers::avx2::intersect(self, ray, primitives, instance) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Tier::Avx512 => unsafe { tiers::avx512::intersect(self, ray, primitives, instance) },
            _ => tiers::portable::intersect(self, ray, primitives, instance),
        }
    }

    /// As [`Bvh::occluded`], for the group of `instance`.
    #[inline]
    pub(crate) fn occluded_as<P: Primitives>(
        &self,
        ray: &Ray,
        primitives: &P,
        instance: u32,
    ) -> bool {
        match self.tier() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Bvh` has only tiers for which `Tier::is_available` holds.
            Tier::Avx2 => unsafe { tiers::avx2::occluded(self, ray, primitives, instance) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Tier::Avx512 => unsafe { tiers::avx512::occluded(self, ray, primitives, instance) },
            _ => tiers::portable::occluded(self, ray, primitives, instance),
        }
    }
}
