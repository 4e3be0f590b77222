//! The binary tree: binned surface area heuristic, top down, in parallel.
//!
//! Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies* (2007). On the way up,
//! each node learns what its best conversion into wide nodes costs; see `collapse`.

use super::MAX_COST_DEPTH;
use super::collapse::{Costs, Plan};
#[cfg(target_arch = "x86_64")]
use super::kernel::Avx2;
use super::kernel::{Kernel, Portable};
use super::reference::Reference;
use crate::node::WIDTH;
use crate::options::BuildOptions;
use crate::simd::Tier;
use etendue_math::Bounds3;
use glam::{Vec3, Vec4};
use std::ops::Range;

/// A node of the binary tree and the references below it. Its left child follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    min: Vec3,
    max: Vec3,
    /// The first reference.
    pub(super) first: u32,
    /// How many references.
    pub(super) count: u32,
    /// How far after this node its right child is; 0 for a leaf.
    pub(super) right: u32,
    /// How the node is best converted into wide nodes.
    pub(super) plan: Plan,
}

impl BinaryNode {
    pub(super) fn bounds(&self) -> Bounds3 {
        Bounds3::new(self.min, self.max)
    }
}

/// A box in SIMD registers, its greatest corner negated so that both corners grow by the lesser;
/// the fourth components mean nothing.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Box4 {
    pub(super) min: Vec4,
    pub(super) negated_max: Vec4,
}

impl Box4 {
    pub(super) const EMPTY: Self =
        Self { min: Vec4::splat(f32::INFINITY), negated_max: Vec4::splat(f32::INFINITY) };

    #[inline(always)]
    pub(super) fn of(reference: &Reference) -> Self {
        Self { min: reference.min, negated_max: -reference.max }
    }

    #[inline(always)]
    pub(super) fn of_point(point: Vec4) -> Self {
        Self { min: point, negated_max: -point }
    }

    #[inline(always)]
    pub(super) fn grow(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.negated_max = self.negated_max.min(other.negated_max);
    }

    #[inline(always)]
    fn extent(&self) -> Vec4 {
        -(self.negated_max + self.min)
    }

    #[inline(always)]
    fn half_area(&self) -> f32 {
        let extent = self.extent();
        extent.x * (extent.y + extent.z) + extent.y * extent.z
    }
}

/// The boxes of a range of references and of their centres.
#[derive(Clone, Copy)]
struct Extent {
    bounds: Box4,
    centers: Box4,
}

impl Extent {
    const EMPTY: Self = Self { bounds: Box4::EMPTY, centers: Box4::EMPTY };

    #[inline(always)]
    fn add(&mut self, reference: &Reference) {
        self.bounds.grow(&Box4::of(reference));
        self.centers.grow(&Box4::of_point(reference.center()));
    }

    fn of(references: &[Reference]) -> Self {
        let mut extent = Self::EMPTY;
        references.iter().for_each(|reference| extent.add(reference));
        extent
    }
}

pub(super) const MAX_BINS: usize = 16;

/// Ranges of more references are divided between threads.
const PARALLEL: usize = 4096;

/// What the recursion carries along unchanged.
struct Builder {
    bin_count: usize,
    leaf_size: usize,
    node_cost: f32,
    tier: Tier,
}

/// A part of the tree to build: its references, and where they begin.
struct Task<'a> {
    references: &'a mut [Reference],
    first: usize,
    extent: Extent,
    depth: usize,
}

/// What a finished part of the tree tells its parent.
#[derive(Clone, Copy)]
pub(super) struct Finished {
    pub(super) costs: Costs,
    pub(super) custom_count: usize,
}

/// Builds the tree and orders the references by its leaves. The root is first. Also says what the
/// tree costs, in half areas times blocks.
pub(super) fn build(
    references: &mut [Reference],
    options: &BuildOptions,
) -> (Vec<BinaryNode>, f32) {
    let mut nodes = Vec::new();
    if references.is_empty() {
        return (nodes, 0.0);
    }
    let builder = Builder {
        bin_count: (options.bin_count as usize).clamp(2, MAX_BINS),
        leaf_size: (options.leaf_size as usize).clamp(1, WIDTH),
        node_cost: options.node_cost,
        tier: Tier::detect(),
    };
    let extent = Extent::of(references);
    let root = Task { references, first: 0, extent, depth: 0 };
    let cost = builder.build(root, &mut nodes).costs.single();
    (nodes, cost)
}

