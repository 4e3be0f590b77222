//! Compares a picture with its reference, and tells noise from errors.

use std::path::Path;

use etendue::image::metrics::{
    BlockThresholds, Estimate, block_test, mean_difference, relative_mse,
};
use etendue::image::{ColorImage, EncodeOptions, FileFormat, Picture, decode_exr_layers, encode};

use crate::trial::output;
use crate::z_test;

/// A picture, and the variance of the mean for each pixel.
#[derive(Clone)]
pub(crate) struct Measured {
    pub(crate) mean: ColorImage,
    pub(crate) variance: ColorImage,
}

/// How two pictures differ.
#[derive(Debug)]
pub(crate) struct Difference {
    /// The relative difference of means in percent, for the channel where it is largest.
    pub(crate) mean: f64,
    /// The difference of means in standard errors, for the channel where it is largest.
    pub(crate) mean_errors: f64,
    /// The percentage of blocks of 8×8 pixels that differ by more than four standard errors and by
    /// more than 2 %.
    pub(crate) blocks: f64,
    /// The percentage of pixel channels that pass the z-test.
    pub(crate) accepted: f64,
}

/// The limits of a [`Difference`].
pub(crate) struct Limits {
    pub(crate) mean: f64,
    pub(crate) mean_errors: f64,
    pub(crate) blocks: f64,
    /// A minimum; the others are maxima.
    pub(crate) accepted: f64,
}

impl Limits {
    /// No limits; a base for struct updates.
    pub(crate) const NONE: Self = Self {
        mean: f64::INFINITY,
        mean_errors: f64::INFINITY,
        blocks: f64::INFINITY,
        accepted: 0.0,
    };
}

/// Reads an EXR file.
pub(crate) fn read(path: &Path) -> Result<Picture, String> {
    let message = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let bytes = std::fs::read(path).map_err(|error| message(&error))?;
    decode_exr_layers(&bytes).map_err(|error| message(&error))
}

/// The colours of an EXR file.
pub(crate) fn read_colors(path: &Path) -> Result<ColorImage, String> {
    read(path)?.to_color_image().map_err(|error| error.to_string())
}

/// Applies a function to all values of an image.
pub(crate) fn map(image: &ColorImage, value: impl Fn(f32) -> f32) -> ColorImage {
    let pixels = image.pixels.iter().map(|pixel| pixel.map(&value)).collect();
    ColorImage { width: image.width, height: image.height, pixels }
}

impl Measured {
    /// Reads a picture written by `etendue render --variance`.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let picture = read(path)?;
        let mean = picture.to_color_image().map_err(|error| error.to_string())?;
        let variance = layer(&picture, "variance")
            .ok_or_else(|| format!("{} has no variance layers", path.display()))?;
        Ok(Self { mean, variance })
    }

    /// The mean of several renders with equal sample counts, and its variance estimated from them.
    ///
    /// # Errors
    /// If the sizes differ, or there are fewer than two.
    pub(crate) fn of_renders(renders: &[ColorImage]) -> Result<Self, String> {
        let count = renders.len() as f32;
        let [first, _, ..] = renders else {
            return Err("at least two renders are needed".to_owned());
        };
        let mut mean = map(first, |_| 0.0);
        let mut variance = mean.clone();
        for render in renders {
            if render.pixels.len() != mean.pixels.len() {
                return Err("the sizes differ".to_owned());
            }
            for (sum, value) in values_of_both(&mut mean, render) {
                *sum += value / count;
            }
        }
        for render in renders {
            let deviation = ColorImage {
                pixels: render.pixels.iter().zip(&mean.pixels).map(difference).collect(),
                ..*render
            };
            for (sum, value) in values_of_both(&mut variance, &deviation) {
                *sum += value * value / (count * (count - 1.0));
            }
        }
        Ok(Self { mean, variance })
    }

    /// Raises each variance to at least the mean of the 5×5 pixels around it. A pixel that no rare
    /// bright path has hit yet underestimates its variance, but its neighbours show it.
    pub(crate) fn with_smooth_variance(mut self) -> Self {
        let (width, height) = (self.variance.width as usize, self.variance.height as usize);
        let around = |place: usize, end: usize| place.saturating_sub(2)..(place + 3).min(end);
        let smooth = |index: usize| {
            let (columns, rows) = (around(index % width, width), around(index / width, height));
            let count = (columns.len() * rows.len()) as f32;
            let mut sums = [0.0; 3];
            for pixel in rows.flat_map(|y| columns.clone().map(move |x| y * width + x)) {
                for (sum, value) in sums.iter_mut().zip(self.variance.pixels[pixel]) {
                    *sum += value / count;
                }
            }
            let own = self.variance.pixels[index];
            std::array::from_fn(|channel| own[channel].max(sums[channel]))
        };
        self.variance.pixels = (0..width * height).map(smooth).collect();
        self
    }

    /// Compares with a reference. `least_variance` is a lower bound for the variance of each pixel.
    pub(crate) fn compare(
        &self,
        reference: &Self,
        least_variance: f64,
    ) -> Result<(Difference, ColorImage), String> {
        let text = |error: etendue::image::ImageError| error.to_string();
        let means = mean_difference(&self.mean, &reference.mean).map_err(text)?;
        if means.absolute.non_finite > 0 {
            return Err(format!("{} pixels are not finite", means.absolute.non_finite));
        }
        let thresholds =
            BlockThresholds { relative_difference: 0.02, ..BlockThresholds::default() };
        let blocks =
            block_test(self.estimate(), reference.estimate(), &thresholds).map_err(text)?;
        let test = z_test::test(self, reference, least_variance)?;
        let largest = |values: [f64; 3]| values.into_iter().map(f64::abs).fold(0.0, f64::max);
        let errors = mean_standard_errors(self, reference, least_variance);
        let in_errors = std::array::from_fn(|channel| means.signed[channel] / errors[channel]);
        let difference = Difference {
            mean: 100.0 * largest(means.relative),
            mean_errors: largest(in_errors),
            blocks: 100.0 * blocks.share(),
            accepted: 100.0 * test.accepted,
        };
        Ok((difference, test.p_values))
    }

    fn estimate(&self) -> Estimate<'_> {
        Estimate { mean: &self.mean, variance: &self.variance }
    }
}

