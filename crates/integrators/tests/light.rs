//! Closed forms: the expected results of rendering simple scenes.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_integrators::{Integrator, IntegratorOptions, Start, Watch, build_integrator};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_sampling::{SamplerKind, SamplerSpec};
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_spectrum::color::rgb_to_xyz;
use etendue_testkit::{Accumulator, welch};
use glam::{UVec2, Vec3};

/// A square in the plane z = 0 with strongly tilted normals.
const LEANING: &str =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn 0.8 0 0.6\nf 1//1 2//1 3//1 4//1\n";

struct Setup {
    scene: Scene,
    integrator: Box<dyn Integrator>,
}

fn setup(text: &str, options: &IntegratorOptions) -> Setup {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default().with("leaning.obj", LEANING);
    let text = format!("<scene>{text}<sensor type=\"perspective\"/></scene>");
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
        .unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    let scene = build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()));
    let integrator = build_integrator(&document, options, &diagnostics)
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()));
    Setup { scene, integrator }
}

impl Setup {
    /// The luminance that arrives along a ray.
    fn measure(&self, origin: Vec3, direction: Vec3, samples: u32) -> Accumulator {
        let spec = SamplerSpec::new(SamplerKind::Independent, samples, 5);
        let mut accumulator = Accumulator::default();
        let mut channels = vec![0.0; self.integrator.channels().len()];
        for index in 0..samples {
            let mut sampler = spec.start(UVec2::new(3, 4), index);
            let ray = Ray::new(origin, direction.normalize());
            let radiance = self.integrator.sample(
                &self.scene,
                &Start { ray, medium: None },
                &mut sampler,
                &mut channels,
                &Watch::patient(),
            );
            accumulator.add(f64::from(radiance.color.luminance()));
        }
        accumulator
    }
}

fn without_emitter_sampling() -> IntegratorOptions {
    IntegratorOptions { emitter_sampling: false, ..IntegratorOptions::default() }
}

fn path(max_depth: i32) -> String {
    format!(
        r#"<integrator type="path"><integer name="max_depth" value="{max_depth}"/></integrator>"#
    )
}

/// Inside a closed shape that emits radiance 1 and reflects ½, paths of at most n edges give 1 + ½
/// + … = 2 − 2¹⁻ⁿ.
#[test]
fn a_furnace_sums_the_geometric_series() {
    for shape in ["sphere", "cube"] {
        for depth in [1, 2, 3, 8] {
            let text = format!(
                r#"{}<shape type="{shape}"><boolean name="flip_normals" value="true"/><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf><emitter type="area"/></shape>"#,
                path(depth)
            );
            let expected = 2.0 - 2.0_f64.powi(1 - depth);
            for options in [IntegratorOptions::default(), without_emitter_sampling()] {
                let setup = setup(&text, &options);
                let found = setup.measure(Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.0, 0.3, 0.2), 4000);
                let tolerance = 5.0 * found.standard_error() + 1e-4;
                assert!(
                    (found.mean() - expected).abs() < tolerance,
                    "{shape} {depth}: {}",
                    found.mean()
                );
            }
        }
    }
}

/// A large floor below a point light of intensity I at height h: E = I / h², L = ρ E / π.
#[test]
fn a_point_light_above_a_floor_is_a_closed_form() {
    for integrator in [path(2), r#"<integrator type="direct"/>"#.to_owned()] {
        let text = format!(
            r#"{integrator}<shape type="rectangle"><transform name="to_world"><scale value="100"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.6"/></bsdf></shape>
            <emitter type="point"><point name="position" x="0" y="0" z="3"/><rgb name="intensity" value="20"/></emitter>"#
        );
        let found = setup(&text, &IntegratorOptions::default()).measure(Vec3::Z, Vec3::NEG_Z, 64);
        let expected = 0.6 * 20.0 / 9.0 / std::f64::consts::PI;
        assert!((found.mean() / expected - 1.0).abs() < 1e-4, "{integrator}: {}", found.mean());
    }
}

