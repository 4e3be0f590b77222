//! Films: the size of the image, its crop, its filter, and its file format.
//!
//! # Contract
//! - Pixels are counted from the left and from the top. The centre of the first pixel is (0.5,
//!   0.5).
//! - The [`CropWindow`] lies inside the film and is never empty. Sensors always see the whole film:
//!   a crop shows the same image as the whole film, cut out.

pub mod hdrfilm;
pub mod ldrfilm;

use crate::builder::Builder;
use crate::manual::{ParameterManual, parameter};
use crate::plugin::{Plugin, plugin};
use crate::rfilter::{self, ReconstructionFilter};
use etendue_document::{Fault, Parameters};
use etendue_image::{ExrPrecision, FileFormat, ToneMap};
use glam::UVec2;

/// Builds a film.
pub type BuildFilm = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<FilmSpec>;

/// The list of films, one line per plugin. All build a [`FilmSpec`].
pub static FILMS: &[Plugin<BuildFilm>] = &[
    plugin("hdrfilm", &hdrfilm::MANUAL, hdrfilm::build),
    plugin("ldrfilm", &ldrfilm::MANUAL, ldrfilm::build),
];

/// The most pixels along a side of a film. Positions in single precision get too coarse beyond.
const MAX_SIDE: i64 = 1 << 17;
/// The most pixels in a render: 16384².
const MAX_PIXELS: u64 = 1 << 28;

/// The settings of the image.
#[derive(Clone, Debug)]
pub struct FilmSpec {
    /// Width of the whole film in pixels.
    pub width: u32,
    /// Height of the whole film in pixels.
    pub height: u32,
    /// The part that is rendered.
    pub crop: CropWindow,
    /// The reconstruction filter.
    pub filter: ReconstructionFilter,
    /// The channels that are written.
    pub pixel_format: PixelFormat,
    /// The number format of an OpenEXR file.
    pub component_format: ExrPrecision,
    /// The file format.
    pub file_format: FileFormat,
    /// The tone mapping for files with a bounded range.
    pub display: Display,
}

/// A rectangle of pixels of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CropWindow {
    /// The leftmost column.
    pub x: u32,
    /// The topmost row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// The channels of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// Luminance.
    Luminance,
    /// Luminance and alpha.
    LuminanceAlpha,
    /// Linear Rec. 709.
    Rgb,
    /// Linear Rec. 709 and alpha.
    Rgba,
    /// CIE 1931.
    Xyz,
    /// CIE 1931 and alpha.
    Xyza,
}

/// Maps linear values to a display.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Exposure in stops: each stop doubles all values.
    pub exposure: f32,
    /// The curve that compresses the range after exposure.
    pub tone_map: ToneMap,
}

impl Default for FilmSpec {
    /// The film of a scene without one: the default `hdrfilm`.
    fn default() -> Self {
        Self::new(UVec2::new(DEFAULT_SIZE[0] as u32, DEFAULT_SIZE[1] as u32))
    }
}

impl FilmSpec {
    /// A whole film of at least one pixel, otherwise like the default `hdrfilm`.
    #[must_use]
    pub fn new(size: UVec2) -> Self {
        let size = size.max(UVec2::ONE);
        Self {
            width: size.x,
            height: size.y,
            crop: CropWindow { x: 0, y: 0, width: size.x, height: size.y },
            filter: ReconstructionFilter::default(),
            pixel_format: PixelFormat::Rgb,
            component_format: ExrPrecision::Half,
            file_format: FileFormat::Exr,
            display: Display::default(),
        }
    }

