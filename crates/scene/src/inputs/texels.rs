//! The texels of a picture, stored at the precision of its file.

use etendue_image::srgb::{linear_of_srgb_u8, srgb_to_linear};
use etendue_image::{Bitmap, Samples};
use etendue_spectrum::Spectrum;
use std::sync::OnceLock;

/// A picture with one or three channels, stored at the precision of its file.
#[derive(Clone, Debug)]
pub(crate) struct Texels {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Row by row from the top, with interleaved channels.
    samples: Samples,
    is_grey: bool,
    /// The decoded value of each 8-bit code.
    narrow_codes: &'static [f32; 256],
    /// The decoded value of each 16-bit code; empty for other formats.
    wide_codes: Vec<f32>,
    /// See [`Texels::are_out_of_gamut`].
    are_out_of_gamut: bool,
    /// What the file says about its colours and is not followed; nothing for raw data.
    warnings: Vec<String>,
    /// See [`Texels::mean`]; computed on demand because it is rarely needed.
    mean: OnceLock<Spectrum>,
}

/// How a picture continues outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WrapMode {
    /// The picture repeats.
    #[default]
    Repeat,
    /// The picture repeats, mirrored every other time.
    Mirror,
    /// The outermost texels continue.
    Clamp,
}

/// The channel to extract from a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Red, or grey.
    Red,
    /// Green, or grey.
    Green,
    /// Blue, or grey.
    Blue,
    /// Alpha.
    Alpha,
}

/// The value of each 8-bit code without sRGB decoding.
static FRACTIONS: [f32; 256] = {
    let mut codes = [0.0; 256];
    let mut code = 0;
    while code < 256 {
        codes[code] = code as f32 / 255.0;
        code += 1;
    }
    codes
};

impl Texels {
    /// Takes the colours of a picture without alpha, or one channel. Samples are neither decoded nor
    /// converted to the primaries of BT.709 if `raw`. Returns `None` if the channel is missing or the picture has no texels.
    pub(crate) fn new(bitmap: Bitmap, channel: Option<Channel>, raw: bool) -> Option<Self> {
        let is_converted = !raw && bitmap.to_bt709.is_some();
        let mut bitmap = if raw { bitmap } else { bitmap.into_bt709() };
        let are_out_of_gamut = is_converted
            && matches!(&bitmap.samples, Samples::F32(values) if values.iter().any(|v| *v < 0.0));
        let warnings = if raw { Vec::new() } else { std::mem::take(&mut bitmap.warnings) };
        let stride = bitmap.channels as usize;
        let is_color = stride >= 3;
        let kept = match channel {
            None if is_color => 0..3,
            Some(Channel::Green) if is_color => 1..2,
            Some(Channel::Blue) if is_color => 2..3,
            Some(Channel::Alpha) if !bitmap.has_alpha() => return None,
            Some(Channel::Alpha) => stride - 1..stride,
            _ => 0..1,
        };
        let expected = u64::from(bitmap.width) * u64::from(bitmap.height) * stride as u64;
        if expected == 0 || bitmap.samples.len() as u64 != expected {
            return None;
        }
        let encoded = bitmap.srgb && !raw && channel != Some(Channel::Alpha);
        let wide_codes = match bitmap.samples {
            Samples::U16(_) => wide_codes(encoded),
            _ => Vec::new(),
        };
        Some(Self {
            width: bitmap.width,
            height: bitmap.height,
            is_grey: kept.len() == 1,
            samples: keep_channels(bitmap.samples, stride, kept),
            narrow_codes: if encoded { linear_of_srgb_u8() } else { &FRACTIONS },
            wide_codes,
            are_out_of_gamut,
            warnings,
            mean: OnceLock::new(),
        })
    }

    /// Whether the file holds floating-point numbers, which may not be finite.
    pub(crate) fn are_floats(&self) -> bool {
        matches!(self.samples, Samples::F16(_) | Samples::F32(_))
    }

    /// Whether colours of wider primaries became negative in those of BT.709.
    pub(crate) fn are_out_of_gamut(&self) -> bool {
        self.are_out_of_gamut
    }

    /// What the file says about its colours and is not followed.
    pub(crate) fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Whether there is only one channel.
    #[inline]
    pub(crate) fn is_grey(&self) -> bool {
        self.is_grey
    }

