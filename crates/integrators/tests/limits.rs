//! Every path ends: after a number of steps, or when the host no longer wants it.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_integrators::{
    CameraRay, Integrator, IntegratorOptions, MAX_COLLISIONS, Start, Watch, build_integrator,
};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_sampling::{SamplerKind, SamplerSpec};
use etendue_scene::{BuildOptions, Scene, build_scene};
use glam::{UVec2, Vec3};
use std::cell::Cell;

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

fn endless(name: &str) -> String {
    format!(
        r#"<integrator type="{name}"><integer name="rr_depth" value="2000000000"/></integrator>"#
    )
}

/// Perfect mirrors all around the camera, and a lamp that no path finds by chance.
const MIRRORS: [&str; 2] = ["cube", "sphere"];

fn hall_of_mirrors(shape: &str) -> String {
    format!(
        r#"<shape type="{shape}"><boolean name="flip_normals" value="true"/>
        <transform name="to_world"><scale value="10"/></transform><bsdf type="conductor"/></shape>
        <emitter type="point"/>"#
    )
}

impl Setup {
    fn rays(count: u32) -> Vec<CameraRay> {
        let spec = SamplerSpec::new(SamplerKind::Independent, count, 7);
        let direction = Vec3::new(0.2, 0.3, -1.0).normalize();
        let start = Start { ray: Ray::new(Vec3::Z, direction), medium: None };
        (0..count)
            .map(|index| CameraRay { start, sampler: spec.start(UVec2::ZERO, index) })
            .collect()
    }

    fn sample_together(&self, count: u32, watch: &Watch<'_>) {
        let mut seen = Vec::new();
        self.integrator.sample_batch(
            &self.scene,
            &mut Self::rays(count),
            &mut [],
            watch,
            &mut seen,
        );
        assert_eq!(seen.len(), count as usize);
    }

    fn sample_alone(&self, watch: &Watch<'_>) {
        let CameraRay { start, mut sampler } = Self::rays(1)[0];
        self.integrator.sample(&self.scene, &start, &mut sampler, &mut [], watch);
    }
}

#[test]
fn a_path_between_mirrors_ends_at_the_limit_and_is_counted() {
    for shape in MIRRORS {
        for name in ["path", "volpath", "volpathmis"] {
            let setup = setup(&endless(name), &hall_of_mirrors(shape));
            let watch = Watch::patient();
            setup.sample_alone(&watch);
            assert_eq!(watch.truncated_paths(), 1, "{name} {shape}");
            setup.sample_together(3, &watch);
            assert_eq!(watch.truncated_paths(), 4, "{name} {shape}");
            assert!(!watch.is_abandoned());
        }
    }
}

#[test]
fn a_particle_between_mirrors_ends_at_the_limit() {
    let setup = setup(&endless("ptracer"), &hall_of_mirrors("cube"));
    let watch = Watch::patient();
    let target = etendue_integrators::SplatTarget {
        sensor: &setup.scene.sensors()[0].sensor,
        margin: glam::Vec2::ZERO,
    };
    let mut sampler = Setup::rays(1)[0].sampler;
    let particles = setup.integrator.particles().expect("a particle tracer");
    particles.trace_particle(&setup.scene, &mut sampler, &target, &mut |_| {}, &watch);
    assert_eq!(watch.truncated_paths(), 1);
}

#[test]
fn paths_with_roulette_never_reach_the_limit() {
    for name in ["path", "volpath"] {
        let setup = setup(&format!(r#"<integrator type="{name}"/>"#), &hall_of_mirrors("cube"));
        let watch = Watch::patient();
        setup.sample_together(500, &watch);
        assert_eq!(watch.truncated_paths(), 0, "{name}");
    }
}

#[test]
fn long_paths_are_abandoned_when_the_host_says_so() {
    for name in ["path", "volpath", "volpathmis"] {
        let setup = setup(&endless(name), &hall_of_mirrors("cube"));
        let questions = Cell::new(0);
        let is_over = || {
            questions.set(questions.get() + 1);
            questions.get() > 2
        };
        let watch = Watch::new(&is_over);
        setup.sample_together(4, &watch);
        assert!(watch.is_abandoned(), "{name}");
        assert_eq!((watch.truncated_paths(), questions.get()), (0, 3), "{name}");
    }
}

/// Colours that are not absorbed pass imaginary collisions without end.
#[test]
fn the_collisions_of_a_path_are_bounded() {
    let fog = |scale: &str| {
        format!(
            r#"<shape type="cube"><bsdf type="null"/><medium type="heterogeneous" name="interior">
            <volume type="constvolume" name="sigma_t"><rgb name="value" value="{scale}, 0, 0"/>
            <transform name="to_world"><translate value="-0.5"/><scale value="4"/></transform></volume>
            </medium></shape><emitter type="constant"/>"#
        )
    };
    // In front of a mirror, light crosses the fog again and again.
    let mirrors = hall_of_mirrors("cube");
    for name in ["volpath", "volpathmis"] {
        let watch = Watch::patient();
        for scale in ["1e4", "1e37"] {
            let open = setup(&format!(r#"<integrator type="{name}"/>"#), &fog(scale));
            open.sample_together(8, &watch);
            assert_eq!(watch.truncated_paths(), 0, "{name} {scale}");
        }
        let closed = setup(&endless(name), &format!("{}{mirrors}", fog("1e37")));
        closed.sample_together(4, &watch);
        assert!(watch.truncated_paths() > 0, "{name}: fewer than {MAX_COLLISIONS} collisions");
    }
}
