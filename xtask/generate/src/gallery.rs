//! `cargo xtask gallery`: renders scenes under `scenes/` into `gallery/`.

mod denoise;
mod page;
mod table;

use std::fs;
use std::ops::Range;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use etendue::image::{EncodeOptions, FileFormat, encode};
use etendue::{
    Cancel, Files, LoadedScene, RenderJob, RenderOptions, Rendering, SampleChoice, SceneOptions,
    Silent, Workers, load_text,
};

use crate::repository::{has_generated_files, root};
use denoise::{Layers, Planes, denoise};
use table::{PICTURES, Picture};

/// The quality of the JPEG files, which keeps the repository small.
const JPEG_QUALITY: u8 = 90;

/// Samples per pixel of albedo and normals, which guide the denoiser.
const SURFACE_SAMPLES: u32 = 24;

/// What to render.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Pictures, by name; all if none is named
    names: Vec<String>,
    /// A factor on the numbers of samples, for drafts
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    spp_scale: f64,
    /// Write to this folder instead
    #[arg(long, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

/// Renders the pictures and writes the page.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let folder = arguments.output.clone().unwrap_or_else(|| root().join("gallery"));
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let workers = Workers::new(None).map_err(|error| error.to_string())?;
    for picture in choose(&arguments.names)? {
        let started = Instant::now();
        let bytes = render(picture, arguments.spp_scale, &workers)
            .map_err(|error| format!("{}: {error}", picture.name))?;
        let path = folder.join(picture.file_name());
        fs::write(&path, &bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        let minutes = started.elapsed().as_secs_f64() / 60.0;
        println!("{minutes:6.1} min {:>8} bytes  {}", bytes.len(), picture.name);
    }
    let path = folder.join("README.md");
    fs::write(&path, page::page()).map_err(|error| format!("{}: {error}", path.display()))
}

/// The pictures with these names.
fn choose(names: &[String]) -> Result<Vec<&'static Picture>, String> {
    let find = |name: &String| {
        let found = PICTURES.iter().find(|picture| picture.name == name);
        found.ok_or_else(|| format!("there is no picture `{name}`"))
    };
    if names.is_empty() {
        return Ok(PICTURES.iter().collect());
    }
    names.iter().map(find).collect()
}

/// Renders a picture to JPEG.
fn render(picture: &Picture, spp_scale: f64, workers: &Workers) -> Result<Vec<u8>, String> {
    let path = root().join(picture.scene());
    if !has_generated_files(&path) {
        return Err(format!("run `cargo xtask assets {}` first", picture.name));
    }
    let text = fs::read_to_string(&path).map_err(|error| error.to_string())?;
    let scene = Scene { text: &text, folder: path.with_file_name(""), workers };
    let count = (f64::from(picture.samples_per_pixel) * spp_scale).round().max(2.0) as u32;
    // The scenes serve as examples, so they must not contain unknown parameters.
    let strict = SceneOptions { strict: true, ..SceneOptions::default() };
    let loaded = scene.load(&strict)?;
    let half = |samples: Range<u32>| {
        scene
            .render(&loaded, samples, count)
            .map(|rendering| (planes(&rendering.picture, ""), rendering))
    };
    let (first, mut rendering) = half(0..count / 2)?;
    let (second, _) = half(count / 2..count)?;
    let surfaces = scene.surfaces()?.picture;
    let layers = Layers {
        width: rendering.picture.width as usize,
        halves: [first, second],
        albedo: planes(&surfaces, "albedo."),
        normal: planes(&surfaces, "normal."),
    };
    for (channel, plane) in rendering.picture.channels.iter_mut().zip(denoise(&layers)) {
        channel.data = plane;
    }
    let encoding = EncodeOptions {
        jpeg_quality: JPEG_QUALITY,
        tone_map: picture.tone_map,
        exposure: picture.exposure,
        ..rendering.encoding
    };
    encode(&rendering.picture, FileFormat::Jpeg, &encoding).map_err(|error| error.to_string())
}

/// The first three channels of a layer.
fn planes(picture: &etendue::image::Picture, layer: &str) -> Planes {
    let mut channels = picture.channels.iter().filter(|channel| channel.name.starts_with(layer));
    std::array::from_fn(|_| channels.next().map_or_else(Vec::new, |channel| channel.data.clone()))
}

/// The text of a scene, and what is needed to render it.
struct Scene<'a> {
    text: &'a str,
    folder: PathBuf,
    workers: &'a Workers,
}

impl Scene<'_> {
    fn load(&self, options: &SceneOptions) -> Result<LoadedScene, String> {
        self.load_text(self.text, options)
    }

    fn load_text(&self, text: &str, options: &SceneOptions) -> Result<LoadedScene, String> {
        let folder = self.folder.clone();
        let loaded = self.workers.run(|| load_text(text, folder, &Files::default(), options));
        loaded.scene.ok_or_else(|| loaded.diagnostics.to_string())
    }

    /// Renders some of the samples.
    fn render(
        &self,
        scene: &LoadedScene,
        samples: Range<u32>,
        planned: u32,
    ) -> Result<Rendering, String> {
        let options = RenderOptions {
            samples_per_pixel: Some(planned),
            samples: Some(SampleChoice::Indices(samples)),
            ..RenderOptions::default()
        };
        let job = RenderJob::new(scene, &options).map_err(|error| error.to_string())?;
        let rendering =
            job.render(self.workers, &Silent, &Cancel::new()).map_err(|error| error.to_string())?;
        if rendering.statistics.defects.total() > 0 {
            return Err("some samples are not finite".to_owned());
        }
        Ok(rendering)
    }

    /// The albedo and the normals of what the camera sees.
    fn surfaces(&self) -> Result<Rendering, String> {
        let layers = r#"<integrator type="aov">
            <string name="aovs" value="albedo:albedo, normal:sh_normal"/>"#;
        let text = ["path", "volpath"].iter().fold(self.text.to_owned(), |text, name| {
            text.replace(&format!("<integrator type=\"{name}\">"), layers)
        });
        // It does not know the other integrator's parameters.
        let scene = self.load_text(&text, &SceneOptions::default())?;
        self.render(&scene, 0..SURFACE_SAMPLES, SURFACE_SAMPLES)
    }
}
