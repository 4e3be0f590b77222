//! The random numbers of a vertex.

use etendue_math::lanes::{Lanes, Simd, Vector2};
use etendue_sampling::{RandomBatch, Sampler};
use glam::Vec2;

/// The random numbers of a vertex. Every vertex draws the same six, used or not, so a path's
/// numbers at one depth do not depend on what it hit before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VertexNumbers<R> {
    /// Selects an emitter and a point on it.
    pub(crate) light: Vector2<R>,
    /// Selects the next direction.
    pub(crate) scatter: ScatterNumbers<R>,
    /// For Russian roulette.
    pub(crate) roulette: R,
}

/// The random numbers that select a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScatterNumbers<R> {
    /// Selects a lobe.
    pub(crate) lobe: R,
    /// Selects a direction within the lobe.
    pub(crate) direction: Vector2<R>,
}

impl VertexNumbers<f32> {
    /// Draws the next six numbers.
    #[inline]
    pub(crate) fn draw(sampler: &mut Sampler) -> Self {
        let (light, direction) = (sampler.next_2d().into(), sampler.next_2d().into());
        let Vec2 { x: lobe, y: roulette } = sampler.next_independent_2d();
        Self { light, scatter: ScatterNumbers { lobe, direction }, roulette }
    }
}

impl<S: Simd> VertexNumbers<Lanes<S>> {
    /// The numbers of the lanes starting at `first`.
    #[inline(always)]
    pub(crate) fn load(simd: S, numbers: &RandomBatch, first: usize) -> Self {
        let [lobe, roulette] = &numbers.choices;
        Self {
            light: Vector2::load(simd, &numbers.light, first),
            scatter: ScatterNumbers {
                lobe: Lanes::load(simd, lobe, first),
                direction: Vector2::load(simd, &numbers.direction, first),
            },
            roulette: Lanes::load(simd, roulette, first),
        }
    }
}
