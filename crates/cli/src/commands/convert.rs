//! `etendue convert`: converts a picture to another format, with exposure and tone mapping.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use etendue::image::{EncodeOptions, Picture, ToneMap, encode, exposure_scale};

use crate::failure::{Failure, Status};
use crate::output::Target;
use crate::pictures;

/// The arguments of `etendue convert`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The picture to read: exr, png, jpg, hdr, pfm, bmp, tga or tiff
    input: PathBuf,
    /// The picture to write: exr, png, jpg, hdr, pfm, bmp or tiff by extension
    output: PathBuf,
    /// Exposure in stops: each stop doubles all values
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
    /// Tone curve that compresses values too bright for a display
    #[arg(long, value_enum, value_name = "CURVE", default_value_t = Curve::None)]
    tonemap: Curve,
}

/// The tone maps as argument values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Curve {
    None,
    Aces,
    Agx,
    Filmic,
}

impl From<Curve> for ToneMap {
    fn from(curve: Curve) -> Self {
        match curve {
            Curve::None => Self::None,
            Curve::Aces => Self::Aces,
            Curve::Agx => Self::Agx,
            Curve::Filmic => Self::Filmic,
        }
    }
}

/// Reads, tone maps and writes the picture.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    if !arguments.exposure.is_finite() {
        return Err(Failure::bad_input("the exposure is not a finite number"));
    }
    let target = Target::new(&arguments.output)?;
    let mut picture = pictures::read(&arguments.input)?;
    let options = EncodeOptions {
        exposure: arguments.exposure,
        tone_map: arguments.tonemap.into(),
        ..EncodeOptions::default()
    };
    if target.format.is_linear() {
        apply(&mut picture, &options);
    }
    target.write(encode(&picture, target.format, &options))?;
    Ok(Status::Success)
}

/// Applies exposure and tone map to a picture. Only linear formats need this; the encoders of the
/// others do it.
fn apply(picture: &mut Picture, options: &EncodeOptions) {
    let Some(main) = picture.main_layer() else {
        return;
    };
    let scale = exposure_scale(options.exposure);
    for index in 0..picture.channels[main.color[0]].data.len() {
        let color = main.color.map(|channel| picture.channels[channel].data[index] * scale);
        let mapped = options.tone_map.apply(color);
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
}
