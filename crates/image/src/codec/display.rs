//! Converts linear channels to the integers of a display format: exposure, tone mapping, sRGB.

use image::{DynamicImage, ImageBuffer, Luma, LumaA, Rgb, Rgba};
use rayon::prelude::*;

use super::options::{BitDepth, EncodeOptions};
use crate::srgb::{linear_to_srgb, linear_to_srgb_u8};
use crate::{ImageError, MainLayer, Picture, ToneMap, exposure_scale};

/// Pictures with fewer pixels are converted on one thread, which takes less time than waking the
/// others.
const PARALLEL_PIXELS: usize = 1 << 17;

/// The treatment of alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AlphaMode {
    /// Alpha is kept, and premultiplied colours are divided by it.
    Straight,
    /// Alpha is dropped. Colours stay premultiplied, which shows them over black.
    Dropped,
}

/// An integer that a display format stores.
trait DisplaySample: Copy + Default + Send + Sync {
    /// Encodes a linear colour.
    fn from_linear(linear: f32) -> Self;
    /// Scales alpha, which is never sRGB encoded.
    fn from_alpha(alpha: f32) -> Self;
}

impl DisplaySample for u8 {
    fn from_linear(linear: f32) -> Self {
        linear_to_srgb_u8(linear)
    }

    fn from_alpha(alpha: f32) -> Self {
        // The conversion saturates, and NaN becomes zero.
        (alpha * 255.0 + 0.5) as Self
    }
}

impl DisplaySample for u16 {
    fn from_linear(linear: f32) -> Self {
        (linear_to_srgb(linear) * 65535.0 + 0.5) as Self
    }

    fn from_alpha(alpha: f32) -> Self {
        (alpha * 65535.0 + 0.5) as Self
    }
}

/// Converts the main layer to integers of the chosen depth. JPEG and BMP, which only have eight
/// bits, drop alpha.
pub(super) fn display_image(
    picture: &Picture,
    options: &EncodeOptions,
    alpha_mode: AlphaMode,
) -> Result<DynamicImage, ImageError> {
    let mut main = picture.require_main_layer()?;
    if alpha_mode == AlphaMode::Dropped {
        main.alpha = None;
    }
    let depth = if alpha_mode == AlphaMode::Dropped { BitDepth::Eight } else { options.bit_depth };
    let source = Source { picture, main, scale: exposure_scale(options.exposure) };
    let image = match depth {
        BitDepth::Eight => {
            let samples = source.convert::<u8>(options.tone_map);
            assemble_u8(picture, &main, samples)
        }
        BitDepth::Sixteen => {
            let samples = source.convert::<u16>(options.tone_map);
            assemble_u16(picture, &main, samples)
        }
    };
    image.ok_or_else(|| ImageError::invalid_picture("its channels have too few values"))
}

/// The channels to convert, and the exposure factor.
struct Source<'a> {
    picture: &'a Picture,
    main: MainLayer,
    scale: f32,
}

impl Source<'_> {
    /// The number of samples per pixel: grey or RGB, and alpha.
    fn samples_per_pixel(&self) -> usize {
        let color = if self.main.is_grey { 1 } else { 3 };
        color + usize::from(self.main.alpha.is_some())
    }

    /// Interleaved samples of all pixels.
    fn convert<T: DisplaySample>(&self, tone_map: ToneMap) -> Vec<T> {
        let pixel_count = self.picture.width as usize * self.picture.height as usize;
        let row_samples = self.picture.width as usize * self.samples_per_pixel();
        let mut samples = vec![T::default(); pixel_count * self.samples_per_pixel()];
        let convert_row = |(row, target): (usize, &mut [T])| {
            self.convert_row(row * self.picture.width as usize, target, tone_map);
        };
        if pixel_count < PARALLEL_PIXELS {
            samples.chunks_mut(row_samples).enumerate().for_each(convert_row);
        } else {
            samples.par_chunks_mut(row_samples).enumerate().for_each(convert_row);
        }
        samples
    }

    /// Converts one row; `start` is the index of its first pixel.
    fn convert_row<T: DisplaySample>(&self, start: usize, target: &mut [T], tone_map: ToneMap) {
        let data = |index: usize| &self.picture.channels[index].data[start..];
        let color = self.main.color.map(data);
        let alpha = self.main.alpha.map(data);
        let pixels = target.chunks_exact_mut(self.samples_per_pixel());
        for (index, pixel) in pixels.enumerate() {
            let coverage = alpha.map_or(1.0, |alpha| alpha[index]);
            let is_divided = coverage > 0.0 && !self.picture.straight_alpha;
            let divided = if is_divided { self.scale / coverage } else { self.scale };
            let linear = tone_map.apply(color.map(|channel| channel[index] * divided));
            let color_count = if self.main.is_grey { 1 } else { 3 };
            for (sample, &value) in pixel.iter_mut().zip(&linear[..color_count]) {
                *sample = T::from_linear(value);
            }
            if alpha.is_some() {
                pixel[color_count] = T::from_alpha(coverage);
            }
        }
    }
}

/// Wraps 8-bit samples for the encoders. `None` if there are too few.
fn assemble_u8(picture: &Picture, main: &MainLayer, samples: Vec<u8>) -> Option<DynamicImage> {
    let (width, height) = (picture.width, picture.height);
    Some(match (main.is_grey, main.alpha.is_some()) {
        (true, false) => ImageBuffer::<Luma<u8>, _>::from_raw(width, height, samples)?.into(),
        (true, true) => ImageBuffer::<LumaA<u8>, _>::from_raw(width, height, samples)?.into(),
        (false, false) => ImageBuffer::<Rgb<u8>, _>::from_raw(width, height, samples)?.into(),
        (false, true) => ImageBuffer::<Rgba<u8>, _>::from_raw(width, height, samples)?.into(),
    })
}

/// Wraps 16-bit samples for the encoders. `None` if there are too few.
fn assemble_u16(picture: &Picture, main: &MainLayer, samples: Vec<u16>) -> Option<DynamicImage> {
    let (width, height) = (picture.width, picture.height);
    Some(match (main.is_grey, main.alpha.is_some()) {
        (true, false) => ImageBuffer::<Luma<u16>, _>::from_raw(width, height, samples)?.into(),
        (true, true) => ImageBuffer::<LumaA<u16>, _>::from_raw(width, height, samples)?.into(),
        (false, false) => ImageBuffer::<Rgb<u16>, _>::from_raw(width, height, samples)?.into(),
        (false, true) => ImageBuffer::<Rgba<u16>, _>::from_raw(width, height, samples)?.into(),
    })
}
