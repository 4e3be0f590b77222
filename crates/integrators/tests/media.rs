//! Closed forms: the expected light in participating media.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_integrators::{Integrator, IntegratorOptions, Start, Watch, build_integrator};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_sampling::{SamplerKind, SamplerSpec};
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_testkit::{Accumulator, welch};
use glam::{UVec2, Vec3};

struct Setup {
    scene: Scene,
    integrator: Box<dyn Integrator>,
}

/// A grid in the unit cube whose extinction varies by cell and colour channel.
fn grid() -> Vec<u8> {
    let header = [1, 3, 2, 2, 3].map(i32::to_le_bytes).concat();
    let bounds = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0].map(f32::to_le_bytes).concat();
    let values: Vec<u8> =
        (0..36_u8).flat_map(|i| (f32::from(i * 7 % 11) * 0.3).to_le_bytes()).collect();
    [b"VOL\x03".to_vec(), header, bounds, values].concat()
}

/// Microflakes in the unit cube that vary by cell.
fn flakes() -> Vec<u8> {
    let header = [1, 2, 1, 1, 6].map(i32::to_le_bytes).concat();
    let bounds = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0].map(f32::to_le_bytes).concat();
    let values = [0.2_f32, 0.9, 0.4, 0.1, 0.0, 0.1, 0.7, 0.3, 0.8, 0.0, -0.2, 0.1];
    [b"VOL\x03".to_vec(), header, bounds, values.map(f32::to_le_bytes).concat()].concat()
}

/// An integrator without a path length limit.
fn unlimited(name: &str) -> String {
    format!(r#"<integrator type="{name}"/>"#)
}

/// An integrator with this maximum path length in edges.
fn limited(name: &str, depth: u32) -> String {
    format!(r#"<integrator type="{name}"><integer name="max_depth" value="{depth}"/></integrator>"#)
}

fn setup(integrator: &str, text: &str, emitter_sampling: bool) -> Setup {
    let diagnostics = Diagnostics::new();
    let resources =
        MemoryResources::default().with("grid.vol", grid()).with("flakes.vol", flakes());
    let text =
        format!(r#"<scene version="3.0.0">{integrator}{text}<sensor type="perspective"/></scene>"#);
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
        .unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    let scene = build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()));
    let options = IntegratorOptions { emitter_sampling, ..IntegratorOptions::default() };
    let integrator = build_integrator(&document, &options, &diagnostics)
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()));
    Setup { scene, integrator }
}

impl Setup {
    /// The radiance along a ray, by channel.
    fn measure(&self, ray: Ray, samples: u32) -> [Accumulator; 3] {
        let spec = SamplerSpec::new(SamplerKind::Independent, samples, 5);
        let mut channels = [(); 3].map(|()| Accumulator::default());
        let start = Start { ray, medium: None };
        for index in 0..samples {
            let mut sampler = spec.start(UVec2::new(3, 4), index);
            let radiance = self.integrator.sample(
                &self.scene,
                &start,
                &mut sampler,
                &mut [],
                &Watch::patient(),
            );
            for (channel, value) in channels.iter_mut().zip(radiance.color.rgb()) {
                channel.add(f64::from(value));
            }
        }
        channels
    }
}

/// Every channel's mean must be within five standard errors of the expected value.
#[track_caller]
fn assert_close(what: &str, found: &[Accumulator; 3], expected: [f64; 3]) {
    for (found, expected) in found.iter().zip(expected) {
        let tolerance = 5.0 * found.standard_error() + 2e-5;
        let (mean, distance) = (found.mean(), (found.mean() - expected).abs());
        assert!(distance < tolerance, "{what}: {mean} instead of {expected} ± {tolerance}");
    }
}

const INTEGRATORS: [&str; 2] = ["volpath", "volpathmis"];

/// A ball of radius 1 around the origin.
fn ball(medium: &str, bsdf: &str) -> String {
    format!(
        r#"<shape type="sphere"><bsdf type="{bsdf}"/><medium name="interior" {medium}</medium></shape>"#
    )
}

const HOMOGENEOUS: &str = r#"type="homogeneous"><rgb name="sigma_t" value="0.3, 1, 2.5"/>"#;

