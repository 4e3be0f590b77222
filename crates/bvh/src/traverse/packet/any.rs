//! Any-hit queries for a packet.

use super::rays::Packet;
use super::triangles::Survivors;
use super::walk::{Query, lanes_of};
use crate::node::{Child, TriangleBlock};
use crate::simd::wide::{Row, Wide};
use crate::traverse::ray::RayConstants;
use crate::triangle::resolve;
use etendue_math::Ray;

/// The state of the query.
pub(super) struct Any<'a, F> {
    rays: &'a [Ray],
    /// Whether a single ray hits anything below a child.
    trace_single: F,
    /// The rays' ends, or -1 where a hit has been found.
    t_max: Row,
    /// The rays that hit something.
    found: u32,
}

impl<'a, F: Fn(&Ray, Child) -> bool> Any<'a, F> {
    #[inline(always)]
    pub(super) fn new<W: Wide>(rays: &'a [Ray], packet: &Packet<W>, trace_single: F) -> Self {
        Self { rays, trace_single, t_max: W::store(packet.t_max), found: 0 }
    }

    /// The results for all rays. Those that are not `regular` are traced singly.
    #[inline(always)]
    pub(super) fn finish(self, regular: u32) -> impl Iterator<Item = bool> {
        let irregular = !regular & ((1 << self.rays.len()) - 1);
        let trace = |lane: usize| (self.trace_single)(&self.rays[lane], Child::node(0));
        let found = match irregular {
            0 => self.found,
            _ => lanes_of(irregular)
                .fold(self.found, |set, lane| set | u32::from(trace(lane)) << lane),
        };
        (0..self.rays.len()).map(move |lane| found >> lane & 1 != 0)
    }

    /// Which of the rays in `uncertain` hit a triangle.
    #[cold]
    #[inline(never)]
    fn decide(&self, uncertain: u32, block: &TriangleBlock, triangle: usize) -> u32 {
        let hits = |lane: &usize| {
            RayConstants::new(&self.rays[*lane]).is_some_and(|constants| {
                resolve(1 << triangle, block, &constants, self.t_max.0[*lane]).mask != 0
            })
        };
        lanes_of(uncertain).filter(hits).fold(0, |set, lane| set | 1 << lane)
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
            let uncertain = candidates.uncertain & !hits;
            if uncertain != 0 {
                hits |= self.decide(uncertain, block, candidates.triangle);
            }
        }
        self.end::<W>(hits);
    }

    #[inline(always)]
    fn trace_singly(&mut self, lanes: u32, child: Child) {
        let mut hits = 0;
        for lane in lanes_of(lanes) {
            let ray = Ray { t_max: self.t_max.0[lane].next_up(), ..self.rays[lane] };
            hits |= u32::from((self.trace_single)(&ray, child)) << lane;
        }
        self.end::<W>(hits);
    }
}