impl Builder {
    /// Appends the part to `nodes`. The recursion is as deep as the tree, which is bounded.
    fn build(&self, task: Task<'_>, nodes: &mut Vec<BinaryNode>) -> Finished {
        let Task { references, first, extent, depth } = task;
        let (count, place) = (references.len(), nodes.len());
        nodes.push(BinaryNode {
            min: extent.bounds.min.truncate(),
            max: -extent.bounds.negated_max.truncate(),
            first: first as u32,
            count: count as u32,
            right: 0,
            plan: Plan::default(),
        });
        let area = extent.bounds.half_area();
        let few = if count <= self.leaf_size { &*references } else { &[] };
        let custom_count = few.iter().filter(|reference| reference.is_custom()).count();
        if count == 1 || (count <= self.leaf_size && custom_count == 0) {
            return Finished { costs: Costs::leaf(area), custom_count };
        }
        let (middle, [left_extent, right_extent]) = self.split(references, &extent, depth);
        let (left, right) = references.split_at_mut(middle);
        let depth = depth + 1;
        let left = Task { references: left, first, extent: left_extent, depth };
        let right = Task { references: right, first: first + middle, extent: right_extent, depth };
        let (left, right, right_place) = if count > PARALLEL {
            let mut right_nodes = Vec::new();
            let (left, right) =
                rayon::join(|| self.build(left, nodes), || self.build(right, &mut right_nodes));
            let right_place = nodes.len();
            nodes.append(&mut right_nodes);
            (left, right, right_place)
        } else {
            let left = self.build(left, nodes);
            let right_place = nodes.len();
            (left, self.build(right, nodes), right_place)
        };
        let custom_count = left.custom_count + right.custom_count;
        let (costs, plan) = Costs::combine(
            [&left.costs, &right.costs],
            area,
            self.node_cost,
            (count, custom_count),
        );
        nodes[place].right = (right_place - place) as u32;
        nodes[place].plan = plan;
        Finished { costs, custom_count }
    }

    /// Reorders the references into two parts and says where the second begins.
    fn split(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        depth: usize,
    ) -> (usize, [Extent; 2]) {
        #[cfg(target_arch = "x86_64")]
        if self.tier != Tier::Portable {
            // SAFETY: `Tier::detect` has found that the machine has these instructions, which all
            // tiers but the portable one include.
            return unsafe { self.split_avx2(references, extent, depth) };
        }
        self.split_by::<Portable>(references, extent, depth)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn split_avx2(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        depth: usize,
    ) -> (usize, [Extent; 2]) {
        self.split_by::<Avx2>(references, extent, depth)
    }

    #[inline(always)]
    fn split_by<K: Kernel>(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        depth: usize,
    ) -> (usize, [Extent; 2]) {
        if let [left, right] = references {
            return (1, [*left, *right].map(|reference| Extent::of(&[reference])));
        }
        let split =
            (depth < MAX_COST_DEPTH).then(|| self.find_split::<K>(references, extent)).flatten();
        if let Some(split) = split {
            return partition::<K>(references, &split);
        }
        // No plane parts the centres, or the tree is too deep: halve.
        let middle = references.len() / 2;
        let extents = [Extent::of(&references[..middle]), Extent::of(&references[middle..])];
        (middle, extents)
    }

    /// The cheapest of the planes between bins, if any parts the centres.
    #[inline(always)]
    fn find_split<K: Kernel>(&self, references: &[Reference], extent: &Extent) -> Option<Split> {
        // A bin for every few references is enough, and small ranges are by far the most.
        let count = (4 + references.len() / 4).min(self.bin_count);
        let binning = Binning::new(extent, count);
        let mut bins = Bins::new(count);
        for reference in references {
            let places = binning.bins(reference);
            K::add(&mut bins.boxes, places, reference);
            for (counts, place) in bins.counts.iter_mut().zip(places) {
                counts[place] += 1;
            }
        }
        let mut best = None;
        let mut least = f32::INFINITY;
        for axis in 0..3 {
            if binning.scale[axis] == 0.0 {
                continue;
            }
            let (plane, cost) = bins.best_plane(axis, count);
            if cost < least {
                least = cost;
                best = Some((axis, plane));
            }
        }
        let (axis, plane) = best?;
        let bounds = [bins.bounds(axis, 0..plane), bins.bounds(axis, plane..count)];
        Some(Split { binning, axis, plane, bounds })
    }
}

/// References go left if their bin on the axis is below the plane.
struct Split {
    binning: Binning,
    axis: usize,
    plane: usize,
    /// The boxes of the two sides.
    bounds: [Box4; 2],
}

/// How centres are sorted into bins.
#[derive(Clone, Copy)]
struct Binning {
    origin: Vec4,
    scale: Vec4,
}

/// Adding this to a small number that is not negative rounds it into the lowest bits: much quicker
/// than a conversion, which in Rust saturates.
const TO_LOW_BITS: f32 = 8_388_608.0;

impl Binning {
    fn new(extent: &Extent, count: usize) -> Self {
        let size = extent.centers.extent();
        let scale = Vec4::splat(count as f32 - 1.0) / size;
        // An axis on which the centres agree, or are so near or far that it overflows, is flat.
        let usable = size.cmpgt(Vec4::ZERO) & scale.cmplt(Vec4::splat(f32::MAX));
        Self { origin: extent.centers.min, scale: Vec4::select(usable, scale, Vec4::ZERO) }
    }

