//! Planar pictures with named channels and metadata: films write and comparisons read them.

use crate::numeric::multiply;
use crate::primaries::{BT709, to_bt709};
use crate::{BitDepth, ColorImage, ImageError};

/// A rectangle of pixels, such as OpenEXR's display window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Leftmost pixel.
    pub x: i32,
    /// Topmost pixel.
    pub y: i32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

/// One channel of a [`Picture`].
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The channel's name, such as `R`, `albedo.R` or `depth.Z`.
    pub name: String,
    /// `width × height` values, the top row first.
    pub data: Vec<f32>,
}

/// The value of a header attribute.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MetadataValue {
    /// UTF-8 text.
    Text(String),
    /// A signed 32-bit integer.
    Integer(i32),
    /// A 32-bit float.
    Float(f32),
    /// A 64-bit float.
    Double(f64),
    /// Two floats.
    Vector2([f32; 2]),
    /// Three floats.
    Vector3([f32; 3]),
    /// A 3 × 3 matrix, row by row.
    Matrix3([f32; 9]),
    /// A 4 × 4 matrix, row by row.
    Matrix4([f32; 16]),
    /// x and y of the red, green and blue primaries and of the white point (CIE 1931).
    Chromaticities([f32; 8]),
}

/// A planar picture with any number of named channels, and metadata.
///
/// The channels cover the *data window*: the `width × height` pixels starting at
/// [`data_origin`](Self::data_origin). The [`display_window`](Self::display_window) is the whole
/// picture. It is larger if only a crop was rendered.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width of the data window in pixels.
    pub width: u32,
    /// Height of the data window in pixels.
    pub height: u32,
    /// The channels, with distinct names.
    pub channels: Vec<Channel>,
    /// Attributes with distinct names. Only OpenEXR keeps them.
    pub metadata: Vec<(String, MetadataValue)>,
    /// The top left corner of the data window, in the coordinates of the display window.
    pub data_origin: [i32; 2],
    /// The whole picture, of which the channels may cover a part. Only OpenEXR keeps it.
    pub display_window: Window,
    /// Whether the colours of the main layer are not premultiplied by its alpha, as in PNG. Films
    /// and OpenEXR files have premultiplied colours.
    pub straight_alpha: bool,
    /// Bits per sample of the file that was read, if its samples are integers.
    pub source_depth: Option<BitDepth>,
    /// What the file that was read says about its colours and is not followed, for people.
    pub warnings: Vec<String>,
}

/// The channels that show the picture itself, as indices into [`Picture::channels`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MainLayer {
    /// Red, green and blue; the same channel three times for grey.
    pub color: [usize; 3],
    /// Alpha, if any. Colours are premultiplied by it unless [`Picture::straight_alpha`].
    pub alpha: Option<usize>,
    /// Whether the picture is greyscale.
    pub is_grey: bool,
}

