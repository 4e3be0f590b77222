//! `bitmap`: a picture from a file or from memory.

use super::{TextureModel, Textures};
use crate::builder::{Assets, Builder};
use crate::inputs::picture_in_memory;
use crate::inputs::texels::Texels;
pub use crate::inputs::texels::{Channel, WrapMode};
use crate::inputs::uv::read_to_uv;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_image::Bitmap;
use etendue_spectrum::Spectrum;
use glam::{Affine2, Vec2};
use std::path::PathBuf;
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A picture from a file: PNG, JPEG, BMP, TGA, TIFF, WebP, QOI, Radiance HDR, OpenEXR, \
              PFM or NumPy. Files with 8 or 16 bits are taken to be sRGB encoded unless `raw`; \
              colours of other primaries, as OpenEXR and PNG files may declare, become those of \
              Rec. 709 unless `raw`; alpha is left out; grey pictures give grey colours.",
    parameters: &[
        parameter("filename", "string", "", "The file; required unless there is `data`."),
        parameter(
            "data",
            "buffer",
            "",
            "Instead of a file: rows, columns and up to four channels, of floats (linear), or of \
             unsigned integers with 8 or 16 bits (as in files). For scenes built in code.",
        ),
        parameter(
            "filter_type",
            "string",
            "bilinear",
            "`bilinear`, between the centres of texels, or `nearest`, which shows texels as squares.",
        ),
        parameter(
            "wrap_mode",
            "string",
            "repeat",
            "What lies outside the unit square: `repeat`, `mirror` (every other copy reversed) or \
             `clamp` (the texels of the edge).",
        ),
        parameter(
            "raw",
            "boolean",
            "false",
            "Take the numbers as they are, without sRGB decoding and in their own primaries: for \
             normals, roughness and the like.",
        ),
        parameter("to_uv", "transform", "", "Applied to texture coordinates; a scale repeats."),
        parameter(
            "channel",
            "string",
            "all",
            "Use one channel as a scalar: `r`, `g`, `b` or `a`. From Mitsuba 0.6.",
        ),
        parameter(
            "format",
            "string",
            "auto",
            "Accepted and without effect (`auto`, `variant` or `fp16`): the file's precision is kept.",
        ),
        parameter("accel", "boolean", "true", "Accepted and without effect."),
    ],
    sample: r#"<texture type="bitmap">
    <string name="filename" value="wood.png"/>
    <string name="wrap_mode" value="mirror"/>
</texture>"#,
};

/// How values between texel centres are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterMode {
    /// Bilinear interpolation.
    #[default]
    Bilinear,
    /// The value of the nearest texel.
    Nearest,
}

/// Options for reading a picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct BitmapOptions {
    /// How to filter between texel centres.
    pub filter: FilterMode,
    /// How to continue outside the unit square.
    pub wrap: WrapMode,
    /// Whether values are used as they are, without sRGB decoding.
    pub raw: bool,
    /// The channel to use instead of the colours.
    pub channel: Option<Channel>,
    /// Applied to texture coordinates.
    pub to_uv: Affine2,
}

/// A picture over the unit square: (0, 0) is the upper left corner of the first texel, and v runs
/// down.
#[derive(Clone, Debug)]
pub struct BitmapTexture {
    /// Shared by all textures that use the same channels of a file.
    texels: Arc<Texels>,
    filter: FilterMode,
    wrap: WrapMode,
    to_uv: Affine2,
}

/// Reads the texture.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<BitmapTexture> {
    load(builder.assets, std::slice::from_ref(parameters)).pop().flatten()
}

/// Reads textures that name the same file, which is decoded once. Depends on files only, so calls
/// can run in parallel.
#[must_use]
pub fn load<'a>(assets: &Assets<'_>, all: &[Parameters<'a>]) -> Vec<Option<BitmapTexture>> {
    if let [only] = all
        && only.has("data")
    {
        return vec![in_memory(only)];
    }
    let options: Vec<_> = all.iter().map(BitmapOptions::read).collect();
    let mut selections = Vec::new();
    for selection in options.iter().flatten().map(BitmapOptions::selection) {
        if !selections.contains(&selection) {
            selections.push(selection);
        }
    }
    let Some((path, taken)) = read_selections(assets, all, selections) else {
        return vec![None; all.len()];
    };
    let texture = |(parameters, options): (&Parameters<'_>, Option<BitmapOptions>)| {
        let options = options?;
        let (_, texels) = taken.iter().find(|(selection, _)| *selection == options.selection())?;
        let Some(texels) = texels else {
            let message = format!("{} has no such channel", path.display());
            parameters.error(Fault::BadValue, "channel", message);
            return None;
        };
        for warning in texels.warnings() {
            let message = format!("{}: {warning}", path.display());
            parameters.warning(Fault::Unsupported, "filename", message);
        }
        // NaN or infinity propagates into the sum.
        if texels.are_floats() && !texels.mean().is_finite() {
            let message = format!("{} holds values that are not finite", path.display());
            parameters.warning(Fault::BadValue, "filename", message);
        }
        Some(BitmapTexture::of(texels.clone(), &options))
    };
    all.iter().zip(options).map(texture).collect()
}

