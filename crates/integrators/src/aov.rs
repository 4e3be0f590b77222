//! `aov`: quantities of the first visible surface, for compositing, denoising and debugging.

use crate::integrator::{CameraRay, ChannelKind, Integrator, Radiance, Start};
use crate::nested::{Nested, Rows, sample_alone, write};
use crate::watch::Watch;
use etendue_document::{Diagnostic, Fault, Parameters, list_names};
use etendue_sampling::Sampler;
use etendue_scene::bsdf::Bsdf;
use etendue_scene::{Manual, ParameterManual, Scene, SurfaceInteraction};
use glam::Vec3;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Adds layers to the picture of the first integrator nested in it. `aovs` lists them as \
              `NAME:KIND`, separated by commas; a kind alone is its own name. They belong to the first \
              surface along the camera ray, and are zero where there is none. The kinds, with their \
              channels, are `albedo` (R, G, B), `depth` (T, the distance), `position` (X, Y, Z), `uv` \
              (U, V), `geo_normal`, `sh_normal` (before bump and normal maps), `dp_du` and `dp_dv` (X, Y, \
              Z), `prim_index` and `shape_index` (I; shapes count from 1; the value of the sample nearest \
              to the pixel's centre, where others are means). A nested integrator NAME \
              (`_arg_0`, `_arg_1`, … for those without a name) adds its own result as `NAME.R`, \
              `NAME.G`, `NAME.B` and `NAME.A`, and its layers as `NAME.LAYER`.",
    parameters: &[ParameterManual {
        name: "aovs",
        kind: "string",
        default: "",
        meaning: "The layers.",
    }],
    sample: r#"<integrator type="aov"><string name="aovs" value="albedo:albedo, normal:sh_normal, depth"/><integrator type="path" name="img"/></integrator>"#,
};

/// A quantity known at a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Albedo,
    Depth,
    Position,
    Uv,
    GeometricNormal,
    ShadingNormal,
    DpDu,
    DpDv,
    PrimitiveIndex,
    ShapeIndex,
}

/// The name of each kind, and of its channels.
const KINDS: [(&str, Kind, &[&str]); 10] = [
    ("albedo", Kind::Albedo, &["R", "G", "B"]),
    ("depth", Kind::Depth, &["T"]),
    ("position", Kind::Position, &["X", "Y", "Z"]),
    ("uv", Kind::Uv, &["U", "V"]),
    ("geo_normal", Kind::GeometricNormal, &["X", "Y", "Z"]),
    ("sh_normal", Kind::ShadingNormal, &["X", "Y", "Z"]),
    ("dp_du", Kind::DpDu, &["X", "Y", "Z"]),
    ("dp_dv", Kind::DpDv, &["X", "Y", "Z"]),
    ("prim_index", Kind::PrimitiveIndex, &["I"]),
    ("shape_index", Kind::ShapeIndex, &["I"]),
];

/// Adds channels to a picture.
pub struct Aov {
    kinds: Vec<Kind>,
    /// The channel names: those of the nested integrators, then those of the kinds.
    channels: Vec<String>,
    /// How the film combines each of the channels.
    channel_kinds: Vec<ChannelKind>,
    nested: Vec<Nested>,
}

