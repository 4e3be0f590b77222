//! The nearest hits of a packet.

use super::rays::Packet;
use super::triangles::{Candidates, Survivors};
use super::walk::Query;
use crate::bvh::{Bvh, Hit};
use crate::node::{Child, TriangleBlock};
use crate::simd::wide::{MOST, Row, Wide};
use crate::traverse::ray::RayConstants;
use crate::triangle::{Resolved, resolve};
use crate::triangle_numbers::TriangleNumbers;
use etendue_math::Ray;
use std::mem::MaybeUninit;

/// No triangle's name.
const NONE: u32 = u32::MAX;

/// The nearest hits so far.
pub(super) struct Closest<'a, F> {
    names: &'a TriangleNumbers,
    rays: &'a [Ray],
    /// The nearest hit of a ray below a child.
    alone: F,
    /// The distances; hits count up to them, inclusive.
    t: Row,
    /// The edge functions and their sums where a triangle is hit.
    v: Row,
    w: Row,
    determinant: Row,
    /// Where hits are equally far, triangles with lower names than these count: the triangle that
    /// is hit, or [`TriangleNumbers::bound`] of what else is, or [`NONE`].
    name: Row<u32>,
    /// The lanes whose hit is in `hits`.
    whole: u32,
    hits: [MaybeUninit<Hit>; MOST],
}

/// Of hits that are equally far that of the lowest rank counts.
fn rank(hit: &Hit) -> (u32, u32, u32) {
    (hit.instance, hit.geometry, hit.primitive)
}

impl<'a, F: Fn(&Ray, Child) -> Option<Hit>> Closest<'a, F> {
    #[inline(always)]
    pub(super) fn new<W: Wide>(
        bvh: &'a Bvh,
        rays: &'a [Ray],
        packet: &Packet<W>,
        alone: F,
    ) -> Self {
        let none = Row([0.0; MOST]);
        Self {
            names: &bvh.names,
            rays,
            alone,
            t: W::store(packet.t_max),
            v: none,
            w: none,
            determinant: none,
            name: Row([NONE; MOST]),
            whole: 0,
            hits: [MaybeUninit::uninit(); MOST],
        }
    }

    /// Takes a triangle for the rays that hit it.
    #[inline(always)]
    fn take<W: Wide>(&mut self, name: u32, candidates: &Candidates<W>) {
        let mut lanes = candidates.mask & W::less(candidates.t, W::load(&self.t));
        let ties = candidates.mask & !lanes;
        if ties != 0 {
            lanes |= self.yielding(ties, name);
        }
        put::<W>(&mut self.t, lanes, candidates.t);
        put::<W>(&mut self.v, lanes, candidates.v);
        put::<W>(&mut self.w, lanes, candidates.w);
        put::<W>(&mut self.determinant, lanes, candidates.determinant);
        W::set_words(&mut self.name, lanes, name);
        self.whole &= !lanes;
    }

    /// The lanes whose hit yields to a triangle that is as far.
    #[cold]
    #[inline(never)]
    fn yielding(&self, ties: u32, name: u32) -> u32 {
        lanes_of(ties).filter(|&lane| name < self.name.0[lane]).fold(0, |set, lane| set | 1 << lane)
    }

    /// Decides what single precision leaves open.
    #[cold]
    #[inline(never)]
    fn take_doubtful(&mut self, doubtful: u32, block: &TriangleBlock, triangle: usize) {
        let name = block.names[triangle];
        for lane in lanes_of(doubtful) {
            let Some(constants) = RayConstants::new(&self.rays[lane]) else { continue };
            let nearest = self.t.0[lane];
            let Resolved { mask, t, v, w } = resolve(1 << triangle, block, &constants, nearest);
            let t = t.0[triangle];
            if mask != 0 && (t < nearest || name < self.name.0[lane]) {
                self.t.0[lane] = t;
                (self.v.0[lane], self.w.0[lane]) = (v.0[triangle], w.0[triangle]);
                self.determinant.0[lane] = 1.0;
                self.name.0[lane] = name;
                self.whole &= !(1 << lane);
            }
        }
    }