/// Reads a texture from a buffer.
fn in_memory(parameters: &Parameters<'_>) -> Option<BitmapTexture> {
    let options = BitmapOptions::read(parameters);
    let bitmap = picture_in_memory::read(parameters)?;
    let texture = BitmapTexture::new(bitmap, &options?);
    if texture.is_none() {
        parameters.error(Fault::BadValue, "channel", "`data` has no such channel");
    }
    if texture.as_ref().is_some_and(|t| t.texels.are_floats() && !t.mean().is_finite()) {
        parameters.warning(Fault::BadValue, "data", "`data` holds values that are not finite");
    }
    texture
}

/// What a texture uses of a picture: the channel, and whether values are not decoded.
type Selection = (Option<Channel>, bool);

/// The texels of a picture for each selection; `None` if there is no such channel.
type Selected = Vec<(Selection, Option<Arc<Texels>>)>;

/// Reads the picture that the textures name, with its path. Returns `None` after reporting an
/// error.
fn read_selections(
    assets: &Assets<'_>,
    all: &[Parameters<'_>],
    selections: Vec<Selection>,
) -> Option<(PathBuf, Selected)> {
    let names: Vec<_> = all
        .iter()
        .filter_map(|parameters| {
            Some((parameters.required_string("filename")?, parameters.span_of("filename")))
        })
        .collect();
    let kept = |(name, span): &(&str, _)| {
        let path = assets.find_kept_file(name, *span)?;
        let texels = |selection: &Selection| {
            let texels = assets.kept_of_file(&path, &way(*selection))?;
            Some((*selection, Some(texels)))
        };
        let taken = selections.iter().map(texels).collect::<Option<Selected>>()?;
        Some((path, taken))
    };
    if !selections.is_empty()
        && let Some(kept) = names.first().and_then(kept)
    {
        return Some(kept);
    }
    // If the file is missing, report it for each texture.
    let file = names.into_iter().find_map(|(name, span)| assets.read_named_file(name, span));
    let (path, bytes) = file?;
    // Texels are kept as they are decoded.
    let bitmap = assets.decode_picture((&path, &bytes), 0);
    drop(bytes);
    let bitmap = match bitmap {
        Ok(bitmap) => bitmap,
        Err((fault, message)) => {
            for parameters in all {
                parameters.error(fault, "filename", message.as_str());
            }
            return None;
        }
    };
    let taken = take(bitmap, selections);
    for (selection, texels) in &taken {
        if let Some(texels) = texels {
            assets.keep_of_file(&path, &way(*selection), texels);
        }
    }
    Some((path, taken))
}

/// The cache key of a selection.
fn way(selection: Selection) -> String {
    format!("{selection:?}")
}

fn take(bitmap: Bitmap, selections: Vec<Selection>) -> Selected {
    // There is usually only one, which needs no copy.
    let mut copies = vec![bitmap];
    while copies.len() < selections.len() {
        copies.push(copies[0].clone());
    }
    let texels = |(selection, bitmap): (Selection, _)| {
        let (channel, raw) = selection;
        (selection, Texels::new(bitmap, channel, raw).map(Arc::new))
    };
    selections.into_iter().zip(copies).map(texels).collect()
}

impl BitmapOptions {
    fn selection(&self) -> Selection {
        (self.channel, self.raw)
    }

    /// Reads everything but the file. Returns `None` after reporting an error.
    fn read(parameters: &Parameters<'_>) -> Option<Self> {
        const FILTERS: [(&str, FilterMode); 2] =
            [("bilinear", FilterMode::Bilinear), ("nearest", FilterMode::Nearest)];
        const WRAPS: [(&str, WrapMode); 3] = [
            ("repeat", WrapMode::Repeat),
            ("mirror", WrapMode::Mirror),
            ("clamp", WrapMode::Clamp),
        ];
        const CHANNELS: [(&str, Option<Channel>); 5] = [
            ("all", None),
            ("r", Some(Channel::Red)),
            ("g", Some(Channel::Green)),
            ("b", Some(Channel::Blue)),
            ("a", Some(Channel::Alpha)),
        ];
        parameters.choice("format", (), &[("auto", ()), ("variant", ()), ("fp16", ())]);
        parameters.optional_boolean("accel");
        Some(Self {
            filter: parameters.choice("filter_type", FilterMode::Bilinear, &FILTERS),
            wrap: parameters.choice("wrap_mode", WrapMode::Repeat, &WRAPS),
            raw: parameters.boolean("raw", false),
            channel: parameters.choice("channel", None, &CHANNELS),
            to_uv: read_to_uv(parameters)?,
        })
    }
}

/// The two texels on either side of a coordinate.
#[derive(Clone, Copy)]
struct Neighbours {
    low: usize,
    high: usize,
    /// The weight of the higher texel.
    fraction: f32,
    /// −1 where the picture is mirrored, otherwise 1.
    sign: f32,
}

/// Four adjacent texels and their weights.
struct Footprint {
    /// Upper left, upper right, lower left, lower right.
    indices: [usize; 4],
    fraction: Vec2,
    /// Texels per unit of u and v, negative where the picture is mirrored.
    scale: Vec2,
}

impl TextureModel for BitmapTexture {
    fn eval(&self, _textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        self.eval(surface.uv)
    }

    fn eval_scalar(&self, _textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        self.eval_scalar(surface.uv)
    }

    fn gradient(&self, _textures: Textures<'_>, surface: &SurfaceInteraction) -> Vec2 {
        self.gradient(surface.uv)
    }

    fn mean(&self, _textures: Textures<'_>) -> Spectrum {
        self.mean()
    }

    fn texels(&self) -> Option<&Arc<Texels>> {
        Some(&self.texels)
    }
}

impl BitmapTexture {
    /// Takes a picture. Returns `None` if it lacks the requested channel or has no texels.
    #[must_use]
    pub fn new(bitmap: Bitmap, options: &BitmapOptions) -> Option<Self> {
        let texels = Texels::new(bitmap, options.channel, options.raw)?;
        Some(Self::of(Arc::new(texels), options))
    }

    fn of(texels: Arc<Texels>, options: &BitmapOptions) -> Self {
        let BitmapOptions { filter, wrap, to_uv, .. } = *options;
        Self { texels, filter, wrap, to_uv }
    }

    /// The colour at `uv`; grey for pictures with one channel.
    #[inline]
    #[must_use]
    pub fn eval(&self, uv: Vec2) -> Spectrum {
        match self.filter {
            FilterMode::Nearest => self.texels.colors([self.nearest(uv)])[0],
            FilterMode::Bilinear => {
                let footprint = self.footprint(uv);
                let [a, b, c, d] = self.texels.colors(footprint.indices);
                let Vec2 { x, y } = footprint.fraction;
                a.lerp(b, x).lerp(c.lerp(d, x), y)
            }
        }
    }

    /// The scalar at `uv`: the only channel, or the luminance.
    #[inline]
    #[must_use]
    pub fn eval_scalar(&self, uv: Vec2) -> f32 {
        if !self.texels.is_grey() {
            return self.eval(uv).luminance();
        }
        match self.filter {
            FilterMode::Nearest => self.texels.scalars([self.nearest(uv)])[0],
            FilterMode::Bilinear => {
                let footprint = self.footprint(uv);
                let [a, b, c, d] = self.texels.scalars(footprint.indices);
                let Vec2 { x, y } = footprint.fraction;
                let lerp = |from: f32, to: f32, share: f32| from + share * (to - from);
                lerp(lerp(a, b, x), lerp(c, d, x), y)
            }
        }
    }

    /// The derivatives of the scalar by u and v; zero for [`FilterMode::Nearest`].
    ///
    /// Same as Mitsuba's `eval_1_grad`, unless `to_uv` rotates a picture that is not square:
    /// Mitsuba 3.9.1 then swaps the two resolutions.
    #[inline]
    #[must_use]
    pub fn gradient(&self, uv: Vec2) -> Vec2 {
        if self.filter == FilterMode::Nearest {
            return Vec2::ZERO;
        }
        let footprint = self.footprint(uv);
        let [a, b, c, d] = self.texels.scalars(footprint.indices);
        let Vec2 { x, y } = footprint.fraction;
        let by_texel =
            Vec2::new((b - a) + y * ((d - c) - (b - a)), (c - a) + x * ((d - b) - (c - a)));
        self.to_uv.matrix2.transpose() * (by_texel * footprint.scale)
    }

    /// The mean colour of all texels.
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        self.texels.mean()
    }

    /// Columns and rows.
    #[must_use]
    pub fn resolution(&self) -> [u32; 2] {
        [self.texels.width, self.texels.height]
    }

    /// The only channel of a texel, or its luminance, to build a distribution over a picture.
    /// Column and row count from the upper left corner and must be less than the [`resolution`].
    ///
    /// # Panics
    /// If column or row is out of range and the texel would lie outside the picture.
    ///
    /// [`resolution`]: Self::resolution
    #[inline]
    #[must_use]
    pub fn texel_luminance(&self, column: u32, row: u32) -> f32 {
        self.texels.scalars([row as usize * self.texels.width as usize + column as usize])[0]
    }

    /// The index of the texel at `uv`.
    #[inline]
    fn nearest(&self, uv: Vec2) -> usize {
        let uv = self.to_uv.transform_point2(uv);
        let column = self.wrap.texel(uv.x, self.texels.width);
        let row = self.wrap.texel(uv.y, self.texels.height);
        row * self.texels.width as usize + column
    }

    /// The texels around `uv`, with their weights.
    #[inline]
    fn footprint(&self, uv: Vec2) -> Footprint {
        let uv = self.to_uv.transform_point2(uv);
        let Texels { width, height, .. } = *self.texels;
        let x = self.wrap.neighbours(uv.x, width);
        let y = self.wrap.neighbours(uv.y, height);
        let (upper, lower) = (y.low * width as usize, y.high * width as usize);
        Footprint {
            indices: [upper + x.low, upper + x.high, lower + x.low, lower + x.high],
            fraction: Vec2::new(x.fraction, y.fraction),
            scale: Vec2::new(width as f32 * x.sign, height as f32 * y.sign),
        }
    }
}

