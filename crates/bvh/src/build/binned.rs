//! Builds parts of the binary tree: binned surface area heuristic, top down, in parallel.
//!
//! Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies* (2007). On the way back
//! up, each node records the cost of its best conversion into wide nodes; see `plan`.

use super::binary_tree::BinaryNode;
use super::bins::{Binning, Bins, MAX_BINS, Split};
use super::extent::Extent;
#[cfg(target_arch = "x86_64")]
use super::kernel::Avx2;
use super::kernel::{Kernel, Portable};
use super::plan::Costs;
use super::reference::Reference;
use crate::depth::MAX_COST_DEPTH;
use crate::node::WIDTH;
use crate::options::BuildOptions;
use crate::simd::Tier;
use rayon::prelude::*;

/// Ranges of more references than this are divided between threads.
pub(super) const PARALLEL: usize = 4096;

/// Ranges of more references than this are binned by several threads: the first few ranges, while
/// there are fewer of them than threads.
const PARALLEL_BINNING: usize = 4 * Reference::CHUNK;

/// Constants of the recursion.
pub(super) struct Builder {
    bin_count: usize,
    leaf_size: usize,
    pub(super) node_cost: f32,
    tier: Tier,
}

/// A part of the tree to build: its references, and the index of the first of them.
pub(super) struct Task<'a> {
    pub(super) references: &'a mut [Reference],
    pub(super) first: usize,
    pub(super) extent: Extent,
    pub(super) depth: usize,
}

/// The result of a finished part of the tree.
#[derive(Clone, Copy)]
pub(super) struct Finished {
    pub(super) costs: Costs,
    pub(super) custom_count: usize,
}

impl Builder {
    pub(super) fn new(options: &BuildOptions) -> Self {
        Self {
            bin_count: (options.bin_count as usize).clamp(2, MAX_BINS),
            leaf_size: (options.leaf_size as usize).clamp(1, WIDTH),
            node_cost: options.node_cost,
            tier: Tier::detect(),
        }
    }

    /// Appends the subtree to `nodes`, its root first, and sorts the references in the order of its
    /// leaves. The recursion is as deep as the tree, whose depth is bounded.
    pub(super) fn build(&self, task: Task<'_>, nodes: &mut Vec<BinaryNode>) -> Finished {
        let (count, place) = (task.references.len(), nodes.len());
        nodes.push(BinaryNode::new(&task.extent.bounds, task.first, count));
        let area = task.extent.bounds.half_area();
        let few = if count <= self.leaf_size { &*task.references } else { &[] };
        let custom_count = few.iter().filter(|reference| reference.is_custom()).count();
        if count == 1 || (count <= self.leaf_size && custom_count == 0) {
            return Finished { costs: Costs::leaf(area), custom_count };
        }
        let [left, right] = self.divide(task);
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

    /// Splits a part of at least two references in two.
    pub(super) fn divide<'a>(&self, task: Task<'a>) -> [Task<'a>; 2] {
        let Task { references, first, extent, depth } = task;
        let (middle, [left_extent, right_extent]) = self.split(references, &extent, depth);
        let (left, right) = references.split_at_mut(middle);
        let depth = depth + 1;
        [
            Task { references: left, first, extent: left_extent, depth },
            Task { references: right, first: first + middle, extent: right_extent, depth },
        ]
    }

    /// Partitions the references in two, and returns the index of the first on the right.
    fn split(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        depth: usize,
    ) -> (usize, [Extent; 2]) {
        #[cfg(target_arch = "x86_64")]
        if self.tier != Tier::Portable {
            // SAFETY: `Tier::detect` has found that the machine supports these instructions; every
            // tier but the portable one includes them.
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
        if let Some(Split { plane, bounds: [left, right] }) = split {
            let (middle, [left_centers, right_centers]) = K::partition(references, &plane);
            let left = Extent { bounds: left, centers: left_centers };
            return (middle, [left, Extent { bounds: right, centers: right_centers }]);
        }
        // No plane separates the centres, or the tree is too deep: halve the range.
        let middle = references.len() / 2;
        let extents = [Extent::of(&references[..middle]), Extent::of(&references[middle..])];
        (middle, extents)
    }

    /// The cheapest plane between bins, or `None` if no plane separates the centres.
    #[inline(always)]
    fn find_split<K: Kernel>(&self, references: &[Reference], extent: &Extent) -> Option<Split> {
        // A bin for every few references suffices, and most ranges are small.
        let count = (4 + references.len() / 4).min(self.bin_count);
        let binning = Binning::new(extent, count);
        if references.len() > PARALLEL_BINNING {
            return self.bins_of_many(references, &binning, count).best_split(&binning);
        }
        let mut bins = Bins::new(count);
        K::add(&mut bins, &binning, references);
        bins.best_split(&binning)
    }

    /// Sorts references into bins in parallel.
    #[inline(never)]
    fn bins_of_many(&self, references: &[Reference], binning: &Binning, count: usize) -> Bins {
        let chunks = references.par_chunks(Reference::CHUNK);
        let chunks: Vec<Bins> = chunks.map(|chunk| self.bins_of(chunk, binning, count)).collect();
        let mut bins = Bins::new(count);
        chunks.iter().for_each(|chunk| bins.merge(chunk));
        bins
    }

    fn bins_of(&self, references: &[Reference], binning: &Binning, count: usize) -> Bins {
        let mut bins = Bins::new(count);
        #[cfg(target_arch = "x86_64")]
        if self.tier != Tier::Portable {
            // SAFETY: as in `split`.
            unsafe { add_avx2(&mut bins, binning, references) };
            return bins;
        }
        Portable::add(&mut bins, binning, references);
        bins
    }
}

/// As [`Kernel::add`].
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn add_avx2(bins: &mut Bins, binning: &Binning, references: &[Reference]) {
    Avx2::add(bins, binning, references);
}
