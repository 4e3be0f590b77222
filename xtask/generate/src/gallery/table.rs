//! The table of all gallery pictures.

/// Pictures shown side by side under a heading.
pub(super) struct Section {
    pub(super) heading: &'static str,
    /// The scene's folder under `scenes/`.
    pub(super) scene: &'static str,
    pub(super) text: &'static str,
    pub(super) pictures: &'static [Entry],
}

/// One picture.
pub(super) struct Entry {
    /// The file name without `.png`.
    pub(super) name: &'static str,
    pub(super) caption: &'static str,
    pub(super) samples_per_pixel: u32,
    /// Values for `$name`, which override the scene's defaults.
    pub(super) defines: &'static [(&'static str, &'static str)],
    pub(super) emitter_sampling: EmitterSampling,
}

/// Whether emitters are sampled; otherwise paths find light only by hitting emitters.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum EmitterSampling {
    On,
    Off,
}

impl Entry {
    /// A picture of the scene with its default values.
    const fn plain(name: &'static str, caption: &'static str, samples_per_pixel: u32) -> Self {
        let emitter_sampling = EmitterSampling::On;
        Self { name, caption, samples_per_pixel, defines: &[], emitter_sampling }
    }

    const fn with(self, defines: &'static [(&'static str, &'static str)]) -> Self {
        Self { defines, ..self }
    }

    const fn without_emitter_sampling(self) -> Self {
        Self { emitter_sampling: EmitterSampling::Off, ..self }
    }
}

/// All sections, in the order of the page.
pub(super) const SECTIONS: &[Section] = &[
    Section {
        heading: "A Cornell box",
        scene: "cornell-box",
        text: "Diffuse walls under a ceiling light. The small pictures have 32 samples per pixel each. \
               The second one turns off emitter sampling (`--no-emitter-sampling`), so paths find light \
               only by hitting the lamp. Both converge to the same picture.",
        pictures: &[
            Entry::plain("cornell-box", "256 samples per pixel", 256).with(&[("size", "480")]),
            Entry::plain("cornell-box-32", "32 samples per pixel", 32).with(&[("size", "240")]),
            Entry::plain("cornell-box-32-no-emitter-sampling", "32, without emitter sampling", 32)
                .with(&[("size", "240")])
                .without_emitter_sampling(),
        ],
    },
    Section {
        heading: "Depth of field",
        scene: "depth-of-field",
        text: "A `thinlens` camera focused on one pawn in a row. The pawns are `revsurface`s, placed as \
               `instance`s of two `shapegroup`s.",
        pictures: &[Entry::plain("depth-of-field", "", 256)],
    },
    Section {
        heading: "Glass and metal",
        scene: "glass-and-metal",
        text: "A `dielectric` ball and a `conductor` ball of gold.",
        pictures: &[Entry::plain("glass-and-metal", "", 768)],
    },
    Section {
        heading: "Cups",
        scene: "cups",
        text: "The same surface of revolution (`revsurface` with a B-spline profile) as solid glass \
               (`dielectric`, left) and as a thin film of glass (`thindielectric`, right).",
        pictures: &[Entry::plain("cups", "", 512)],
    },
    Section {
        heading: "Plastics",
        scene: "plastics",
        text: "`plastic` and `roughplastic` on a mesh with smooth normals.",
        pictures: &[Entry::plain("plastics", "", 256)],
    },
    Section {
        heading: "Rough metals",
        scene: "rough-metals",
        text: "`roughconductor` with `alpha` 0.05, 0.1, 0.2, 0.35 and 0.6, and anisotropic aluminium \
               in front.",
        pictures: &[Entry::plain("rough-metals", "", 256)],
    },
    Section {
        heading: "Textures",
        scene: "textures",
        text: "`bitmap` and `checkerboard` textures, a `bumpmap` on the wall, and a `mask` that cuts \
               holes into the lamp shade.",
        pictures: &[Entry::plain("textures", "", 384)],
    },
    Section {
        heading: "Smoke",
        scene: "smoke",
        text: "A `heterogeneous` medium over a `gridvolume`, lit by a lamp and by the ember below, \
               rendered with `volpath`.",
        pictures: &[Entry::plain("smoke", "", 512)],
    },
    Section {
        heading: "Soft shadows",
        scene: "soft-shadows",
        text: "`area` lights of equal power with sides of 0.1, 1.2 and 3.6.",
        pictures: &[
            Entry::plain("soft-shadows-small", "side 0.1", 256)
                .with(&[("light", "0.05"), ("radiance", "9216")]),
            Entry::plain("soft-shadows-medium", "side 1.2", 256)
                .with(&[("light", "0.6"), ("radiance", "64")]),
            Entry::plain("soft-shadows-large", "side 3.6", 256)
                .with(&[("light", "1.8"), ("radiance", "7.1111")]),
        ],
    },
];
