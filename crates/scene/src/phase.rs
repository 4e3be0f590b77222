//! Phase functions: how media scatter light.
//!
//! # Contract
//! - `wi` and `wo` are unit vectors in world space that point away from the scattering point. `wi`
//!   points back along the path. Light that is not deflected has `wo` = −`wi`.
//! - The value of a phase function is its density in solid angle. It integrates to one. Sampling
//!   follows it exactly, so samples have no weight.
//! - [`PhaseFunction::sample`] takes one random number to choose among components and two for the
//!   direction.

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

/// The list of phase functions, one line per plugin: its XML `type`, which is also its module, and
/// the [`PhaseModel`] that the scene stores.
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

/// The interface of a phase function plugin; see the module's contract.
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

    /// See [`PhaseFunction::projected_area`]; 1 except for microflakes.
    fn projected_area(&self, _interaction: &MediumInteraction) -> f32 {
        1.0
    }

    /// The maximum of [`projected_area`](Self::projected_area).
    fn greatest_area(&self) -> f32 {
        1.0
    }

    /// Whether the projected area is one everywhere, that is, there are no microflakes.
    fn shows_one_area(&self) -> bool {
        true
    }

    /// Whether the projected area depends on the direction only, not on the point.
    fn is_uniform(&self) -> bool {
        true
    }

    /// Appends the grids that the phase function reads.
    fn collect_grids<'a>(&'a self, _grids: &mut Vec<&'a Arc<GridVolume>>) {}
}

/// Generates the enum of phase functions, its dispatch and the registry from the list.
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

/// A point of scattering.
#[derive(Clone, Copy, Debug)]
pub struct MediumInteraction {
    /// The point.
    pub point: Vec3,
    /// The unit direction back along the path.
    pub wi: Vec3,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct PhaseSample {
    /// The direction in which the path continues.
    pub wo: Vec3,
    /// The density in solid angle, which is also the value.
    pub pdf: f32,
}

impl PhaseFunction {
    /// The density of `wo`; see the module's contract.
    #[inline]
    #[must_use]
    pub fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32 {
        with_phase!(self, phase => phase.eval(interaction, wo))
    }

    /// Samples `wo`; `None` on failure. `part` and `direction` are uniform in [0, 1).
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

    /// The factor by which the extinction depends on direction: the projected area of microflakes,
    /// and 1 for other phase functions.
    #[inline]
    #[must_use]
    pub fn projected_area(&self, interaction: &MediumInteraction) -> f32 {
        with_phase!(self, phase => phase.projected_area(interaction))
    }

    /// The maximum of [`Self::projected_area`].
    #[must_use]
    pub fn greatest_area(&self) -> f32 {
        with_phase!(self, phase => phase.greatest_area())
    }

    /// Whether the projected area is one everywhere, that is, there are no microflakes.
    fn shows_one_area(&self) -> bool {
        with_phase!(self, phase => phase.shows_one_area())
    }

    /// Appends the grids that the phase function reads.
    pub(crate) fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        with_phase!(self, phase => phase.collect_grids(grids));
    }

    /// Whether the projected area depends on the direction only, not on the point.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        with_phase!(self, phase => phase.is_uniform())
    }
}

/// The cosine of the scattering angle; 1 for no deflection.
#[inline]
fn forwardness(interaction: &MediumInteraction, wo: Vec3) -> f32 {
    -interaction.wi.dot(wo)
}

/// Deflects the light at `interaction` by the angle whose cosine is `forwardness`. `turn` is the
/// azimuth in whole turns.
#[inline]
fn deflected(interaction: &MediumInteraction, forwardness: f32, turn: f32) -> Vec3 {
    let sine = (1.0 - forwardness * forwardness).max(0.0).sqrt();
    let (y, x) = (TAU * turn).sin_cos();
    Frame::from_normal(-interaction.wi).to_world(Vec3::new(sine * x, sine * y, forwardness))
}
