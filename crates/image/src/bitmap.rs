//! Interleaved samples in the precision of a file.

use half::f16;

use crate::ColorImage;
use crate::numeric::multiply;
use crate::srgb::{srgb_to_linear, srgb_u8_to_linear};

/// The samples of a [`Bitmap`], in the precision of the file.
///
/// Integers are fractions of their maximum: 255 and 65535 stand for one.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// Eight bits.
    U8(Vec<u8>),
    /// Sixteen bits.
    U16(Vec<u16>),
    /// Half-precision floats.
    F16(Vec<f16>),
    /// Single-precision floats.
    F32(Vec<f32>),
}

impl Samples {
    /// The number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::F16(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Default for Samples {
    fn default() -> Self {
        Self::U8(Vec::new())
    }
}

/// An image as stored in its file: interleaved samples, the top row first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bitmap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// 1 for grey, 2 for grey and alpha, 3 for RGB, 4 for RGB and alpha.
    pub channels: u32,
    /// `width × height × channels` samples. The channels of a pixel are adjacent; row 0 is at the
    /// top.
    pub samples: Samples,
    /// Whether colour and grey are sRGB encoded (alpha never is). True for files with 8 or 16 bits;
    /// floating-point files are linear.
    pub srgb: bool,
    /// The matrix, row by row, that takes linear colours to the primaries of BT.709; `None` if they
    /// have these.
    pub to_bt709: Option<[[f32; 3]; 3]>,
    /// What the file says about its colours and is not followed, for people.
    pub warnings: Vec<String>,
}

impl Bitmap {
    /// Whether the last channel is alpha.
    pub fn has_alpha(&self) -> bool {
        self.channels == 2 || self.channels == 4
    }

    /// All samples as linear floats relative to the primaries of BT.709: integers are scaled to
    /// [0, 1], and sRGB is decoded if [`srgb`](Self::srgb) is set.
    pub fn to_linear(&self) -> Vec<f32> {
        let mut values = if self.srgb { self.decoded() } else { self.to_raw() };
        if let Some(matrix) = self.to_bt709.as_ref().filter(|_| self.channels >= 3) {
            for pixel in values.chunks_exact_mut(self.channels as usize) {
                let color = multiply(matrix, [pixel[0], pixel[1], pixel[2]]);
                pixel[..3].copy_from_slice(&color);
            }
        }
        values
    }

    /// The same image with the primaries of BT.709, as linear floats if they had to be converted.
    #[must_use]
    pub fn into_bt709(self) -> Self {
        if self.to_bt709.is_none() {
            return self;
        }
        let samples = Samples::F32(self.to_linear());
        Self { samples, srgb: false, to_bt709: None, ..self }
    }

    /// All samples as floats without decoding; integers are scaled to [0, 1]. For data such as
    /// normals and roughness.
    pub fn to_raw(&self) -> Vec<f32> {
        match &self.samples {
            Samples::U8(values) => values.iter().map(|&v| f32::from(v) / 255.0).collect(),
            Samples::U16(values) => values.iter().map(|&v| f32::from(v) / 65535.0).collect(),
            Samples::F16(values) => values.iter().map(|v| v.to_f32()).collect(),
            Samples::F32(values) => values.clone(),
        }
    }

    /// Linear RGB triples. Grey is repeated, alpha is dropped.
    pub fn to_color_image(&self) -> ColorImage {
        let linear = self.to_linear();
        let color = if self.channels < 3 { [0, 0, 0] } else { [0, 1, 2] };
        let pixels = linear
            .chunks_exact(self.channels.max(1) as usize)
            .map(|pixel| color.map(|channel| pixel[channel]))
            .collect();
        ColorImage { width: self.width, height: self.height, pixels }
    }

    /// The samples with sRGB decoded in every channel but alpha.
    fn decoded(&self) -> Vec<f32> {
        let channels = self.channels.max(1) as usize;
        let is_alpha = |index: usize| self.has_alpha() && index % channels == channels - 1;
        if let Samples::U8(values) = &self.samples {
            let decode = |(index, &value): (usize, &u8)| {
                if is_alpha(index) { f32::from(value) / 255.0 } else { srgb_u8_to_linear(value) }
            };
            return values.iter().enumerate().map(decode).collect();
        }
        let mut values = self.to_raw();
        for (index, value) in values.iter_mut().enumerate() {
            if !is_alpha(index) {
                *value = srgb_to_linear(*value);
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_is_never_srgb_decoded() {
        let samples = Samples::U8(vec![128, 128]);
        let bitmap =
            Bitmap { width: 1, height: 1, channels: 2, samples, srgb: true, ..Bitmap::default() };
        let linear = bitmap.to_linear();
        assert!((linear[0] - 0.215_860_5).abs() < 1e-6, "{linear:?}");
        assert_eq!(linear[1], 128.0 / 255.0);
    }

    #[test]
    fn precisions_agree_on_the_same_color() {
        let of = |samples| {
            let (width, height) = (1, 1);
            Bitmap { width, height, channels: 3, samples, srgb: true, ..Bitmap::default() }
        };
        let eight = of(Samples::U8(vec![0, 51, 255])).to_linear();
        let sixteen = of(Samples::U16(vec![0, 51 * 257, 65535])).to_linear();
        for (a, b) in eight.iter().zip(&sixteen) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }

    #[test]
    fn grey_becomes_equal_triples() {
        let samples = Samples::F32(vec![0.5, 0.1, 2.0, 0.2]);
        let bitmap = Bitmap { width: 2, height: 1, channels: 2, samples, ..Bitmap::default() };
        assert_eq!(bitmap.to_color_image().pixels, vec![[0.5; 3], [2.0; 3]]);
    }

    #[test]
    fn other_primaries_are_converted_and_alpha_is_not() {
        let swap = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        let samples = Samples::F32(vec![1.0, 2.0, 3.0, 0.5]);
        let to_bt709 = Some(swap);
        let bitmap =
            Bitmap { width: 1, height: 1, channels: 4, samples, to_bt709, ..Bitmap::default() };
        assert_eq!(bitmap.to_raw(), [1.0, 2.0, 3.0, 0.5]);
        assert_eq!(bitmap.to_linear(), [3.0, 2.0, 1.0, 0.5]);
        let converted = bitmap.into_bt709();
        assert_eq!(converted.to_raw(), [3.0, 2.0, 1.0, 0.5]);
        assert_eq!(converted.to_bt709, None);
    }
}