impl Picture {
    /// A picture without channels, whose data and display windows are `width × height`.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            channels: Vec::new(),
            metadata: Vec::new(),
            data_origin: [0, 0],
            display_window: Window { x: 0, y: 0, width, height },
            straight_alpha: false,
            source_depth: None,
            warnings: Vec::new(),
        }
    }

    /// A picture with the channels `R`, `G` and `B`.
    pub fn from_color_image(image: &ColorImage) -> Self {
        let mut picture = Self::new(image.width, image.height);
        for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
            picture.push(name, image.pixels.iter().map(|pixel| pixel[channel]).collect());
        }
        picture
    }

    /// Adds a channel.
    pub fn push(&mut self, name: impl Into<String>, data: Vec<f32>) {
        self.channels.push(Channel { name: name.into(), data });
    }

    /// The channel with this name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The attribute with this name.
    pub fn metadata(&self, name: &str) -> Option<&MetadataValue> {
        self.metadata.iter().find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// The channels that show the picture itself: `R`, `G`, `B` with `A`, else `Y` with `A`, else
    /// the first group such as `diffuse.R`, `diffuse.G`, `diffuse.B`, else the only channel.
    pub fn main_layer(&self) -> Option<MainLayer> {
        find_main_layer(&self.channels.iter().map(|c| c.name.as_str()).collect::<Vec<_>>())
    }

    /// Multiplies the colours of the main layer by its alpha, unless they are premultiplied.
    pub fn premultiply(&mut self) {
        if !std::mem::take(&mut self.straight_alpha) {
            return;
        }
        let Some(MainLayer { mut color, alpha: Some(alpha), is_grey }) = self.main_layer() else {
            return;
        };
        let alpha = self.channels[alpha].data.clone();
        // The colours of grey pictures are one channel.
        let distinct = if is_grey { &mut color[..1] } else { &mut color[..] };
        for index in distinct {
            for (value, alpha) in self.channels[*index].data.iter_mut().zip(&alpha) {
                *value *= alpha;
            }
        }
    }

    /// Converts all colours, groups of channels that end in `R`, `G` and `B`, to the primaries of
    /// BT.709, if the attribute `chromaticities` says that they have others.
    pub(crate) fn convert_to_bt709(&mut self) {
        let Some(&MetadataValue::Chromaticities(points)) = self.metadata("chromaticities") else {
            return;
        };
        let matrix = match to_bt709(&points) {
            Ok(None) => return,
            Ok(Some(matrix)) => matrix,
            Err(_) => {
                self.warnings.push(degenerate_chromaticities(&points));
                self.metadata.retain(|(name, _)| name != "chromaticities");
                return;
            }
        };
        let names: Vec<&str> = self.channels.iter().map(|c| c.name.as_str()).collect();
        let groups = names.iter().filter_map(|name| match name.rsplit_once('.') {
            // A variance is no colour: it would need the covariances of the channels.
            Some((group, "R")) if group != "variance" => find_color(&names, group),
            None if *name == "R" => find_color(&names, ""),
            _ => None,
        });
        let groups: Vec<[usize; 3]> = groups.map(|group| group.color).collect();
        for channels in groups {
            for pixel in 0..self.channels[channels[0]].data.len() {
                let color = channels.map(|channel| self.channels[channel].data[pixel]);
                for (channel, value) in channels.into_iter().zip(multiply(&matrix, color)) {
                    self.channels[channel].data[pixel] = value;
                }
            }
        }
        for (name, value) in &mut self.metadata {
            if name == "chromaticities" {
                *value = MetadataValue::Chromaticities(BT709);
            }
        }
    }

    /// The layers: groups of channels by the part of their names before the last dot, each with the
    /// indices of its channels. The first one, without a name, is the
    /// [main layer](Self::main_layer), if that has no name. Channels without a dot that do not belong
    /// to it are layers of their own.
    pub fn layers(&self) -> Vec<(&str, Vec<usize>)> {
        let is_plain = |index: &usize| !self.channels[*index].name.contains('.');
        let main = self.main_layer().filter(|main| is_plain(&main.color[0]));
        let main: Vec<usize> = main.map_or_else(Vec::new, |MainLayer { color, alpha, is_grey }| {
            let color = if is_grey { &color[..1] } else { &color[..] };
            color.iter().copied().chain(alpha).collect()
        });
        let mut layers: Vec<(&str, Vec<usize>)> = Vec::new();
        let others = self.channels.iter().enumerate().filter(|(index, _)| !main.contains(index));
        for (index, channel) in others {
            let name =
                channel.name.rsplit_once('.').map_or(channel.name.as_str(), |(name, _)| name);
            match layers.iter_mut().find(|(known, _)| *known == name) {
                Some((_, channels)) => channels.push(index),
                None => layers.push((name, vec![index])),
            }
        }
        for (_, channels) in &mut layers {
            // Files sort channels by name; colours come as red, green, blue and alpha.
            let order = |index: &usize| {
                let letter = self.channels[*index].name.rsplit('.').next().unwrap_or_default();
                ["R", "G", "B", "A"].iter().position(|known| *known == letter)
            };
            if channels.iter().all(|index| order(index).is_some()) {
                channels.sort_by_key(order);
            }
        }
        if !main.is_empty() {
            layers.insert(0, ("", main));
        }
        layers
    }

    /// The picture of one layer, as its main layer: the channels become `R`, `G` and `B`, or `Y`, and
    /// `A`. Two channels become red and green. A channel of this name is a layer, too. `None` if there
    /// is neither.
    pub fn layer(&self, name: &str) -> Option<Self> {
        let layer = self.layers().into_iter().find(|(known, _)| *known == name);
        let channels = match layer {
            Some((_, channels)) => channels,
            None => vec![self.channels.iter().position(|channel| channel.name == name)?],
        };
        let mut picture = Self {
            channels: Vec::new(),
            metadata: self.metadata.clone(),
            warnings: self.warnings.clone(),
            ..*self
        };
        let names: &[&str] = match channels.len() {
            1 => &["Y"],
            2 | 3 => &["R", "G", "B"],
            _ => &["R", "G", "B", "A"],
        };
        for (index, name) in channels.iter().zip(names) {
            picture.push(*name, self.channels[*index].data.clone());
        }
        if channels.len() == 2 {
            picture.push("B", vec![0.0; self.width as usize * self.height as usize]);
        }
        Some(picture)
    }

    /// The main layer as linear RGB triples, premultiplied by alpha.
    ///
    /// # Errors
    /// [`ImageError::InvalidPicture`] if there is no main layer or the picture is not
    /// [valid](Self::validate).
    pub fn to_color_image(&self) -> Result<ColorImage, ImageError> {
        self.validate()?;
        let main = self.require_main_layer()?;
        let [red, green, blue] = main.color.map(|index| &self.channels[index].data);
        let color = red.iter().zip(green).zip(blue);
        let mut pixels: Vec<_> = color.map(|((&red, &green), &blue)| [red, green, blue]).collect();
        if let Some(alpha) = main.alpha.filter(|_| self.straight_alpha) {
            for (pixel, alpha) in pixels.iter_mut().zip(&self.channels[alpha].data) {
                *pixel = pixel.map(|value| value * alpha);
            }
        }
        Ok(ColorImage { width: self.width, height: self.height, pixels })
    }

    /// Checks that every channel has `width × height` values, and that names are distinct.
    ///
    /// # Errors
    /// [`ImageError::InvalidPicture`] with the first problem.
    pub fn validate(&self) -> Result<(), ImageError> {
        let expected = self.width as usize * self.height as usize;
        if expected == 0 {
            return Err(ImageError::invalid_picture("it has no pixels"));
        }
        for channel in &self.channels {
            if channel.data.len() != expected {
                return Err(ImageError::invalid_picture(format!(
                    "channel '{}' has {} values instead of {expected}",
                    channel.name,
                    channel.data.len(),
                )));
            }
        }
        require_distinct("channel", self.channels.iter().map(|channel| channel.name.as_str()))?;
        require_distinct("attribute", self.metadata.iter().map(|(name, _)| name.as_str()))
    }

    /// The main layer, or an error that lists the channels.
    pub(crate) fn require_main_layer(&self) -> Result<MainLayer, ImageError> {
        self.main_layer().ok_or_else(|| {
            let names: Vec<_> = self.channels.iter().map(|c| c.name.as_str()).collect();
            ImageError::invalid_picture(format!(
                "it has neither colour nor grey channels, but only: {}",
                names.join(", ")
            ))
        })
    }
}

