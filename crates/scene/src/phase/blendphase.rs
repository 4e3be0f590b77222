//! `blendphase`: a mixture of two phase functions.

#[cfg(test)]
use super::tests::Cases;
use super::{MediumInteraction, PhaseFunction, PhaseModel, PhaseSample};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use crate::volume::Volume;
use crate::volume::gridvolume::GridVolume;
use etendue_document::{Class, Fault, Parameters};
use etendue_spectrum::SpectrumUse;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A mixture of two phase functions: at a weight of 0 the first, at 1 the second. Named \
              ones count in the order of their names.",
    parameters: &[
        parameter("weight", "float or volume", "0.5", "The share of the second, from 0 to 1."),
        parameter("(nested)", "phase", "", "The two phase functions."),
    ],
    sample: r#"<phase type="blendphase">
    <float name="weight" value="0.2"/>
    <phase name="phase_0" type="isotropic"/>
    <phase name="phase_1" type="hg"><float name="g" value="0.2"/></phase>
</phase>"#,
};

/// The cases for the tests of all phase functions.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        r#"<phase type="blendphase"><float name="weight" value="0.3"/><phase type="rayleigh"/><phase type="hg"/></phase>"#,
        r#"<phase type="blendphase"><phase name="b" type="hg"/><phase name="a" type="blendphase"><phase type="isotropic"/><phase type="rayleigh"/></phase></phase>"#,
    ],
    extreme: &[
        r#"<phase type="blendphase"><float name="weight" value="1e-30"/><phase type="rayleigh"/><phase type="hg"><float name="g" value="0.99999"/></phase></phase>"#,
        r#"<phase type="blendphase"><float name="weight" value="1"/><phase type="isotropic"/><phase type="rayleigh"/></phase>"#,
    ],
};

/// A mixture of two phase functions.
#[derive(Clone, Debug)]
pub struct Blend {
    weight: Volume,
    parts: [PhaseFunction; 2],
}

/// Reads the parameters.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Blend> {
    let weight = builder.volume_or_color(parameters, "weight", 0.5, SpectrumUse::Unbounded)?;
    let [low, high] = weight.range();
    if low < 0.0 || high > 1.0 {
        let message = "a weight is below 0 or above 1: it is limited to that";
        parameters.warning(Fault::BadValue, "weight", message);
    }
    let mut children = parameters.children_of(Class::Phase);
    // Named children come first, in the order of their names, as in Mitsuba. The others follow in
    // the order of the file.
    children.sort_by(|a, b| match (&a.name, &b.name) {
        (Some(a), Some(b)) => a.cmp(b),
        (a, b) => b.is_some().cmp(&a.is_some()),
    });
    let parts: Vec<PhaseFunction> =
        children.iter().filter_map(|child| builder.phase(child.node)).collect();
    match <[PhaseFunction; 2]>::try_from(parts) {
        Ok(parts) => Some(Blend { weight, parts }),
        Err(parts) => {
            // Failures to build have been reported.
            if children.len() != 2 {
                let message = format!("a blend has two phase functions, not {}", parts.len());
                parameters.error(Fault::MissingParameter, "", message);
            }
            None
        }
    }
}

impl Blend {
    #[inline]
    fn shares(&self, interaction: &MediumInteraction) -> [f32; 2] {
        let second = self.weight.eval_scalar(interaction.point);
        // A NaN weight counts as 0.
        let second = if second > 0.0 { second.min(1.0) } else { 0.0 };
        [1.0 - second, second]
    }
}

impl PhaseModel for Blend {
    fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32 {
        let shares = self.shares(interaction);
        self.parts
            .iter()
            .zip(shares)
            .map(|(phase, share)| share * phase.eval(interaction, wo))
            .sum()
    }

    fn sample(
        &self,
        interaction: &MediumInteraction,
        part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        let shares = self.shares(interaction);
        let second = part < shares[1];
        let (phase, part) = if second {
            (&self.parts[1], part / shares[1])
        } else {
            (&self.parts[0], (part - shares[1]) / shares[0])
        };
        let sample = phase.sample(interaction, part.min(1.0 - f32::EPSILON), direction)?;
        Some(PhaseSample { pdf: self.eval(interaction, sample.wo), ..sample })
    }

    fn projected_area(&self, interaction: &MediumInteraction) -> f32 {
        let shares = self.shares(interaction);
        self.parts
            .iter()
            .zip(shares)
            .map(|(phase, share)| share * phase.projected_area(interaction))
            .sum()
    }

    fn greatest_area(&self) -> f32 {
        self.parts.iter().map(PhaseFunction::greatest_area).fold(0.0, f32::max)
    }

    fn is_uniform(&self) -> bool {
        let has_one_weight = self.weight.as_constant().is_some();
        self.parts.iter().all(PhaseFunction::is_uniform)
            && (has_one_weight || self.parts.iter().all(PhaseFunction::shows_one_area))
    }

    fn shows_one_area(&self) -> bool {
        self.parts.iter().all(PhaseFunction::shows_one_area)
    }

    fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        grids.extend(self.weight.grid());
        self.parts.iter().for_each(|part| part.collect_grids(grids));
    }
}
