//! Closest-hit queries for a packet.

use super::rays::Packet;
use super::triangles::{Candidates, Survivors};
use super::walk::{Query, lanes_of};
use crate::bvh::Bvh;
use crate::hit::Hit;
use crate::node::{Child, TriangleBlock};
use crate::simd::wide::{MAX_LANES, Row, Wide};
use crate::traverse::ray::RayConstants;
use crate::triangle::{Resolved, resolve};
use crate::triangle_ids::TriangleIds;
use etendue_math::Ray;
use std::mem::MaybeUninit;

/// The id of no triangle.
const NONE: u32 = u32::MAX;

/// The nearest hits so far.
pub(super) struct Closest<'a, F> {
    ids: &'a TriangleIds,
    rays: &'a [Ray],
    /// The nearest hit of a single ray below a child.
    trace_single: F,
    /// The distances; hits up to and including them count.
    t: Row,
    /// The edge functions and their sums where a triangle is hit.
    v: Row,
    w: Row,
    determinant: Row,
    /// At equal distances, triangles with a lower id than this win: the id of the triangle that is
    /// hit, [`TriangleIds::lower_bound`] of another primitive that is hit, or [`NONE`].
    id: Row<u32>,
    /// The lanes whose hit is stored in `hits`.
    stored: u32,
    hits: [MaybeUninit<Hit>; MAX_LANES],
}

impl<'a, F: Fn(&Ray, Child) -> Option<Hit>> Closest<'a, F> {
    #[inline(always)]
    pub(super) fn new<W: Wide>(
        bvh: &'a Bvh,
        rays: &'a [Ray],
        packet: &Packet<W>,
        trace_single: F,
    ) -> Self {
        let zeros = Row([0.0; MAX_LANES]);
        Self {
            ids: &bvh.triangle_ids,
            rays,
            trace_single,
            t: W::store(packet.t_max),
            v: zeros,
            w: zeros,
            determinant: zeros,
            id: Row([NONE; MAX_LANES]),
            stored: 0,
            hits: [MaybeUninit::uninit(); MAX_LANES],
        }
    }

    /// Records a triangle for the rays that hit it.
    #[inline(always)]
    fn take<W: Wide>(&mut self, id: u32, candidates: &Candidates<W>) {
        let mut lanes = candidates.mask & W::less(candidates.t, W::load(&self.t));
        let ties = candidates.mask & !lanes;
        if ties != 0 {
            lanes |= self.lost_ties(ties, id);
        }
        put::<W>(&mut self.t, lanes, candidates.t);
        put::<W>(&mut self.v, lanes, candidates.v);
        put::<W>(&mut self.w, lanes, candidates.w);
        put::<W>(&mut self.determinant, lanes, candidates.determinant);
        W::set_words(&mut self.id, lanes, id);
        self.stored &= !lanes;
    }

    /// The lanes of `ties` in which a triangle takes precedence over the current hit.
    #[cold]
    #[inline(never)]
    fn lost_ties(&self, ties: u32, id: u32) -> u32 {
        lanes_of(ties).filter(|&lane| id < self.id.0[lane]).fold(0, |set, lane| set | 1 << lane)
    }

    /// Decides the lanes that single precision cannot.
    #[cold]
    #[inline(never)]
    fn take_uncertain(&mut self, uncertain: u32, block: &TriangleBlock, triangle: usize) {
        let id = block.ids[triangle];
        for lane in lanes_of(uncertain) {
            let Some(constants) = RayConstants::new(&self.rays[lane]) else { continue };
            let nearest = self.t.0[lane];
            let Resolved { mask, t, v, w } = resolve(1 << triangle, block, &constants, nearest);
            let t = t.0[triangle];
            if mask != 0 && (t < nearest || id < self.id.0[lane]) {
                self.t.0[lane] = t;
                (self.v.0[lane], self.w.0[lane]) = (v.0[triangle], w.0[triangle]);
                self.determinant.0[lane] = 1.0;
                self.id.0[lane] = id;
                self.stored &= !(1 << lane);
            }
        }
    }

