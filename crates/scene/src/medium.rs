//! Participating media, which fill the space between surfaces.
//!
//! # Contract
//! - Coefficients are per unit of length in world space. The extinction σt is the sum of absorption
//!   and scattering. The albedo is the scattered fraction: σs = albedo · σt.
//! - A shape's `interior` is the medium on the side opposite to its normals; `exterior` is the
//!   medium on the side of its normals. A path that crosses such a shape continues in the medium of
//!   the side it enters. No other shape changes its medium.

pub mod heterogeneous;
pub mod homogeneous;

pub use crate::models::majorants::{Collision, Tracker};
pub use heterogeneous::Heterogeneous;
pub use homogeneous::Homogeneous;

use crate::builder::Builder;
use crate::ids::MediumId;
use crate::manual::{ParameterManual, parameter};
use crate::phase::isotropic::Isotropic;
use crate::phase::{MediumInteraction, PhaseFunction};
use crate::plugin::{Plugin, plugin};
use crate::volume::Volume;
use crate::volume::gridvolume::GridVolume;
use etendue_document::{Class, Fault, Parameters};
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::Vec3;
use std::sync::Arc;

/// Builds a medium.
pub type BuildMedium = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Medium>;

/// The list of media, one line per plugin. The spatial distribution of each is a [`Density`].
pub static MEDIA: &[Plugin<BuildMedium>] = &[
    plugin("heterogeneous", &heterogeneous::MANUAL, heterogeneous::build),
    plugin("homogeneous", &homogeneous::MANUAL, homogeneous::build),
];

/// A medium of the scene.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Its spatial distribution.
    pub density: Density,
    /// Its phase function.
    pub phase: PhaseFunction,
    /// Whether points of scattering sample emitters. This is of no use behind glass, which no
    /// straight path to an emitter can cross.
    pub sample_emitters: bool,
}

/// The spatial distribution of a medium.
#[derive(Clone, Debug)]
pub enum Density {
    /// The same everywhere.
    Homogeneous(Homogeneous),
    /// Varies from point to point.
    Heterogeneous(Box<Heterogeneous>),
}

/// The media on both sides of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MediumInterface {
    /// On the side opposite to the shape's normals.
    pub interior: Option<MediumId>,
    /// On the side of the shape's normals.
    pub exterior: Option<MediumId>,
}

/// The coefficients of a medium at a point, for one direction.
#[derive(Clone, Copy, Debug)]
pub struct Coefficients {
    /// σt.
    pub extinction: Spectrum,
    /// σs.
    pub scattering: Spectrum,
}

impl MediumInterface {
    /// The medium of a path that leaves a surface with the geometric normal `normal` towards
    /// `direction`.
    #[inline]
    #[must_use]
    pub fn towards(&self, normal: Vec3, direction: Vec3) -> Option<MediumId> {
        if direction.dot(normal) > 0.0 { self.exterior } else { self.interior }
    }
}

const ALBEDO: ParameterManual = parameter(
    "albedo",
    "float, spectrum or volume",
    "0.75",
    "The share of the extinction that is scattered.",
);
const SCALE: ParameterManual = parameter("scale", "float", "1", "A factor on the extinction.");
const SAMPLE_EMITTERS: ParameterManual = parameter(
    "sample_emitters",
    "boolean",
    "true",
    "Whether points of scattering sample emitters; behind glass that is of no use.",
);
const PHASE: ParameterManual =
    parameter("(nested)", "phase", "isotropic", "How the medium scatters light.");

impl Medium {
    /// The coefficients for light that arrives from `site.wi`.
    #[inline]
    #[must_use]
    pub fn coefficients(&self, site: &MediumInteraction) -> Coefficients {
        let area = self.phase.projected_area(site);
        let (extinction, albedo) = match &self.density {
            Density::Homogeneous(medium) => (medium.extinction(), medium.albedo(site.point)),
            Density::Heterogeneous(medium) => {
                (medium.extinction(site.point), medium.albedo(site.point))
            }
        };
        let extinction = extinction * area;
        Coefficients { extinction, scattering: extinction * albedo }
    }

    /// Bytes of memory beyond the struct itself. Excludes grids, which may be shared.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        match &self.density {
            Density::Homogeneous(_) => 0,
            Density::Heterogeneous(medium) => medium.bounds_bytes(),
        }
    }

    /// Appends the grids of the medium.
    pub(crate) fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        match &self.density {
            Density::Homogeneous(medium) => {
                grids.extend(medium.volumes().into_iter().filter_map(Volume::grid));
            }
            Density::Heterogeneous(medium) => {
                grids.extend(medium.volumes().into_iter().filter_map(Volume::grid));
            }
        }
        self.phase.collect_grids(grids);
    }
}

/// The parameters that both kinds of media have.
struct Common {
    albedo: Volume,
    scale: f32,
    phase: PhaseFunction,
    sample_emitters: bool,
}

/// The greatest `scale` of coefficients.
const MAX_SCALE: f64 = 1e18;

impl Common {
    fn read(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Self> {
        let albedo = builder.volume_or_color(parameters, "albedo", 0.75, SpectrumUse::Unbounded);
        let scale = parameters.float_in("scale", 1.0, 0.0..=MAX_SCALE) as f32;
        let sample_emitters = parameters.boolean("sample_emitters", true);
        let phase = read_phase(builder, parameters);
        let albedo = without_negative(parameters, "albedo", albedo?)?;
        if albedo.range()[1] > 1.0 {
            let message = "the albedo is above 1 in places: it is limited to 1";
            parameters.warning(Fault::BadValue, "albedo", message);
        }
        Some(Self { albedo, scale, phase: phase?, sample_emitters })
    }
}

/// The nested phase function, or the isotropic one.
fn read_phase(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<PhaseFunction> {
    let children = parameters.children_of(Class::Phase);
    if let [_, second, ..] = children.as_slice() {
        let message = "a medium has one phase function: this one is left out";
        parameters.diagnostics().warning(Fault::BadValue, second.span, message);
    }
    match children.first() {
        Some(child) => builder.phase(child.node),
        None => Some(PhaseFunction::Isotropic(Isotropic)),
    }
}

/// The extinction, with checked values; `None` after an error has been reported.
fn read_extinction(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Volume> {
    let volume = builder.volume_or_color(parameters, "sigma_t", 1.0, SpectrumUse::Unbounded)?;
    without_negative(parameters, "sigma_t", volume)
}

/// The greatest share of a volume's maximum by which its values may fall below zero. Simulations and
/// filters undershoot a little; anything more is a mistake.
const UNDERSHOOT: f32 = 0.1;

/// A volume whose values are slightly negative in places counts as zero there, with a warning; `None`
/// after reporting values that are clearly negative.
fn without_negative(parameters: &Parameters<'_>, name: &str, volume: Volume) -> Option<Volume> {
    let [low, high] = volume.range();
    if low >= 0.0 {
        return Some(volume);
    }
    if -low > UNDERSHOOT * high || volume.as_constant().is_some() {
        let message = format!("`{name}` is negative in places, down to {low}");
        parameters.error(Fault::BadValue, name, message);
        return None;
    }
    let message =
        format!("`{name}` is slightly negative in places, down to {low}: it counts as 0 there");
    parameters.warning(Fault::BadValue, name, message);
    Some(volume.without_negative())
}