    /// The memory used by the texels, in bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        let sample = match self.samples {
            Samples::U8(_) => 1,
            Samples::U16(_) | Samples::F16(_) => 2,
            Samples::F32(_) => 4,
        };
        self.samples.len() * sample + size_of_val(self.wide_codes.as_slice())
    }

    /// The colours of the texels at these indices: row times width plus column.
    #[inline]
    pub(crate) fn colors<const N: usize>(&self, indices: [usize; N]) -> [Spectrum; N] {
        if self.is_grey {
            return self.scalars(indices).map(Spectrum::splat);
        }
        let narrow = self.narrow_codes;
        let wide = self.wide_codes.as_slice();
        match &self.samples {
            Samples::U8(samples) => triples(samples, indices, |code| narrow[usize::from(code)]),
            Samples::U16(samples) => triples(samples, indices, |code| wide[usize::from(code)]),
            Samples::F16(samples) => {
                triples(samples, indices, |value| half_to_float(value.to_bits()))
            }
            Samples::F32(samples) => triples(samples, indices, |value| value),
        }
    }

    /// The only channel of these texels, or the luminance of their colours.
    #[inline]
    pub(crate) fn scalars<const N: usize>(&self, indices: [usize; N]) -> [f32; N] {
        if !self.is_grey {
            return self.colors(indices).map(Spectrum::luminance);
        }
        match &self.samples {
            Samples::U8(samples) => indices.map(|i| self.narrow_codes[usize::from(samples[i])]),
            Samples::U16(samples) => indices.map(|i| self.wide_codes[usize::from(samples[i])]),
            Samples::F16(samples) => indices.map(|i| half_to_float(samples[i].to_bits())),
            Samples::F32(samples) => indices.map(|i| samples[i]),
        }
    }

    /// The mean colour.
    pub(crate) fn mean(&self) -> Spectrum {
        *self.mean.get_or_init(|| {
            let sums = match &self.samples {
                Samples::U8(samples) => self.code_sums(samples, self.narrow_codes),
                Samples::U16(samples) => self.code_sums(samples, &self.wide_codes),
                Samples::F16(_) | Samples::F32(_) => self.color_sums(),
            };
            let count = f64::from(self.width) * f64::from(self.height);
            Spectrum::from_rgb(sums.map(|sum| (sum / count) as f32))
        })
    }

    /// Sums all texels by channel, from the histogram of codes.
    fn code_sums<C: Copy + Into<usize>>(&self, samples: &[C], values: &[f32]) -> [f64; 3] {
        let channels = if self.is_grey { 1 } else { 3 };
        let mut counts = vec![[0_u64; 3]; values.len()];
        for texel in samples.chunks_exact(channels) {
            for (channel, &code) in texel.iter().enumerate() {
                counts[code.into()][channel] += 1;
            }
        }
        let mut sums = [0.0_f64; 3];
        for (counts, &value) in counts.iter().zip(values) {
            for (sum, &count) in sums.iter_mut().zip(counts) {
                *sum += count as f64 * f64::from(value);
            }
        }
        if self.is_grey { [sums[0]; 3] } else { sums }
    }

    /// Sums all texels by channel.
    fn color_sums(&self) -> [f64; 3] {
        let mut sum = [0.0_f64; 3];
        for index in 0..self.width as usize * self.height as usize {
            let [color] = self.colors([index]);
            let [red, green, blue] = color.rgb().map(f64::from);
            sum = [sum[0] + red, sum[1] + green, sum[2] + blue];
        }
        sum
    }
}

/// Reads three adjacent samples of each texel as a colour.
#[inline]
fn triples<S: Copy, const N: usize>(
    samples: &[S],
    indices: [usize; N],
    decode: impl Fn(S) -> f32,
) -> [Spectrum; N] {
    indices.map(|index| {
        let triple = &samples[3 * index..3 * index + 3];
        Spectrum::from_rgb([decode(triple[0]), decode(triple[1]), decode(triple[2])])
    })
}

/// The decoded values of all 16-bit codes. A table, because the sRGB curve is slow.
fn wide_codes(encoded: bool) -> Vec<f32> {
    let fractions = (0..=u16::MAX).map(|code| f32::from(code) / 65535.0);
    if encoded { fractions.map(srgb_to_linear).collect() } else { fractions.collect() }
}

/// Keeps only a range of adjacent channels.
fn keep_channels(samples: Samples, stride: usize, kept: std::ops::Range<usize>) -> Samples {
    fn keep<S: Copy>(samples: Vec<S>, stride: usize, kept: std::ops::Range<usize>) -> Vec<S> {
        if kept.len() == stride {
            return samples;
        }
        samples.chunks_exact(stride).flat_map(|texel| &texel[kept.clone()]).copied().collect()
    }
    match samples {
        Samples::U8(values) => Samples::U8(keep(values, stride, kept)),
        Samples::U16(values) => Samples::U16(keep(values, stride, kept)),
        Samples::F16(values) => Samples::F16(keep(values, stride, kept)),
        Samples::F32(values) => Samples::F32(keep(values, stride, kept)),
    }
}

/// Converts a half-precision float.
///
/// The `half` crate detects CPU features on each conversion, which took three quarters of a
/// look-up. This shifts the exponent into place and corrects its bias with a multiplication. The
/// result is exact, also for subnormal numbers.
#[inline]
fn half_to_float(bits: u16) -> f32 {
    /// 2¹¹²: the difference between the exponent biases, 127 and 15.
    const REBIAS: f32 = f32::from_bits((127 + 112) << 23);
    let magnitude = f32::from_bits(u32::from(bits & 0x7fff) << 13) * REBIAS;
    // The largest exponent encodes infinity and NaN in both formats.
    let magnitude = if bits & 0x7c00 == 0x7c00 {
        f32::from_bits(u32::from(bits & 0x7fff) << 13 | 0x7f80_0000)
    } else {
        magnitude
    };
    if bits & 0x8000 == 0 { magnitude } else { -magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_becomes_its_value() {
        for bits in 0..=u16::MAX {
            let found = half_to_float(bits);
            let (exponent, mantissa) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
            let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
            let expected = match exponent {
                0 => sign * mantissa * 2_f64.powi(-24),
                31 if mantissa == 0.0 => sign * f64::INFINITY,
                31 => f64::NAN,
                _ => sign * (1024.0 + mantissa) * 2_f64.powi(exponent - 25),
            };
            let same = f64::from(found) == expected || found.is_nan() && expected.is_nan();
            assert!(same, "{bits:#x}: {found}, not {expected}");
        }
    }
}
