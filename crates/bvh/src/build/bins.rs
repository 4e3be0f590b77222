//! Bins along the axes, and the best plane between them.

use super::extent::{Box4, Extent};
use super::reference::Reference;
use crate::node::WIDTH;
use glam::Vec4;
use std::ops::Range;

pub(super) const MAX_BINS: usize = 16;

/// The mapping of centres to bins.
#[derive(Clone, Copy)]
pub(super) struct Binning {
    pub(super) origin: Vec4,
    pub(super) scale: Vec4,
}

/// Adding this to a small non-negative float rounds it into the lowest bits of the sum. Much faster
/// than a conversion to an integer, which saturates in Rust.
const TO_LOW_BITS: f32 = 8_388_608.0;

impl Binning {
    /// A mapping to `count` bins per axis.
    pub(super) fn new(extent: &Extent, count: usize) -> Self {
        let size = extent.centers.extent();
        let scale = Vec4::splat(count as f32 - 1.0) / size;
        // Treat an axis as flat if all centres agree, or if the scale overflows.
        let usable = size.cmpgt(Vec4::ZERO) & scale.cmplt(Vec4::splat(f32::MAX));
        Self { origin: extent.centers.min, scale: Vec4::select(usable, scale, Vec4::ZERO) }
    }

    /// Three floats whose lowest bits, as many as [`MAX_BINS`] needs, are the bins of a centre.
    #[inline(always)]
    pub(super) fn place(&self, center: Vec4) -> Vec4 {
        (center - self.origin) * self.scale + Vec4::splat(TO_LOW_BITS)
    }

    #[inline(always)]
    pub(super) fn bins(&self, reference: &Reference) -> [usize; 3] {
        let place = self.place(reference.center());
        [place.x, place.y, place.z].map(|place| place.to_bits() as usize & (MAX_BINS - 1))
    }
}

/// A splitting plane. References go left if their position on the axis is below the limit.
pub(super) struct Plane {
    pub(super) binning: Binning,
    pub(super) axis: usize,
    pub(super) limit: f32,
}

/// A plane, and the boxes of its two sides.
pub(super) struct Split {
    pub(super) plane: Plane,
    pub(super) bounds: [Box4; 2],
}

/// The boxes and counts of the references in each bin of each axis.
pub(super) struct Bins {
    count: usize,
    pub(super) boxes: [[Box4; MAX_BINS]; 3],
    pub(super) counts: [[u32; MAX_BINS]; 3],
}

impl Bins {
    /// Empty bins, `count` of them in use on each axis.
    #[inline(always)]
    pub(super) fn new(count: usize) -> Self {
        // Not initialised one by one: the compiler then also copied the whole array.
        const EMPTY: Bins =
            Bins { count: 0, boxes: [[Box4::EMPTY; MAX_BINS]; 3], counts: [[0; MAX_BINS]; 3] };
        Self { count, ..EMPTY }
    }

    /// The same number of empty bins.
    #[inline(always)]
    pub(super) fn new_like(&self) -> Self {
        Self::new(self.count)
    }

    /// Adds the content of other bins.
    #[inline(always)]
    pub(super) fn merge(&mut self, others: &Self) {
        for axis in 0..3 {
            for bin in 0..self.count {
                self.boxes[axis][bin].grow(&others.boxes[axis][bin]);
                self.counts[axis][bin] += others.counts[axis][bin];
            }
        }
    }

    /// The cheapest plane between bins, or `None` if no plane separates the centres.
    #[inline(always)]
    pub(super) fn best_split(&self, binning: &Binning) -> Option<Split> {
        let best = self.best_plane();
        if best == NO_PLANE {
            return None;
        }
        let (axis, first_right) = (best as usize >> AXIS_SHIFT & 3, best as usize % MAX_BINS);
        let limit = TO_LOW_BITS + first_right as f32;
        let plane = Plane { binning: *binning, axis, limit };
        let bounds =
            [self.bounds(axis, 0..first_right), self.bounds(axis, first_right..self.count)];
        Some(Split { plane, bounds })
    }

    /// The box of everything in a range of bins.
    #[inline(always)]
    fn bounds(&self, axis: usize, bins: Range<usize>) -> Box4 {
        let mut bounds = Box4::EMPTY;
        self.boxes[axis][bins].iter().for_each(|bin| bounds.grow(bin));
        bounds
    }

    /// The cheapest plane packed into one integer: the bits of its cost, the axis, and the first
    /// bin of the right side. [`NO_PLANE`] if no plane separates the references.
    ///
    /// Without branches: most ranges are small, and their planes come in no order. Branches on
    /// which plane is better, or whether a side is empty, were mispredicted eight times per split,
    /// which took longer than the arithmetic. An empty side costs ∞ · 0 = NaN, whose bits exceed
    /// those of any cost. (A cost may be −0.)
    #[inline(always)]
    fn best_plane(&self) -> u64 {
        let mut right_costs = [[0.0; 3]; MAX_BINS];
        let mut sides = [Side::NOTHING; 3];
        for bin in (1..self.count).rev() {
            for (axis, side) in sides.iter_mut().enumerate() {
                side.add(&self.boxes[axis][bin], self.counts[axis][bin]);
                right_costs[bin][axis] = side.cost();
            }
        }
        let mut best = NO_PLANE;
        let mut sides = [Side::NOTHING; 3];
        for (bin, right_costs) in right_costs.iter().enumerate().take(self.count).skip(1) {
            for (axis, (side, right_cost)) in sides.iter_mut().zip(right_costs).enumerate() {
                side.add(&self.boxes[axis][bin - 1], self.counts[axis][bin - 1]);
                let cost = side.cost() + right_cost;
                let place = (axis << AXIS_SHIFT | bin) as u64;
                best = best.min(u64::from(cost.abs().to_bits()) << 32 | place);
            }
        }
        best
    }
}

/// The packed form of no plane: the cost is infinite.
const NO_PLANE: u64 = (f32::INFINITY.to_bits() as u64) << 32;

const AXIS_SHIFT: u32 = MAX_BINS.ilog2();

/// The union of all bins on one side of a plane.
#[derive(Clone, Copy)]
struct Side {
    bounds: Box4,
    count: u32,
}

impl Side {
    const NOTHING: Self = Self { bounds: Box4::EMPTY, count: 0 };

    #[inline(always)]
    fn add(&mut self, bounds: &Box4, count: u32) {
        self.bounds.grow(bounds);
        self.count += count;
    }

    #[inline(always)]
    fn cost(&self) -> f32 {
        self.bounds.half_area() * weight(self.count)
    }
}

/// The weight of a number of references in the cost of a split: three parts for the whole blocks
/// that would hold them, and one part for their number.
///
/// By the number alone, blocks were less full (5.9 of 8 in a room of a million triangles), the
/// build took 7 % longer, and the tree took a sixth more memory. By blocks alone, there is no
/// preference between two splits into equally many blocks, and shadow rays were 10 % slower. A
/// constant in addition to the number made rays slower, too.
#[inline(always)]
fn weight(references: u32) -> f32 {
    const BLOCK: u32 = WIDTH as u32;
    (references.next_multiple_of(BLOCK) * 3 + references) as f32
}
