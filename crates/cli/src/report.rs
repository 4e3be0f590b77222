//! Summary messages of a render.

use std::time::Duration;

use etendue::integrators::{MAX_COLLISIONS, MAX_EDGES};
use etendue::scene::Scene;
use etendue::{LoadTimes, RenderJob, Rendering, SamplesPerPixel, Statistics};

use crate::outputs::Outputs;
use crate::{memory, terminal, text};

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

/// Warns about values that files cannot hold.
pub(crate) fn clamped(rendering: &Rendering) {
    if rendering.clamped_values > 0 {
        let values = text::counted(rendering.clamped_values, "value");
        terminal::warning(&format!(
            "{values} beyond single precision, such as variances of radiance above 1e19: written as \
             {:e}",
            f32::MAX
        ));
    }
}

/// Warns about paths that were cut, and about pixels that have no sample because the time ran out in
/// the middle of a long path.
pub(crate) fn long_paths(statistics: &Statistics) {
    if statistics.truncated_paths > 0 {
        let paths = usize::try_from(statistics.truncated_paths).unwrap_or(usize::MAX);
        terminal::warning(&format!(
            "{} cut after {} edges or {} collisions in media: light beyond is missing",
            text::counted(paths, "path"),
            text::grouped(MAX_EDGES as usize),
            text::grouped(MAX_COLLISIONS as usize),
        ));
    }
    if statistics.samples_per_pixel.least == 0 && !statistics.cancelled {
        terminal::warning(
            "some pixels have no sample: the time ran out in the middle of long paths",
        );
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

/// Prints the memory that the render needs, before it starts, and the most that loading took:
/// `memory: 1.2 GB scene, 158 MB film; loading took 2.1 GB`.
pub(crate) fn memory(scene: &Scene, job: &RenderJob) {
    let statistics = scene.statistics();
    let scene = statistics.mesh_bytes
        + statistics.tree_bytes
        + statistics.texture_bytes
        + statistics.volume_bytes;
    let film = usize::try_from(job.memory_needed()).unwrap_or(usize::MAX);
    let loading = memory::peak().and_then(|peak| usize::try_from(peak).ok());
    let loading =
        loading.map(|peak| format!("; loading took {}", text::bytes(peak))).unwrap_or_default();
    terminal::message_line(&format!(
        "memory: {} scene, {} film{loading}",
        text::bytes(scene),
        text::bytes(film)
    ));
}
