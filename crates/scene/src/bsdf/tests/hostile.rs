//! Extreme inputs: no result may be infinite, negative or NaN.

use super::incident;
use crate::bsdf::{Bsdf, Transport};
use crate::testing::bsdf_cases::{PLUGINS, configurations};
use crate::testing::material::TestMaterial;
use etendue_spectrum::Spectrum;
use etendue_testkit::TestRng;
use glam::{Vec2, Vec3};

/// Arbitrary directions, many of them exactly or nearly along the normal or the surface.
fn direction(random: &mut TestRng) -> Vec3 {
    let tangent = Vec2::from_angle(random.range_f32(0.0, 6.4));
    let side = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let small = [0.0, 1e-45, 1e-38, 1e-20, 1e-10, 1e-7, 1e-4, 1e-2][random.below(8) as usize];
    match random.below(4) {
        0 => tangent.extend(side * small).normalize(),
        1 => (tangent * small).extend(side).normalize(),
        2 => Vec3::Z * side,
        _ => random.unit_vector(),
    }
}

/// Uniform numbers, often the first or last of their range.
fn uniform(random: &mut TestRng) -> f32 {
    match random.below(8) {
        0 => 0.0,
        1 => 1.0 - f32::EPSILON / 2.0,
        2 => 0.5,
        _ => random.next_f32(),
    }
}

fn sound(value: Spectrum, pdf: f32) -> bool {
    value.is_finite() && !value.has_negative() && pdf.is_finite() && pdf >= 0.0
}

fn check(xml: &str, bsdf: &Bsdf<'_>, wi: Vec3, random: &mut TestRng) {
    for transport in [Transport::Radiance, Transport::Importance] {
        let wo = direction(random);
        let (value, pdf) = bsdf.eval_pdf(wi, wo, transport);
        assert!(sound(value, pdf), "{xml}: {wi:?} {wo:?} {value:?} {pdf}");
        let (lobe, point) = (uniform(random), Vec2::new(uniform(random), uniform(random)));
        let Some(sample) = bsdf.sample(wi, lobe, point, transport) else { continue };
        let good = sound(sample.weight, sample.pdf)
            && sample.pdf > 0.0
            && (sample.wo.length() - 1.0).abs() < 1e-4
            && sample.eta.is_finite();
        assert!(good, "{xml}: {wi:?} {lobe} {point} {sample:?}");
        // The sampled direction must also evaluate without bad values.
        let (value, pdf) = bsdf.eval_pdf(wi, sample.wo, transport);
        assert!(sound(value, pdf), "{xml}: {wi:?} {sample:?} {value:?} {pdf}");
    }
    assert!(sound(bsdf.albedo(wi), 0.0), "{xml}: {wi:?} {:?}", bsdf.albedo(wi));
    let normal = bsdf.normal();
    assert!((normal.length() - 1.0).abs() < 1e-4, "{xml}: {normal}");
}

#[test]
fn extreme_directions_and_parameters_stay_finite() {
    let mut random = TestRng::new(5);
    let usual = configurations().map(|configuration| configuration.xml);
    let extreme = PLUGINS.iter().flat_map(|(_, cases)| cases.extreme.iter().copied());
    for xml in usual.chain(extreme) {
        let material = TestMaterial::read(xml);
        for _ in 0..20_000 {
            let wi = direction(&mut random);
            check(xml, &material.bsdf(wi), wi, &mut random);
        }
    }
}

#[test]
fn nearly_smooth_surfaces_reflect_as_smooth_ones() {
    let rough = TestMaterial::read(
        r#"<bsdf type="roughdielectric"><float name="alpha" value="0.0001"/></bsdf>"#,
    );
    let smooth = TestMaterial::read(r#"<bsdf type="dielectric"/>"#);
    let mut random = TestRng::new(6);
    for wi in incident() {
        for _ in 0..100 {
            let (lobe, point) = (random.next_f32(), random.next_vec2());
            let [rough, smooth] = [&rough, &smooth].map(|material| {
                material.bsdf(wi).sample(wi, lobe, point, Transport::Radiance).expect("a sample")
            });
            assert_eq!(rough.eta, smooth.eta);
            assert!((rough.wo - smooth.wo).length() < 0.02, "{wi}: {rough:?} {smooth:?}");
            assert!((rough.weight - smooth.weight).abs().max_component() < 0.01);
        }
    }
}
