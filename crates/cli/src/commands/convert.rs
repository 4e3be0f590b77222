//! `etendue convert`: converts a picture to another format, with exposure and tone mapping.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use etendue::image::{
    BitDepth, EncodeOptions, FileFormat, Picture, ToneMap, encode, exposure_scale, losses,
};

use crate::display::DisplayArguments;
use crate::failure::{Failure, Status};
use crate::output::Target;
use crate::{parsers, pictures, terminal, text};

/// The arguments of `etendue convert`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The picture to read: exr, png, jpg, hdr, pfm, bmp, tga, tiff, webp, qoi, npy or npz; - reads
    /// standard input
    input: PathBuf,
    /// The picture to write: exr, png, jpg, hdr, pfm, bmp, tiff, npy or npz by extension; - writes
    /// standard output and needs --format
    output: PathBuf,
    /// The format to write, whatever the extension
    #[arg(long, value_name = "FORMAT", value_parser = parsers::format)]
    format: Option<FileFormat>,
    /// Convert only this layer, such as albedo, or this channel, such as depth.T
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// Bits per sample of png and tiff [default: 8, or those of the picture read]
    #[arg(long, value_enum, value_name = "BITS")]
    depth: Option<Depth>,
    #[command(flatten)]
    display: DisplayArguments,
}

/// Bits per sample as an argument value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Depth {
    #[value(name = "8")]
    Eight,
    #[value(name = "16")]
    Sixteen,
}

impl From<Depth> for BitDepth {
    fn from(depth: Depth) -> Self {
        match depth {
            Depth::Eight => Self::Eight,
            Depth::Sixteen => Self::Sixteen,
        }
    }
}

/// Reads, tone maps and writes the picture.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let output = Output::new(arguments)?;
    let format = output.format();
    if arguments.depth.is_some() && !matches!(format, FileFormat::Png | FileFormat::Tiff) {
        return Err(Failure::bad_input("--depth is for png and tiff"));
    }
    let mut picture = pictures::read(&arguments.input)?;
    if let Some(layer) = &arguments.layer {
        picture = pictures::layer(&picture, layer, &arguments.input)?;
    }
    let depth = arguments.depth.map(BitDepth::from).or(picture.source_depth);
    let options = EncodeOptions {
        bit_depth: depth.unwrap_or_default(),
        exposure: arguments.display.exposure.unwrap_or_default(),
        tone_map: arguments.display.tone_map().unwrap_or_default(),
        ..EncodeOptions::default()
    };
    if format.is_linear() {
        apply(&mut picture, &options);
    }
    for loss in losses(&picture, format, &options) {
        terminal::warning(&format!("{}: {loss}", text::path(&arguments.output)));
    }
    let encoded = encode(&picture, format, &options);
    match output {
        Output::File(target) => target.write(encoded)?,
        Output::Standard(_) => {
            let bytes = encoded
                .map_err(|error| Failure::failed(format!("cannot write the picture: {error}")))?;
            terminal::result_bytes(&bytes)?;
        }
    }
    Ok(Status::Success)
}

/// Where the picture goes.
enum Output {
    File(Target),
    Standard(FileFormat),
}

impl Output {
    fn new(arguments: &Arguments) -> Result<Self, Failure> {
        if arguments.output != Path::new(pictures::STANDARD) {
            return Ok(Self::File(Target::with_format(&arguments.output, arguments.format)?));
        }
        match arguments.format {
            Some(format) => Ok(Self::Standard(format)),
            None => Err(Failure::bad_input(format!(
                "standard output needs --format: {}",
                parsers::format_names()
            ))),
        }
    }

    fn format(&self) -> FileFormat {
        match self {
            Self::File(target) => target.format,
            Self::Standard(format) => *format,
        }
    }
}

/// Applies exposure and tone map to a picture. Only linear formats need this; the encoders of the
/// others do it. Tone curves apply to colours that are not premultiplied.
fn apply(picture: &mut Picture, options: &EncodeOptions) {
    let Some(main) = picture.main_layer() else {
        return;
    };
    let scale = exposure_scale(options.exposure);
    let is_divided = options.tone_map != ToneMap::None && !picture.straight_alpha;
    let alpha = main.alpha.filter(|_| is_divided);
    for index in 0..picture.channels[main.color[0]].data.len() {
        let coverage = alpha.map_or(1.0, |alpha| picture.channels[alpha].data[index]);
        let coverage = if coverage > 0.0 { coverage } else { 1.0 };
        let color = main.color.map(|channel| picture.channels[channel].data[index] * scale);
        let mapped = match alpha {
            None => options.tone_map.apply(color),
            Some(_) => {
                let mapped = options.tone_map.apply(color.map(|value| value / coverage));
                mapped.map(|value| value * coverage)
            }
        };
        for (channel, value) in main.color.into_iter().zip(mapped) {
            picture.channels[channel].data[index] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_pictures_are_exposed_once() {
        let mut picture = Picture::new(1, 1);
        picture.push("Y", vec![3.0]);
        apply(&mut picture, &EncodeOptions { exposure: 1.0, ..EncodeOptions::default() });
        assert_eq!(picture.channels[0].data, [6.0]);
    }

    #[test]
    fn alpha_and_layers_keep_their_values() {
        let mut picture = Picture::new(1, 1);
        for name in ["R", "G", "B", "A", "depth.Z"] {
            picture.push(name, vec![1.0]);
        }
        apply(&mut picture, &EncodeOptions { exposure: -1.0, ..EncodeOptions::default() });
        let values: Vec<f32> = picture.channels.iter().map(|channel| channel.data[0]).collect();
        assert_eq!(values, [0.5, 0.5, 0.5, 1.0, 1.0]);
    }

    #[test]
    fn tone_curves_see_the_colour_without_alpha() {
        let tone_map = ToneMap::Filmic;
        let mut picture = Picture::new(1, 1);
        for (name, value) in [("R", 0.5), ("G", 0.5), ("B", 0.5), ("A", 0.25)] {
            picture.push(name, vec![value]);
        }
        apply(&mut picture, &EncodeOptions { tone_map, ..EncodeOptions::default() });
        let expected = tone_map.apply([2.0; 3])[0] * 0.25;
        assert_eq!(picture.channels[0].data, [expected]);
    }
}