/// The warning about chromaticities that span no colour space.
pub(crate) fn degenerate_chromaticities(points: &[f32; 8]) -> String {
    format!(
        "the chromaticities {points:?} span no colour space; the primaries of Rec. 709 are assumed"
    )
}

/// Returns an error for the first name that occurs twice.
fn require_distinct<'a>(
    what: &str,
    names: impl Iterator<Item = &'a str>,
) -> Result<(), ImageError> {
    let mut seen = std::collections::HashSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(ImageError::invalid_picture(format!("{what} '{name}' occurs twice")));
        }
    }
    Ok(())
}

/// The main layer for a list of channel names; see [`Picture::main_layer`].
pub(crate) fn find_main_layer(names: &[&str]) -> Option<MainLayer> {
    let color_groups = names.iter().filter_map(|name| name.strip_suffix(".R"));
    find_color(names, "")
        .or_else(|| find_grey(names, "Y"))
        .or_else(|| color_groups.into_iter().find_map(|group| find_color(names, group)))
        .or_else(|| if let [only] = names { find_grey(names, only) } else { None })
}

/// The channels R, G, B and A of a group; the empty group is the top level.
fn find_color(names: &[&str], group: &str) -> Option<MainLayer> {
    let find = |letter: &str| {
        let belongs = |name: &&str| match name.rsplit_once('.') {
            Some((prefix, last)) => prefix == group && last == letter,
            None => group.is_empty() && *name == letter,
        };
        names.iter().position(belongs)
    };
    let color = [find("R")?, find("G")?, find("B")?];
    Some(MainLayer { color, alpha: find("A"), is_grey: false })
}

