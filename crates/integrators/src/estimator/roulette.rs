//! Russian roulette.

use etendue_math::lanes::Real;

/// Paths always have at least this chance to end.
const MAX_SURVIVAL: f32 = 0.95;

/// The outcome of Russian roulette: paths that carry little end early, and the survivors stand for
/// them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Roulette<R: Real> {
    /// Whether the path goes on.
    pub(crate) survives: R::Mask,
    /// What the throughput of a survivor is multiplied by.
    pub(crate) gain: R,
}

impl<R: Real> Roulette<R> {
    /// Plays for a path whose greatest component of throughput is `carried`.
    ///
    /// `eta` is the index of refraction here relative to that at the path's start: radiance that has
    /// been compressed in glass expands again when it leaves, and is not to be lost meanwhile.
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
