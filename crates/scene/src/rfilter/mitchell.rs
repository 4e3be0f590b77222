//! `mitchell`: a cubic that trades blurring for ringing.

use super::{Profile, ReconstructionFilter};
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Mitchell and Netravali's piecewise cubic (\"Reconstruction Filters in Computer \
              Graphics\", 1988). Sharper than the Gaussian; its small negative lobes can make dark \
              seams beside very bright pixels.",
    parameters: &[
        parameter("B", "float", "0.333333", "Blur, from 0 to 1."),
        parameter("C", "float", "0.333333", "Ringing, from 0 to 1."),
    ],
    sample: r#"<rfilter type="mitchell"><float name="B" value="0.2"/><float name="C" value="0.4"/></rfilter>"#,
};

/// Equation 8 of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mitchell {
    b: f32,
    c: f32,
}

impl Default for Mitchell {
    fn default() -> Self {
        Self { b: 1.0 / 3.0, c: 1.0 / 3.0 }
    }
}

/// Reads the filter.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<ReconstructionFilter> {
    let read = |name| parameters.float_in(name, 1.0 / 3.0, 0.0..=1.0) as f32;
    Some(ReconstructionFilter::new(Mitchell { b: read("B"), c: read("C") }.into()))
}

impl Mitchell {
    pub(super) const fn new(b: f32, c: f32) -> Self {
        Self { b, c }
    }

    pub(super) fn radius(self) -> f32 {
        2.0
    }

    pub(super) fn eval(self, distance: f32) -> f32 {
        let (x, b, c) = (distance, self.b, self.c);
        let cubic = if x < 1.0 {
            (12.0 - 9.0 * b - 6.0 * c) * (x * x * x)
                + (-18.0 + 12.0 * b + 6.0 * c) * (x * x)
                + (6.0 - 2.0 * b)
        } else {
            // A polynomial in 2 − x, whose constant and linear terms vanish. It keeps its precision
            // near the end.
            let y = 2.0 - x;
            (b + 6.0 * c) * (y * y * y) - 6.0 * c * (y * y)
        };
        cubic / 6.0
    }
}

impl From<Mitchell> for Profile {
    fn from(filter: Mitchell) -> Self {
        Self::Mitchell(filter)
    }
}