    /// Takes a hit if it is nearer, or as near and of a lower rank.
    fn offer(&mut self, lane: usize, hit: Hit) {
        let nearer = hit.t < self.t.0[lane]
            || (hit.t == self.t.0[lane] && self.found(lane).is_none_or(|found| rank(&hit) < found));
        if nearer {
            self.t.0[lane] = hit.t;
            self.name.0[lane] = match hit.instance {
                Hit::NO_INSTANCE => self.names.bound(hit.geometry, hit.primitive),
                // Before all triangles that are in none.
                _ => 0,
            };
            self.whole |= 1 << lane;
            self.hits[lane].write(hit);
        }
    }

    /// The rank of a lane's hit.
    fn found(&self, lane: usize) -> Option<(u32, u32, u32)> {
        if self.whole >> lane & 1 != 0 {
            return Some(rank(&self.whole(lane)));
        }
        let name = self.name.0[lane];
        (name != NONE).then(|| {
            let (geometry, primitive) = self.names.resolve(name);
            (Hit::NO_INSTANCE, geometry, primitive)
        })
    }

    /// The hit of a lane of `whole`.
    fn whole(&self, lane: usize) -> Hit {
        assert!(self.whole >> lane & 1 != 0);
        // SAFETY: `offer` sets the bit when it has written the hit.
        unsafe { self.hits[lane].assume_init() }
    }

    /// Writes the hits of all rays; those that are not `ordinary` go alone.
    #[inline(always)]
    pub(super) fn finish<W: Wide>(mut self, ordinary: u32, hits: &mut [Option<Hit>]) {
        let determinant = W::load(&self.determinant);
        let (v, w) = (W::load(&self.v), W::load(&self.w));
        self.v = W::store(W::divide(v, determinant));
        self.w = W::store(W::divide(w, determinant));
        let odd = !ordinary & ((1 << self.rays.len()) - 1);
        if self.whole | odd != 0 {
            self.finish_others(odd, hits);
        }
        for (lane, hit) in hits.iter_mut().enumerate().take(W::LANES) {
            let name = self.name.0[lane];
            if name == NONE {
                continue;
            }
            let (geometry, primitive) = self.names.resolve(name);
            let (t, u, v) = (self.t.0[lane], self.v.0[lane], self.w.0[lane]);
            *hit = Some(Hit { t, u, v, geometry, primitive, instance: Hit::NO_INSTANCE });
        }
    }

    /// As [`Self::finish`], of lanes that have a whole hit and of those that are `odd`.
    #[cold]
    #[inline(never)]
    fn finish_others(&mut self, odd: u32, hits: &mut [Option<Hit>]) {
        for lane in lanes_of(self.whole) {
            hits[lane] = Some(self.whole(lane));
            self.name.0[lane] = NONE;
        }
        for lane in lanes_of(odd) {
            hits[lane] = (self.alone)(&self.rays[lane], Child::node(0));
        }
    }
}

/// Replaces some numbers of a row.
#[inline(always)]
fn put<W: Wide>(row: &mut Row, lanes: u32, vector: W::Vector) {
    *row = W::store(W::select(lanes, vector, W::load(row)));
}

/// The lanes of a set.
pub(super) fn lanes_of(lanes: u32) -> impl Iterator<Item = usize> {
    (0..MOST).filter(move |lane| lanes >> lane & 1 != 0)
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
                self.take(block.names[candidates.triangle], &candidates);
            }
            if candidates.doubtful != 0 {
                self.take_doubtful(candidates.doubtful, block, candidates.triangle);
            }
        }
    }

    #[inline(always)]
    fn alone(&mut self, lanes: u32, child: Child) {
        for lane in lanes_of(lanes) {
            // One step beyond the nearest hit, for the hits that are as near.
            let ray = Ray { t_max: self.t.0[lane].next_up(), ..self.rays[lane] };
            if let Some(hit) = (self.alone)(&ray, child) {
                self.offer(lane, hit);
            }
        }
    }
}
