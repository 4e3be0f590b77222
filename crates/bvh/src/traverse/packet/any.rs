//! Whether the rays of a packet hit anything.

use super::closest::lanes_of;
use super::rays::Packet;
use super::triangles::Survivors;
use super::walk::Query;
use crate::node::{Child, TriangleBlock};
use crate::simd::wide::{Row, Wide};
use crate::traverse::ray::RayConstants;
use crate::triangle::resolve;
use etendue_math::Ray;

/// What has been found so far.
pub(super) struct Any<'a, F> {
    rays: &'a [Ray],
    /// Whether a ray hits anything below a child.
    alone: F,
    /// The rays' ends, or below zero where a hit has been found.
    t_max: Row,
    /// The rays that hit something.
    found: u32,
}

impl<'a, F: Fn(&Ray, Child) -> bool> Any<'a, F> {
    #[inline(always)]
    pub(super) fn new<W: Wide>(rays: &'a [Ray], packet: &Packet<W>, alone: F) -> Self {
        Self { rays, alone, t_max: W::store(packet.t_max), found: 0 }
    }

    /// The answers for all rays; those that are not `ordinary` go alone.
    #[inline(always)]
    pub(super) fn finish(self, ordinary: u32) -> impl Iterator<Item = bool> {
        let odd = !ordinary & ((1 << self.rays.len()) - 1);
        let alone = |lane: usize| (self.alone)(&self.rays[lane], Child::node(0));
        let found = match odd {
            0 => self.found,
            _ => lanes_of(odd).fold(self.found, |set, lane| set | u32::from(alone(lane)) << lane),
        };
        (0..self.rays.len()).map(move |lane| found >> lane & 1 != 0)
    }

    /// The rays of `doubtful` that hit a triangle.
    #[cold]
    #[inline(never)]
    fn decide(&self, doubtful: u32, block: &TriangleBlock, triangle: usize) -> u32 {
        let hits = |lane: &usize| {
            RayConstants::new(&self.rays[*lane]).is_some_and(|constants| {
                resolve(1 << triangle, block, &constants, self.t_max.0[*lane]).mask != 0
            })
        };
        lanes_of(doubtful).filter(hits).fold(0, |set, lane| set | 1 << lane)
    }

    #[inline(always)]
    fn end<W: Wide>(&mut self, lanes: u32) {
        self.found |= lanes;
        let ends = W::select(lanes, W::splat(-1.0), W::load(&self.t_max));
        self.t_max = W::store(ends);
    }
}

impl<W: Wide, F: Fn(&Ray, Child) -> bool> Query<W> for Any<'_, F> {
    const SORTED: bool = false;

    #[inline(always)]
    fn limit(&self) -> W::Vector {
        W::load(&self.t_max)
    }

    #[inline(always)]
    fn block(&mut self, rays: &Packet<W>, lanes: u32, block: &TriangleBlock) {
        let mut survivors = Survivors::new();
        survivors.find(block, rays, lanes);
        let limit = W::load(&self.t_max);
        let mut hits = 0;
        for number in 0..survivors.count() {
            let candidates = survivors.hits(number, rays, limit);
            hits |= candidates.mask;
            let doubtful = candidates.doubtful & !hits;
            if doubtful != 0 {
                hits |= self.decide(doubtful, block, candidates.triangle);
            }
        }
        self.end::<W>(hits);
    }

    #[inline(always)]
    fn alone(&mut self, lanes: u32, child: Child) {
        let mut hits = 0;
        for lane in lanes_of(lanes) {
            let ray = Ray { t_max: self.t_max.0[lane].next_up(), ..self.rays[lane] };
            hits |= u32::from((self.alone)(&ray, child)) << lane;
        }
        self.end::<W>(hits);
    }
}