impl WrapMode {
    /// Wraps a coordinate to [0, 1] and returns the sign of its derivative. NaN may remain NaN.
    #[inline]
    fn reduce(self, coordinate: f32) -> (f32, f32) {
        match self {
            Self::Repeat => (fraction(coordinate), 1.0),
            Self::Clamp => (coordinate.clamp(0.0, 1.0), 1.0),
            Self::Mirror => {
                let place = 2.0 * fraction(0.5 * coordinate);
                if place > 1.0 { (2.0 - place, -1.0) } else { (place, 1.0) }
            }
        }
    }

    /// The texel index of a coordinate, out of `size` texels.
    #[inline]
    fn texel(self, coordinate: f32, size: u32) -> usize {
        let (place, _) = self.reduce(coordinate);
        // Casting NaN gives zero.
        ((place * size as f32) as u32).min(size - 1) as usize
    }

    /// The texels whose centres are on either side of a coordinate, out of `size` texels.
    #[inline]
    fn neighbours(self, coordinate: f32, size: u32) -> Neighbours {
        let (place, sign) = self.reduce(coordinate);
        // Starts half a texel before the first centre. Adding one makes casts round down.
        let position = place * size as f32 + 0.5;
        let above = (position as u32).min(size);
        let fraction = position - above as f32;
        let (before_first, after_last) = match self {
            Self::Repeat => (size - 1, 0),
            Self::Clamp | Self::Mirror => (0, size - 1),
        };
        let low = if above == 0 { before_first } else { above - 1 };
        let high = if above == size { after_last } else { above };
        Neighbours { low: low as usize, high: high as usize, fraction, sign }
    }
}

/// The fractional part of a number, in [0, 1].
///
/// Without SSE4.1, which a default build cannot assume, `floor` is a function call. This halves the
/// time to wrap both coordinates. Beyond 2³¹ floats have no fractional part, and the end of the
/// interval is as good as any place.
#[inline]
fn fraction(number: f32) -> f32 {
    let rest = number - number as i32 as f32;
    let rest = if rest < 0.0 { rest + 1.0 } else { rest };
    rest.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests;
