//! How sums become a picture: the settings of film and camera, without the sums.
//!
//! These settings are stored in checkpoints and parts, so that parts can be merged without the
//! scene.

use etendue_engine::{Camera, Region};
use etendue_image::{ExrPrecision, MetadataValue, ToneMap};
use etendue_scene::film::PixelFormat;

/// What is needed to develop sums into a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Development {
    pub(crate) pixel_format: PixelFormat,
    pub(crate) precision: ExrPrecision,
    pub(crate) tone_map: ToneMap,
    /// Exposure in stops.
    pub(crate) exposure: f32,
    /// Width and height of the whole film.
    pub(crate) film: [u32; 2],
    /// In hexadecimal.
    pub(crate) scene_hash: String,
    /// Empty if the host has not named the scene.
    pub(crate) scene_name: String,
    pub(crate) seed: u64,
    /// The limit of indirect light; infinite if there is none.
    pub(crate) clamp_indirect: f32,
    pub(crate) world_to_camera: [f32; 16],
    pub(crate) world_to_ndc: [f32; 16],
}

/// A value and its name in a file.
type Named<T> = (&'static str, T);

const PIXEL_FORMATS: [Named<PixelFormat>; 6] = [
    ("luminance", PixelFormat::Luminance),
    ("luminance_alpha", PixelFormat::LuminanceAlpha),
    ("rgb", PixelFormat::Rgb),
    ("rgba", PixelFormat::Rgba),
    ("xyz", PixelFormat::Xyz),
    ("xyza", PixelFormat::Xyza),
];

const PRECISIONS: [Named<ExrPrecision>; 2] =
    [("float16", ExrPrecision::Half), ("float32", ExrPrecision::Float)];

const TONE_MAPS: [Named<ToneMap>; 4] = [
    ("none", ToneMap::None),
    ("aces", ToneMap::Aces),
    ("agx", ToneMap::Agx),
    ("filmic", ToneMap::Filmic),
];

impl Development {
    pub(crate) fn new(camera: &Camera, scene_hash: &[u8; 32]) -> Self {
        let setup = camera.setup();
        let film = &setup.film;
        let matrices = setup.sensor.camera_matrices();
        // OpenEXR matrices act on row vectors, so they are the transposes of glam's; writing them
        // column by column gives the right order.
        Self {
            pixel_format: film.pixel_format,
            precision: film.component_format,
            tone_map: film.display.tone_map,
            exposure: film.display.exposure,
            film: [film.width, film.height],
            scene_hash: hexadecimal(scene_hash),
            scene_name: String::new(),
            seed: camera.sampler().seed(),
            clamp_indirect: camera.integrator().clamp_indirect().unwrap_or(f32::INFINITY),
            world_to_camera: matrices.world_to_camera.to_cols_array(),
            world_to_ndc: matrices.world_to_ndc.to_cols_array(),
        }
    }

    /// The settings as named strings.
    pub(crate) fn to_notes(&self) -> Vec<(String, String)> {
        let [width, height] = self.film;
        let notes = [
            ("pixel format", name_of(&PIXEL_FORMATS, self.pixel_format)),
            ("component format", name_of(&PRECISIONS, self.precision)),
            ("tone map", name_of(&TONE_MAPS, self.tone_map)),
            ("exposure", self.exposure.to_string()),
            ("film", format!("{width} {height}")),
            ("scene", self.scene_hash.clone()),
            (SCENE_NAME, self.scene_name.clone()),
            ("seed", self.seed.to_string()),
            ("clamp indirect", self.clamp_indirect.to_string()),
            ("world to camera", numbers(&self.world_to_camera)),
            ("world to NDC", numbers(&self.world_to_ndc)),
        ];
        notes.map(|(name, value)| (name.to_owned(), value)).into()
    }

    /// Reads what [`Self::to_notes`] wrote; `None` if a setting is missing or invalid.
    pub(crate) fn from_notes(notes: &[(String, String)]) -> Option<Self> {
        let note = |name: &str| {
            notes.iter().find(|(other, _)| other == name).map(|(_, value)| value.as_str())
        };
        let development = Self {
            pixel_format: named(&PIXEL_FORMATS, note("pixel format")?)?,
            precision: named(&PRECISIONS, note("component format")?)?,
            tone_map: named(&TONE_MAPS, note("tone map")?)?,
            exposure: note("exposure")?.parse().ok()?,
            film: parse(note("film")?)?,
            scene_hash: note("scene")?.to_owned(),
            scene_name: note(SCENE_NAME)?.to_owned(),
            seed: note("seed")?.parse().ok()?,
            clamp_indirect: note("clamp indirect")?.parse().ok()?,
            world_to_camera: parse(note("world to camera")?)?,
            world_to_ndc: parse(note("world to NDC")?)?,
        };
        development.is_valid().then_some(development)
    }

    /// Whether the settings can be those of a render; a file may hold anything.
    fn is_valid(&self) -> bool {
        let matrices = [&self.world_to_camera, &self.world_to_ndc];
        let is_side = |side: u32| (1..=i32::MAX.unsigned_abs()).contains(&side);
        self.exposure.is_finite()
            && matrices.into_iter().flatten().all(|value| value.is_finite())
            && self.film.into_iter().all(is_side)
            && self.scene_hash.len() <= 64
            && self.scene_hash.bytes().all(|byte| byte.is_ascii_hexdigit())
    }

    /// Whether these pixels lie within the film.
    pub(crate) fn contains(&self, region: Region) -> bool {
        let [width, height] = self.film;
        let fits = |start: u32, length: u32, side: u32| {
            start.checked_add(length).is_some_and(|end| end <= side)
        };
        fits(region.x, region.width, width) && fits(region.y, region.height, height)
    }

    /// The metadata of a picture with this many samples per pixel and this render time in seconds.
    pub(crate) fn metadata(
        &self,
        samples_per_pixel: u32,
        seconds: f64,
    ) -> Vec<(String, MetadataValue)> {
        let text = |value: String| MetadataValue::Text(value);
        let count = i32::try_from(samples_per_pixel).unwrap_or(i32::MAX);
        let mut entries = vec![
            ("software", text(format!("Etendue {}", env!("CARGO_PKG_VERSION")))),
            ("sceneHash", text(self.scene_hash.clone())),
            // Header integers are 32-bit signed, but seeds are 64-bit.
            ("seed", text(self.seed.to_string())),
            ("samplesPerPixel", MetadataValue::Integer(count)),
            ("renderSeconds", MetadataValue::Float(seconds as f32)),
            ("worldToCamera", MetadataValue::Matrix4(self.world_to_camera)),
            ("worldToNDC", MetadataValue::Matrix4(self.world_to_ndc)),
        ];
        if !self.scene_name.is_empty() {
            entries.push(("scene", text(self.scene_name.clone())));
        }
        if self.clamp_indirect.is_finite() {
            entries.push(("clampIndirect", MetadataValue::Float(self.clamp_indirect)));
        }
        entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// The note with the name of the scene.
const SCENE_NAME: &str = "scene name";

/// The name of the scene in the notes of a film, if it has one.
pub fn scene_name(notes: &[(String, String)]) -> Option<&str> {
    let found = notes.iter().find(|(name, _)| name == SCENE_NAME)?;
    Some(found.1.as_str()).filter(|name| !name.is_empty())
}

pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn name_of<T: PartialEq>(names: &[Named<T>], value: T) -> String {
    let found = names.iter().find(|(_, other)| *other == value);
    found.map_or_else(String::new, |(name, _)| (*name).to_owned())
}

fn named<T: Copy>(names: &[Named<T>], name: &str) -> Option<T> {
    names.iter().find(|(other, _)| *other == name).map(|(_, value)| *value)
}

/// Numbers written with full precision.
fn numbers(values: &[f32]) -> String {
    values.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

/// Exactly as many numbers as requested.
fn parse<T: std::str::FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let values: Option<Vec<T>> = text.split(' ').map(|value| value.parse().ok()).collect();
    values?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn development() -> Development {
        Development {
            pixel_format: PixelFormat::Xyza,
            precision: ExrPrecision::Half,
            tone_map: ToneMap::Agx,
            exposure: -0.1,
            film: [640, 360],
            scene_hash: hexadecimal(&[0xab; 32]),
            scene_name: "cups/scene.xml".to_owned(),
            seed: u64::MAX,
            clamp_indirect: 0.1,
            world_to_camera: std::array::from_fn(|i| 1.0 / (i as f32 + 3.0)),
            world_to_ndc: std::array::from_fn(|i| f32::MIN_POSITIVE * i as f32),
        }
    }

    #[test]
    fn notes_keep_every_bit() {
        let notes = development().to_notes();
        assert_eq!(Development::from_notes(&notes), Some(development()));
    }

    #[test]
    fn every_note_is_needed_and_must_make_sense() {
        let notes = development().to_notes();
        for index in 0..notes.len() {
            let mut fewer = notes.clone();
            fewer.remove(index);
            assert_eq!(Development::from_notes(&fewer), None, "without {}", notes[index].0);
        }
        let impossible =
            [(3, "inf"), (4, "640"), (4, "0 0"), (4, "4294967295 1"), (5, "\u{1b}[2J"), (7, "NaN")];
        for (place, value) in impossible {
            let mut wrong = notes.clone();
            wrong[place].1 = value.to_owned();
            assert_eq!(Development::from_notes(&wrong), None, "{value}");
        }
    }

    #[test]
    fn regions_lie_within_the_film_or_not() {
        let contains = |x, width| development().contains(Region { x, y: 0, width, height: 360 });
        assert!(contains(0, 640) && contains(639, 1));
        assert!(!contains(1, 640) && !contains(u32::MAX, 1));
    }
}
