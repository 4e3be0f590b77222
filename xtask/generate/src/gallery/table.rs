//! The table of all gallery pictures.

use etendue::image::ToneMap;

/// A picture of the scene with the same name.
pub(super) struct Picture {
    pub(super) name: &'static str,
    pub(super) heading: &'static str,
    pub(super) text: &'static str,
    /// Width and height, as the scene says.
    pub(super) size: [u32; 2],
    pub(super) samples_per_pixel: u32,
    pub(super) tone_map: ToneMap,
    /// In stops.
    pub(super) exposure: f32,
    /// How long it took, as measured.
    pub(super) minutes: u32,
}

impl Picture {
    /// The path of the scene from the root.
    pub(super) fn scene(&self) -> String {
        format!("scenes/{}/scene.xml", self.name)
    }

    pub(super) fn file_name(&self) -> String {
        format!("{}.jpg", self.name)
    }

    /// How the picture is brought to a display.
    pub(super) fn display(&self) -> String {
        let curve = match self.tone_map {
            ToneMap::None => "sRGB",
            ToneMap::Aces => "ACES",
            ToneMap::Agx => "AgX",
            ToneMap::Filmic => "the filmic curve",
        };
        format!("{curve} at {:+} stops", self.exposure)
    }
}

/// All pictures, in the order of the page.
pub(super) const PICTURES: &[Picture] = &[Picture {
    name: "chess",
    heading: "Chess",
    text: "A middle game under the soft boxes of a studio, through a `thinlens` with a wide aperture. \
           The bodies of the pieces are `revsurface`s along B-splines.",
    size: [1280, 720],
    samples_per_pixel: 128,
    tone_map: ToneMap::Filmic,
    exposure: 0.8,
    minutes: 0,
}];
