//! Multiple importance sampling: weights for techniques that can find the same light.

use etendue_math::lanes::Real;

/// The weight of a sample of density `pdf` when another technique could have found it with density
/// `other` (Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997, section 9.2.4:
/// the power heuristic with exponent two).
#[inline(always)]
#[must_use]
pub(crate) fn power_heuristic<R: Real>(pdf: R, other: R) -> R {
    let squared = pdf * pdf;
    let sum = squared + other * other;
    // Squares overflow above 1e19, where the larger density dominates.
    let greater = R::select(pdf.gt(other), pdf.like(1.0), pdf.zero());
    R::select(sum.is_finite(), squared / sum, greater)
}

/// The weight of light sampled by next-event estimation with density `light_pdf`, in a direction
/// that scattering samples with density `scatter_pdf`. Only next-event estimation finds delta
/// emitters.
#[inline(always)]
#[must_use]
pub(crate) fn next_event_weight<R: Real>(light_pdf: R, delta: R::Mask, scatter_pdf: R) -> R {
    R::select(delta, light_pdf.like(1.0), power_heuristic(light_pdf, scatter_pdf))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_both_techniques_sum_to_one() {
        for (pdf, other) in [(0.3_f32, 2.0), (1e-3, 1e-3), (7.0, 0.0), (1e25, 1e-3), (3.0, 1e30)] {
            let sum = power_heuristic(pdf, other) + power_heuristic(other, pdf);
            assert!((sum - 1.0).abs() < 1e-6, "{pdf} {other}: {sum}");
        }
    }

    #[test]
    fn nothing_competes_with_next_event_estimation_for_delta_emitters() {
        assert_eq!(next_event_weight(1.0_f32, true, 5.0), 1.0);
        assert_eq!(next_event_weight(1.0_f32, false, 1.0), 0.5);
    }
}
