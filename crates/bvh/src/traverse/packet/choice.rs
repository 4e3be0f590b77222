//! Which rays go in packets.

use crate::bvh::Bvh;
use crate::simd::wide::Wide;
use etendue_math::Ray;

/// In trees of so few nodes packets are faster whatever the rays are.
const SMALL: usize = 8;

/// Fewer rays are faster one after another.
const LEAST_RAYS: usize = 4;

/// The least cosine squared between the directions of coherent rays.
const LEAST_COSINE_SQUARED: f32 = 0.8;

/// How far apart their origins may lie, as a part of the extent of the tree.
const GREATEST_DISTANCE: f32 = 0.1;

/// How many of the rays go on alike, at least one if there are any, and whether in packets.
#[inline(always)]
pub(in super::super) fn next_run<W: Wide>(bvh: &Bvh, rays: &[Ray]) -> (usize, bool) {
    let small = bvh.nodes.len() <= SMALL;
    let reach = GREATEST_DISTANCE * bvh.bounds.extent().max_element();
    let (mut count, mut choice) = (0, false);
    while count < rays.len() {
        let end = rays.len().min(count + W::LANES);
        let packet = &rays[count..end];
        let together = packet.len() >= LEAST_RAYS && (small || are_coherent(packet, reach));
        if count == 0 {
            choice = together;
        } else if choice != together {
            break;
        }
        count = end;
    }
    (count, choice)
}

/// Whether rays that are spread over a packet start near each other and go the same way.
#[inline(always)]
fn are_coherent(rays: &[Ray], reach: f32) -> bool {
    let first = &rays[0];
    let agrees = |ray: &Ray| {
        let cosine = ray.direction.dot(first.direction);
        let lengths = ray.direction.length_squared() * first.direction.length_squared();
        // In one comparison, which seldom holds unless it mostly does: a branch on the cosine's sign
        // cannot be foretold, and cost a few in a hundred.
        cosine * cosine.abs() >= LEAST_COSINE_SQUARED * lengths
            && (ray.origin - first.origin).abs().max_element() <= reach
    };
    agrees(&rays[rays.len() - 1])
        && agrees(&rays[rays.len() / 3])
        && agrees(&rays[rays.len() * 2 / 3])
}
