//! Phase functions: how media scatter light.
//!
//! # Contract
//! - `wi` and `wo` are unit, in world space, and point away from the place of scattering; `wi` is
//!   where the path comes from. Light that goes straight on has `wo` = −`wi`.
//! - The value of a phase function is its density in solid angle: it integrates to one, and sampling
//!   follows it exactly, so that samples carry no weight.
//! - [`PhaseFunction::sample`] uses one number to choose among parts and two for the direction.

pub mod blendphase;
pub mod hg;
pub mod isotropic;
pub mod rayleigh;
pub mod sggx;
pub mod tabphase;
#[cfg(test)]
mod tests;

use crate::builder::Builder;
use crate::plugin::{Plugin, plugin};
use crate::volume::gridvolume::GridVolume;
use etendue_document::Parameters;
use etendue_math::Frame;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

/// The list of phase functions: one line is one plugin, its XML `type`, which is its module as well, and
/// what the scene holds of it, which is a [`PhaseModel`].
macro_rules! phase_list {
    ($macro:ident) => {
        $macro! {
            blendphase => Blend(Box<blendphase::Blend>);
            hg => HenyeyGreenstein(hg::HenyeyGreenstein);
            isotropic => Isotropic(isotropic::Isotropic);
            rayleigh => Rayleigh(rayleigh::Rayleigh);
            sggx => Sggx(sggx::Sggx);
            tabphase => Tabulated(Box<tabphase::Tabulated>);
        }
    };
}

/// What a phase function plugin computes; see the module's contract.
pub(crate) trait PhaseModel {
    /// See [`PhaseFunction::eval`].
    fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32;

    /// See [`PhaseFunction::sample`].
    fn sample(
        &self,
        interaction: &MediumInteraction,
        part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample>;

    /// See [`PhaseFunction::projected_area`]; 1 for all but microflakes.
    fn projected_area(&self, _interaction: &MediumInteraction) -> f32 {
        1.0
    }

    /// The greatest value that [`projected_area`](Self::projected_area) takes anywhere.
    fn greatest_area(&self) -> f32 {
        1.0
    }

    /// Whether the projected area is one everywhere: there are no microflakes.
    fn shows_one_area(&self) -> bool {
        true
    }

    /// Whether the projected area is the same everywhere for a direction.
    fn is_uniform(&self) -> bool {
        true
    }

    /// Adds the grids that the phase function reads, if it reads any.
    fn collect_grids<'a>(&'a self, _grids: &mut Vec<&'a Arc<GridVolume>>) {}
}

/// Makes the enum of phase functions, its dispatch and the registry from the list.
macro_rules! phases {
    ($($module:ident => $name:ident($type:ty);)*) => {
        /// A phase function of the scene.
        #[derive(Clone, Debug)]
        pub enum PhaseFunction {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($type),)*
        }

        /// Every phase function.
        pub static PHASES: &[Plugin<BuildPhase>] = &[
            $(plugin(stringify!($module), &$module::MANUAL, |builder, parameters| {
                let phase = $module::build(builder, parameters)?;
                Some(PhaseFunction::$name(phase.into()))
            }),)*
        ];

        /// Runs `$work` with the [`PhaseModel`] of a phase function.
        macro_rules! with_phase {
            ($phase_function:expr, $phase:ident => $work:expr) => {
                match $phase_function {
                    $(PhaseFunction::$name($phase) => $work,)*
                }
            };
        }
    };
}

#[cfg(test)]
use phase_list;

phase_list!(phases);

/// Builds a phase function.
pub type BuildPhase = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<PhaseFunction>;

/// Where light is scattered.
#[derive(Clone, Copy, Debug)]
pub struct MediumInteraction {
    /// The place.
    pub point: Vec3,
    /// Where the path comes from.
    pub wi: Vec3,
}

/// A direction that a phase function chose.
#[derive(Clone, Copy, Debug)]
pub struct PhaseSample {
    /// Where the path goes on.
    pub wo: Vec3,
    /// The density in solid angle, which is the value as well.
    pub pdf: f32,
}

impl PhaseFunction {
    /// The density of `wo`; see the module's contract.
    #[inline]
    #[must_use]
    pub fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32 {
        with_phase!(self, phase => phase.eval(interaction, wo))
    }

    /// Chooses `wo`; `None` where it fails. `part` and `direction` are uniform in [0, 1).
    #[inline]
    #[must_use]
    pub fn sample(
        &self,
        interaction: &MediumInteraction,
        part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        with_phase!(self, phase => phase.sample(interaction, part, direction))
    }

    /// What the extinction along a direction is multiplied by: the area of microflakes seen from it,
    /// and 1 for all others.
    #[inline]
    #[must_use]
    pub fn projected_area(&self, interaction: &MediumInteraction) -> f32 {
        with_phase!(self, phase => phase.projected_area(interaction))
    }

    /// The greatest value that [`Self::projected_area`] takes anywhere.
    #[must_use]
    pub fn greatest_area(&self) -> f32 {
        with_phase!(self, phase => phase.greatest_area())
    }

    /// Whether the projected area is one everywhere: there are no microflakes.
    fn shows_one_area(&self) -> bool {
        with_phase!(self, phase => phase.shows_one_area())
    }

    /// Adds the grids that the phase function reads.
    pub(crate) fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        with_phase!(self, phase => phase.collect_grids(grids));
    }

    /// Whether the projected area is the same everywhere for a direction.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        with_phase!(self, phase => phase.is_uniform())
    }
}

/// The cosine of the scattering angle: 1 where light goes straight on.
#[inline]
fn forwardness(interaction: &MediumInteraction, wo: Vec3) -> f32 {
    -interaction.wi.dot(wo)
}

/// The direction that turns light at `interaction` by an angle of the cosine `forwardness`, at an azimuth of
/// `turn` (in whole turns).
#[inline]
fn deflected(interaction: &MediumInteraction, forwardness: f32, turn: f32) -> Vec3 {
    let sine = (1.0 - forwardness * forwardness).max(0.0).sqrt();
    let (y, x) = (TAU * turn).sin_cos();
    Frame::from_normal(-interaction.wi).to_world(Vec3::new(sine * x, sine * y, forwardness))
}
