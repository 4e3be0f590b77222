//! The throughput of a path through media, and the densities with which it could have been found.
//!
//! If extinction differs between colour channels, distances are sampled for one channel, chosen for
//! the whole path. Any other channel could have produced the same path, and the balance heuristic
//! over all of them keeps weights bounded (Wilkie et al., "Hero Wavelength Spectral Sampling",
//! 2014; for media with null collisions Miller, Georgiev and Jarosz, "A null-scattering path
//! integral formulation of light transport", *ACM Transactions on Graphics* 38(4), 2019).
//!
//! The *unidirectional density* of a path is the density with which scattering alone finds it, one
//! value for each channel that distances could have been sampled for. Its *light density* is the
//! density with which next-event estimation finds it.

use crate::estimator::{next_event_weight, power_heuristic};
use etendue_scene::emitter::DirectionSample;
use etendue_spectrum::Spectrum;

/// How next-event estimation and unidirectional sampling are weighted against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heuristic {
    /// By the densities of the last direction: the power heuristic, as on surfaces.
    Directions,
    /// By the densities of the whole path with all collisions, over all channels: the balance
    /// heuristic.
    Paths,
}

/// A path's throughput and the densities it was found with.
///
/// All densities are relative to the channel mean of the unidirectional density, so that they do
/// not overflow or underflow on long paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    /// The fraction of light at the end of the path that reaches the camera, divided by the average
    /// density.
    pub(crate) throughput: Spectrum,
    /// The unidirectional density for each channel; the mean is one.
    unidirectional_pdf: Spectrum,
    /// The light density if the path ended here on an emitter, without the density of choosing the
    /// emitter; zero if next-event estimation does not compete.
    light_pdf: Spectrum,
    /// The solid angle density of the path's last direction, if next-event estimation competes.
    direction_pdf: Option<f32>,
}

/// A step along a path that does not change its direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// The transmitted fraction of light, times position densities.
    pub(crate) value: Spectrum,
    /// The unidirectional density of the step for each channel.
    pub(crate) unidirectional_pdf: Spectrum,
    /// The density of the step as part of a connection to a sampled emitter.
    pub(crate) light_pdf: f32,
}

/// A new direction, sampled identically for all channels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    /// The scattered fraction of light, divided by `pdf`.
    pub(crate) weight: Spectrum,
    /// The solid angle density.
    pub(crate) pdf: f32,
    /// Whether next-event estimation could have found what lies in the direction.
    pub(crate) competes: bool,
}

impl Weights {
    /// A path at its start.
    pub(crate) fn new() -> Self {
        Self {
            throughput: Spectrum::ONE,
            unidirectional_pdf: Spectrum::ONE,
            light_pdf: Spectrum::ZERO,
            direction_pdf: None,
        }
    }

    /// Takes a step; false if no throughput remains.
    #[inline]
    pub(crate) fn advance(&mut self, step: &Step) -> bool {
        let unidirectional_pdf = self.unidirectional_pdf * step.unidirectional_pdf;
        let average = unidirectional_pdf.mean();
        if average <= 0.0 {
            return false;
        }
        let inverse = 1.0 / average;
        self.throughput *= step.value * inverse;
        self.unidirectional_pdf = unidirectional_pdf * inverse;
        self.light_pdf *= step.light_pdf * inverse;
        !self.throughput.is_black()
    }

    /// Null transmission through a surface, sampled with probability `pdf` in all channels.
    #[inline]
    pub(crate) fn pass_straight(&mut self, weight: Spectrum, pdf: f32) -> bool {
        let unidirectional_pdf = Spectrum::splat(pdf);
        self.advance(&Step { value: weight * pdf, unidirectional_pdf, light_pdf: 1.0 })
    }

    /// Continues in a new direction.
    #[inline]
    pub(crate) fn turn(&mut self, turn: &Turn) {
        let Turn { weight, pdf, competes } = *turn;
        self.throughput *= weight;
        self.direction_pdf = competes.then_some(pdf);
        self.light_pdf = if competes { self.unidirectional_pdf / pdf } else { Spectrum::ZERO };
    }

