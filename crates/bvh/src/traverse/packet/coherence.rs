//! Decides which rays are traced in packets.

use crate::bvh::Bvh;
use crate::simd::wide::Wide;
use etendue_math::Ray;

/// In trees with this many nodes or fewer, packets are faster even for incoherent rays.
const SMALL_TREE: usize = 8;

/// Fewer rays than this are faster one by one.
const MIN_RAYS: usize = 4;

/// The least squared cosine between the directions of coherent rays.
const MIN_COSINE_SQUARED: f32 = 0.8;

/// The greatest distance between the origins of coherent rays, as a fraction of the tree's extent.
const MAX_DISTANCE: f32 = 0.1;

/// The length of the first run of rays to be traced in the same way (at least one if there are any
/// rays), and whether that is in packets.
#[inline(always)]
pub(in super::super) fn next_run<W: Wide>(bvh: &Bvh, rays: &[Ray]) -> (usize, bool) {
    let small = bvh.nodes.len() <= SMALL_TREE;
    let reach = MAX_DISTANCE * bvh.bounds.extent().max_element();
    let (mut count, mut choice) = (0, false);
    while count < rays.len() {
        let end = rays.len().min(count + W::LANES);
        let packet = &rays[count..end];
        let coherent = packet.len() >= MIN_RAYS && (small || are_coherent(packet, reach));
        if count == 0 {
            choice = coherent;
        } else if choice != coherent {
            break;
        }
        count = end;
    }
    (count, choice)
}

/// Whether a sample of the rays start near each other and have similar directions.
#[inline(always)]
fn are_coherent(rays: &[Ray], reach: f32) -> bool {
    let first = &rays[0];
    let agrees = |ray: &Ray| {
        let cosine = ray.direction.dot(first.direction);
        let lengths = ray.direction.length_squared() * first.direction.length_squared();
        // A single comparison, which usually fails unless most rays pass: a branch on the sign of
        // the cosine is unpredictable and cost a few percent.
        cosine * cosine.abs() >= MIN_COSINE_SQUARED * lengths
            && (ray.origin - first.origin).abs().max_element() <= reach
    };
    agrees(&rays[rays.len() - 1])
        && agrees(&rays[rays.len() / 3])
        && agrees(&rays[rays.len() * 2 / 3])
}
