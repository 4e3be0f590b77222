//! Summary messages of a render.

use std::time::Duration;

use etendue::scene::Scene;
use etendue::{LoadTimes, RenderJob, Rendering, SamplesPerPixel, Statistics};

use crate::outputs::Outputs;
use crate::{terminal, text};

/// Prints `a.exr, a.png: 256x256, 64 samples per pixel in 1.20 s (3.41 Msamples/s)`.
pub(crate) fn written(rendering: &Rendering, outputs: &Outputs) {
    let (picture, statistics) = (&rendering.picture, &rendering.statistics);
    let SamplesPerPixel { least, most } = statistics.samples_per_pixel;
    let samples = if least == most {
        text::counted(most as usize, "sample")
    } else {
        format!("{least} to {most} samples")
    };
    terminal::message_line(&format!(
        "{}: {}x{}, {samples} per pixel in {} ({}samples/s){}",
        outputs.names(),
        picture.width,
        picture.height,
        text::duration(statistics.duration),
        text::scaled(statistics.samples_per_second()),
        if statistics.cancelled { ", stopped early" } else { "" },
    ));
}

/// Warns about variances that single precision cannot hold.
pub(crate) fn clamped_variances(rendering: &Rendering) {
    let layers = &rendering.picture.channels;
    let variances = layers.iter().filter(|layer| layer.name.starts_with("variance."));
    let values = variances.flat_map(|layer| &layer.data);
    let count = values.filter(|&&value| value == f32::MAX).count();
    if count > 0 {
        terminal::warning(&format!(
            "{} beyond single precision, written as its greatest number",
            text::counted(count, "variance")
        ));
    }
}

/// Prints how long each stage took.
pub(crate) fn times(load: &LoadTimes, statistics: &Statistics, writing: Duration) {
    let milliseconds = |duration: Duration| format!("{:.1} ms", duration.as_secs_f64() * 1e3);
    terminal::message_line(&format!(
        "document {}, scene {}, {} passes in {} on {}, files {}",
        milliseconds(load.document),
        milliseconds(load.scene),
        statistics.passes,
        milliseconds(statistics.duration),
        text::counted(statistics.threads, "thread"),
        milliseconds(writing),
    ));
}

/// Prints the memory that the render needs, before it starts: `memory: 1.2 GB scene, 158 MB film`.
pub(crate) fn memory(scene: &Scene, job: &RenderJob) {
    let statistics = scene.statistics();
    let scene = statistics.mesh_bytes
        + statistics.tree_bytes
        + statistics.texture_bytes
        + statistics.volume_bytes;
    let film = usize::try_from(job.memory_needed()).unwrap_or(usize::MAX);
    terminal::message_line(&format!(
        "memory: {} scene, {} film",
        text::bytes(scene),
        text::bytes(film)
    ));
}
