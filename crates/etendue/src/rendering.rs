//! A finished picture with its metadata and statistics.

use etendue_engine::{Channels, FilmSums, Statistics};
use etendue_image::{EncodeOptions, ExrPrecision, FileFormat, ImageError, Picture, Window, encode};
use etendue_scene::film::PixelFormat;
use etendue_spectrum::color;

use crate::development::Development;

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The channels requested by the film, then the integrator's, then variances; with metadata.
    ///
    /// Colours are linear Rec. 709 in `R`, `G`, `B`, or luminance in `Y`.
    pub picture: Picture,
    /// Whether OpenEXR files of it are written in CIE XYZ instead.
    pub wants_xyz: bool,
    /// The film's output settings: number format, exposure, tone mapping.
    pub encoding: EncodeOptions,
    /// The render statistics.
    pub statistics: Statistics,
    /// How many values single precision cannot hold: they are written as its greatest.
    pub clamped_values: usize,
}

impl Rendering {
    /// Develops sums into a picture; `seconds` is the wall time of all runs that contributed.
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
        let values = picture.channels.iter().flat_map(|channel| &channel.data);
        let clamped_values = values.filter(|value| value.abs() == f32::MAX).count();
        Self { picture, wants_xyz, encoding, statistics, clamped_values }
    }

    /// Encodes the picture as a file.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if the format cannot hold the picture.
    pub fn encode(&self, format: FileFormat) -> Result<Vec<u8>, ImageError> {
        if self.wants_xyz && format == FileFormat::Exr {
            let mut picture = self.picture.clone();
            to_xyz(&mut picture);
            return encode(&picture, format, &self.encoding);
        }
        encode(&self.picture, format, &self.encoding)
    }
}

/// Whether there are channels besides colour.
struct HasLayers(bool);

/// The largest half float: (2 − 2⁻¹⁰) · 2¹⁵.
const GREATEST_HALF: f32 = 65504.0;

/// Half floats are too coarse for positions, distances, identifiers and variances: with such
/// channels the whole file uses 32 bits. It also does if the light exceeds the half float range,
/// such as the sun in a mirror, which would otherwise be clipped silently.
fn precision(asked: ExrPrecision, picture: &Picture, has_layers: HasLayers) -> ExrPrecision {
    let mut values = picture.channels.iter().flat_map(|channel| &channel.data);
    let is_beyond = values.any(|value| value.abs() > GREATEST_HALF);
    if has_layers.0 || is_beyond { ExrPrecision::Float } else { asked }
}

/// Converts the picture to luminance: one channel instead of three.
fn to_luminance(picture: &mut Picture) {
    map_color(picture, |rgb| [color::luminance(rgb); 3]);
    picture.channels.drain(1..3);
    picture.channels[0].name = "Y".to_owned();
}

/// Converts the picture to CIE XYZ.
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
