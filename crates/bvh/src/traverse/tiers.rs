//! The entry points: the one body of each traversal, compiled for the instructions of each tier.
//!
//! All are out of line, so that the choice of the tier is a jump and not a frame of its own.

#[cfg(target_arch = "x86_64")]
use super::packet;
use super::{any::any, closest::closest};
use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::node::Child;
use etendue_math::Ray;

/// One ray's entry points of a tier.
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

/// Many rays' entry points of a tier that has packets.
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

        #[inline(never)]
        $(#[$attribute])*
        pub(in super::super) fn intersect_many<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            hits: &mut Vec<Option<Hit>>,
        ) {
            if !packet::pays(bvh) {
                hits.reserve(rays.len());
                for ray in rays {
                    let start = Child::node(0);
                    let hit = closest::<$simd, P>(bvh, ray, primitives, Hit::NO_INSTANCE, start);
                    hits.push(hit);
                }
                return;
            }
            let alone = |ray: &Ray, child| intersect_below(bvh, ray, primitives, child);
            packet::intersect_many::<$wide>(bvh, rays, alone, hits);
        }

        #[inline(never)]
        $(#[$attribute])*
        pub(in super::super) fn occluded_many<P: Primitives>(
            bvh: &Bvh,
            rays: &[Ray],
            primitives: &P,
            occluded: &mut Vec<bool>,
        ) {
            if !packet::pays(bvh) {
                occluded.reserve(rays.len());
                for ray in rays {
                    let start = Child::node(0);
                    occluded.push(any::<$simd, P>(bvh, ray, primitives, Hit::NO_INSTANCE, start));
                }
                return;
            }
            let alone = |ray: &Ray, child| occluded_below(bvh, ray, primitives, child);
            packet::occluded_many::<$wide>(bvh, rays, alone, occluded);
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