    /// Takes a hit if it is nearer, or equally near with a lower rank.
    fn offer(&mut self, lane: usize, hit: Hit) {
        let nearer = hit.t < self.t.0[lane]
            || (hit.t == self.t.0[lane] && self.rank(lane).is_none_or(|rank| hit.rank() < rank));
        if nearer {
            self.t.0[lane] = hit.t;
            self.id.0[lane] = match hit.instance {
                Hit::NO_INSTANCE => self.ids.lower_bound(hit.geometry, hit.primitive),
                // Hits in instances come before all triangles outside.
                _ => 0,
            };
            self.stored |= 1 << lane;
            self.hits[lane].write(hit);
        }
    }

    /// The rank of a lane's hit.
    fn rank(&self, lane: usize) -> Option<(u32, u32, u32)> {
        if self.stored >> lane & 1 != 0 {
            return Some(self.stored_hit(lane).rank());
        }
        let id = self.id.0[lane];
        (id != NONE).then(|| {
            let (geometry, primitive) = self.ids.resolve(id);
            (Hit::NO_INSTANCE, geometry, primitive)
        })
    }

    /// The hit of a lane in `stored`.
    fn stored_hit(&self, lane: usize) -> Hit {
        assert!(self.stored >> lane & 1 != 0);
        // SAFETY: `offer` writes the hit before it sets the bit.
        unsafe { self.hits[lane].assume_init() }
    }

    /// Writes the hits of all rays. Those that are not `regular` are traced singly.
    #[inline(always)]
    pub(super) fn finish<W: Wide>(mut self, regular: u32, hits: &mut [Option<Hit>]) {
        let determinant = W::load(&self.determinant);
        let (v, w) = (W::load(&self.v), W::load(&self.w));
        self.v = W::store(W::divide(v, determinant));
        self.w = W::store(W::divide(w, determinant));
        let irregular = !regular & ((1 << self.rays.len()) - 1);
        if self.stored | irregular != 0 {
            self.finish_others(irregular, hits);
        }
        for (lane, hit) in hits.iter_mut().enumerate().take(W::LANES) {
            let id = self.id.0[lane];
            if id == NONE {
                continue;
            }
            let (geometry, primitive) = self.ids.resolve(id);
            let (t, u, v) = (self.t.0[lane], self.v.0[lane], self.w.0[lane]);
            *hit = Some(Hit { t, u, v, geometry, primitive, instance: Hit::NO_INSTANCE });
        }
    }

    /// As [`Self::finish`], for stored hits and irregular rays.
    #[cold]
    #[inline(never)]
    fn finish_others(&mut self, irregular: u32, hits: &mut [Option<Hit>]) {
        for lane in lanes_of(self.stored) {
            hits[lane] = Some(self.stored_hit(lane));
            self.id.0[lane] = NONE;
        }
        for lane in lanes_of(irregular) {
            hits[lane] = (self.trace_single)(&self.rays[lane], Child::node(0));
        }
    }
}

/// Replaces the given lanes of a row.
#[inline(always)]
fn put<W: Wide>(row: &mut Row, lanes: u32, vector: W::Vector) {
    *row = W::store(W::select(lanes, vector, W::load(row)));
}

impl<W: Wide, F: Fn(&Ray, Child) -> Option<Hit>> Query<W> for Closest<'_, F> {
    const SORTED: bool = true;

    #[inline(always)]
    fn limit(&self) -> W::Vector {
        W::load(&self.t)
    }

    #[inline(always)]
    fn block(&mut self, rays: &Packet<W>, lanes: u32, block: &TriangleBlock) {
        let mut survivors = Survivors::new();
        survivors.find(block, rays, lanes);
        for number in 0..survivors.count() {
            let candidates = survivors.hits(number, rays, W::load(&self.t));
            if candidates.mask != 0 {
                self.take(block.ids[candidates.triangle], &candidates);
            }
            if candidates.uncertain != 0 {
                self.take_uncertain(candidates.uncertain, block, candidates.triangle);
            }
        }
    }

    #[inline(always)]
    fn trace_singly(&mut self, lanes: u32, child: Child) {
        for lane in lanes_of(lanes) {
            // One step beyond the nearest hit, to include hits at the same distance.
            let ray = Ray { t_max: self.t.0[lane].next_up(), ..self.rays[lane] };
            if let Some(hit) = (self.trace_single)(&ray, child) {
                self.offer(lane, hit);
            }
        }
    }
}