impl Aov {
    /// Reads the list of channels; the picture is that of the first integrator in `nested`.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, nested: Vec<Nested>) -> Self {
        let mut channels: Vec<String> = Vec::new();
        let mut channel_kinds = Vec::new();
        for nested in &nested {
            channels.extend(nested.channel_names());
            channels
                .extend(["R", "G", "B", "A"].map(|channel| format!("{}.{channel}", nested.name)));
            channel_kinds.extend(nested.integrator.channel_kinds());
            channel_kinds.extend([ChannelKind::Mean; 4]);
        }
        let mut aov = Self { kinds: Vec::new(), channels, channel_kinds, nested };
        for item in parameters.string("aovs", "").split(',').map(str::trim) {
            if item.is_empty() {
                continue;
            }
            let (name, kind) = item.split_once(':').unwrap_or((item, item));
            aov.add(parameters, name.trim(), kind.trim());
        }
        aov
    }

    fn add(&mut self, parameters: &Parameters<'_>, name: &str, kind: &str) {
        let Some((_, kind, channels)) = KINDS.iter().find(|(known, ..)| *known == kind) else {
            let names = KINDS.iter().map(|(known, ..)| *known);
            let message = format!("there is no layer `{kind}`: it is left out");
            let place = parameters.span_of("aovs");
            let found = Diagnostic::warning(Fault::BadValue, place, message);
            let found = found.help(format!("there are {}", list_names(names)));
            parameters.diagnostics().push(found);
            return;
        };
        self.kinds.push(*kind);
        let is_index = matches!(kind, Kind::PrimitiveIndex | Kind::ShapeIndex);
        let channel_kind = if is_index { ChannelKind::Nearest } else { ChannelKind::Mean };
        self.channel_kinds.extend(channels.iter().map(|_| channel_kind));
        self.channels.extend(channels.iter().map(|channel| format!("{name}.{channel}")));
    }

    fn fill(&self, scene: &Scene, surface: &SurfaceInteraction, channels: &mut [f32]) {
        let bsdf = scene.prepare_bsdf(surface);
        let mut rest = channels;
        for kind in &self.kinds {
            let (values, count) = kind.values(surface, &bsdf);
            rest = write(rest, &values[..count]);
        }
    }
}

impl Kind {
    /// The quantity's values, and how many of them are used.
    fn values(self, surface: &SurfaceInteraction, bsdf: &Bsdf<'_>) -> ([f32; 3], usize) {
        let vector = |v: Vec3| (v.to_array(), 3);
        match self {
            Self::Albedo => (bsdf.albedo(surface.wi).rgb(), 3),
            Self::Depth => ([surface.t, 0.0, 0.0], 1),
            Self::Position => vector(surface.point),
            Self::Uv => ([surface.uv.x, surface.uv.y, 0.0], 2),
            Self::GeometricNormal => vector(surface.normal),
            Self::ShadingNormal => vector(surface.shading.n),
            Self::DpDu => vector(surface.dp_du),
            Self::DpDv => vector(surface.dp_dv),
            Self::PrimitiveIndex => ([surface.primitive as f32, 0.0, 0.0], 1),
            Self::ShapeIndex => ([surface.shape.0 as f32 + 1.0, 0.0, 0.0], 1),
        }
    }
}

impl Integrator for Aov {
    fn channels(&self) -> &[String] {
        &self.channels
    }

    fn channel_kinds(&self) -> Vec<ChannelKind> {
        self.channel_kinds.clone()
    }

    fn needs_light(&self) -> bool {
        self.nested.iter().any(|nested| nested.integrator.needs_light())
    }

    fn clamp_indirect(&self) -> Option<f32> {
        self.nested.iter().find_map(|nested| nested.integrator.clamp_indirect())
    }

    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        channels: &mut [f32],
        watch: &Watch<'_>,
    ) -> Radiance {
        sample_alone(self, scene, start, sampler, (channels, watch))
    }

    fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        channels: &mut [f32],
        watch: &Watch<'_>,
        radiance: &mut Vec<Radiance>,
    ) {
        let mut rows = Rows::new(channels, self.channels.len());
        let mut first = None;
        for nested in &self.nested {
            let seen = nested.sample_batch(scene, rays, &mut rows, watch);
            rows.append(4, |row| {
                let [red, green, blue] = seen[row].color.rgb();
                [red, green, blue, seen[row].alpha]
            });
            first.get_or_insert(seen);
        }
        let surfaces: Vec<_> = rays.iter().map(|ray| scene.intersect(&ray.start.ray)).collect();
        for (surface, row) in surfaces.iter().zip(rows.rest()) {
            if let Some(surface) = surface {
                self.fill(scene, surface, row);
            }
        }
        let alone = |surface: &Option<SurfaceInteraction>| Radiance {
            alpha: if surface.is_some() { 1.0 } else { 0.0 },
            ..Radiance::NONE
        };
        radiance.extend(first.unwrap_or_else(|| surfaces.iter().map(alone).collect()));
    }
}