    #[inline(always)]
    fn bins(&self, reference: &Reference) -> [usize; 3] {
        let place = (reference.center() - self.origin) * self.scale + Vec4::splat(TO_LOW_BITS);
        [bin_of(place.x), bin_of(place.y), bin_of(place.z)]
    }

    /// The same as `bins(reference)[axis]`, to the last bit, given the centre's coordinate.
    #[inline(always)]
    fn bin(&self, center: f32, axis: usize) -> usize {
        bin_of((center - self.origin[axis]) * self.scale[axis] + TO_LOW_BITS)
    }
}

#[inline(always)]
fn bin_of(place: f32) -> usize {
    place.to_bits() as usize & (MAX_BINS - 1)
}

/// What fell into each bin of each axis.
struct Bins {
    boxes: [[Box4; MAX_BINS]; 3],
    counts: [[u32; MAX_BINS]; 3],
}

impl Bins {
    /// `count` empty bins on each axis, and more that are not used.
    fn new(count: usize) -> Self {
        let mut bins = Self {
            boxes: [[Box4 { min: Vec4::ZERO, negated_max: Vec4::ZERO }; MAX_BINS]; 3],
            counts: [[0; MAX_BINS]; 3],
        };
        for axis in 0..3 {
            bins.boxes[axis][..count].fill(Box4::EMPTY);
        }
        bins
    }

    /// The box of everything in some bins.
    #[inline(always)]
    fn bounds(&self, axis: usize, bins: Range<usize>) -> Box4 {
        let mut bounds = Box4::EMPTY;
        self.boxes[axis][bins].iter().for_each(|bin| bounds.grow(bin));
        bounds
    }

    /// The first bin of the right side, and the cost; infinite if no plane parts the references.
    #[inline(always)]
    fn best_plane(&self, axis: usize, count: usize) -> (usize, f32) {
        let mut right_costs = [f32::INFINITY; MAX_BINS];
        let (mut bounds, mut total) = (Box4::EMPTY, 0);
        for bin in (1..count).rev() {
            let of_bin = &self.boxes[axis][bin];
            bounds.grow(of_bin);
            total += self.counts[axis][bin];
            if total > 0 {
                right_costs[bin] = bounds.half_area() * weight(total);
            }
        }
        let mut best = (0, f32::INFINITY);
        let (mut bounds, mut total) = (Box4::EMPTY, 0);
        for (plane, &right_cost) in right_costs.iter().enumerate().take(count).skip(1) {
            let of_bin = &self.boxes[axis][plane - 1];
            bounds.grow(of_bin);
            total += self.counts[axis][plane - 1];
            if total > 0 {
                let cost = bounds.half_area() * weight(total) + right_cost;
                if cost < best.1 {
                    best = (plane, cost);
                }
            }
        }
        best
    }
}

/// What a number of references weighs in the cost of a split: three parts what whole blocks would
/// take them, and one part their number.
///
/// By their number alone, blocks were filled less (5.9 of 8 in a room of a million triangles), the
/// build took a fifteenth longer, and the tree a sixth more memory. By blocks alone, nothing speaks
/// for the better of two splits into as many blocks, and shadow rays were a tenth slower. A constant
/// beside the number makes rays slower, too.
#[inline(always)]
fn weight(references: u32) -> f32 {
    const BLOCK: u32 = WIDTH as u32;
    (references.next_multiple_of(BLOCK) * 3 + references) as f32
}

/// Moves the references left of the split to the front.
///
/// Without a branch on the side, which could not be foretold: a reference of the right side is
/// swapped with another of its side, and the boxes of the centres grow by nothing. That took a
/// third off the build.
#[inline(always)]
fn partition<K: Kernel>(references: &mut [Reference], split: &Split) -> (usize, [Extent; 2]) {
    let mut centers = K::no_centers();
    let mut left = 0;
    for index in 0..references.len() {
        let reference = references[index];
        let center = reference.center();
        let is_left = split.binning.bin(center[split.axis], split.axis) < split.plane;
        centers = K::grow_side(centers, center, is_left);
        references[index] = references[left];
        references[left] = reference;
        left += usize::from(is_left);
    }
    let centers = K::boxes(centers);
    let [left_bounds, right_bounds] = split.bounds;
    let left_extent = Extent { bounds: left_bounds, centers: centers[0] };
    (left, [left_extent, Extent { bounds: right_bounds, centers: centers[1] }])
}
