//! A finished picture with what is known about how it came to be.

use etendue_engine::{Channels, FilmSums, Statistics};
use etendue_image::{EncodeOptions, ExrPrecision, FileFormat, ImageError, Picture, Window, encode};
use etendue_scene::film::PixelFormat;
use etendue_spectrum::color;

use crate::development::Development;

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The channels that the film asks for, then the integrator's layers, then variances; with
    /// metadata.
    ///
    /// Colours are linear Rec. 709 in `R`, `G`, `B`, or luminance in `Y`.
    pub picture: Picture,
    /// Whether OpenEXR files of it are to be in CIE XYZ instead.
    pub wants_xyz: bool,
    /// How the film says that files are written: numbers, exposure, tone mapping.
    pub encoding: EncodeOptions,
    /// What it took.
    pub statistics: Statistics,
}

impl Rendering {
    /// Makes a picture of sums; `seconds` is the wall time of all runs that made them.
    pub(crate) fn new(
        film: &FilmSums,
        statistics: Statistics,
        development: &Development,
        seconds: f64,
    ) -> Self {
        let format = development.pixel_format;
        let channels = Channels { alpha: format.has_alpha(), variance: film.has_variance() };
        let mut picture = film.develop(channels);
        let has_layers = picture.channels.len() > 3 + usize::from(channels.alpha);
        if format.without_alpha() == PixelFormat::Luminance {
            to_luminance(&mut picture);
        }
        let [width, height] = development.film;
        picture.display_window = Window { x: 0, y: 0, width, height };
        picture.metadata = development.metadata(statistics.samples_per_pixel.least, seconds);
        let encoding = EncodeOptions {
            exr_precision: precision(development.precision, &picture, HasLayers(has_layers)),
            tone_map: development.tone_map,
            exposure: development.exposure,
            ..EncodeOptions::default()
        };
        let wants_xyz = format.without_alpha() == PixelFormat::Xyz;
        Self { picture, wants_xyz, encoding, statistics }
    }

    /// The bytes of a picture file.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if the picture does not fit the format.
    pub fn encode(&self, format: FileFormat) -> Result<Vec<u8>, ImageError> {
        if self.wants_xyz && format == FileFormat::Exr {
            let mut picture = self.picture.clone();
            to_xyz(&mut picture);
            return encode(&picture, format, &self.encoding);
        }
        encode(&self.picture, format, &self.encoding)
    }
}

/// Whether there are channels beside the colour.
struct HasLayers(bool);

/// The greatest number of 16 bits: (2 − 2⁻¹⁰) · 2¹⁵.
const GREATEST_HALF: f32 = 65504.0;

/// Layers hold positions, distances, identifiers and variances, for which 16 bits are too coarse:
/// with them the whole file has 32. So it has with light beyond what 16 bits hold, such as the sun
/// seen in a mirror, which would be cut off without a word.
fn precision(asked: ExrPrecision, picture: &Picture, has_layers: HasLayers) -> ExrPrecision {
    let mut values = picture.channels.iter().flat_map(|channel| &channel.data);
    let is_beyond = values.any(|value| value.abs() > GREATEST_HALF);
    if has_layers.0 || is_beyond { ExrPrecision::Float } else { asked }
}

/// The picture in luminance: one channel instead of three.
fn to_luminance(picture: &mut Picture) {
    map_color(picture, |rgb| [color::luminance(rgb); 3]);
    picture.channels.drain(1..3);
    picture.channels[0].name = "Y".to_owned();
}

/// The picture in CIE XYZ.
fn to_xyz(picture: &mut Picture) {
    map_color(picture, color::rgb_to_xyz);
    for (channel, name) in picture.channels.iter_mut().zip(["X", "Y", "Z"]) {
        channel.name = name.to_owned();
    }
}

/// Maps the first three channels, which are red, green and blue.
fn map_color(picture: &mut Picture, map: impl Fn([f32; 3]) -> [f32; 3]) {
    let [red, green, blue, ..] = picture.channels.as_mut_slice() else {
        return;
    };
    for ((red, green), blue) in red.data.iter_mut().zip(&mut green.data).zip(&mut blue.data) {
        [*red, *green, *blue] = map([*red, *green, *blue]);
    }
}