    /// The weight of light that the path has hit, on an emitter that next-event estimation would
    /// have sampled with density `light_pdf`.
    #[inline]
    pub(crate) fn of_emission(&self, heuristic: Heuristic, light_pdf: impl FnOnce() -> f32) -> f32 {
        let Some(direction_pdf) = self.direction_pdf else { return 1.0 };
        match heuristic {
            Heuristic::Directions => power_heuristic(direction_pdf, light_pdf()),
            Heuristic::Paths => 1.0 / (1.0 + self.light_pdf.mean() * light_pdf()),
        }
    }

    /// The weight of `light`, sampled by next-event estimation, in a direction that scattering
    /// would have sampled with density `scatter_pdf`. `unidirectional_pdf` is that of
    /// [`Connection`](super::Connection).
    #[inline]
    pub(crate) fn of_connection(
        &self,
        heuristic: Heuristic,
        light: &DirectionSample,
        scatter_pdf: f32,
        unidirectional_pdf: Spectrum,
    ) -> f32 {
        match heuristic {
            Heuristic::Directions => next_event_weight(light.pdf, light.delta, scatter_pdf),
            Heuristic::Paths if light.delta => 1.0,
            Heuristic::Paths => {
                let passed = (self.unidirectional_pdf * unidirectional_pdf).mean();
                1.0 / (1.0 + scatter_pdf / light.pdf * passed)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_scene::emitter::Target;
    use glam::Vec3;

    const STEP: Step = Step {
        value: Spectrum::from_rgb([0.5, 0.2, 0.1]),
        unidirectional_pdf: Spectrum::from_rgb([0.6, 0.3, 0.3]),
        light_pdf: 0.25,
    };

    /// The weights of both techniques for the same path sum to one.
    #[test]
    fn both_ways_of_finding_a_path_share_it() {
        let (direction_pdf, light_pdf) = (0.7, 2.0);
        let light = DirectionSample {
            direction: Vec3::Z,
            radiance: Spectrum::ONE,
            pdf: light_pdf,
            delta: false,
            target: Target::Afar,
        };
        for heuristic in [Heuristic::Directions, Heuristic::Paths] {
            let mut before = Weights::new();
            assert!(before.advance(&STEP) && before.advance(&STEP));
            let unidirectional_pdf = Spectrum::from_rgb([0.9, 0.1, 0.3]);
            let connected = before.of_connection(
                heuristic,
                &light,
                direction_pdf,
                unidirectional_pdf * (1.0 / 0.4),
            );
            let mut found = before;
            found.turn(&Turn { weight: Spectrum::ONE, pdf: direction_pdf, competes: true });
            assert!(found.advance(&Step {
                value: Spectrum::ONE,
                unidirectional_pdf,
                light_pdf: 0.4
            }));
            let by_chance = found.of_emission(heuristic, || light_pdf);
            assert!((connected + by_chance - 1.0).abs() < 1e-6, "{connected} {by_chance}");
        }
    }

    #[test]
    fn the_throughput_is_weighed_over_the_channels() {
        let mut weights = Weights::new();
        assert!(weights.advance(&STEP) && weights.advance(&STEP));
        // Two steps: value² over the mean of unidirectional_pdf².
        let mean = (0.36 + 0.09 + 0.09) / 3.0;
        for (found, value) in weights.throughput.rgb().into_iter().zip([0.25, 0.04, 0.01]) {
            assert!((found - value / mean).abs() < 1e-6);
        }
        assert!((weights.unidirectional_pdf.mean() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_could_not_compete_counts_in_full() {
        let mut weights = Weights::new();
        weights.turn(&Turn { weight: Spectrum::ONE, pdf: 1.0, competes: false });
        for heuristic in [Heuristic::Directions, Heuristic::Paths] {
            assert_eq!(weights.of_emission(heuristic, || 5.0), 1.0);
        }
        assert!(!weights.advance(&Step { unidirectional_pdf: Spectrum::ZERO, ..STEP }));
    }
}
