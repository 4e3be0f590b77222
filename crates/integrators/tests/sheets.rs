//! Alpha and hidden emitters behind masks, `null` and thin sheets.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_integrators::{
    CameraRay, Integrator, IntegratorOptions, Start, Watch, build_integrator,
};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_sampling::{SamplerKind, SamplerSpec};
use etendue_scene::{BuildOptions, Scene, build_scene};
use glam::{UVec2, Vec3};

struct Setup {
    scene: Scene,
    integrator: Box<dyn Integrator>,
}

fn setup(integrator: &str, body: &str) -> Setup {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default();
    let text =
        format!(r#"<scene version="3.0.0">{integrator}{body}<sensor type="perspective"/></scene>"#);
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
        .unwrap_or_else(|_| panic!("{text}: {:?}", diagnostics.sorted()));
    let scene = build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
        .unwrap_or_else(|| panic!("{text}: {:?}", diagnostics.sorted()));
    let integrator = build_integrator(&document, &IntegratorOptions::default(), &diagnostics)
        .unwrap_or_else(|| panic!("{text}: {:?}", diagnostics.sorted()));
    Setup { scene, integrator }
}

const SAMPLES: u32 = 4096;

impl Setup {
    /// The mean luminance and alpha along the z axis, one by one and in a batch.
    fn look(&self) -> [[f64; 2]; 2] {
        let spec = SamplerSpec::new(SamplerKind::Independent, SAMPLES, 7);
        let start = Start { ray: Ray::new(Vec3::Z * 5.0, Vec3::NEG_Z), medium: None };
        let ray = |index| CameraRay { start, sampler: spec.start(UVec2::ZERO, index) };
        let mut rays: Vec<CameraRay> = (0..SAMPLES).map(ray).collect();
        let mut channels = vec![0.0; self.integrator.channels().len()];
        let watch = Watch::patient();
        let alone: Vec<_> = rays
            .clone()
            .iter_mut()
            .map(|CameraRay { start, sampler }| {
                self.integrator.sample(&self.scene, start, sampler, &mut channels, &watch)
            })
            .collect();
        let mut together = Vec::new();
        let mut channels = vec![0.0; channels.len() * rays.len()];
        self.integrator.sample_batch(&self.scene, &mut rays, &mut channels, &watch, &mut together);
        [alone, together].map(|seen| {
            let mean = |values: &mut dyn Iterator<Item = f32>| {
                values.map(f64::from).sum::<f64>() / f64::from(SAMPLES)
            };
            [
                mean(&mut seen.iter().map(|radiance| radiance.color.luminance())),
                mean(&mut seen.iter().map(|radiance| radiance.alpha)),
            ]
        })
    }
}

fn integrators(parameters: &str) -> impl Iterator<Item = String> {
    let plain = ["path", "direct", "volpath", "volpathmis"]
        .map(|name| format!(r#"<integrator type="{name}">{parameters}</integrator>"#));
    let nested = ["aov", "moment"]
        .map(|name| format!(r#"<integrator type="{name}">{}</integrator>"#, plain[0]));
    plain.into_iter().chain(nested)
}

fn assert_sees(parameters: &str, body: &str, [light, alpha]: [f64; 2]) {
    for integrator in integrators(parameters) {
        for seen in setup(&integrator, body).look() {
            let far = |found: f64, expected: f64| (found - expected).abs() > 0.035;
            let what = format!("{integrator} {body}: {seen:?}");
            assert!(!far(seen[0], light) && !far(seen[1], alpha), "{what}");
        }
    }
}

const MASK: &str =
    r#"<bsdf type="mask"><float name="opacity" value="0"/><bsdf type="diffuse"/></bsdf>"#;
const HALF: &str =
    r#"<bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="diffuse"/></bsdf>"#;
const NULL: &str = r#"<bsdf type="null"/>"#;
/// A sheet that reflects nothing. Glass of any other index does.
const THIN: &str = r#"<bsdf type="thindielectric"><float name="int_ior" value="1.0001"/>
    <float name="ext_ior" value="1"/></bsdf>"#;
const SHEETS: [&str; 3] = [MASK, NULL, THIN];

/// A large square in front of the camera.
fn sheet(bsdf: &str) -> String {
    format!(
        r#"<shape type="rectangle"><transform name="to_world"><scale value="5"/></transform>{bsdf}</shape>"#
    )
}

/// A square behind the sheet, turned by `angle` degrees.
fn behind(angle: u32, inside: &str) -> String {
    format!(
        r#"<shape type="rectangle"><transform name="to_world"><scale value="5"/>
        <rotate y="1" angle="{angle}"/><translate z="-1"/></transform>{inside}</shape>"#
    )
}

const LAMP: &str = r#"<emitter type="point"><point name="position" x="0" y="0" z="3"/></emitter>"#;
const SKY: &str = r#"<emitter type="constant"/>"#;
const HIDE: &str = r#"<boolean name="hide_emitters" value="true"/>"#;

#[test]
fn what_scatters_nothing_is_opaque_behind_a_sheet() {
    for bsdf in SHEETS {
        let front = sheet(bsdf);
        let turned_away = behind(180, r#"<bsdf type="diffuse"/>"#);
        assert_sees("", &format!("{front}{turned_away}{LAMP}"), [0.0, 1.0]);
        let black = r#"<bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf>"#;
        assert_sees("", &format!("{front}{}{LAMP}", behind(0, black)), [0.0, 1.0]);
        let glowing = r#"<emitter type="area"/>"#;
        assert_sees("", &format!("{front}{}", behind(0, glowing)), [1.0, 1.0]);
        assert_sees("", &format!("{front}{}", behind(180, glowing)), [0.0, 1.0]);
        assert_sees("", &format!("{front}{LAMP}"), [0.0, 0.0]);
        assert_sees("", &format!("{front}{SKY}"), [1.0, 1.0]);
    }
}

#[test]
fn both_faces_of_a_masked_ball_cover_their_share() {
    let ball = r#"<shape type="sphere"><bsdf type="mask"><float name="opacity" value="0.4"/>
        <bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf></bsdf></shape>"#;
    for name in ["path", "volpath", "volpathmis"] {
        let integrator = format!(r#"<integrator type="{name}"/>"#);
        for [_, alpha] in setup(&integrator, &format!("{ball}{LAMP}")).look() {
            assert!((alpha - 0.64).abs() < 0.035, "{name}: {alpha}");
        }
    }
}

#[test]
fn hidden_emitters_stay_hidden_behind_a_sheet() {
    let lamp = behind(0, r#"<emitter type="area"/>"#);
    for bsdf in SHEETS {
        for light in [SKY, &lamp] {
            assert_sees(HIDE, &format!("{}{light}", sheet(bsdf)), [0.0, 0.0]);
        }
    }
    // Half of the sheet reflects half of the light.
    assert_sees(HIDE, &format!("{}{SKY}", sheet(HALF)), [0.25, 0.5]);
}
