//! Majorants of a medium's extinction along a ray, and tentative collisions sampled from them.
//!
//! Delta tracking (Woodcock et al., 1965) adds fictitious matter to a medium until its density
//! reaches a bound σ̄. Distances to collisions are then exponential, and a collision at x is real
//! with probability σt(x) / σ̄. Grids have one bound per block of cells, so rays cross empty space
//! without collisions (Yue et al., "Unbiased, adaptive stochastic sampling for rendering
//! inhomogeneous participating media", 2010). With it, `scenes/smoke` renders six times as fast as
//! with a single bound.

use crate::volume::Volume;
use crate::volume::gridvolume::GridVolume;
use etendue_math::{Bounds3, Ray, next_up};
use glam::{Affine3A, IVec3, Vec3, Vec3A};

/// Upper bounds of the extinction in a box.
#[derive(Clone, Debug)]
pub(crate) struct Majorants {
    bounds: Bounds3,
    /// An upper bound of every channel everywhere.
    greatest: f32,
    blocks: Option<Blocks>,
}

/// One bound per block of grid cells.
#[derive(Clone, Debug)]
struct Blocks {
    /// World to block coordinates. The outermost blocks extend to infinity, like the values at the
    /// grid's faces.
    to_blocks: Affine3A,
    size: IVec3,
    values: Vec<f32>,
}

/// A tentative collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// The distance along the ray, whose direction is unit.
    pub t: f32,
    /// The majorant σ̄ there, per unit of length.
    pub majorant: f32,
}

/// Finds successive collisions along a ray.
#[derive(Clone, Debug)]
pub struct Tracker<'a> {
    /// Where the ray enters the medium. The distances below start there, so their rounding does not
    /// depend on the ray's origin.
    start: f32,
    /// The distance at which the medium ends.
    end: f32,
    /// The distance at which the search continues.
    t: f32,
    /// The majorant up to the end of the block.
    majorant: f32,
    /// The distance to the block's end on each axis, and the length of a block.
    next: Vec3,
    length: Vec3,
    block: IVec3,
    step: IVec3,
    blocks: Option<&'a Blocks>,
}

/// Grid cells per bound along each axis; more in large grids.
const BLOCK: i32 = 4;
/// The maximum number of blocks along an axis.
const MOST_BLOCKS: i32 = 64;
/// A ray that would cross more blocks than this, in a grid that is squeezed flat, uses one bound.
const MOST_STEPS: f32 = 4096.0;

impl Majorants {
    /// Bounds of an extinction that is multiplied by `scale`.
    pub(crate) fn new(extinction: &Volume, scale: f32) -> Self {
        let blocks = match extinction {
            Volume::Grid(grid) if grid.ends_at_its_faces() => Some(Blocks::new(grid, scale)),
            _ => None,
        };
        let greatest = extinction.range()[1] * scale;
        Self { bounds: extinction.bounds(), greatest, blocks }
    }

    /// The bounds if the extinction is limited.
    pub(crate) fn limited(mut self, limit: f32) -> Self {
        self.greatest = self.greatest.min(limit);
        for value in self.blocks.iter_mut().flat_map(|blocks| &mut blocks.values) {
            *value = value.min(limit);
        }
        self
    }

    pub(crate) fn greatest(&self) -> f32 {
        self.greatest
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.blocks.as_ref().map_or(0, |blocks| std::mem::size_of_val(blocks.values.as_slice()))
    }

    /// Follows a ray with unit direction.
    #[inline]
    pub(crate) fn track(&self, ray: &Ray) -> Tracker<'_> {
        let (start, end) = crossing(&self.bounds, ray);
        let mut tracker = Tracker {
            start,
            end: end - start,
            t: 0.0,
            majorant: self.greatest,
            next: Vec3::INFINITY,
            length: Vec3::INFINITY,
            block: IVec3::ZERO,
            step: IVec3::ZERO,
            blocks: None,
        };
        if let Some(blocks) = &self.blocks
            && tracker.end > 0.0
        {
            tracker.enter(blocks, ray.at(start), ray.direction);
        }
        tracker
    }
}

/// Where a ray enters and leaves a box. The end does not exceed the start if the ray misses.
#[inline]
fn crossing(bounds: &Bounds3, ray: &Ray) -> (f32, f32) {
    let inverse = ray.direction.recip();
    let low = (bounds.min - ray.origin) * inverse;
    let high = (bounds.max - ray.origin) * inverse;
    // A ray in the plane of a face gives NaN on that axis, which `min` and `max` ignore.
    let (near, far) = (low.min(high), low.max(high));
    let start = near.to_array().into_iter().fold(0.0, f32::max);
    let end = far.to_array().into_iter().fold(ray.t_max, f32::min);
    // A ray whose exit is infinite is invalid and would never terminate.
    (start, if end.is_finite() { end } else { start })
}