/// A floor under a disk of radius r at height h, seen right below: E = π L r² / (r² + h²).
#[test]
fn a_disk_light_above_a_floor_is_a_closed_form() {
    for (integrator, options) in [
        (path(2), IntegratorOptions::default()),
        (path(2), without_emitter_sampling()),
        (
            r#"<integrator type="direct"><integer name="emitter_samples" value="3"/></integrator>"#
                .to_owned(),
            IntegratorOptions::default(),
        ),
        (
            r#"<integrator type="direct"><integer name="bsdf_samples" value="0"/></integrator>"#
                .to_owned(),
            IntegratorOptions::default(),
        ),
    ] {
        let text = format!(
            r#"{integrator}<shape type="rectangle"><transform name="to_world"><scale value="100"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.6"/></bsdf></shape>
            <shape type="disk"><transform name="to_world"><scale value="1.5"/><rotate x="1" angle="180"/><translate z="2"/></transform><emitter type="area"><rgb name="radiance" value="7"/></emitter></shape>"#
        );
        let found = setup(&text, &options).measure(Vec3::Z, Vec3::NEG_Z, 20_000);
        let expected = 0.6 * 7.0 * 2.25 / (2.25 + 4.0);
        let tolerance = 5.0 * found.standard_error();
        assert!(
            (found.mean() - expected).abs() < tolerance,
            "{integrator}: {} not {expected}",
            found.mean()
        );
    }
}

/// Emitter sampling and roulette change the noise, not the picture.
#[test]
fn ways_of_finding_light_agree_in_the_mean() {
    let body = r#"<shape type="cube"><boolean name="flip_normals" value="true"/><transform name="to_world"><scale value="2"/></transform><bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.5"/></bsdf></shape>
        <shape type="sphere"><float name="radius" value="0.5"/><bsdf type="roughconductor"><string name="material" value="Cu"/><float name="alpha" value="0.3"/></bsdf></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="0.7"/><rotate x="1" angle="180"/><translate z="1.9"/></transform><emitter type="area"/></shape>"#;
    let roulette = |depth: i32| {
        format!(
            r#"<integrator type="path"><integer name="max_depth" value="12"/><integer name="rr_depth" value="{depth}"/></integrator>{body}"#
        )
    };
    let measure = |text: &str, options: &IntegratorOptions| {
        setup(text, options).measure(Vec3::new(1.5, 0.0, 0.2), Vec3::new(-1.0, 0.1, -0.3), 40_000)
    };
    let usual = measure(&roulette(5), &IntegratorOptions::default());
    let by_chance = measure(&roulette(5), &without_emitter_sampling());
    let early_roulette = measure(&roulette(1), &IntegratorOptions::default());
    for (name, other) in [("by chance", by_chance), ("early roulette", early_roulette)] {
        assert!(
            welch(&usual, &other).accepts(1e-4),
            "{name}: {} and {}",
            usual.mean(),
            other.mean()
        );
    }
}

/// `hide_emitters` hides the emitters themselves but not their light.
#[test]
fn hidden_emitters_are_passed_through_by_camera_rays_alone() {
    let text = |hide: bool| {
        format!(
            r#"<integrator type="path"><integer name="max_depth" value="2"/><boolean name="hide_emitters" value="{hide}"/></integrator>
            <shape type="rectangle"><transform name="to_world"><scale value="10"/></transform></shape>
            <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="180"/><translate z="1"/></transform><emitter type="area"/></shape>
            <shape type="rectangle"><transform name="to_world"><translate z="2"/></transform><emitter type="area"><rgb name="radiance" value="9"/></emitter></shape>"#
        )
    };
    let look = |hide| {
        setup(&text(hide), &IntegratorOptions::default()).measure(Vec3::Z * 5.0, Vec3::NEG_Z, 4000)
    };
    assert!((look(false).mean() - 9.0).abs() < 1e-5);
    // The floor under a square of half its height's width (Lambert): each quarter gives
    // atan(1/√2) / √2 of the irradiance.
    let expected = 0.5 * 4.0 / std::f64::consts::PI * 0.5_f64.sqrt() * 0.5_f64.sqrt().atan();
    let hidden = look(true);
    let tolerance = 5.0 * hidden.standard_error();
    assert!((hidden.mean() - expected).abs() < tolerance, "{} not {expected}", hidden.mean());
}

/// A masked box thin enough to be one sheet transmits as much as a single face.
#[test]
fn the_two_faces_of_a_thin_masked_sheet_count_once() {
    let text = |integrator: &str, thickness: f32| {
        format!(
            r#"<integrator type="{integrator}"/><shape type="cube"><transform name="to_world"><scale x="1" y="1" z="{thickness}"/></transform><bsdf type="mask"><float name="opacity" value="0.75"/><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></bsdf></shape><emitter type="constant"/>"#
        )
    };
    let through = |integrator, thickness| {
        setup(&text(integrator, thickness), &IntegratorOptions::default()).measure(
            Vec3::Z * 5.0,
            Vec3::NEG_Z,
            20_000,
        )
    };
    for integrator in ["path", "volpath", "volpathmis"] {
        for (thickness, expected) in [(2e-5, 0.25), (0.1, 0.0625)] {
            let found = through(integrator, thickness);
            let tolerance = 5.0 * found.standard_error();
            let (mean, what) = (found.mean(), format!("{integrator} {thickness}"));
            assert!((mean - expected).abs() < tolerance, "{what}: {mean}");
        }
    }
}

