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
pub(super) const PICTURES: &[Picture] = &[
    Picture {
        name: "chess",
        heading: "Chess",
        text: "A middle game under the soft boxes of a studio, through a `thinlens` with a wide aperture. \
               The bodies of the pieces are `revsurface`s along B-splines, placed by `instance`s.",
        size: [1280, 720],
        samples_per_pixel: 32,
        tone_map: ToneMap::Filmic,
        exposure: 0.7,
        minutes: 13,
    },
    Picture {
        name: "cosmetics",
        heading: "Cosmetics",
        text: "Satin lacquer, porcelain and brass before a painted disk, lit by an `envmap` of a studio. \
               Bottles, jars and plinths are `revsurface`s with rounded edges.",
        size: [1280, 720],
        samples_per_pixel: 16,
        tone_map: ToneMap::Filmic,
        exposure: 0.4,
        minutes: 6,
    },
    Picture {
        name: "watch",
        heading: "A watch",
        text: "The movement of a watch: brass wheels, a gilded balance, blued screws and rubies, and bridges \
               whose stripes are a `bumpmap` on an anisotropic `roughconductor`.",
        size: [1280, 720],
        samples_per_pixel: 16,
        tone_map: ToneMap::Filmic,
        exposure: 0.0,
        minutes: 3,
    },
    Picture {
        name: "cloth",
        heading: "Velvet",
        text: "Velvet over a pedestal, with a brass vase and two pears. The folds come from a simulation of \
               the cloth, the sheen from the `principled` material.",
        size: [1280, 720],
        samples_per_pixel: 16,
        tone_map: ToneMap::Filmic,
        exposure: 0.6,
        minutes: 5,
    },
    Picture {
        name: "villa",
        heading: "A villa by the sea",
        text: "The last hours of a day under the `sunsky`: a low sun, long shadows, and waves that are a \
               `bumpmap`.",
        size: [1280, 720],
        samples_per_pixel: 16,
        tone_map: ToneMap::Filmic,
        exposure: 2.6,
        minutes: 5,
    },
    Picture {
        name: "interior",
        heading: "A room in daylight",
        text: "An armchair beside a window, on a parquet of oak. One `area` light behind the panes is all the \
               light there is; the rest is what walls and floor send on.",
        size: [1280, 720],
        samples_per_pixel: 16,
        tone_map: ToneMap::Filmic,
        exposure: 1.0,
        minutes: 3,
    },
    Picture {
        name: "cups",
        heading: "Cups",
        text: "The same surface of revolution four times, from one B-spline: solid glass (`dielectric`), a \
               film of glass too thin to bend light (`thindielectric`), porcelain and copper.",
        size: [1280, 720],
        samples_per_pixel: 16,
        tone_map: ToneMap::Filmic,
        exposure: 0.3,
        minutes: 3,
    },
];