impl Blocks {
    fn new(grid: &GridVolume, scale: f32) -> Self {
        let cells = grid.size();
        let size = ((cells + (BLOCK - 1)) / BLOCK).min(IVec3::splat(MOST_BLOCKS));
        let to_blocks = Affine3A::from_scale(size.as_vec3()) * grid.to_world().inverse_affine();
        let mut values = vec![0.0_f32; size.as_usizevec3().element_product()];
        let ratio = size.as_vec3() / cells.as_vec3();
        for z in 0..cells.z {
            for y in 0..cells.y {
                for x in 0..cells.x {
                    let cell = IVec3::new(x, y, z);
                    let greatest = grid.cell(cell).iter().copied().fold(0.0, f32::max) * scale;
                    // A cell's value reaches to the centres of its neighbours, plus rounding.
                    let reach = |offset: f32| {
                        let place = ((cell.as_vec3() + offset) * ratio).floor().as_ivec3();
                        place.clamp(IVec3::ZERO, size - 1)
                    };
                    let (low, high) = (reach(-0.51), reach(1.51));
                    for z in low.z..=high.z {
                        for y in low.y..=high.y {
                            for x in low.x..=high.x {
                                let value = &mut values[index(IVec3::new(x, y, z), size)];
                                *value = value.max(greatest);
                            }
                        }
                    }
                }
            }
        }
        Self { to_blocks, size, values }
    }

    #[inline]
    fn value(&self, block: IVec3) -> f32 {
        self.values[index(block.clamp(IVec3::ZERO, self.size - 1), self.size)]
    }
}

/// The index of a block inside the grid.
#[inline]
fn index(block: IVec3, size: IVec3) -> usize {
    let [x, y, z] = block.to_array().map(|coordinate| coordinate as usize);
    (z * size.y as usize + y) * size.x as usize + x
}

impl<'a> Tracker<'a> {
    /// Starts walking the blocks at `point` (Amanatides and Woo, "A fast voxel traversal algorithm
    /// for ray tracing", Eurographics 1987).
    #[inline]
    fn enter(&mut self, blocks: &'a Blocks, point: Vec3, direction: Vec3) {
        let place = Vec3::from(blocks.to_blocks.transform_point3a(Vec3A::from(point)));
        let speed = Vec3::from(blocks.to_blocks.transform_vector3a(Vec3A::from(direction)));
        let steps = speed.abs().element_sum() * self.end;
        // Written this way, NaN also falls back to one bound.
        if !(steps < MOST_STEPS && place.abs().max_element() < MOST_STEPS * MOST_STEPS) {
            return;
        }
        let floor = place.floor();
        let inverse = speed.recip();
        let border = floor + Vec3::select(speed.cmpgt(Vec3::ZERO), Vec3::ONE, Vec3::ZERO);
        let still = speed.cmpeq(Vec3::ZERO);
        self.next = Vec3::select(still, Vec3::INFINITY, (border - place) * inverse);
        self.length = Vec3::select(still, Vec3::INFINITY, inverse.abs());
        self.step = speed.signum().as_ivec3();
        self.block = floor.as_ivec3();
        self.majorant = blocks.value(self.block);
        self.blocks = Some(blocks);
    }

    /// The next collision, `optical_depth` after the last one; `None` if the ray leaves the medium
    /// or ends first. The caller samples `optical_depth` from the exponential distribution of rate
    /// one.
    #[inline]
    pub fn advance(&mut self, optical_depth: f32) -> Option<Collision> {
        let mut rest = optical_depth;
        while self.t < self.end {
            let exit = self.next.min_element().min(self.end);
            let depth = self.majorant * (exit - self.t);
            if rest < depth {
                let t = self.t + rest / self.majorant;
                // Advance even if the step is too short for single precision.
                self.t = if t > self.t { t } else { next_up(self.t) };
                return Some(Collision { t: self.start + self.t, majorant: self.majorant });
            }
            rest -= depth.max(0.0);
            self.t = self.t.max(exit);
            self.leave_block();
        }
        None
    }

    /// Moves to the next block.
    #[inline]
    fn leave_block(&mut self) {
        let Some(blocks) = self.blocks else { return };
        let axis = self.next.min_position();
        self.next[axis] += self.length[axis];
        self.block[axis] += self.step[axis];
        self.majorant = blocks.value(self.block);
    }
}

#[cfg(test)]
mod tests;