/// A lamp behind a masked sheet: `path` only finds it by hitting it; `volpath` also connects to it
/// through the sheet.
#[test]
fn both_path_tracers_see_the_same_through_masked_sheets() {
    let body = r#"<shape type="rectangle"><transform name="to_world"><scale value="5"/></transform></shape>
        <shape type="cube"><transform name="to_world"><scale x="2" y="2" z="2e-5"/><translate z="1"/></transform><bsdf type="mask"><float name="opacity" value="0.6"/><bsdf type="diffuse"/></bsdf></shape>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="180"/><translate z="2"/></transform><emitter type="area"/></shape>"#;
    let look = |name: &str| {
        let text = format!(r#"<integrator type="{name}"/>{body}"#);
        let setup = setup(&text, &IntegratorOptions::default());
        setup.measure(Vec3::new(3.0, 0.0, 0.5), Vec3::new(-2.8, 0.2, -0.5), 60_000)
    };
    let path = look("path");
    for name in ["volpath", "volpathmis"] {
        let other = look(name);
        assert!(welch(&path, &other).accepts(1e-4), "{name}: {} {}", path.mean(), other.mean());
    }
}

/// `moment` records the squares, `aov` the visible surface, `depth` the distance.
#[test]
fn layers_hold_what_they_are_named_for() {
    let text = r#"<integrator type="moment"><integrator type="aov" name="all"><string name="aovs" value="depth, albedo:albedo, n:geo_normal"/><integrator type="depth" name="far"/></integrator><integrator type="depth" name="far"/></integrator><shape type="sphere"/>"#;
    let Setup { scene, integrator } = setup(text, &IntegratorOptions::default());
    // As Mitsuba 3.9.1 names them. Files do not preserve the order.
    let names = [
        "all.far.R",
        "all.far.G",
        "all.far.B",
        "all.far.A",
        "all.depth.T",
        "all.albedo.R",
        "all.albedo.G",
        "all.albedo.B",
        "all.n.X",
        "all.n.Y",
        "all.n.Z",
        "all.X",
        "all.Y",
        "all.Z",
        "far.X",
        "far.Y",
        "far.Z",
    ];
    let channels = integrator.channels();
    assert_eq!(channels.len(), 2 * names.len());
    assert_eq!(channels[..names.len()], names);
    assert!(
        channels[names.len()..].iter().zip(names).all(|(m2, name)| *m2 == format!("m2_{name}"))
    );
    let spec = SamplerSpec::new(SamplerKind::Independent, 1, 0);
    let mut values = vec![0.0; 2 * names.len()];
    let ray = Ray::new(Vec3::Z * 4.0, Vec3::NEG_Z);
    let start = Start { ray, medium: None };
    let seen = integrator.sample(
        &scene,
        &start,
        &mut spec.start(UVec2::ZERO, 0),
        &mut values,
        &Watch::patient(),
    );
    assert!((seen.color.luminance() - 3.0).abs() < 1e-4 && seen.alpha == 1.0);
    let [x, y, z] = rgb_to_xyz([3.0; 3]);
    let expected = [3.0, 3.0, 3.0, 1.0, 3.0, 0.5, 0.5, 0.5, 0.0, 0.0, 1.0, x, y, z, x, y, z];
    let (means, squares) = values.split_at(names.len());
    for ((mean, square), expected) in means.iter().zip(squares).zip(expected) {
        assert!((mean - expected).abs() < 1e-4, "{values:?}");
        assert!((square - expected * expected).abs() < 1e-3, "{values:?}");
    }
}

/// With a tilted shading normal, light arrives from below the surface's horizon: `strict_normals`
/// removes it.
#[test]
fn strict_normals_take_light_away_where_shading_disagrees_with_the_surface() {
    let text = |strict: bool| {
        format!(
            r#"<integrator type="path"><integer name="max_depth" value="2"/><boolean name="strict_normals" value="{strict}"/></integrator>
            <shape type="obj"><string name="filename" value="leaning.obj"/></shape><emitter type="constant"/>"#
        )
    };
    let look = |strict| {
        let setup = setup(&text(strict), &IntegratorOptions::default());
        setup.measure(Vec3::new(0.2, 0.1, 4.0), Vec3::NEG_Z, 20_000).mean()
    };
    let (strict, usual) = (look(true), look(false));
    assert!(strict < 0.95 * usual, "{strict} and {usual}");
}

/// A shape that emits light and has no material reflects nothing, as in Mitsuba. Others are grey.
#[test]
fn shapes_that_emit_and_have_no_material_are_black() {
    let shapes =
        [("cube", 1), ("sphere", 1), ("rectangle", 1), ("disk", 1), ("cylinder", 90)].map(
            |(shape, angle)| {
                format!(
                    r#"<shape type="{shape}"><transform name="to_world"><rotate x="1" angle="{angle}"/></transform>"#
                )
            },
        );
    let area = r#"<emitter type="area"><rgb name="radiance" value="0.1"/></emitter>"#;
    let cases = [
        ("", 0.5),
        (area, 0.1),
        (r#"<emitter type="directionalarea"/>"#, 0.0),
        (&format!(r#"{area}<bsdf type="diffuse"/>"#), 0.6),
    ];
    for integrator in ["path", "direct", "volpath"] {
        for (inside, expected) in cases {
            for shape in &shapes {
                let text = format!(
                    r#"<integrator type="{integrator}"/>{shape}{inside}</shape><emitter type="constant"/>"#
                );
                let setup = setup(&text, &IntegratorOptions::default());
                let found = setup.measure(Vec3::new(0.3, -0.2, 5.0), Vec3::NEG_Z, 500);
                let tolerance = 5.0 * found.standard_error() + 1e-5;
                let what = format!("{text}: {}", found.mean());
                assert!((found.mean() - expected).abs() < tolerance, "{what}");
            }
        }
    }
}

/// A floor under a square lamp, and under the sky, at scales from atoms to the solar system.
#[test]
fn light_does_not_depend_on_the_scale() {
    let square = r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="180"/><translate z="1"/><scale value="SCALE"/></transform><emitter type="area"/></shape>"#;
    let floor = r#"<shape type="rectangle"><transform name="to_world"><scale value="100"/><scale value="SCALE"/></transform></shape>"#;
    let quarter = 0.5_f64.sqrt() * 0.5_f64.sqrt().atan();
    let cases = [
        (square, 0.5 * 4.0 / std::f64::consts::PI * quarter),
        (r#"<emitter type="constant"/>"#, 0.5),
    ];
    for (light, expected) in cases {
        for exponent in -15..=12 {
            let scale = format!("1e{exponent}");
            let text = format!("{}{floor}{light}", path(2)).replace("SCALE", &scale);
            let setup = setup(&text, &IntegratorOptions::default());
            let origin = Vec3::new(0.0, 0.0, 0.5) * scale.parse::<f32>().expect("a number");
            let found = setup.measure(origin, Vec3::NEG_Z, 4000);
            let tolerance = 5.0 * found.standard_error() + 1e-5;
            let what = format!("{scale} {light}: {} not {expected}", found.mean());
            assert!((found.mean() - expected).abs() < tolerance, "{what}");
        }
    }
}

/// `clamp_indirect` limits only light that was scattered more than once.
#[test]
fn limited_indirect_light_leaves_direct_light_alone() {
    let text = |integrator: &str, parameters: &str| {
        format!(
            r#"<integrator type="{integrator}">{parameters}</integrator><shape type="sphere"><boolean name="flip_normals" value="true"/><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf><emitter type="area"/></shape>"#
        )
    };
    let look = |integrator: &str, parameters: &str| {
        let setup = setup(&text(integrator, parameters), &IntegratorOptions::default());
        setup.measure(Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.0, 0.3, 0.2), 4000)
    };
    for integrator in ["path", "volpath", "volpathmis"] {
        let dark = look(integrator, r#"<float name="clamp_indirect" value="0"/>"#);
        assert!((dark.mean() - 1.5).abs() < 5.0 * dark.standard_error() + 1e-4, "{integrator}");
        let limited = look(integrator, r#"<float name="clamp_indirect" value="0.05"/>"#);
        let whole = look(integrator, "");
        assert!(dark.mean() < limited.mean() && limited.mean() < whole.mean(), "{integrator}");
        let unlimited = look(integrator, r#"<float name="clamp_indirect" value="1e6"/>"#);
        assert_eq!(unlimited.mean(), whole.mean(), "{integrator}");
    }
}