/// A grey channel, and the alpha of the top level.
fn find_grey(names: &[&str], grey: &str) -> Option<MainLayer> {
    let find = |wanted: &str| names.iter().position(|name| *name == wanted);
    let alpha = find("A").filter(|_| grey != "A");
    Some(MainLayer { color: [find(grey)?; 3], alpha, is_grey: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn main_layer_prefers_plain_color_then_grey_then_the_first_group() {
        let plain = find_main_layer(&["albedo.R", "A", "B", "G", "R"]).unwrap();
        assert_eq!(plain, MainLayer { color: [4, 3, 2], alpha: Some(1), is_grey: false });
        let grey = find_main_layer(&["x.R", "x.G", "x.B", "Y"]).unwrap();
        assert_eq!(grey, MainLayer { color: [3; 3], alpha: None, is_grey: true });
        let group = find_main_layer(&["z", "a.b.B", "a.b.G", "a.b.R", "A"]).unwrap();
        assert_eq!(group, MainLayer { color: [3, 2, 1], alpha: None, is_grey: false });
        let only = find_main_layer(&["depth.Z"]).unwrap();
        assert_eq!(only.color, [0; 3]);
        assert_eq!(find_main_layer(&["depth.Z", "normal.X"]), None);
        assert_eq!(find_main_layer(&[]), None);
    }

    #[test]
    fn inconsistent_pictures_are_rejected() {
        let mut picture = Picture::new(2, 1);
        picture.push("R", vec![0.0; 2]);
        assert_eq!(picture.validate(), Ok(()));
        picture.push("R", vec![0.0; 2]);
        assert!(picture.validate().unwrap_err().to_string().contains("'R' occurs twice"));
        picture.channels[1] = Channel { name: "G".into(), data: vec![0.0; 3] };
        assert!(picture.validate().unwrap_err().to_string().contains("3 values instead of 2"));
        assert!(Picture::new(0, 4).validate().is_err());
    }

    #[test]
    fn color_images_round_trip() {
        let pixels = vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        let image = ColorImage { width: 1, height: 2, pixels };
        assert_eq!(Picture::from_color_image(&image).to_color_image(), Ok(image));
    }

    #[test]
    fn layers_are_groups_and_one_of_them_can_be_taken_out() {
        let mut picture = Picture::new(1, 1);
        let names = ["A", "B", "G", "R", "Z", "n.X", "n.Y", "uv.U", "uv.V", "x.B", "x.G", "x.R"];
        for (index, name) in names.into_iter().enumerate() {
            picture.push(name, vec![index as f32]);
        }
        let expected: Vec<(&str, Vec<usize>)> = vec![
            ("", vec![3, 2, 1, 0]),
            ("Z", vec![4]),
            ("n", vec![5, 6]),
            ("uv", vec![7, 8]),
            ("x", vec![11, 10, 9]),
        ];
        assert_eq!(picture.layers(), expected);
        let values = |name: &str| {
            let layer = picture.layer(name)?;
            let pairs = layer.channels.iter().map(|c| (c.name.clone(), c.data[0]));
            Some(pairs.collect::<Vec<_>>())
        };
        let pair = |name: &str, value| (name.to_owned(), value);
        assert_eq!(values("Z"), Some(vec![pair("Y", 4.0)]));
        assert_eq!(values("uv"), Some(vec![pair("R", 7.0), pair("G", 8.0), pair("B", 0.0)]));
        assert_eq!(values("x"), Some(vec![pair("R", 11.0), pair("G", 10.0), pair("B", 9.0)]));
        assert_eq!(values("n.Y"), Some(vec![pair("Y", 6.0)]));
        assert_eq!(values("nothing"), None);
    }

    #[test]
    fn straight_colours_are_multiplied_by_alpha_once() {
        let mut picture = Picture::new(1, 1);
        for (name, value) in [("R", 0.5), ("G", 1.0), ("B", 0.0), ("A", 0.5)] {
            picture.push(name, vec![value]);
        }
        picture.straight_alpha = true;
        assert_eq!(picture.to_color_image().unwrap().pixels, [[0.25, 0.5, 0.0]]);
        picture.premultiply();
        picture.premultiply();
        assert_eq!(picture.to_color_image().unwrap().pixels, [[0.25, 0.5, 0.0]]);
        assert_eq!(picture.channels[3].data, [0.5]);
    }
}
