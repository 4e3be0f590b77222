//! The library as a Rust program uses it.
#![allow(clippy::disallowed_methods, reason = "tests write scene files")]

use std::fs;
use std::time::Duration;

use etendue::image::{FileFormat, MetadataValue, decode_picture};
use etendue::{
    Error, Region, RenderOptions, Rendering, SamplesPerPixel, SceneOptions, SensorChoice,
    render_file, render_text,
};

/// A scene whose film has the given parameters in addition to its size of 12x8.
fn scene(film: &str) -> String {
    format!(
        r#"<scene version="3.0.0">
            <sensor type="perspective" id="eye">
                <film type="hdrfilm">
                    <integer name="width" value="12"/><integer name="height" value="8"/>
                    {film}
                </film>
                <sampler type="independent"><integer name="sample_count" value="2"/></sampler>
            </sensor>
            <emitter type="constant"><rgb name="radiance" value="1, 0.5, 0.25"/></emitter>
        </scene>"#
    )
}

fn render(film: &str, options: &RenderOptions) -> Result<Rendering, Error> {
    render_text(&scene(film), &SceneOptions::default(), options)
}

fn names(rendering: &Rendering) -> Vec<&str> {
    rendering.picture.channels.iter().map(|channel| channel.name.as_str()).collect()
}

fn format(name: &str) -> String {
    format!(r#"<string name="pixel_format" value="{name}"/>"#)
}

#[test]
fn pixel_formats_choose_the_channels() {
    let render = |name: &str| render(&format(name), &RenderOptions::default()).unwrap();
    assert_eq!(names(&render("rgb")), ["R", "G", "B"]);
    assert_eq!(names(&render("rgba")), ["R", "G", "B", "A"]);
    let luminance = render("luminance_alpha");
    assert_eq!(names(&luminance), ["Y", "A"]);
    // The luminance of (1, 0.5, 0.25) by ITU-R BT.709.
    let expected = 0.212_639 + 0.5 * 0.715_169 + 0.25 * 0.072_192;
    assert!((luminance.picture.channels[0].data[0] - expected).abs() < 1e-4);
    assert_eq!(luminance.picture.channels[1].data[0], 1.0, "an environment that shows covers");
}

#[test]
fn xyz_is_what_exr_files_get_and_others_stay_rgb() {
    let rendering = render(&format("xyz"), &RenderOptions::default()).unwrap();
    let exr = decode_picture(&rendering.encode(FileFormat::Exr).unwrap(), "a.exr").unwrap();
    let mut channels: Vec<_> = exr.channels.iter().map(|channel| channel.name.as_str()).collect();
    channels.sort_unstable();
    assert_eq!(channels, ["X", "Y", "Z"]);
    let pfm = decode_picture(&rendering.encode(FileFormat::Pfm).unwrap(), "a.pfm").unwrap();
    assert_eq!(pfm.channels[1].data[0], 0.5);
}

#[test]
fn variances_come_on_demand_and_the_rest_is_metadata() {
    let options = RenderOptions { variance: true, seed: Some(7), ..RenderOptions::default() };
    let rendering = render("", &options).unwrap();
    assert!(names(&rendering).contains(&"variance.G"));
    let seed = rendering.picture.metadata("seed");
    assert_eq!(seed, Some(&MetadataValue::Text("7".to_owned())));
    assert_eq!(rendering.statistics.samples, 12 * 8 * 2);
}

#[test]
fn parts_of_the_film_are_checked() {
    let part = |x, y, width, height| {
        let region = Some(Region { x, y, width, height });
        render("", &RenderOptions { region, ..RenderOptions::default() })
    };
    let rendering = part(11, 7, 1, 1).unwrap();
    assert_eq!((rendering.picture.width, rendering.picture.data_origin), (1, [11, 7]));
    for (x, y, width, height) in [(12, 0, 1, 1), (0, 0, 13, 1), (0, 0, 0, 1), (1, 1, u32::MAX, 1)] {
        assert!(matches!(part(x, y, width, height), Err(Error::Region { .. })));
    }
}

#[test]
fn budgets_may_be_samples_or_time() {
    let few = RenderOptions { samples_per_pixel: Some(5), ..RenderOptions::default() };
    assert_eq!(render("", &few).unwrap().statistics.samples_per_pixel, SamplesPerPixel::all(5));
    let time_limit = Some(Duration::from_millis(1));
    let short = RenderOptions { time_limit, ..RenderOptions::default() };
    assert!(render("", &short).unwrap().statistics.samples_per_pixel.least >= 1);
}

#[test]
fn errors_say_what_is_wrong() {
    let sensor = SensorChoice::from("nose");
    let error = render("", &RenderOptions { sensor, ..RenderOptions::default() }).unwrap_err();
    assert_eq!(error.to_string(), "the scene has no sensor `nose`, but 0 (`eye`)");

    let broken = "<scene version=\"3.0.0\">\n<shape type=\"spherre\"/>\n</scene>";
    let options = RenderOptions::default();
    let error = render_text(broken, &SceneOptions::default(), &options).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("spherre") && message.contains(":2:1"), "{message}");

    let memory_limit = Some(1000);
    let error = render("", &RenderOptions { memory_limit, ..RenderOptions::default() });
    assert!(matches!(error, Err(Error::Engine(_))));
}