    /// Changes the size of the whole film. A crop scales with it, rounded outwards.
    ///
    /// # Errors
    /// If the film would be empty or larger than the limits allow. The film is then unchanged.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<(), String> {
        let scaled = |start: u32, length: u32, old: u32, new: u32| {
            let scale = |edge: u64| edge * u64::from(new);
            let low = scale(u64::from(start)) / u64::from(old);
            let high = scale(u64::from(start) + u64::from(length)).div_ceil(u64::from(old));
            // At most `new`, which fits into 32 bits.
            (low as u32, (high - low) as u32)
        };
        let [width, height] = size;
        let (x, crop_width) = scaled(self.crop.x, self.crop.width, self.width, width);
        let (y, crop_height) = scaled(self.crop.y, self.crop.height, self.height, height);
        let crop = CropWindow { x, y, width: crop_width, height: crop_height };
        check_size(size, crop).map_err(|(_, problem)| problem)?;
        (self.width, self.height, self.crop) = (width, height, crop);
        Ok(())
    }

    /// Changes the part that is rendered: x, y, width and height.
    ///
    /// # Errors
    /// If it is empty, not inside the film or larger than the limits allow. The film is then
    /// unchanged.
    pub fn set_crop(&mut self, [x, y, width, height]: [u32; 4]) -> Result<(), String> {
        let crop = CropWindow { x, y, width, height };
        check_size([self.width, self.height], crop).map_err(|(_, problem)| problem)?;
        self.crop = crop;
        Ok(())
    }

    /// Width over height of the whole film.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}

impl PixelFormat {
    /// Whether alpha is written.
    #[must_use]
    pub fn has_alpha(self) -> bool {
        matches!(self, Self::LuminanceAlpha | Self::Rgba | Self::Xyza)
    }

    /// The same format without alpha.
    #[must_use]
    pub fn without_alpha(self) -> Self {
        match self {
            Self::LuminanceAlpha => Self::Luminance,
            Self::Rgba => Self::Rgb,
            Self::Xyza => Self::Xyz,
            other => other,
        }
    }
}

/// The default width and height.
const DEFAULT_SIZE: [i64; 2] = [768, 576];

const WIDTH: ParameterManual = parameter("width", "integer", "768", "Width in pixels.");
const HEIGHT: ParameterManual = parameter("height", "integer", "576", "Height in pixels.");
const CROP_OFFSET_X: ParameterManual =
    parameter("crop_offset_x", "integer", "0", "The leftmost column that is rendered.");
const CROP_OFFSET_Y: ParameterManual =
    parameter("crop_offset_y", "integer", "0", "The topmost row that is rendered.");
const CROP_WIDTH: ParameterManual =
    parameter("crop_width", "integer", "", "How many columns are rendered; by default the rest.");
const CROP_HEIGHT: ParameterManual =
    parameter("crop_height", "integer", "", "How many rows are rendered; by default the rest.");
const SAMPLE_BORDER: ParameterManual = parameter(
    "sample_border",
    "boolean",
    "false",
    "Accepted and without effect: every pixel gets all the samples that its filter asks for, those \
     beyond the edge of the film included.",
);
const HIGH_QUALITY_EDGES: ParameterManual =
    parameter("high_quality_edges", "boolean", "false", "The old name of `sample_border`.");
const BANNER: ParameterManual =
    parameter("banner", "boolean", "true", "Accepted and without effect: no banner is drawn.");
const FILTER: ParameterManual =
    parameter("(nested)", "rfilter", "gaussian", "The reconstruction filter.");

/// Reads the settings that all films have.
fn read_common(parameters: &Parameters<'_>) -> Option<FilmSpec> {
    for without_effect in ["sample_border", "high_quality_edges", "banner"] {
        parameters.optional_boolean(without_effect);
    }
    let filter = rfilter::build_child(parameters);
    let width = read_side(parameters, "width", DEFAULT_SIZE[0]);
    let height = read_side(parameters, "height", DEFAULT_SIZE[1]);
    let (width, height) = (width?, height?);
    let columns = read_crop(parameters, ["crop_offset_x", "crop_width"], width);
    let rows = read_crop(parameters, ["crop_offset_y", "crop_height"], height);
    let ((x, crop_width), (y, crop_height)) = (columns?, rows?);
    let crop = CropWindow { x, y, width: crop_width, height: crop_height };
    if let Err((fault, problem)) = check_size([width, height], crop) {
        parameters.error(fault, "width", problem);
        return None;
    }
    Some(FilmSpec { crop, filter: filter?, ..FilmSpec::new(UVec2::new(width, height)) })
}

