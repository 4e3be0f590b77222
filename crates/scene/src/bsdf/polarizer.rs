//! `polarizer`: an ideal linear polarizer, in its effect on unpolarised light.

use super::null::Null;
use crate::builder::Builder;
use crate::manual::{Manual, ParameterManual, parameter};
use crate::models::bsdf_inputs::reflectance;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use etendue_document::Parameters;

/// The parameter that all polarisation filters have.
pub(crate) const TRANSMITTANCE: ParameterManual = parameter(
    "transmittance",
    "spectrum or texture",
    "1",
    "A factor on the light that is let through.",
);

/// The fraction of unpolarised light that an ideal polarizer passes (Malus' law, averaged over all
/// angles).
pub(crate) const SHARE: f32 = 0.5;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "An ideal linear polarizer: half of the light goes straight through. Light is unpolarised \
              here, so that two crossed polarizers let a quarter through, as in the unpolarised modes \
              of Mitsuba.",
    parameters: &[
        parameter(
            "theta",
            "float or texture",
            "0",
            "The angle of the transmitting axis (degrees). Unpolarised light knows none.",
        ),
        TRANSMITTANCE,
        parameter(
            "polarizing",
            "boolean",
            "true",
            "Whether light leaves polarised. Unpolarised light is halved in either case.",
        ),
    ],
    sample: r#"<bsdf type="polarizer">
    <float name="theta" value="30"/>
    <rgb name="transmittance" value="0.9, 0.9, 0.8"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="polarizer"/>"#),
        plain(r#"<bsdf type="polarizer"><float name="theta" value="30"/><rgb name="transmittance" value="0.2, 0.4, 0.8"/><boolean name="polarizing" value="false"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="polarizer"><float name="transmittance" value="0"/></bsdf>"#,
    ],
    batched: &[],
};

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Null> {
    // The parameters have no effect. They are read only to report mistakes; see the manual.
    builder.scalar(parameters, "theta", 0.0);
    parameters.boolean("polarizing", true);
    Some(Null::filter(reflectance(builder, parameters, "transmittance", 1.0), SHARE))
}

#[cfg(test)]
mod tests {
    use crate::testing::material::{TestMaterial, assert_same};
    use etendue_spectrum::Spectrum;
    use glam::Vec3;

    #[test]
    fn half_of_the_light_goes_straight_on() {
        let polarizer = TestMaterial::read(
            r#"<bsdf type="polarizer"><rgb name="transmittance" value="0.2, 0.4, 0.8"/></bsdf>"#,
        );
        for wi in [Vec3::new(0.6, 0.0, 0.8), -Vec3::Z] {
            let null_transmission = polarizer.bsdf(wi).null_transmission(wi);
            assert_eq!(null_transmission, (Spectrum::from_rgb([0.1, 0.2, 0.4]), 1.0));
        }
    }

    #[test]
    fn unpolarised_light_knows_no_angle() {
        assert_same(
            r#"<bsdf type="polarizer"/>"#,
            r#"<bsdf type="polarizer"><float name="theta" value="70"/>
               <boolean name="polarizing" value="false"/></bsdf>"#,
        );
    }
}