/// A purely absorbing medium of thickness 2: light falls off with exp(−2 σ).
#[test]
fn absorption_is_the_exponential() {
    let expected = [0.3, 1.0, 2.5].map(|sigma: f64| (-2.0 * sigma).exp());
    let constant = r#"type="heterogeneous"><volume name="sigma_t" type="constvolume">
        <rgb name="value" value="0.3, 1, 2.5"/>
        <transform name="to_world"><translate value="-0.5"/><scale value="4"/></transform></volume>"#;
    for medium in [HOMOGENEOUS, constant] {
        let text = ball(&format!(r#"{medium}<float name="albedo" value="0"/>"#), "null")
            + r#"<emitter type="constant"/>"#;
        for integrator in INTEGRATORS {
            let ray = Ray::new(Vec3::new(0.0, 0.0, 4.0), Vec3::NEG_Z);
            let found = setup(&unlimited(integrator), &text, true).measure(ray, 40_000);
            assert_close(&format!("{integrator} {medium}"), &found, expected);
        }
    }
}

/// A medium with albedo one is invisible under uniform light, whatever its phase function.
#[test]
fn a_furnace_stays_even_where_nothing_is_absorbed() {
    let phases = [
        "isotropic\">",
        "rayleigh\">",
        r#"hg"><float name="g" value="0.6"/>"#,
        r#"tabphase"><string name="values" value="1 0.2 3"/>"#,
        r#"sggx"><string name="S" value="0.2 0.9 0.4 0.1 0 0.1"/>"#,
    ];
    let densities = [
        HOMOGENEOUS,
        r#"type="heterogeneous"><float name="scale" value="2"/><volume name="sigma_t" type="gridvolume">
            <string name="filename" value="grid.vol"/>
            <transform name="to_world"><translate value="-0.5"/><scale value="1.5"/></transform></volume>"#,
    ];
    for (density, bsdf) in [
        (densities[0], "null"),
        (densities[0], "thindielectric"),
        (densities[0], "dielectric"),
        (densities[1], "null"),
    ] {
        for phase in phases {
            let medium =
                format!(r#"{density}<float name="albedo" value="1"/><phase type="{phase}</phase>"#);
            let text = ball(&medium, bsdf) + r#"<emitter type="constant"/>"#;
            for integrator in INTEGRATORS {
                let ray = Ray::new(Vec3::new(0.2, 0.1, 4.0), Vec3::NEG_Z);
                let found = setup(&unlimited(integrator), &text, true).measure(ray, 6000);
                assert_close(&format!("{integrator} {medium} {bsdf}"), &found, [1.0; 3]);
            }
        }
    }
}

/// The same for spatially varying flakes: the majorant bounds their extinction.
#[test]
fn a_furnace_of_flakes_on_a_grid_stays_even() {
    let flakes = r#"<phase type="sggx"><volume name="S" type="gridvolume">
        <string name="filename" value="flakes.vol"/>
        <transform name="to_world"><translate value="-0.5"/><scale value="2"/></transform></volume></phase>"#;
    let medium = r#"type="heterogeneous"><float name="albedo" value="1"/><volume name="sigma_t" type="constvolume">
        <float name="value" value="2"/>
        <transform name="to_world"><translate value="-0.5"/><scale value="1.1"/></transform></volume>"#;
    let text = ball(&format!("{medium}{flakes}"), "null") + r#"<emitter type="constant"/>"#;
    for integrator in INTEGRATORS {
        let ray = Ray::new(Vec3::new(0.2, 0.1, 4.0), Vec3::NEG_Z);
        let found = setup(&unlimited(integrator), &text, true).measure(ray, 6000);
        assert_close(integrator, &found, [1.0; 3]);
    }
}

/// Unidirectional sampling and emitter sampling have the same mean.
#[test]
fn both_ways_to_find_light_agree() {
    let medium = r#"type="heterogeneous"><float name="scale" value="2"/>
        <volume name="sigma_t" type="gridvolume"><string name="filename" value="grid.vol"/>
        <transform name="to_world"><translate value="-0.5"/><scale value="1.5"/></transform></volume>
        <rgb name="albedo" value="0.9, 0.6, 0.8"/><phase type="hg"><float name="g" value="0.4"/></phase>"#;
    let emitters = r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>
        <translate y="1.7"/></transform><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="3"/><translate z="-1.5"/></transform></shape>"#;
    let ray = Ray::new(Vec3::new(0.3, 0.2, 4.0), Vec3::NEG_Z);
    for bsdf in ["null", "thindielectric"] {
        let text = ball(medium, bsdf) + emitters;
        let means: Vec<[Accumulator; 3]> = INTEGRATORS
            .iter()
            .flat_map(|name| [true, false].map(|sampling| (name, sampling)))
            .map(|(name, sampling)| setup(&unlimited(name), &text, sampling).measure(ray, 60_000))
            .collect();
        for other in &means[1..] {
            for (one, other) in means[0].iter().zip(other) {
                let outcome = welch(one, other);
                assert!(outcome.accepts(1e-4), "{bsdf}: {} {}", one.mean(), other.mean());
            }
        }
    }
}

/// Single scattering in a thin medium under a distant light of irradiance E: L = E σs / 4π ×
/// length, attenuated on both ways.
#[test]
fn light_scattered_once_is_a_closed_form() {
    let text = r#"<shape type="cube"><transform name="to_world"><scale x="50" y="50" z="1"/></transform>
        <bsdf type="null"/><medium name="interior" type="homogeneous">
        <rgb name="sigma_t" value="0.3, 1, 2.5"/><float name="albedo" value="0.5"/></medium></shape>
        <emitter type="directional"><vector name="direction" x="0" y="0" z="-1"/><rgb name="irradiance" value="2"/></emitter>"#;
    // Both ways have length t, for t from 0 to the thickness of 2: the integral of σs exp(−2 σt t).
    let expected = [0.3, 1.0, 2.5].map(|sigma: f64| {
        let integral = 0.5 * (1.0 - (-2.0 * sigma * 2.0).exp()) / 2.0;
        2.0 * integral / (4.0 * std::f64::consts::PI)
    });
    for integrator in INTEGRATORS {
        let setup = setup(&limited(integrator, 2), text, true);
        let ray = Ray::new(Vec3::new(0.2, 0.1, 4.0), Vec3::NEG_Z);
        assert_close(integrator, &setup.measure(ray, 60_000), expected);
    }
}

/// Without media, `volpath` takes exactly the same paths as `path`.
#[test]
fn without_media_it_is_the_path_tracer() {
    let text = r#"<shape type="sphere"><bsdf type="plastic"/></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="5"/><translate z="-1"/></transform></shape>
        <shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="0.3"/>
            <emitter type="area"/></shape><emitter type="constant"/>"#;
    let ray = Ray::new(Vec3::new(0.3, 0.2, 4.0), Vec3::NEG_Z);
    let [path, volpath] =
        ["path", "volpath"].map(|name| setup(&limited(name, 5), text, true).measure(ray, 2000));
    for (one, other) in path.iter().zip(&volpath) {
        assert!((one.mean() - other.mean()).abs() < 1e-6, "{} {}", one.mean(), other.mean());
    }
}

/// A camera inside a medium sees through less of it.
#[test]
fn a_ray_may_start_inside() {
    let text = ball(&format!(r#"{HOMOGENEOUS}<float name="albedo" value="0"/>"#), "null")
        + r#"<emitter type="constant"/>"#;
    let setup = setup(&unlimited("volpath"), &text, true);
    let medium = setup.scene.intersect(&Ray::new(Vec3::Z * 4.0, Vec3::NEG_Z)).and_then(|surface| {
        setup
            .scene
            .medium_interface(&surface)
            .and_then(|medium_interface| medium_interface.interior)
    });
    let start = Start { ray: Ray::new(Vec3::ZERO, Vec3::X), medium };
    let spec = SamplerSpec::new(SamplerKind::Independent, 20_000, 5);
    let mut found = [(); 3].map(|()| Accumulator::default());
    for index in 0..20_000 {
        let mut sampler = spec.start(UVec2::ZERO, index);
        let radiance =
            setup.integrator.sample(&setup.scene, &start, &mut sampler, &mut [], &Watch::patient());
        found.iter_mut().zip(radiance.color.rgb()).for_each(|(sum, value)| sum.add(value.into()));
    }
    assert_close("inside", &found, [0.3, 1.0, 2.5].map(|sigma: f64| (-sigma).exp()));
}

/// Integrators of surfaces warn that they ignore media; the others give no warning.
#[test]
fn what_leaves_media_out_says_so() {
    let text = ball(&format!("{HOMOGENEOUS}<phase type=\"hg\"/>"), "null");
    for (name, count) in [("path", 1), ("direct", 1), ("volpath", 0), ("volpathmis", 0), ("aov", 0)]
    {
        let diagnostics = Diagnostics::new();
        let text = format!(r#"<scene version="3.0.0"><integrator type="{name}"/>{text}</scene>"#);
        let resources = MemoryResources::default();
        let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics);
        let options = IntegratorOptions::default();
        let _ = build_integrator(&document.expect("a document"), &options, &diagnostics);
        let findings = diagnostics.sorted();
        assert_eq!(findings.len(), count, "{name}: {findings:?}");
        assert!(findings.iter().all(|found| found.message.contains("leaves media out")));
    }
}