/// The values of two images of the same size, side by side.
fn values_of_both<'a>(
    a: &'a mut ColorImage,
    b: &'a ColorImage,
) -> impl Iterator<Item = (&'a mut f32, &'a f32)> {
    a.pixels.as_flattened_mut().iter_mut().zip(b.pixels.as_flattened())
}

fn difference((a, b): (&[f32; 3], &[f32; 3])) -> [f32; 3] {
    std::array::from_fn(|channel| a[channel] - b[channel])
}

/// The channels `NAME.R`, `NAME.G` and `NAME.B` as one image.
pub(crate) fn layer(picture: &Picture, name: &str) -> Option<ColorImage> {
    let [red, green, blue] = ["R", "G", "B"].map(|end| picture.channel(&format!("{name}.{end}")));
    let colors = red?.data.iter().zip(&green?.data).zip(&blue?.data);
    let pixels = colors.map(|((&red, &green), &blue)| [red, green, blue]).collect();
    Some(ColorImage { width: picture.width, height: picture.height, pixels })
}

/// The standard error of the difference of the two pictures' means, for each channel.
fn mean_standard_errors(picture: &Measured, reference: &Measured, least_variance: f64) -> [f64; 3] {
    let pairs = picture.variance.pixels.iter().zip(&reference.variance.pixels);
    let mut sums = [0.0; 3];
    for (own, other) in pairs {
        for channel in 0..3 {
            let sum = f64::from(own[channel]) + f64::from(other[channel]);
            sums[channel] += sum.max(least_variance);
        }
    }
    sums.map(|sum| sum.sqrt() / picture.mean.pixels.len() as f64)
}

impl Difference {
    /// Whether all values are within the limits; NaN never is.
    pub(crate) fn is_within(&self, limits: &Limits) -> bool {
        self.mean <= limits.mean
            && self.mean_errors <= limits.mean_errors
            && self.blocks <= limits.blocks
            && self.accepted >= limits.accepted
    }
}

/// Compares a picture with its reference. If a limit is exceeded, writes pictures that show the
/// difference, and returns an error with their location.
pub(crate) fn check(
    trial: &str,
    [picture, reference]: [&Measured; 2],
    least_variance: f64,
    limits: &Limits,
) -> Result<Difference, String> {
    let (difference, p_values) = picture.compare(reference, least_variance)?;
    if difference.is_within(limits) {
        return Ok(difference);
    }
    let text = |error: etendue::image::ImageError| error.to_string();
    let error = relative_mse(&picture.mean, &reference.mean).map_err(text)?;
    let pictures = [
        ("_reference.png", Picture::from_color_image(&reference.mean)),
        ("_p-values.png", Picture::from_color_image(&p_values)),
        ("_difference.png", error.to_picture(error.quantile(0.99))),
    ];
    for (suffix, shown) in pictures {
        let bytes = encode(&shown, FileFormat::Png, &EncodeOptions::default()).map_err(text)?;
        std::fs::write(output(trial, suffix)?, bytes).map_err(|error| error.to_string())?;
    }
    Err(format!("{difference:.4?}; see {}", output(trial, "*")?.display()))
}
