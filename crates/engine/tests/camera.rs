//! The camera as a source of samples: where they lie, and that any of them can be replayed.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_engine::{
    Budget, Camera, Cancel, Channels, Host, Job, Region, SampleId, SampleSource, Silent, Watch,
    Workers, render,
};
use etendue_integrators::{Integrator, IntegratorOptions, build_integrator};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use std::sync::Arc;

/// A square from (-1, -1) to (1, 1) that fills the film, so that positions on both correspond.
const SQUARE: &str = r#"
    <scene version="3.0.0">
        <integrator type="aov">
            <string name="aovs" value="position:position"/>
            <integrator type="path"/>
        </integrator>
        <sensor type="orthographic">
            <transform name="to_world">
                <lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/>
            </transform>
            <film type="hdrfilm">
                <integer name="width" value="8"/>
                <integer name="height" value="8"/>
                <rfilter type="box"/>
            </film>
            <sampler type="sobol"><integer name="sample_count" value="64"/></sampler>
        </sensor>
        <emitter type="constant"/>
        <shape type="rectangle"/>
    </scene>"#;

fn build() -> (Arc<Scene>, Arc<dyn Integrator>) {
    let diagnostics = Diagnostics::new();
    let files = MemoryResources::default();
    let built = read_text(SQUARE, &files, &LoadOptions::default(), &diagnostics).ok().and_then(
        |document| {
            let scene = build_scene(&document, &files, &diagnostics, &BuildOptions::default())?;
            let options = IntegratorOptions::default();
            let integrator = build_integrator(&document, &options, &diagnostics)?;
            Some((Arc::new(scene), integrator.into()))
        },
    );
    built.unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

fn job(region: Region, samples_per_pixel: u32) -> Job {
    let budget = Budget { samples_per_pixel: Some(samples_per_pixel), time: None };
    Job { region, first_sample: 0, budget, variance: false, memory_limit: 1 << 30 }
}

fn with_camera<T>(test: impl FnOnce(&Camera) -> T) -> T {
    let (scene, integrator) = build();
    let setup = scene.sensors()[0].clone();
    let sampler = setup.sampler;
    test(&Camera::new(scene, setup, sampler, integrator))
}

#[test]
fn pixels_lie_where_the_film_says_also_in_a_crop() {
    with_camera(|camera| {
        let region = Region { x: 2, y: 1, width: 5, height: 6 };
        let workers = Workers::new(None).unwrap();
        let host = Host { workers: &workers, observer: &Silent, cancel: &Cancel::new() };
        let (film, _) = render(camera, &job(region, 64), &host).unwrap();
        let picture = film.develop(Channels::default());
        let x = &picture.channel("position.X").unwrap().data;
        let y = &picture.channel("position.Y").unwrap().data;
        for (index, (&x, &y)) in x.iter().zip(y).enumerate() {
            let (column, row) = (index as u32 % 5 + 2, index as u32 / 5 + 1);
            let centre = [(column as f32 + 0.5) / 4.0 - 1.0, 1.0 - (row as f32 + 0.5) / 4.0];
            // 64 points of a low-discrepancy sequence have a mean within a few hundredths of the
            // pixel's width of 0.25.
            assert!((x - centre[0]).abs() < 0.01, "{x} is not {}", centre[0]);
            assert!((y - centre[1]).abs() < 0.01, "{y} is not {}", centre[1]);
        }
    });
}

#[test]
fn a_replayed_sample_is_the_one_that_was_rendered() {
    with_camera(|camera| {
        let region = Region { x: 3, y: 4, width: 1, height: 1 };
        let workers = Workers::new(None).unwrap();
        let host = Host { workers: &workers, observer: &Silent, cancel: &Cancel::new() };
        let (film, _) = render(camera, &job(region, 1), &host).unwrap();
        let picture = film.develop(Channels { alpha: true, variance: false });
        let replay = camera.replay(SampleId { index: 0, y: 4, x: 3 });
        let [red, green, blue] = replay.sample.color.rgb();
        let mut expected = vec![red, green, blue, replay.sample.alpha];
        expected.extend(&replay.channels);
        let rendered: Vec<f32> = picture.channels.iter().map(|channel| channel.data[0]).collect();
        assert_eq!(rendered, expected);
        assert_eq!(replay.channels.len(), camera.channels().len());
    });
}

#[test]
fn what_a_channel_held_before_does_not_matter() {
    with_camera(|camera| {
        let id = SampleId { index: 5, y: 2, x: 1 };
        let mut channels = vec![f32::NAN; camera.channels().len()];
        let mut samples = Vec::new();
        camera.take_samples(&[id], &mut channels, &Watch::patient(), &mut samples);
        let replay = camera.replay(id);
        assert_eq!((samples, channels), (vec![replay.sample], replay.channels));
    });
}
