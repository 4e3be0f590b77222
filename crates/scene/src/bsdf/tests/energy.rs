//! Energy conservation.

use super::incident;
use crate::bsdf::{Bsdf, Transport};
use crate::testing::bsdf_cases::configurations;
use crate::testing::material::TestMaterial;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The tolerance of the estimates of [`albedo`].
const ERROR: f32 = 1e-3;

/// The mean weight of samples: the albedo. Refraction conserves importance, not radiance.
///
/// The uniform numbers are Roberts' sequence, multiples of the powers of the root of x⁴ = x + 1.
/// Its error falls almost as 1 / N.
fn albedo(bsdf: &Bsdf<'_>, wi: Vec3) -> Spectrum {
    const COUNT: u32 = 1 << 17;
    let root = 1.220_744_084_605_76_f64;
    let mut sum = [0.0_f64; Spectrum::LANES];
    for index in 0..COUNT {
        let coordinate = |power: i32| {
            let exact = (0.5 + f64::from(index) * root.powi(-power)).fract();
            (exact as f32).min(1.0 - f32::EPSILON / 2.0)
        };
        let direction = Vec2::new(coordinate(2), coordinate(3));
        let sample = bsdf.sample(wi, coordinate(1), direction, Transport::Importance);
        let weight = sample.map_or(Spectrum::ZERO, |sample| sample.weight);
        for (sum, weight) in sum.iter_mut().zip(weight.rgb()) {
            *sum += f64::from(weight);
        }
    }
    Spectrum::from_rgb(sum.map(|sum| (sum / f64::from(COUNT)) as f32))
}

#[test]
fn nothing_gives_off_more_light_than_it_gets() {
    for configuration in configurations() {
        let material = configuration.material();
        for wi in incident() {
            let albedo = albedo(&material.bsdf(wi), wi);
            let bound = if configuration.xml.contains("roughdiffuse") {
                // Oren and Nayar's fit exceeds one at grazing angles; here the facets have 0.5.
                0.7
            } else {
                1.0 + ERROR
            };
            assert!(albedo.max_component() <= bound, "{} from {wi}: {albedo:?}", configuration.xml);
        }
    }
}

#[test]
fn lossless_materials_give_back_all_of_it() {
    for configuration in configurations().filter(|configuration| configuration.lossless) {
        let material = configuration.material();
        for wi in incident() {
            let bsdf = material.bsdf(wi);
            if bsdf.sample(wi, 0.99, Vec2::splat(0.5), Transport::Importance).is_none() {
                assert!(wi.z < 0.0, "{} is black from the front", configuration.xml);
                continue;
            }
            let albedo = albedo(&bsdf, wi);
            // If every weight is one, there is nothing to estimate.
            let tolerance = if configuration.xml.contains("plastic") { ERROR } else { 1e-6 };
            let off = (albedo - Spectrum::ONE).abs().max_component();
            assert!(off <= tolerance, "{} from {wi}: {albedo:?}", configuration.xml);
        }
    }
}

#[test]
fn rough_surfaces_lose_more_the_rougher_they_are() {
    for plugin in ["roughconductor", "roughdielectric"] {
        for distribution in ["beckmann", "ggx"] {
            let albedo = |alpha: f32, wi: Vec3| {
                let material = TestMaterial::read(&format!(
                    r#"<bsdf type="{plugin}"><float name="alpha" value="{alpha}"/>
                    <string name="distribution" value="{distribution}"/></bsdf>"#
                ));
                albedo(&material.bsdf(wi), wi).max_component()
            };
            let wi = Vec3::new(0.6, 0.0, 0.8);
            let albedos = [0.01, 0.1, 0.3, 0.5, 0.8].map(|alpha| albedo(alpha, wi));
            assert!((albedos[0] - 1.0).abs() < ERROR, "{plugin} {distribution}: {albedos:?}");
            assert!(
                albedos.windows(2).all(|pair| pair[1] < pair[0] + ERROR),
                "{plugin} {distribution}: {albedos:?}"
            );
            assert!(albedos[4] < 0.98, "{plugin} {distribution}: {albedos:?}");
        }
    }
}

#[test]
fn the_albedo_of_smooth_materials_is_what_they_say() {
    for configuration in configurations() {
        let estimated = ["rough", "normalmap", "bumpmap", "principled", "hair", "measured"];
        if estimated.iter().any(|name| configuration.xml.contains(name)) {
            continue;
        }
        let material = configuration.material();
        for wi in incident() {
            let bsdf = material.bsdf(wi);
            let off = (bsdf.albedo(wi) - albedo(&bsdf, wi)).abs().max_component();
            assert!(off < ERROR, "{} from {wi}: {:?}", configuration.xml, bsdf.albedo(wi));
        }
    }
}