/// Reads the width or the height.
fn read_side(parameters: &Parameters<'_>, name: &str, default: i64) -> Option<u32> {
    let side = parameters.integer(name, default);
    let checked = check_side(name, side);
    if let Err((fault, problem)) = &checked {
        parameters.error(*fault, name, problem.clone());
    }
    checked.ok()
}

/// Whether a film may have this width or height.
fn check_side(name: &str, side: i64) -> Result<u32, (Fault, String)> {
    if side > MAX_SIDE {
        let problem = format!("a {name} of {side} pixels is more than the limit of {MAX_SIDE}");
        return Err((Fault::Limit, problem));
    }
    if side < 1 {
        let problem = format!("`{name}` is {side}, but a film needs at least one pixel");
        return Err((Fault::BadValue, problem));
    }
    // Positive and below 2¹⁷.
    Ok(side as u32)
}

/// Whether a film may have this size and crop.
fn check_size([width, height]: [u32; 2], crop: CropWindow) -> Result<(), (Fault, String)> {
    check_side("width", i64::from(width))?;
    check_side("height", i64::from(height))?;
    let fits = |start: u32, length: u32, side: u32| {
        length > 0 && start.checked_add(length).is_some_and(|end| end <= side)
    };
    if !fits(crop.x, crop.width, width) || !fits(crop.y, crop.height, height) {
        let CropWindow { x, y, width: columns, height: rows } = crop;
        let problem = format!(
            "a crop of {columns}x{rows} pixels from ({x}, {y}) does not fit a film of {width}x{height}"
        );
        return Err((Fault::BadValue, problem));
    }
    let pixels = u64::from(crop.width) * u64::from(crop.height);
    if pixels > MAX_PIXELS {
        let problem = format!("{pixels} pixels are more than the limit of {MAX_PIXELS}");
        return Err((Fault::Limit, problem));
    }
    Ok(())
}

/// Reads the start and size of the crop along one axis of a film with `side` pixels.
fn read_crop(parameters: &Parameters<'_>, names: [&str; 2], side: u32) -> Option<(u32, u32)> {
    let [offset_name, size_name] = names;
    let offset = parameters.integer(offset_name, 0);
    let Some(rest) = u32::try_from(offset).ok().and_then(|offset| side.checked_sub(offset)) else {
        let message = format!("`{offset_name}` is {offset}, outside the film's {side} pixels");
        parameters.error(Fault::BadValue, offset_name, message);
        return None;
    };
    let size = parameters.integer(size_name, i64::from(rest));
    if !(1..=i64::from(rest)).contains(&size) {
        let name = if parameters.has(size_name) { size_name } else { offset_name };
        let message =
            format!("a crop of {size} pixels from {offset} does not fit a film of {side}");
        parameters.error(Fault::BadValue, name, message);
        return None;
    }
    Some((side - rest, u32::try_from(size).ok()?))
}

/// [`Parameters::choice`] without regard to case.
fn keyword<T: Copy>(
    parameters: &Parameters<'_>,
    name: &str,
    default: T,
    choices: &[(&str, T)],
) -> T {
    let typed = parameters.optional_string(name);
    let found = choices
        .iter()
        .find(|(choice, _)| typed.is_some_and(|typed| typed.eq_ignore_ascii_case(choice)));
    found.map_or_else(|| parameters.choice(name, default, choices), |(_, chosen)| *chosen)
}

#[cfg(test)]
mod tests {
    use super::hdrfilm::build;
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::{Class, Value};

    fn node() -> TestNode {
        TestNode::new(Class::Film, "hdrfilm")
    }

    /// The faults of building an invalid film.
    fn faults(node: &TestNode) -> Vec<Fault> {
        assert!(node.build(build).is_none(), "{:?}", node.findings());
        node.findings().iter().map(|found| found.fault).collect()
    }

    #[test]
    fn the_defaults_are_those_of_mitsuba() {
        let film = node().build_cleanly(build);
        assert_eq!((film.width, film.height), (768, 576));
        assert_eq!(film.crop, CropWindow { x: 0, y: 0, width: 768, height: 576 });
        assert_eq!(film.filter.radius(), 2.0, "the Gaussian's");
        assert_eq!(film.pixel_format, PixelFormat::Rgb);
        assert_eq!(film.component_format, ExrPrecision::Half);
        assert_eq!(film.file_format, FileFormat::Exr);
        assert_eq!(film.display, Display::default());
    }

