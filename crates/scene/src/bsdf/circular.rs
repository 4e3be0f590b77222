//! `circular`: an ideal circular polarizer, in its effect on unpolarised light.

use super::null::Null;
use super::polarizer::{SHARE, TRANSMITTANCE};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::reflectance;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "An ideal circular polarizer: half of the light goes straight through, which stays \
              unpolarised here; see `polarizer`.",
    parameters: &[
        TRANSMITTANCE,
        parameter(
            "left_handed",
            "boolean",
            "false",
            "The handedness that is let through. Of unpolarised light it is half in either case.",
        ),
    ],
    sample: r#"<bsdf type="circular"><float name="transmittance" value="0.9"/></bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="circular"><rgb name="transmittance" value="0.2, 0.4, 0.8"/><boolean name="left_handed" value="true"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="circular"><float name="transmittance" value="0"/></bsdf>"#,
    ],
    batched: &[],
};

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Null> {
    // The parameter has no effect. It is read only to report mistakes; see the manual.
    parameters.boolean("left_handed", false);
    Some(Null::filter(reflectance(builder, parameters, "transmittance", 1.0), SHARE))
}

#[cfg(test)]
mod tests {
    use crate::testing::material::assert_same;

    #[test]
    fn it_is_a_linear_polarizer_to_unpolarised_light() {
        assert_same(
            r#"<bsdf type="circular"><float name="transmittance" value="0.7"/></bsdf>"#,
            r#"<bsdf type="polarizer"><float name="transmittance" value="0.7"/></bsdf>"#,
        );
    }
}
