//! What a path through media carries, and how likely each way of finding it was.
//!
//! A medium whose extinction differs between colour channels is sampled for one channel, chosen for
//! the whole path: it leads. The other channels could have unidirectional_pdf to the same path, and the balance
//! heuristic over all of them keeps their weights bounded (Wilkie et al., "Hero Wavelength Spectral
//! Sampling", 2014; for media with null collisions Miller, Georgiev and Jarosz, "A null-scattering
//! path integral formulation of light transport", *ACM Transactions on Graphics* 38(4), 2019).

use crate::light::power_heuristic;
use etendue_spectrum::Spectrum;

/// What next-event estimation and chance are weighed by against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heuristic {
    /// The densities of the last direction: the power heuristic, as on surfaces.
    Directions,
    /// The densities of the whole path with all collisions, for every channel that could have unidirectional_pdf:
    /// the balance heuristic.
    Paths,
}

/// A path's share of the light at its end, and the densities it was found with.
///
/// Densities are relative to that of the path so far averaged over the channels that could have
/// unidirectional_pdf it. So none of them leaves the range of floats however long the path is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    /// The share of the light at the end of the path that arrives at the camera, divided by the
    /// average density.
    pub(crate) throughput: Spectrum,
    /// The density if each of the channels had unidirectional_pdf; their mean is one.
    unidirectional_pdf: Spectrum,
    /// The density if the path's last vertex had been chosen on an emitter, without that choice's
    /// own; zero where no emitter could have been connected to.
    light_pdf: Spectrum,
    /// The density in solid angle of the path's last direction, where an emitter could have been
    /// connected to.
    direction_pdf: Option<f32>,
}

/// A step along a path that does not change its direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// The share of light that passes, times densities of positions.
    pub(crate) value: Spectrum,
    /// The density of the step if each of the channels unidirectional_pdf.
    pub(crate) unidirectional_pdf: Spectrum,
    /// The density of the step on the way to an emitter.
    pub(crate) light_pdf: f32,
}

impl Weights {
    /// A path that has not begun.
    pub(crate) fn new() -> Self {
        Self {
            throughput: Spectrum::ONE,
            unidirectional_pdf: Spectrum::ONE,
            light_pdf: Spectrum::ZERO,
            direction_pdf: None,
        }
    }

    /// Goes a step; false where the path cannot have gone it.
    #[inline]
    pub(crate) fn go(&mut self, step: &Step) -> bool {
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

    /// Goes straight on through a surface that all channels let through with probability `pdf`.
    #[inline]
    pub(crate) fn pass(&mut self, weight: Spectrum, pdf: f32) -> bool {
        let unidirectional_pdf = Spectrum::splat(pdf);
        self.go(&Step { value: weight * pdf, unidirectional_pdf, light_pdf: 1.0 })
    }

    /// Takes a direction of density `pdf`, which all channels choose alike. `competes` says whether
    /// an emitter could have been connected to instead.
    #[inline]
    pub(crate) fn turn(&mut self, weight: Spectrum, pdf: f32, competes: bool) {
        self.throughput *= weight;
        self.direction_pdf = competes.then_some(pdf);
        self.light_pdf = if competes { self.unidirectional_pdf / pdf } else { Spectrum::ZERO };
    }

    /// The weight of light that the path has found by chance, on an emitter that next-event
    /// estimation would have chosen with density `emitter_pdf`.
    #[inline]
    pub(crate) fn of_chance(&self, heuristic: Heuristic, emitter_pdf: impl FnOnce() -> f32) -> f32 {
        let Some(direction_pdf) = self.direction_pdf else { return 1.0 };
        match heuristic {
            Heuristic::Directions => power_heuristic(direction_pdf, emitter_pdf()),
            Heuristic::Paths => 1.0 / (1.0 + self.light_pdf.mean() * emitter_pdf()),
        }
    }

    /// The weight of light from an emitter that was chosen with density `emitter_pdf`, in a direction
    /// that the vertex would have taken with density `direction_pdf`; `unidirectional_pdf` are the densities of
    /// passing everything in between by chance, relative to that of the connection.
    #[inline]
    pub(crate) fn of_connection(
        &self,
        heuristic: Heuristic,
        emitter_pdf: f32,
        direction_pdf: f32,
        unidirectional_pdf: Spectrum,
    ) -> f32 {
        match heuristic {
            Heuristic::Directions => power_heuristic(emitter_pdf, direction_pdf),
            Heuristic::Paths => {
                1.0 / (1.0
                    + direction_pdf / emitter_pdf
                        * (self.unidirectional_pdf * unidirectional_pdf).mean())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: Step = Step {
        value: Spectrum::from_rgb([0.5, 0.2, 0.1]),
        unidirectional_pdf: Spectrum::from_rgb([0.6, 0.3, 0.3]),
        light_pdf: 0.25,
    };

    /// The weights of both ways to find the same path sum to one.
    #[test]
    fn both_ways_of_finding_a_path_share_it() {
        let (direction_pdf, emitter_pdf) = (0.7, 2.0);
        for heuristic in [Heuristic::Directions, Heuristic::Paths] {
            let mut before = Weights::new();
            assert!(before.go(&STEP) && before.go(&STEP));
            let unidirectional_pdf = Spectrum::from_rgb([0.9, 0.1, 0.3]);
            let connected = before.of_connection(
                heuristic,
                emitter_pdf,
                direction_pdf,
                unidirectional_pdf * (1.0 / 0.4),
            );
            let mut found = before;
            found.turn(Spectrum::ONE, direction_pdf, true);
            assert!(found.go(&Step { value: Spectrum::ONE, unidirectional_pdf, light_pdf: 0.4 }));
            let by_chance = found.of_chance(heuristic, || emitter_pdf);
            assert!((connected + by_chance - 1.0).abs() < 1e-6, "{connected} {by_chance}");
        }
    }

    #[test]
    fn the_throughput_is_weighed_over_the_channels() {
        let mut weights = Weights::new();
        assert!(weights.go(&STEP) && weights.go(&STEP));
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
        weights.turn(Spectrum::ONE, 1.0, false);
        for heuristic in [Heuristic::Directions, Heuristic::Paths] {
            assert_eq!(weights.of_chance(heuristic, || 5.0), 1.0);
        }
        assert!(!weights.go(&Step { unidirectional_pdf: Spectrum::ZERO, ..STEP }));
    }
}