    #[test]
    fn a_crop_lies_inside_the_film() {
        let film = node().integer("width", 100).integer("height", 80);
        let film = film.integer("crop_offset_x", 10).integer("crop_width", 30);
        let film = film.integer("crop_offset_y", 79).build_cleanly(build);
        assert_eq!(film.crop, CropWindow { x: 10, y: 79, width: 30, height: 1 });
        assert_eq!(film.aspect(), 1.25, "a crop does not change the whole");
    }

    #[test]
    fn the_filter_is_a_child_of_any_name() {
        let film = node().child(Class::ReconstructionFilter, "box").build_cleanly(build);
        assert_eq!(film.filter.radius(), 0.5);
        let unknown = node().child(Class::ReconstructionFilter, "bax");
        assert_eq!(faults(&unknown), [Fault::UnknownPlugin]);
    }

    #[test]
    fn sizes_beyond_the_limits_are_refused_as_such() {
        assert_eq!(faults(&node().integer("width", 2_000_000_000)), [Fault::Limit]);
        assert_eq!(faults(&node().integer("height", i64::MAX)), [Fault::Limit]);
        let large = || node().integer("width", 100_000).integer("height", 100_000);
        assert_eq!(faults(&large()), [Fault::Limit]);
        let tile = large().integer("crop_offset_x", 50_000).integer("crop_width", 64);
        assert_eq!(tile.build_cleanly(build).crop.width, 64, "a tile of it is no trouble");
    }

    #[test]
    fn empty_films_and_crops_outside_are_bad_values() {
        let cases: [&[(&str, i64)]; 9] = [
            &[("width", 0)],
            &[("width", -3)],
            &[("height", i64::MIN)],
            &[("crop_width", 0)],
            &[("crop_width", 769)],
            &[("crop_height", -1)],
            &[("crop_offset_x", -1)],
            &[("crop_offset_y", 576)],
            &[("crop_offset_x", 700), ("crop_width", i64::MAX)],
        ];
        for case in cases {
            let node = case.iter().fold(node(), |node, (name, value)| node.integer(name, *value));
            assert_eq!(faults(&node), [Fault::BadValue], "{case:?}");
        }
    }

    #[test]
    fn names_may_be_written_in_capitals_and_wrong_ones_are_listed() {
        let film = node().string("pixel_format", "RGBA").build_cleanly(build);
        assert_eq!(film.pixel_format, PixelFormat::Rgba);
        let wrong = node().string("pixel_format", "rbg");
        wrong.build(build);
        let finding = &wrong.findings()[0];
        assert_eq!(finding.fault, Fault::BadValue);
        assert!(finding.help.iter().any(|line| line.contains("luminance")), "{finding:?}");
    }

    #[test]
    fn both_films_take_what_a_film_takes() {
        for build in [hdrfilm::build, ldrfilm::build] {
            let node = node()
                .integer("width", 3)
                .with("banner", Value::Boolean(false))
                .with("high_quality_edges", Value::Boolean(true));
            assert_eq!(node.build_cleanly(build).width, 3);
        }
    }

    #[test]
    fn a_resized_film_shows_the_same_part() {
        let mut film = FilmSpec::new(UVec2::new(100, 50));
        assert_eq!(film.set_crop([10, 5, 31, 45]), Ok(()));
        assert_eq!(film.resize([200, 25]), Ok(()));
        assert_eq!(film.crop, CropWindow { x: 20, y: 2, width: 62, height: 23 });
        let before = (film.width, film.height, film.crop);
        for bad in [[0, 10], [10, 0], [u32::MAX, 1], [100_000, 100_000]] {
            assert!(film.resize(bad).is_err(), "{bad:?}");
        }
        for bad in [[0, 0, 0, 1], [200, 0, 1, 1], [199, 0, 2, 1], [1, 0, u32::MAX, 1]] {
            assert!(film.set_crop(bad).is_err(), "{bad:?}");
        }
        assert_eq!((film.width, film.height, film.crop), before);
    }
}
