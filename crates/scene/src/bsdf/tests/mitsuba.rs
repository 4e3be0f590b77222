//! Comparison of values and densities with Mitsuba 3.9.1, variant `scalar_rgb`.

use crate::bsdf::{Lobe, Transport};
use crate::testing::material::TestMaterial;
use glam::{Vec2, Vec3};

/// One material per line, followed by `eval` lines (wi, wo, value with cosine, density) or `sample`
/// lines (wi, the number that selects the lobe, wo, weight, density, eta). Printed from
/// `BSDF.eval_pdf` and `BSDF.sample` at the hit that
/// [`testing::surface`](crate::testing::material::surface) makes. Densities from behind an opaque
/// material are omitted, because Mitsuba returns nonzero ones.
const VALUES: &str = include_str!("mitsuba_values.txt");

/// Values are printed and computed with seven digits.
const RELATIVE: f32 = 2e-4;

#[test]
fn values_and_densities_are_those_of_mitsuba() {
    let mut faults = Vec::new();
    let (mut xml, mut material) = ("", None);
    for line in VALUES.lines() {
        if line.starts_with('<') {
            (xml, material) = (line, Some(TestMaterial::read(line)));
            continue;
        }
        let (kind, numbers) = line.split_once(' ').expect("a kind of line");
        let numbers: Vec<f32> =
            numbers.split_whitespace().map(|word| word.parse().expect("a number")).collect();
        let material = material.as_ref().expect("a material before its values");
        let fault = match kind {
            "eval" => compare_eval(material, xml, &numbers),
            _ => compare_sample(material, &numbers),
        };
        faults.extend(fault.map(|fault| format!("{xml}\n  {line}\n  {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn vector(numbers: &[f32]) -> Vec3 {
    Vec3::from_slice(numbers)
}

fn near(actual: f32, expected: f32, relative: f32) -> bool {
    (actual - expected).abs() <= relative * expected.abs() + 1e-6
}

fn compare_eval(material: &TestMaterial, xml: &str, numbers: &[f32]) -> Option<String> {
    let (wi, wo) = (vector(numbers), vector(&numbers[3..]));
    let (value, pdf) = material.bsdf(wi).eval_pdf(wi, wo, Transport::Radiance);
    let value_tolerance = match xml {
        // Mitsuba fits the diffuse reflectance of a smooth coat, within 0.12 % of 1 − F at this
        // index.
        _ if xml.contains("\"plastic\"") => 2e-3,
        // Both integrate over the normals, but with different numbers of nodes.
        _ if xml.contains("\"roughplastic\"") => 1e-3,
        // Mitsuba truncates its series for the Bessel function. This costs its lobes up to 0.5 %.
        _ if xml.contains("\"hair\"") => 5e-3,
        _ => RELATIVE,
    };
    // For Beckmann normals, Mitsuba's density uses the fit of the masking (0.35 %).
    let fitted = xml.contains("\"rough") && !xml.contains("\"ggx\"");
    let pdf_tolerance = if fitted { 4e-3 } else { value_tolerance };
    let expected = &numbers[6..9];
    let agree = value.rgb().iter().zip(expected).all(|(a, e)| near(*a, *e, value_tolerance))
        && near(pdf, numbers[9], pdf_tolerance);
    (!agree).then(|| format!("{:?} {pdf}", value.rgb()))
}

fn compare_sample(material: &TestMaterial, numbers: &[f32]) -> Option<String> {
    let wi = vector(numbers);
    let bsdf = material.bsdf(wi);
    let Some(sample) = bsdf.sample(wi, numbers[3], Vec2::splat(0.4), Transport::Radiance) else {
        return (numbers[10] != 0.0).then(|| "no sample".to_owned());
    };
    assert!(matches!(sample.lobe, Lobe::Delta | Lobe::Null));
    let expected = &numbers[7..10];
    let agree = (sample.wo - vector(&numbers[4..])).length() < 1e-5
        && sample.weight.rgb().iter().zip(expected).all(|(a, e)| near(*a, *e, RELATIVE))
        && near(sample.pdf, numbers[10], RELATIVE)
        && near(sample.eta, numbers[11], RELATIVE);
    (!agree).then(|| format!("{sample:?}"))
}