#[test]
fn files_are_read_from_disk_and_broken_ones_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.xml");
    fs::write(&path, scene("")).unwrap();
    let options = RenderOptions::default();
    let rendering = render_file(&path, &SceneOptions::default(), &options).unwrap();
    assert_eq!(rendering.picture.width, 12);

    fs::write(&path, "<scene version=\"3.0.0\">\n  <shape\n").unwrap();
    let error = render_file(&path, &SceneOptions::default(), &options).unwrap_err();
    assert!(error.to_string().contains("scene.xml:2:3"), "{error}");
    let missing = render_file(folder.path().join("no.xml"), &SceneOptions::default(), &options);
    assert!(missing.unwrap_err().to_string().contains("no.xml"));
}

/// The messages of loading a scene with this content besides its sensor.
fn messages(body: &str) -> Vec<String> {
    let text = format!(r#"<scene version="3.0.0"><sensor type="perspective"/>{body}</scene>"#);
    let resources = etendue::document::MemoryResources::default();
    let loaded = etendue::load_text(&text, "".into(), &resources, &SceneOptions::default());
    assert!(loaded.scene.is_some(), "{body}");
    loaded.diagnostics.list.iter().map(|diagnostic| diagnostic.message.clone()).collect()
}

#[test]
fn a_scene_without_light_is_reported_unless_it_needs_none() {
    let black = r#"<rgb name="radiance" value="0"/>"#;
    for (body, part) in [
        (r#"<shape type="sphere"/>"#.to_owned(), "no emitter"),
        (format!(r#"<emitter type="constant">{black}</emitter>"#), "are black"),
        (
            format!(r#"<shape type="sphere"><emitter type="area">{black}</emitter></shape>"#),
            "are black",
        ),
    ] {
        let found = messages(&body);
        assert!(found.len() == 1 && found[0].contains(part), "{body}: {found:?}");
        for geometry in
            [r#"type="depth"/>"#, r#"type="aov"><string name="aovs" value="depth"/></integrator>"#]
        {
            let body = format!("<integrator {geometry}{body}");
            assert_eq!(messages(&body), Vec::<String>::new(), "{body}");
        }
        let body =
            format!(r#"<integrator type="aov"><integrator type="path"/></integrator>{body}"#);
        assert_eq!(messages(&body).len(), 1, "{body}");
    }
    let lit = r#"<emitter type="point"/>"#;
    assert_eq!(messages(lit), Vec::<String>::new());
}

#[test]
fn integrator_parameters_that_only_divide_the_work_are_accepted() {
    let body = r#"<integrator type="path"><integer name="samples_per_pass" value="4"/>
        <float name="timeout" value="60"/></integrator><emitter type="constant"/>"#;
    assert_eq!(messages(body), Vec::<String>::new());
}

#[test]
fn the_header_tells_a_limit_of_indirect_light() {
    let limit_of = |options: &SceneOptions| {
        let rendering = render_text(&scene(""), options, &RenderOptions::default()).unwrap();
        let metadata = rendering.picture.metadata.into_iter();
        metadata.filter(|(name, _)| name == "clampIndirect").map(|(_, value)| value).next()
    };
    let mut options = SceneOptions::default();
    assert_eq!(limit_of(&options), None);
    options.integrator.clamp_indirect = Some(2.5);
    assert_eq!(limit_of(&options), Some(MetadataValue::Float(2.5)));
}
