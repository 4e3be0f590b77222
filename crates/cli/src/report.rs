//! What a render says when it is done.

use std::time::Duration;

use etendue::{LoadTimes, Rendering, Statistics};

use crate::output::Target;
use crate::{terminal, text};

/// `a.exr, a.png: 256x256, 64 samples per pixel in 1.20 s (3.41 Msamples/s)`.
pub(crate) fn written(rendering: &Rendering, targets: &[Target]) {
    let names: Vec<_> = targets.iter().map(|target| target.path.display().to_string()).collect();
    let (picture, statistics) = (&rendering.picture, &rendering.statistics);
    let samples = match statistics.samples_per_pixel {
        [least, most] if least == most => text::counted(most as usize, "sample"),
        [least, most] => format!("{least} to {most} samples"),
    };
    terminal::message_line(&format!(
        "{}: {}x{}, {samples} per pixel in {} ({}samples/s){}",
        names.join(", "),
        picture.width,
        picture.height,
        text::duration(statistics.duration),
        text::scaled(statistics.samples_per_second()),
        if statistics.cancelled { ", stopped early" } else { "" },
    ));
}

/// Where the time went.
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
