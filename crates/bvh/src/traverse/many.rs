//! Queries for many rays, in packets where the tier has them.

use super::tiers;
use crate::bvh::Bvh;
use crate::geometry::Primitives;
use crate::hit::Hit;
use crate::simd::Tier;
use etendue_math::Ray;

impl Bvh {
    /// As [`Bvh::intersect`] for many rays, whose hits are appended to `hits`.
    ///
    /// Rays are traced in packets through hierarchies of a few hundred triangles, and where
    /// neighbours in the list are coherent. On x86-64 this is two to four times as fast. The hits
    /// are the same to the last bit.
    pub fn intersect_many<P: Primitives>(
        &self,
        rays: &[Ray],
        primitives: &P,
        hits: &mut Vec<Option<Hit>>,
    ) {
        match self.tier() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Bvh` has only tiers for which `Tier::is_available` holds.
            Tier::Avx2 => unsafe { tiers::avx2::intersect_many(self, rays, primitives, hits) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Tier::Avx512 => unsafe { tiers::avx512::intersect_many(self, rays, primitives, hits) },
            _ => hits.extend(rays.iter().map(|ray| self.intersect(ray, primitives))),
        }
    }

    /// As [`Bvh::occluded`] for many rays; the results are appended to `occluded`.
    pub fn occluded_many<P: Primitives>(
        &self,
        rays: &[Ray],
        primitives: &P,
        occluded: &mut Vec<bool>,
    ) {
        match self.tier() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Tier::Avx2 => unsafe { tiers::avx2::occluded_many(self, rays, primitives, occluded) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Tier::Avx512 => unsafe {
                tiers::avx512::occluded_many(self, rays, primitives, occluded)
            },
            _ => occluded.extend(rays.iter().map(|ray| self.occluded(ray, primitives))),
        }
    }
}
