//! `variance` layers tell the errors of the pictures beside them, whatever the sampler.
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "the test reads the scenes that it renders, and shows what it finds"
)]

use std::path::PathBuf;

use etendue::scene::BuildOptions;
use etendue::{
    Cancel, Files, RenderJob, RenderOptions, Rendering, SceneOptions, Silent, Workers, load_text,
};

/// Every sampler, by its XML type.
const SAMPLERS: [&str; 8] = [
    "independent",
    "stratified",
    "multijitter",
    "orthogonal",
    "ldsampler",
    "halton",
    "hammersley",
    "sobol",
];

/// The limits of the standard deviation of z-scores. A perfect estimate has 1; the estimates here have
/// 25 degrees of freedom and less.
const Z_SCORES: [f64; 2] = [0.8, 1.25];

/// The limits of the mean estimated variance over the mean true one.
const MEAN_RATIO: [f64; 2] = [0.7, 1.3];

/// How well the variances of several renders tell their errors.
#[derive(Debug)]
struct Calibration {
    /// The standard deviation of (mean − expectation) / estimated standard error.
    z_scores: f64,
    /// The mean estimated variance over the mean true one.
    mean_ratio: f64,
}

/// A scene at a small size.
struct Case {
    text: String,
    folder: PathBuf,
    size: [u32; 2],
    samples_per_pixel: u32,
}

impl Case {
    fn render(&self, seeds: u64) -> Vec<Rendering> {
        let workers = Workers::new(None).unwrap();
        let build = BuildOptions { film_size: Some(self.size), ..BuildOptions::default() };
        let options = SceneOptions { build, ..SceneOptions::default() };
        let load = || load_text(&self.text, self.folder.clone(), &Files::default(), &options);
        let loaded = workers.run(load);
        let scene = loaded.scene.expect("the scene loads");
        let render = |seed| {
            let options = RenderOptions {
                samples_per_pixel: Some(self.samples_per_pixel),
                seed: Some(seed),
                variance: true,
                ..RenderOptions::default()
            };
            let job = RenderJob::new(&scene, &options).unwrap();
            job.render(&workers, &Silent, &Cancel::new()).unwrap()
        };
        (1..=seeds).map(render).collect()
    }

    fn calibrate(&self, seeds: u64) -> Calibration {
        let renderings = self.render(seeds);
        let channels = |name: &str| -> Vec<&[f32]> {
            renderings.iter().map(|r| r.picture.channel(name).unwrap().data.as_slice()).collect()
        };
        let count = seeds as f64;
        let (mut squared_z, mut z_count, mut estimated, mut actual) = (0.0, 0.0, 0.0, 0.0);
        for name in ["R", "G", "B"] {
            let (means, variances) = (channels(name), channels(&format!("variance.{name}")));
            for pixel in 0..means[0].len() {
                let expectation = means.iter().map(|m| f64::from(m[pixel])).sum::<f64>() / count;
                for (mean, variance) in means.iter().zip(&variances) {
                    let squared_error = (f64::from(mean[pixel]) - expectation).powi(2);
                    // The expectation is the renders' own mean, to which each is a little nearer.
                    let squared_error = squared_error * count / (count - 1.0);
                    let variance = f64::from(variance[pixel]);
                    (estimated, actual) = (estimated + variance, actual + squared_error);
                    if variance > 0.0 {
                        (squared_z, z_count) =
                            (squared_z + squared_error / variance, z_count + 1.0);
                    }
                }
            }
        }
        Calibration { z_scores: (squared_z / z_count).sqrt(), mean_ratio: estimated / actual }
    }

    fn check(&self, seeds: u64, what: &str) {
        let calibration = self.calibrate(seeds);
        println!("{what}: {calibration:?}");
        let within = |value: f64, [least, most]: [f64; 2]| (least..=most).contains(&value);
        assert!(within(calibration.z_scores, Z_SCORES), "{what}: {calibration:?}");
        assert!(within(calibration.mean_ratio, MEAN_RATIO), "{what}: {calibration:?}");
    }
}

/// A smooth scene, in which spread samples have a small part of the variance of independent ones.
fn smooth(sampler: &str) -> Case {
    let text = format!(
        r#"<scene version="3.0.0">
            <integrator type="direct"/>
            <sensor type="perspective">
                <transform name="to_world">
                    <lookat origin="0, 1, 4" target="0, 0, 0" up="0, 1, 0"/>
                </transform>
                <film type="hdrfilm"><rfilter type="box"/></film>
                <sampler type="{sampler}"/>
            </sensor>
            <emitter type="constant"><rgb name="radiance" value="1, 0.5, 0.25"/></emitter>
            <shape type="sphere"/>
            <shape type="rectangle"><transform name="to_world">
                <rotate x="1" angle="-90"/><scale value="9"/><translate y="-1"/>
            </transform></shape>
        </scene>"#
    );
    Case { text, folder: PathBuf::new(), size: [24, 16], samples_per_pixel: 16 }
}

#[test]
fn variances_hold_for_every_sampler() {
    for sampler in SAMPLERS {
        smooth(sampler).check(24, sampler);
    }
}

#[test]
fn variances_hold_for_any_number_of_samples() {
    for samples_per_pixel in [2, 3, 7] {
        let case = Case { samples_per_pixel, ..smooth("sobol") };
        case.check(24, &format!("{samples_per_pixel} samples"));
    }
}

#[test]
fn independent_samples_are_the_same_with_variances_and_without() {
    let case = smooth("independent");
    let options = |variance| RenderOptions {
        samples_per_pixel: Some(4),
        variance,
        ..RenderOptions::default()
    };
    let render = |variance| {
        let build = BuildOptions { film_size: Some(case.size), ..BuildOptions::default() };
        let scene_options = SceneOptions { build, ..SceneOptions::default() };
        etendue::render_text(&case.text, &scene_options, &options(variance)).unwrap()
    };
    let (with, without) = (render(true), render(false));
    for name in ["R", "G", "B"] {
        assert_eq!(with.picture.channel(name), without.picture.channel(name));
    }
}

#[test]
#[ignore = "renders three scenes hundreds of times, which takes minutes"]
fn variances_hold_for_every_sampler_in_scenes_with_light_and_shadow() {
    for name in ["cornell-box", "cups", "soft-shadows"] {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
        let text = std::fs::read_to_string(folder.join("scene.xml")).unwrap();
        for sampler in SAMPLERS {
            let text = text
                .replace(r#"<sampler type="sobol">"#, &format!(r#"<sampler type="{sampler}">"#));
            assert!(text.contains(sampler));
            let case = Case { text, folder: folder.clone(), size: [64, 48], samples_per_pixel: 16 };
            case.check(12, &format!("{name}, {sampler}"));
        }
    }
}
