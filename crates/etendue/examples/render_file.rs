//! Renders a scene file and writes the picture: `render_file SCENE.xml PICTURE.png [SAMPLES]`.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "an example is a host: it prints, and reads arguments"
)]

use std::error::Error;
use std::path::Path;

use etendue::durable::write_durably;
use etendue::image::FileFormat;
use etendue::{RenderOptions, SceneOptions, render_file};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, picture, samples @ ..] = arguments.as_slice() else {
        return Err("usage: render_file SCENE.xml PICTURE.png [SAMPLES]".into());
    };
    let picture = Path::new(picture);
    let extension = picture.extension().and_then(|extension| extension.to_str());
    let format = extension.and_then(FileFormat::from_extension).ok_or("no such picture format")?;

    // Without a count, the scene's sampler sets the samples per pixel.
    let samples_per_pixel = samples.first().map(|count| count.parse()).transpose()?;
    let options = RenderOptions { samples_per_pixel, ..RenderOptions::default() };
    let rendering = render_file(scene, &SceneOptions::default(), &options)?;

    // The file is replaced atomically.
    let bytes = rendering.encode(format)?;
    write_durably(picture, |file| file.write_all(&bytes))?;
    let seconds = rendering.statistics.duration.as_secs_f64();
    println!("{} samples in {seconds:.2} s", rendering.statistics.samples);
    Ok(())
}
