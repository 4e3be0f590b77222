//! `retarder`: an ideal linear retarder (a wave plate), in its effect on unpolarised light.

use super::null::Null;
use super::polarizer::TRANSMITTANCE;
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::reflectance;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless, plain};
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "An ideal linear retarder, or wave plate: all light goes straight through. A shift of \
              phase changes polarised light alone, and light is unpolarised here.",
    parameters: &[
        parameter(
            "theta",
            "float or texture",
            "0",
            "The angle of the fast axis (degrees). Unpolarised light knows none.",
        ),
        parameter(
            "delta",
            "float or texture",
            "90",
            "The phase between the slow and the fast axis (degrees). Unpolarised light knows none.",
        ),
        TRANSMITTANCE,
    ],
    sample: r#"<bsdf type="retarder"><float name="delta" value="180"/></bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="retarder"><float name="theta" value="30"/><float name="delta" value="45"/><rgb name="transmittance" value="0.2, 0.4, 0.8"/></bsdf>"#),
        lossless(r#"<bsdf type="retarder"/>"#),
    ],
    extreme: &[
        r#"<bsdf type="retarder"><float name="transmittance" value="0"/><float name="delta" value="1e30"/></bsdf>"#,
    ],
    batched: &[],
};

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Null> {
    // The parameters have no effect. They are read only to report mistakes; see the manual.
    builder.scalar(parameters, "theta", 0.0);
    builder.scalar(parameters, "delta", 90.0);
    Some(Null::filter(reflectance(builder, parameters, "transmittance", 1.0), 1.0))
}

#[cfg(test)]
mod tests {
    use crate::testing::material::assert_same;

    #[test]
    fn a_clear_plate_is_nothing_to_unpolarised_light() {
        assert_same(
            r#"<bsdf type="retarder"><float name="theta" value="20"/></bsdf>"#,
            r#"<bsdf type="null"/>"#,
        );
    }
}
