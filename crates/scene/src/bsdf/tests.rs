//! Tests that every material has to pass, over one table of configurations.

mod energy;
mod hostile;
mod mitsuba;
mod statistics;

use crate::testing::material::TestMaterial;
use glam::{Vec2, Vec3};

/// A material and what is expected of it.
struct Configuration {
    /// The `<bsdf>` element.
    xml: &'static str,
    /// Whether swapping the directions changes nothing, but for the adjoint of refraction.
    reciprocal: bool,
    /// Whether it scatters all light in one way or another, once the light is let go on.
    lossless: bool,
}

const fn plain(xml: &'static str) -> Configuration {
    Configuration { xml, reciprocal: true, lossless: false }
}

const fn lossless(xml: &'static str) -> Configuration {
    Configuration { xml, reciprocal: true, lossless: true }
}

/// Shadowed bumps are not reciprocal, nor is what `principledthin` hides, nor measurements made up.
const fn one_way(xml: &'static str) -> Configuration {
    Configuration { xml, reciprocal: false, lossless: false }
}

/// The table: every plugin, several roughnesses, both distributions, isotropic and not.
#[rustfmt::skip]
const CONFIGURATIONS: &[Configuration] = &[
    plain(r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.8"/></bsdf>"#),
    lossless(r#"<bsdf type="diffuse"><float name="reflectance" value="1"/></bsdf>"#),
    plain(r#"<bsdf type="roughdiffuse"><float name="alpha" value="0.5"/></bsdf>"#),
    plain(r#"<bsdf type="roughdiffuse"><boolean name="use_fast_approx" value="true"/></bsdf>"#),
    plain(r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#),
    lossless(r#"<bsdf type="conductor"/>"#),
    plain(r#"<bsdf type="roughconductor"><string name="material" value="Cu"/><float name="alpha" value="0.02"/></bsdf>"#),
    plain(r#"<bsdf type="roughconductor"><float name="alpha" value="0.3"/></bsdf>"#),
    plain(r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.6"/></bsdf>"#),
    plain(r#"<bsdf type="roughconductor"><float name="alpha" value="0.4"/><boolean name="sample_visible" value="false"/></bsdf>"#),
    plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.05"/></bsdf>"#),
    plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.7"/></bsdf>"#),
    plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value="0.5"/><float name="alpha_v" value="0.1"/></bsdf>"#),
    plain(r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.3"/><boolean name="sample_visible" value="false"/></bsdf>"#),
    lossless(r#"<bsdf type="dielectric"/>"#),
    plain(r#"<bsdf type="dielectric"><string name="int_ior" value="water"/><rgb name="specular_transmittance" value="0.3, 0.5, 0.8"/></bsdf>"#),
    lossless(r#"<bsdf type="thindielectric"/>"#),
    lossless(r#"<bsdf type="null"/>"#),
    plain(r#"<bsdf type="roughdielectric"><float name="alpha" value="0.1"/></bsdf>"#),
    plain(r#"<bsdf type="roughdielectric"><float name="alpha_u" value="0.5"/><float name="alpha_v" value="0.2"/><rgb name="specular_reflectance" value="0.9, 0.5, 0.7"/></bsdf>"#),
    plain(r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value="0.5"/></bsdf>"#),
    plain(r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value="0.3"/><float name="int_ior" value="1"/><float name="ext_ior" value="1.7"/></bsdf>"#),
    plain(r#"<bsdf type="roughdielectric"><float name="alpha" value="0.4"/><boolean name="sample_visible" value="false"/></bsdf>"#),
    plain(r#"<bsdf type="plastic"><boolean name="nonlinear" value="true"/></bsdf>"#),
    lossless(r#"<bsdf type="plastic"><float name="diffuse_reflectance" value="1"/></bsdf>"#),
    plain(r#"<bsdf type="roughplastic"><float name="alpha" value="0.1"/><boolean name="nonlinear" value="true"/></bsdf>"#),
    plain(r#"<bsdf type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value="0.4"/></bsdf>"#),
    plain(r#"<bsdf type="principled"/>"#),
    plain(r#"<bsdf type="principled"><float name="metallic" value="0.8"/><float name="roughness" value="0.3"/><float name="anisotropic" value="0.7"/><float name="spec_tint" value="0.5"/></bsdf>"#),
    plain(r#"<bsdf type="principled"><float name="clearcoat" value="1"/><float name="roughness" value="0.8"/><float name="flatness" value="0.7"/><float name="sheen" value="0.5"/><float name="sheen_tint" value="0.5"/></bsdf>"#),
    plain(r#"<bsdf type="principled"><float name="spec_trans" value="0.8"/><float name="roughness" value="0.6"/><float name="clearcoat" value="0.5"/><float name="eta" value="1.4"/></bsdf>"#),
    plain(r#"<bsdf type="principled"><float name="spec_trans" value="1"/><float name="base_color" value="1"/><float name="eta" value="0.8"/></bsdf>"#),
    plain(r#"<bsdf type="principledthin"><float name="diff_trans" value="0.7"/><float name="sheen" value="0.3"/></bsdf>"#),
    one_way(r#"<bsdf type="principledthin"><float name="spec_trans" value="0.7"/><float name="diff_trans" value="0.7"/><float name="roughness" value="0.7"/><float name="anisotropic" value="0.5"/></bsdf>"#),
    one_way(r#"<bsdf type="hair"/>"#),
    one_way(r#"<bsdf type="hair"><rgb name="sigma_a" value="0.1, 0.2, 0.5"/><float name="longitudinal_roughness" value="0.6"/><float name="azimuthal_roughness" value="0.8"/><float name="scale_tilt" value="5"/></bsdf>"#),
    Configuration { xml: r#"<bsdf type="hair"><float name="sigma_a" value="0"/></bsdf>"#, reciprocal: false, lossless: true },
    one_way(r#"<bsdf type="measured"><string name="filename" value="isotropic.bsdf"/></bsdf>"#),
    one_way(r#"<bsdf type="measured"><string name="filename" value="anisotropic.bsdf"/></bsdf>"#),
    one_way(r#"<bsdf type="measured"><string name="filename" value="quarter.bsdf"/></bsdf>"#),
    one_way(r#"<bsdf type="measured"><string name="filename" value="spectral.bsdf"/></bsdf>"#),
    plain(r#"<bsdf type="twosided"><bsdf type="roughconductor"><string name="distribution" value="ggx"/></bsdf><bsdf type="diffuse"/></bsdf>"#),
    plain(r#"<bsdf type="mask"><float name="opacity" value="0.3"/><bsdf type="roughplastic"/></bsdf>"#),
    lossless(r#"<bsdf type="mask"><float name="opacity" value="0.3"/><bsdf type="twosided"><bsdf type="conductor"/></bsdf></bsdf>"#),
    plain(r#"<bsdf type="blendbsdf"><float name="weight" value="0.6"/><bsdf type="plastic"/><bsdf type="roughdielectric"/></bsdf>"#),
    plain(r#"<bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"/><bsdf type="mask"><bsdf type="roughconductor"/></bsdf></bsdf>"#),
    one_way(r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.7, 0.4, 0.9"/><bsdf type="roughplastic"/></bsdf>"#),
    one_way(r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.8, 0.4, 0.8"/><bsdf type="roughdielectric"><float name="alpha" value="0.4"/></bsdf></bsdf>"#),
    one_way(r#"<bsdf type="twosided"><bsdf type="normalmap"><rgb name="normalmap" value="0.3, 0.4, 0.9"/><bsdf type="diffuse"/></bsdf></bsdf>"#),
    one_way(r#"<bsdf type="bumpmap"><texture type="checkerboard"/><bsdf type="diffuse"/></bsdf>"#),
    plain(r#"<bsdf type="polarizer"/>"#),
    plain(r#"<bsdf type="polarizer"><float name="theta" value="30"/><rgb name="transmittance" value="0.2, 0.4, 0.8"/><boolean name="polarizing" value="false"/></bsdf>"#),
    plain(r#"<bsdf type="circular"><rgb name="transmittance" value="0.2, 0.4, 0.8"/><boolean name="left_handed" value="true"/></bsdf>"#),
    plain(r#"<bsdf type="retarder"><float name="theta" value="30"/><float name="delta" value="45"/><rgb name="transmittance" value="0.2, 0.4, 0.8"/></bsdf>"#),
    lossless(r#"<bsdf type="retarder"/>"#),
];

impl Configuration {
    fn material(&self) -> TestMaterial {
        TestMaterial::read(self.xml)
    }
}

/// Incident directions on both sides: along the normal, at 45° and at 85°.
fn incident() -> impl Iterator<Item = Vec3> {
    let at = |degrees: f32, side: f32| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        (Vec2::from_angle(0.7) * sine).extend(side * cosine)
    };
    [1.0, -1.0].into_iter().flat_map(move |side| [0.0, 45.0, 85.0].map(|angle| at(angle, side)))
}

#[test]
fn closures_stay_small() {
    assert!(size_of::<super::AnyClosure<'_>>() <= 80, "{}", size_of::<super::AnyClosure<'_>>());
}
