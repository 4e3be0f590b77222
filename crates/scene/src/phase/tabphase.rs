//! `tabphase`: a tabulated phase function.

#[cfg(test)]
use super::tests::Cases;
use super::{MediumInteraction, PhaseModel, PhaseSample, deflected, forwardness};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_sampling::warp;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A phase function as a table over the cosine of the scattering angle: values at evenly \
              spaced cosines from −1 (back) to 1 (straight on), linear in between, scaled so that \
              they integrate to one.",
    parameters: &[parameter(
        "values",
        "string",
        "",
        "Two values or more, separated by commas or spaces; required.",
    )],
    sample: r#"<phase type="tabphase"><string name="values" value="0.5, 1.0, 1.5"/></phase>"#,
};

/// The cases for the tests of all phase functions.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        r#"<phase type="tabphase"><string name="values" value="0.5, 0, 0 2 1.5"/></phase>"#,
        r#"<phase type="tabphase"><string name="values" value="0 1"/></phase>"#,
    ],
    extreme: &[
        r#"<phase type="tabphase"><string name="values" value="0 0 1e30"/></phase>"#,
        r#"<phase type="tabphase"><string name="values" value="1e-30 0"/></phase>"#,
    ],
};

/// A table over the cosine of the scattering angle.
#[derive(Clone, Debug)]
pub struct Tabulated {
    /// Densities of the cosine at the nodes of the table.
    densities: Vec<f32>,
    /// The cumulative distribution at each node.
    cumulative: Vec<f32>,
}

/// Reads the parameters.
#[must_use]
pub fn build(_builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Tabulated> {
    let text = parameters.required_string("values")?;
    let words = text.split([',', ' ', '\t', '\n', '\r']).filter(|word| !word.is_empty());
    let mut values = Vec::new();
    for word in words {
        match word.parse::<f32>() {
            Ok(value) if value.is_finite() && value >= 0.0 => values.push(value),
            _ => {
                let message = format!("`{word}` is not a valid value of a phase function");
                parameters.error(Fault::BadValue, "values", message);
                return None;
            }
        }
    }
    let table = Tabulated::new(&values);
    if table.is_none() {
        let message = "a table has two values or more, and not all of them zero";
        parameters.error(Fault::BadValue, "values", message);
    }
    table
}

impl Tabulated {
    /// A table of finite, nonnegative values; `None` if there are fewer than two, or if all are
    /// zero.
    fn new(values: &[f32]) -> Option<Self> {
        let step = 2.0 / (values.len().max(2) - 1) as f64;
        let mut cumulative = vec![0.0];
        for pair in values.windows(2) {
            let area = 0.5 * step * (f64::from(pair[0]) + f64::from(pair[1]));
            cumulative.push(cumulative[cumulative.len() - 1] + area);
        }
        let sum = cumulative[cumulative.len() - 1];
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            densities: values.iter().map(|value| (f64::from(*value) / sum) as f32).collect(),
            cumulative: cumulative.iter().map(|below| (below / sum) as f32).collect(),
        })
    }

    /// The density of a direction, by the cosine of the scattering angle.
    fn density(&self, cosine: f32) -> f32 {
        let intervals = self.densities.len() - 1;
        let place = 0.5 * (cosine.clamp(-1.0, 1.0) + 1.0) * intervals as f32;
        let index = (place as usize).min(intervals - 1);
        let share = place - index as f32;
        let (low, high) = (self.densities[index], self.densities[index + 1]);
        (low + share * (high - low)) / TAU
    }
}

impl PhaseModel for Tabulated {
    fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32 {
        self.density(forwardness(interaction, wo))
    }

    /// Inverts the distribution of the cosine.
    fn sample(
        &self,
        interaction: &MediumInteraction,
        _part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        let intervals = self.densities.len() - 1;
        let above = self.cumulative.partition_point(|below| *below <= direction.x);
        let index = above.clamp(1, intervals) - 1;
        let (below, end) = (self.cumulative[index], self.cumulative[index + 1]);
        let rest = ((direction.x - below) / (end - below)).clamp(0.0, 1.0);
        let share = warp::linear::sample(rest, self.densities[index], self.densities[index + 1]);
        let cosine = (2.0 * (index as f32 + share) / intervals as f32 - 1.0).clamp(-1.0, 1.0);
        let wo = deflected(interaction, cosine, direction.y);
        Some(PhaseSample { wo, pdf: self.density(cosine) })
    }
}
