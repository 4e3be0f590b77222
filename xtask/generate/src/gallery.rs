//! `cargo xtask gallery`: renders the scenes under `scenes/` into `gallery/`.

mod page;
mod table;

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use etendue::image::FileFormat;
use etendue::integrators::IntegratorOptions;
use etendue::{Cancel, Files, RenderJob, RenderOptions, SceneOptions, Silent, Workers, load};

use crate::repository::root;
use table::{EmitterSampling, Entry, SECTIONS, Section};

/// What to render.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Pictures or scenes, by name; all if none is named
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
    let chosen = choose(&arguments.names)?;
    for (section, entry) in chosen {
        let started = Instant::now();
        let bytes = render(section, entry, arguments.spp_scale, &workers)
            .map_err(|error| format!("{}: {error}", entry.name))?;
        let path = folder.join(format!("{}.png", entry.name));
        fs::write(&path, &bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        let seconds = started.elapsed().as_secs_f64();
        println!("{seconds:7.1} s {:>8} bytes  {}", bytes.len(), entry.name);
    }
    let path = folder.join("README.md");
    fs::write(&path, page::page()).map_err(|error| format!("{}: {error}", path.display()))
}

/// The pictures with these names, or of scenes with these names.
fn choose(names: &[String]) -> Result<Vec<(&'static Section, &'static Entry)>, String> {
    let all = || {
        SECTIONS
            .iter()
            .flat_map(|section| section.pictures.iter().map(move |entry| (section, entry)))
    };
    let is_called = |(section, entry): (&Section, &Entry), name: &str| {
        section.scene == name || entry.name == name
    };
    if let Some(unknown) = names.iter().find(|name| !all().any(|picture| is_called(picture, name)))
    {
        return Err(format!("there is no picture or scene `{unknown}`"));
    }
    let is_chosen = |picture| names.is_empty() || names.iter().any(|name| is_called(picture, name));
    Ok(all().filter(|picture| is_chosen(*picture)).collect())
}

/// Renders a picture to PNG.
fn render(
    section: &Section,
    entry: &Entry,
    spp_scale: f64,
    workers: &Workers,
) -> Result<Vec<u8>, String> {
    let text = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
    let emitter_sampling = entry.emitter_sampling == EmitterSampling::On;
    let scene_options = SceneOptions {
        defines: entry.defines.iter().map(text).collect(),
        integrator: IntegratorOptions { emitter_sampling, ..IntegratorOptions::default() },
        // The scenes serve as examples, so they must not contain unknown parameters.
        strict: true,
        ..SceneOptions::default()
    };
    let samples = (f64::from(entry.samples_per_pixel) * spp_scale).round().max(1.0) as u32;
    let options = RenderOptions { samples_per_pixel: Some(samples), ..RenderOptions::default() };
    let path = PathBuf::from(format!("scenes/{}/scene.xml", section.scene));
    let loaded = workers.run(|| load(&path, root(), &Files::default(), &scene_options));
    let scene = loaded.scene.ok_or_else(|| loaded.diagnostics.to_string())?;
    let job = RenderJob::new(&scene, &options).map_err(|error| error.to_string())?;
    let rendering =
        job.render(workers, &Silent, &Cancel::new()).map_err(|error| error.to_string())?;
    if rendering.statistics.defects.total() > 0 {
        return Err("some samples are not finite".to_owned());
    }
    rendering.encode(FileFormat::Png).map_err(|error| error.to_string())
}
