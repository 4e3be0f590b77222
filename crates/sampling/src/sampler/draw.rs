//! Drawing numbers: each kind of sampler in its own way.

use super::kind::SamplerKind;
use super::state::{Sampler, point_of_bits};
use super::{halton, hammersley, low_discrepancy, multijitter, orthogonal, sobol, stratified};
use crate::hash::unit_float;
use glam::Vec2;

impl Sampler {
    /// The next number, uniform in [0, 1). Takes one dimension.
    #[inline]
    #[must_use]
    pub fn next_1d(&mut self) -> f32 {
        let value = match self.kind {
            _ if self.is_independent() => unit_float((self.jitter() >> 32) as u32),
            SamplerKind::Independent | SamplerKind::Sobol => sobol::next_1d(self),
            SamplerKind::LowDiscrepancy => low_discrepancy::next_1d(self),
            SamplerKind::Halton => halton::next_1d(self),
            SamplerKind::Orthogonal => orthogonal::next_1d(self),
            SamplerKind::Stratified | SamplerKind::Multijitter | SamplerKind::Hammersley => {
                stratified::next_1d(self)
            }
        };
        self.dimension = self.dimension.wrapping_add(1);
        value
    }

    /// The next point, uniform in [0, 1)². Takes two dimensions (and where an orthogonal array has a
    /// single column left, that one too).
    #[inline]
    #[must_use]
    pub fn next_2d(&mut self) -> Vec2 {
        let value = match self.kind {
            _ if self.is_independent() => return self.next_independent_2d(),
            SamplerKind::Independent | SamplerKind::Sobol => sobol::next_2d(self),
            SamplerKind::LowDiscrepancy => low_discrepancy::next_2d(self),
            SamplerKind::Stratified => stratified::next_2d(self),
            SamplerKind::Multijitter => multijitter::next_2d(self),
            SamplerKind::Hammersley => hammersley::next_2d(self),
            SamplerKind::Halton => halton::next_2d(self),
            SamplerKind::Orthogonal => orthogonal::next_2d(self),
        };
        self.dimension = self.dimension.wrapping_add(2);
        value
    }

    /// The next point, independent of the other samples, in a quarter of the time: for decisions that
    /// gain nothing from being spread. Takes two dimensions.
    #[inline]
    #[must_use]
    pub fn next_independent_2d(&mut self) -> Vec2 {
        let bits = self.jitter();
        self.dimension = self.dimension.wrapping_add(2);
        point_of_bits(bits).into()
    }
}
