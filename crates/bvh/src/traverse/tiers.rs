//! The entry points: the traversals, compiled for the instruction set of each tier.
//!
//! All are out of line, so that the dispatch is a jump without a stack frame.

#[cfg(target_arch = "x86_64")]
use super::packet;
use super::{any::any, closest::closest};
use crate::bvh::Bvh;
use crate::geometry::Primitives;
use crate::hit::Hit;
use crate::node::Child;
use etendue_math::Ray;

/// The entry points of a tier for single rays.
macro_rules! single {
    ($simd:ty, $(#[$attribute:meta])*) => {
        #[inline(never)]
        $(#[$attribute])*
        pub(in super::super) fn intersect<P: Primitives>(
            bvh: &Bvh,
            ray: &Ray,
            primitives: &P,
            instance: u32,
        ) -> Option<Hit> {
            closest::<$simd, P>(bvh, ray, primitives, instance, Child::node(0))
        }

        #[inline(never)]
        $(#[$attribute])*
        pub(in super::super) fn occluded<P: Primitives>(
            bvh: &Bvh,
            ray: &Ray,
            primitives: &P,
            instance: u32,
        ) -> bool {
            any::<$simd, P>(bvh, ray, primitives, instance, Child::node(0))
        }
    };
}

/// The entry points of a tier that has packets, for many rays.
#[cfg(target_arch = "x86_64")]
macro_rules! packets {
    ($simd:ty, $wide:ty, $(#[$attribute:meta])*) => {
        #[inline(never)]
        $(#[$attribute])*
        fn intersect_below<P: Primitives>(
            bvh: &Bvh,
            ray: &Ray,
            primitives: &P,
            child: Child,
        ) -> Option<Hit> {
            closest::<$simd, P>(bvh, ray, primitives, Hit::NO_INSTANCE, child)
        }

        #[inline(never)]
        $(#[$attribute])*
        fn occluded_below<P: Primitives>(
            bvh: &Bvh,
            ray: &Ray,
            primitives: &P,
            child: Child,
        ) -> bool {
            any::<$simd, P>(bvh, ray, primitives, Hit::NO_INSTANCE, child)
        }

        /// Traces the rays one by one; the processor overlaps the end of one with the start of the
        /// next. Not in the same function as packets, which would take registers. Interleaving two
        /// rays, each with its own stack, gained nothing: mispredictions dominate, and each one
        /// discards the work of both rays.
        #[inline(never)]
        $(#[$attribute])*
        fn intersect_each<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            hits: &mut Vec<Option<Hit>>,
        ) {
            hits.reserve(rays.len());
            for ray in rays {
                let start = Child::node(0);
                hits.push(closest::<$simd, P>(bvh, ray, primitives, Hit::NO_INSTANCE, start));
            }
        }

        /// As `intersect_each`.
        #[inline(never)]
        $(#[$attribute])*
        fn occluded_each<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            occluded: &mut Vec<bool>,
        ) {
            occluded.reserve(rays.len());
            for ray in rays {
                let start = Child::node(0);
                occluded.push(any::<$simd, P>(bvh, ray, primitives, Hit::NO_INSTANCE, start));
            }
        }

        #[inline(never)]
        $(#[$attribute])*
        fn intersect_packets<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            hits: &mut Vec<Option<Hit>>,
        ) {
            let trace_single = |ray: &Ray, child| intersect_below(bvh, ray, primitives, child);
            packet::intersect_many::<$wide>(bvh, rays, trace_single, hits);
        }

        #[inline(never)]
        $(#[$attribute])*
        pub(in super::super) fn intersect_many<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            hits: &mut Vec<Option<Hit>>,
        ) {
            let mut rest = rays;
            while !rest.is_empty() {
                let (count, coherent) = packet::coherence::next_run::<$wide>(bvh, rest);
                let (rays, later) = rest.split_at(count);
                rest = later;
                if coherent {
                    intersect_packets(bvh, rays, primitives, hits);
                } else {
                    intersect_each(bvh, rays, primitives, hits);
                }
            }
        }

        #[inline(never)]
        $(#[$attribute])*
        fn occluded_packets<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            occluded: &mut Vec<bool>,
        ) {
            let trace_single = |ray: &Ray, child| occluded_below(bvh, ray, primitives, child);
            packet::occluded_many::<$wide>(bvh, rays, trace_single, occluded);
        }

        #[inline(never)]
        $(#[$attribute])*
        pub(in super::super) fn occluded_many<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            occluded: &mut Vec<bool>,
        ) {
            let mut rest = rays;
            while !rest.is_empty() {
                let (count, coherent) = packet::coherence::next_run::<$wide>(bvh, rest);
                let (rays, later) = rest.split_at(count);
                rest = later;
                if coherent {
                    occluded_packets(bvh, rays, primitives, occluded);
                } else {
                    occluded_each(bvh, rays, primitives, occluded);
                }
            }
        }
    };
}

pub(super) mod portable {
    use super::*;
    use crate::simd::portable::Portable;

    single!(Portable,);
}

#[cfg(target_arch = "x86_64")]
pub(super) mod avx2 {
    use super::*;
    use crate::simd::avx2::Avx2;

    single!(Avx2, #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]);
    packets!(Avx2, Avx2, #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]);
}

#[cfg(target_arch = "x86_64")]
pub(super) mod avx512 {
    use super::*;
    use crate::simd::{avx2::Avx2, wide_avx512::Avx512};

    single!(
        Avx2,
        #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    );
    packets!(
        Avx2,
        Avx512,
        #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    );
}
