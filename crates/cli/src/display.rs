//! How pictures are shown: exposure and tone mapping, as options of several commands.

use clap::{Args, ValueEnum};
use etendue::image::ToneMap;

use crate::parsers;

/// Exposure and tone mapping of files that are sRGB encoded.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct DisplayArguments {
    /// Exposure in stops: each stop doubles all values
    #[arg(long, value_name = "EV", value_parser = parsers::exposure,
          allow_negative_numbers = true)]
    pub(crate) exposure: Option<f32>,
    /// Tone curve that compresses values too bright for a display
    #[arg(long, value_enum, value_name = "CURVE")]
    tonemap: Option<Curve>,
}

/// The tone maps as argument values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Curve {
    None,
    Aces,
    Agx,
    Filmic,
}

impl DisplayArguments {
    /// The tone map, if one is chosen.
    pub(crate) fn tone_map(&self) -> Option<ToneMap> {
        self.tonemap.map(|curve| match curve {
            Curve::None => ToneMap::None,
            Curve::Aces => ToneMap::Aces,
            Curve::Agx => ToneMap::Agx,
            Curve::Filmic => ToneMap::Filmic,
        })
    }
}
