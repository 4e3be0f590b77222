//! A finished picture with what is known about how it came to be.

use etendue_engine::{Channels, FilmSums, Statistics};
use etendue_image::{
    EncodeOptions, ExrPrecision, FileFormat, ImageError, MetadataValue, Picture, Window, encode,
};
use etendue_render::SensorSetup;
use etendue_render::film::PixelFormat;
use etendue_spectrum::colour;

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

/// What tells this rendering from others of the same camera.
pub(crate) struct Identity {
    pub(crate) scene_hash: [u8; 32],
    pub(crate) seed: u64,
    pub(crate) variance: bool,
}

impl Rendering {
    pub(crate) fn new(
        film: &FilmSums,
        statistics: Statistics,
        setup: &SensorSetup,
        identity: &Identity,
    ) -> Self {
        let format = setup.film.pixel_format;
        let channels = Channels { alpha: format.has_alpha(), variance: identity.variance };
        let mut picture = film.develop(channels);
        let has_layers = picture.channels.len() > 3 + usize::from(channels.alpha);
        if format.without_alpha() == PixelFormat::Luminance {
            to_luminance(&mut picture);
        }
        let (width, height) = (setup.film.width, setup.film.height);
        picture.display_window = Window { x: 0, y: 0, width, height };
        picture.metadata = metadata(&statistics, setup, identity);
        let encoding = EncodeOptions {
            exr_precision: precision(setup.film.component_format, &picture, HasLayers(has_layers)),
            tone_map: setup.film.display.tone_map,
            exposure: setup.film.display.exposure,
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
    map_color(picture, |rgb| [colour::luminance(rgb); 3]);
    picture.channels.drain(1..3);
    picture.channels[0].name = "Y".to_owned();
}

/// The picture in CIE XYZ.
fn to_xyz(picture: &mut Picture) {
    map_color(picture, colour::rgb_to_xyz);
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

fn metadata(
    statistics: &Statistics,
    setup: &SensorSetup,
    identity: &Identity,
) -> Vec<(String, MetadataValue)> {
    let text = |value: String| MetadataValue::Text(value);
    let hash: String = identity.scene_hash.iter().map(|byte| format!("{byte:02x}")).collect();
    let count = statistics.samples_per_pixel[0];
    // OpenEXR's matrices are for row vectors, and so the transposes of glam's: written column by
    // column they are right.
    let camera = setup.sensor.camera_matrices();
    let matrix = |matrix: glam::Mat4| MetadataValue::Matrix4(matrix.to_cols_array());
    let entries = [
        ("software", text(format!("Etendue {}", env!("CARGO_PKG_VERSION")))),
        ("sceneHash", text(hash)),
        // Header integers are 32 bits and signed, but seeds have 64.
        ("seed", text(identity.seed.to_string())),
        ("samplesPerPixel", MetadataValue::Integer(i32::try_from(count).unwrap_or(i32::MAX))),
        ("renderSeconds", MetadataValue::Float(statistics.duration.as_secs_f32())),
        ("worldToCamera", matrix(camera.world_to_camera)),
        ("worldToNDC", matrix(camera.world_to_ndc)),
    ];
    entries.map(|(name, value)| (name.to_owned(), value)).into()
}
