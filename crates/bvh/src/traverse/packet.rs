//! Ray packets: one ray per SIMD lane.
//!
//! A box or triangle is tested against all rays of a packet at once. This pays off where most of
//! them meet the same boxes: always in small trees, and where rays are coherent. The tests, and so
//! the hits, are those of single rays to the last bit. Where only a few rays of a packet remain
//! active, they are traced singly, as are rays whose coordinates may overflow.

mod any;
mod closest;
pub(super) mod coherence;
mod rays;
mod triangles;
mod walk;

use crate::bvh::Bvh;
use crate::hit::Hit;
use crate::node::Child;
use crate::simd::wide::Wide;
use etendue_math::Ray;
use rays::{Columns, Packet};

/// Appends the nearest hits of many rays. `trace_single` finds the hit of one ray below a child.
#[inline(always)]
pub(super) fn intersect_many<W: Wide>(
    bvh: &Bvh,
    rays: &[Ray],
    trace_single: impl Fn(&Ray, Child) -> Option<Hit> + Copy,
    hits: &mut Vec<Option<Hit>>,
) {
    let reach = reach(bvh);
    let first = hits.len();
    hits.resize(first + rays.len(), None);
    let mut hits = hits[first..].chunks_mut(W::LANES);
    let packets = rays.chunks(W::LANES);
    let mut columns = [Columns::EMPTY; 2];
    columns[0].fill::<W>(packets.clone().next().unwrap_or_default());
    for (number, rays) in packets.clone().enumerate() {
        let hits = hits.next().unwrap_or_default();
        columns[(number + 1) % 2].fill::<W>(packets.clone().nth(number + 1).unwrap_or_default());
        let packet = Packet::<W>::new(&columns[number % 2], reach);
        let mut query = closest::Closest::new(bvh, rays, &packet, trace_single);
        walk::walk::<W, _>(bvh, &packet, packet.regular, &mut query);
        query.finish::<W>(packet.regular, hits);
    }
}

/// Appends for each ray whether it hits anything. `trace_single` tests one ray below a child.
#[inline(always)]
pub(super) fn occluded_many<W: Wide>(
    bvh: &Bvh,
    rays: &[Ray],
    trace_single: impl Fn(&Ray, Child) -> bool + Copy,
    occluded: &mut Vec<bool>,
) {
    let reach = reach(bvh);
    let packets = rays.chunks(W::LANES);
    let mut columns = [Columns::EMPTY; 2];
    columns[0].fill::<W>(packets.clone().next().unwrap_or_default());
    for (number, rays) in packets.clone().enumerate() {
        columns[(number + 1) % 2].fill::<W>(packets.clone().nth(number + 1).unwrap_or_default());
        let packet = Packet::<W>::new(&columns[number % 2], reach);
        let mut query = any::Any::new(rays, &packet, trace_single);
        walk::walk::<W, _>(bvh, &packet, packet.regular, &mut query);
        occluded.extend(query.finish(packet.regular));
    }
}

/// The greatest coordinate in the tree by magnitude.
fn reach(bvh: &Bvh) -> f32 {
    bvh.bounds.min.abs().max(bvh.bounds.max.abs()).max_element()
}

#[cfg(test)]
mod tests {
    use crate::{BuildOptions, Bvh, GeometryView, NoPrimitives, Tier, TriangleMeshView};
    use etendue_math::Ray;
    use glam::Vec3;

    /// In tests, packets descend only two levels (`walk::DEPTH`).
    #[test]
    fn rays_are_traced_singly_below_the_deepest_packet_level() {
        let place = |index: u32, scale: f32| (index % 40) as f32 * scale;
        let positions: Vec<Vec3> = (0..1600)
            .map(|index| Vec3::new(place(index, 1.0), (index / 40) as f32, place(index, 0.01)))
            .collect();
        let indices: Vec<[u32; 3]> = (0..1599 - 40)
            .flat_map(|index| [[index, index + 1, index + 40], [index + 1, index + 40, index + 41]])
            .collect();
        let mesh = TriangleMeshView { positions: &positions, indices: &indices };
        let built = Bvh::build(&[GeometryView::Triangles(mesh)], &BuildOptions::default());
        let built = built.expect("valid");
        assert!(built.statistics().depth > 2, "{:?}", built.statistics());
        let rays: Vec<Ray> = (0..640)
            .map(|index| {
                let aside = Vec3::new((index % 32) as f32, (index / 32) as f32, 0.0) * 0.1;
                Ray::new(Vec3::new(20.0, 15.0, 40.0), Vec3::new(-1.0, -1.0, -30.0) + aside)
            })
            .collect();
        for tier in [Tier::Portable, Tier::Avx2, Tier::Avx512] {
            let bvh = built.clone().with_tier(tier);
            let (mut hits, mut occluded) = (Vec::new(), Vec::new());
            bvh.intersect_many(&rays, &NoPrimitives, &mut hits);
            bvh.occluded_many(&rays, &NoPrimitives, &mut occluded);
            for ((ray, hit), occluded) in rays.iter().zip(hits).zip(occluded) {
                assert_eq!(hit, bvh.intersect(ray, &NoPrimitives), "{tier:?} {ray:?}");
                assert_eq!(occluded, hit.is_some(), "{tier:?} {ray:?}");
            }
            assert!(bvh.intersect(&rays[0], &NoPrimitives).is_some());
        }
    }
}
