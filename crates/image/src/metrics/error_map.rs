//! Error maps: one error per pixel, and the mean.

use crate::color_image::ColorImage;
use crate::color_map::heat;
use crate::picture::Picture;

/// An error per pixel, and the mean.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The error of each pixel, the top row first; NaN where it is undefined.
    pub values: Vec<f32>,
    /// The mean over all defined values; NaN if there are none.
    pub mean: f64,
    /// The number of pixels excluded because either image is NaN or infinite there.
    pub non_finite: usize,
}

impl ErrorMap {
    /// Averages a map that is NaN where the error is undefined.
    pub(super) fn new(image: &ColorImage, values: Vec<f32>) -> Self {
        let defined = values.iter().filter(|value| !value.is_nan());
        let (sum, count) = defined
            .fold((0.0, 0_usize), |(sum, count), &value| (sum + f64::from(value), count + 1));
        Self {
            width: image.width,
            height: image.height,
            mean: sum / count as f64,
            non_finite: values.len() - count,
            values,
        }
    }

    /// The map as a colour picture: from black at zero through violet, red and
    /// orange to pale yellow at `maximum`; white where it is undefined.
    pub fn to_picture(&self, maximum: f32) -> Picture {
        let color = |&value: &f32| if value.is_nan() { [1.0; 3] } else { heat(value / maximum) };
        let pixels = self.values.iter().map(color).collect();
        Picture::from_color_image(&ColorImage { width: self.width, height: self.height, pixels })
    }

    /// The quantile of the defined values for a given fraction: a robust maximum for
    /// [`to_picture`](Self::to_picture). Zero if there are none.
    pub fn quantile(&self, fraction: f32) -> f32 {
        let mut defined: Vec<f32> = self.values.iter().copied().filter(|v| !v.is_nan()).collect();
        if defined.is_empty() {
            return 0.0;
        }
        let index = (fraction.clamp(0.0, 1.0) * (defined.len() - 1) as f32).round() as usize;
        let index = index.min(defined.len() - 1);
        *defined.select_nth_unstable_by(index, f32::total_cmp).1
    }
}

/// Whether all channels of a pixel are finite.
pub(super) fn is_finite(pixel: &[f32; 3]) -> bool {
    pixel.iter().all(|value| value.is_finite())
}
