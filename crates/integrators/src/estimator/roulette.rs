//! Russian roulette.

use etendue_math::lanes::Real;

/// The minimum probability that a path ends.
const MAX_SURVIVAL: f32 = 0.95;

/// The outcome of Russian roulette: paths of low throughput end early, and the survivors make up
/// for them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Roulette<R: Real> {
    /// Whether the path continues.
    pub(crate) survives: R::Mask,
    /// The factor on the throughput of a survivor.
    pub(crate) gain: R,
}

impl<R: Real> Roulette<R> {
    /// Plays for a path whose largest throughput component is `carried`.
    ///
    /// `eta` is the index of refraction here relative to that at the path's start. Radiance is
    /// scaled inside glass and scaled back on the way out; dividing by the scale keeps such paths
    /// alive meanwhile.
    #[inline(always)]
    pub(crate) fn play(carried: R, eta: R, random: R) -> Self {
        let probability = (carried * eta * eta).min(eta.like(MAX_SURVIVAL));
        Self { survives: random.lt(probability), gain: probability.reciprocal() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survivors_stand_for_the_others() {
        let survival = 0.3_f32;
        let count = 1000;
        let sum: f32 = (0..count)
            .map(|index| Roulette::play(survival, 1.0, (index as f32 + 0.5) / count as f32))
            .map(|roulette| if roulette.survives { roulette.gain } else { 0.0 })
            .sum();
        assert!((sum / count as f32 - 1.0).abs() < 1e-3, "{sum}");
    }

    #[test]
    fn what_glass_compresses_does_not_end_paths() {
        assert!(Roulette::play(0.5_f32, 1.5, 0.9).survives);
        assert!(!Roulette::play(0.5_f32, 1.0, 0.9).survives);
        assert!(!Roulette::play(100.0_f32, 1.0, 0.96).survives);
    }
}
