//! Samples compared with densities, values and their own weights.

use super::incident;
use crate::bsdf::{Bsdf, Transport};
use crate::testing::bsdf_cases::configurations;
use etendue_testkit::{ChiSquare, TestRng};
use glam::Vec3;

/// Whether the material has any smooth reflection or transmission from `wi`.
fn is_visible(bsdf: &Bsdf<'_>, wi: Vec3) -> bool {
    let mut random = TestRng::new(1);
    let mut scatters = |_| {
        let (lobe, direction) = (random.next_f32(), random.next_vec2());
        let sample = bsdf.sample(wi, lobe, direction, Transport::Radiance);
        sample.is_some_and(|sample| sample.lobe.is_smooth())
    };
    (0..1000).any(&mut scatters)
}

#[test]
fn samples_follow_the_density() {
    let test = ChiSquare {
        samples: 100_000,
        ..ChiSquare::one_of((configurations().count() * incident().count()) as u32)
    };
    for configuration in configurations() {
        let material = configuration.material();
        for wi in incident() {
            let bsdf = material.bsdf(wi);
            let density = |wo: Vec3| bsdf.eval_pdf(wi, wo, Transport::Radiance).1;
            if !is_visible(&bsdf, wi) {
                let mut random = TestRng::new(2);
                let dark = (0..1000).all(|_| density(random.unit_vector()) == 0.0);
                assert!(dark, "{} from {wi}: a density without samples", configuration.xml);
                continue;
            }
            let outcome = test.sphere(
                |random| {
                    let (lobe, direction) = (random.next_f32(), random.next_vec2());
                    let sample = bsdf.sample(wi, lobe, direction, Transport::Radiance)?;
                    sample.lobe.is_smooth().then_some(sample.wo)
                },
                density,
            );
            assert!(outcome.accepted(), "{} from {wi}: {outcome}", configuration.xml);
        }
    }
}

#[test]
fn weights_times_densities_are_values() {
    let mut random = TestRng::new(3);
    for configuration in configurations() {
        let material = configuration.material();
        for (wi, transport) in incident().flat_map(|wi| {
            [Transport::Radiance, Transport::Importance].map(|transport| (wi, transport))
        }) {
            let bsdf = material.bsdf(wi);
            for _ in 0..500 {
                let (lobe, direction) = (random.next_f32(), random.next_vec2());
                let Some(sample) = bsdf.sample(wi, lobe, direction, transport) else { continue };
                let (value, pdf) = bsdf.eval_pdf(wi, sample.wo, transport);
                if !sample.lobe.is_smooth() {
                    assert!(sample.pdf > 0.0 && sample.pdf <= 1.0 + 1e-6);
                    continue;
                }
                let product = sample.weight * sample.pdf;
                // The normal between two directions has an error of about 1e-7 divided by their
                // length. The sharpest density here changes by 1 / 0.02² per unit of squared slope.
                let near = |a: f32, b: f32| (a - b).abs() <= 5e-3 * b.abs() + 1e-6;
                let agree = near(sample.pdf, pdf)
                    && product.rgb().iter().zip(value.rgb()).all(|(a, b)| near(*a, b));
                assert!(agree, "{}: {sample:?} {value:?} {pdf}", configuration.xml);
            }
        }
    }
}

#[test]
fn swapped_directions_give_the_adjoint() {
    let mut random = TestRng::new(4);
    let reciprocal = configurations().filter(|configuration| configuration.reciprocal);
    for configuration in reciprocal {
        let material = configuration.material();
        for _ in 0..500 {
            let (wi, wo) = (random.unit_vector(), random.unit_vector());
            // The densities of close directions over cosines near zero would be pure noise.
            if wi.z.abs().min(wo.z.abs()) < 0.05 {
                continue;
            }
            let forth = material.bsdf(wi).eval_pdf(wi, wo, Transport::Radiance).0 / wo.z.abs();
            let back = material.bsdf(wo).eval_pdf(wo, wi, Transport::Importance).0 / wi.z.abs();
            let near = |(a, b): (f32, f32)| (a - b).abs() <= 2e-3 * a.max(b) + 1e-6;
            let agree = forth.rgb().into_iter().zip(back.rgb()).all(near);
            let other_side = wi.z * wo.z < 0.0 && configuration.xml.contains("twosided");
            assert!(agree || other_side, "{} {wi} {wo}: {forth:?} {back:?}", configuration.xml);
        }
    }
}
