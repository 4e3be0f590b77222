//! Tests of all phase functions: samples follow the density, and the density integrates to one.

use super::phase_list;
use super::*;
use crate::builder::{Assets, BuildOptions, Builder};
use crate::inputs::grid_file::tests::file;
use etendue_document::{Class, Diagnostics, MemoryResources};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_testkit::ChiSquare;
use etendue_testkit::quadrature::integrate_sphere;

/// A phase function from XML, and the diagnostics of building it.
fn read(text: &str) -> (Option<PhaseFunction>, Vec<etendue_document::Diagnostic>) {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default()
        .with("even.vol", file([2, 1, 1], 6, &[FLAKES, FLAKES].concat()))
        .with("flakes.vol", file([2, 1, 1], 6, &[FLAKES, [0.4, 0.3, 0.9, 0.0, 0.2, -0.1]].concat()))
        .with("bad.vol", file([2, 1, 1], 6, &[FLAKES, [1.0, 1.0, 1.0, 2.0, 0.0, 0.0]].concat()))
        .with("grey.vol", file([1, 1, 1], 1, &[0.5]));
    let text = format!("<scene><medium type=\"homogeneous\">{text}</medium></scene>");
    let options = LoadOptions::default();
    let document = read_text(&text, &resources, &options, &diagnostics).expect("a document");
    let node = (0..document.nodes.len() as u32)
        .map(etendue_document::NodeId)
        .find(|id| document.node(*id).class == Class::Phase)
        .expect("a phase function");
    let assets = Assets::new(&document, &resources, &diagnostics);
    let options = BuildOptions::default();
    let phase = Builder::new(&assets, &options).phase(node);
    (phase, diagnostics.sorted())
}

fn phase(text: &str) -> PhaseFunction {
    let (phase, findings) = read(text);
    phase.unwrap_or_else(|| panic!("{text}: {findings:?}"))
}

/// The matrix of [`SGGX`].
const FLAKES: [f32; 6] = [0.1, 0.8, 0.3, 0.05, -0.1, 0.2];

/// The cases of a plugin. Each is a `<phase>` element.
pub(crate) struct Cases {
    /// Typical phase functions: samples against densities.
    pub(crate) usual: &'static [&'static str],
    /// Extreme phase functions, whose formulas lose precision: nothing may become infinite,
    /// negative or NaN.
    pub(crate) extreme: &'static [&'static str],
}

/// Generates `PLUGINS` from the list of phase functions.
macro_rules! cases {
    ($($module:ident => $name:ident($type:ty);)*) => {
        /// The name and the cases of every plugin.
        const PLUGINS: &[(&str, &Cases)] = &[$((stringify!($module), &$module::CASES)),*];
    };
}

phase_list!(cases);

/// The typical cases of all plugins.
fn usual() -> impl Iterator<Item = &'static str> {
    PLUGINS.iter().flat_map(|(_, cases)| cases.usual.iter().copied())
}

#[test]
fn every_plugin_has_its_cases() {
    for (name, cases) in PLUGINS {
        let names_itself = |xml: &&str| xml.contains(&format!("type=\"{name}\""));
        assert!(cases.usual.iter().any(names_itself), "`{name}` has no usual case");
        assert!(cases.extreme.iter().any(names_itself), "`{name}` has no extreme case");
    }
}

const HG: &str = r#"<phase type="hg"><float name="g" value="0.85"/></phase>"#;
const RAYLEIGH: &str = r#"<phase type="rayleigh"/>"#;
const TABLE: &str =
    r#"<phase type="tabphase"><string name="values" value="0.5, 0, 0 2 1.5"/></phase>"#;
const SGGX: &str =
    r#"<phase type="sggx"><string name="S" value="0.1 0.8 0.3 0.05 -0.1 0.2"/></phase>"#;
const BLEND: &str = r#"<phase type="blendphase"><float name="weight" value="0.3"/><phase type="rayleigh"/><phase type="hg"/></phase>"#;

fn sites() -> [MediumInteraction; 2] {
    let site = |wi: Vec3| MediumInteraction { point: Vec3::new(0.3, 0.2, 0.1), wi: wi.normalize() };
    [site(Vec3::new(0.3, -0.5, 0.7)), site(Vec3::NEG_Z)]
}

#[test]
fn samples_follow_the_density() {
    let test_count = (usual().count() * sites().len()) as u32;
    for text in usual() {
        let phase = phase(text);
        for site in sites() {
            let mut wrong = 0;
            let outcome = ChiSquare::one_of(test_count).sphere(
                |random| {
                    let sample = phase.sample(&site, random.next_f32(), random.next_vec2())?;
                    let density = phase.eval(&site, sample.wo);
                    wrong += u32::from((sample.pdf / density - 1.0).abs() > 2e-3);
                    Some(sample.wo)
                },
                |wo| phase.eval(&site, wo),
            );
            assert!(outcome.accepted(), "{text} {site:?}: {outcome:?}");
            assert_eq!(wrong, 0, "{text} {site:?}: the density of the sample is another one");
        }
    }
}

#[test]
fn extreme_directions_and_parameters_stay_finite() {
    let mut random = etendue_testkit::TestRng::new(3);
    let extreme = PLUGINS.iter().flat_map(|(_, cases)| cases.extreme.iter().copied());
    for text in usual().chain(extreme) {
        let phase = phase(text);
        for round in 0..2000 {
            let wi = [Vec3::X, Vec3::NEG_Z, random.unit_vector()][round % 3];
            let interaction = MediumInteraction { point: random.unit_vector() * 2.0, wi };
            let wo = [wi, -wi, random.unit_vector()][round / 3 % 3];
            let value = phase.eval(&interaction, wo);
            assert!(value.is_finite() && value >= 0.0, "{text}: {wi} {wo} {value}");
            let part = [0.0, 0.5, 1.0 - f32::EPSILON / 2.0][round / 9 % 3];
            let sample = phase.sample(&interaction, part, random.next_vec2());
            let sound = sample.is_none_or(|sample| {
                let is_unit = (sample.wo.length() - 1.0).abs() < 1e-4;
                is_unit && sample.pdf.is_finite() && sample.pdf > 0.0
            });
            assert!(sound, "{text}: {wi} {sample:?}");
            let area = phase.projected_area(&interaction);
            assert!(area.is_finite() && area > 0.0, "{text}: {wi} {area}");
        }
    }
}

#[test]
fn the_mean_cosine_is_g() {
    for g in [-0.7_f32, 0.3, 0.9] {
        let phase = phase(&format!(r#"<phase type="hg"><float name="g" value="{g}"/></phase>"#));
        let site = sites()[0];
        let mean = integrate_sphere(|wo| f64::from(phase.eval(&site, wo) * wo.dot(-site.wi)), 1e-6);
        assert!((mean - f64::from(g)).abs() < 1e-4, "{g}: {mean}");
    }
}

/// Values from Mitsuba 3.9.1.
#[test]
fn values_are_mitsubas() {
    let [a, b, c] =
        [Vec3::new(0.3, -0.5, 0.7), Vec3::new(-0.1, 0.9, 0.2), Vec3::new(0.6, 0.4, 0.5)]
            .map(Vec3::normalize);
    let pairs = [(a, b), (a, c), (b, c)];
    let cases = [
        (HG, [0.020_870_16, 0.005_850_442, 0.005_397_206]),
        (TABLE, [0.170_796_7, 0.0, 0.0]),
        (SGGX, [0.022_943_06, 0.003_574_896, 0.045_444_15]),
        (BLEND, [0.057_188_89, 0.051_360_14, 0.054_146_35]),
    ];
    for (text, values) in cases {
        let phase = phase(text);
        for ((wi, wo), value) in pairs.into_iter().zip(values) {
            let found = phase.eval(&MediumInteraction { point: Vec3::splat(0.5), wi }, wo);
            assert!((found - value).abs() <= 2e-5 * value, "{text} {found} {value}");
        }
    }
    let area = phase(SGGX).projected_area(&MediumInteraction { point: Vec3::ZERO, wi: b });
    assert!((area - 0.920_060_7).abs() < 1e-6);
}

#[test]
fn sggx_is_symmetric_but_for_the_area() {
    let phase = phase(SGGX);
    let point = Vec3::ZERO;
    let [a, b] = [Vec3::new(0.3, -0.5, 0.7).normalize(), Vec3::new(-0.1, 0.9, 0.2).normalize()];
    let (from_a, from_b) = (MediumInteraction { point, wi: a }, MediumInteraction { point, wi: b });
    let forth = phase.projected_area(&from_a) * phase.eval(&from_a, b);
    let back = phase.projected_area(&from_b) * phase.eval(&from_b, a);
    assert!((forth / back - 1.0).abs() < 1e-4, "{forth} {back}");
    let bound = phase.greatest_area();
    for direction in [a, b, Vec3::X, Vec3::Y, Vec3::Z] {
        assert!(phase.projected_area(&MediumInteraction { point, wi: direction }) <= bound);
    }
}

/// A grid whose cells all hold one matrix equals that matrix.
#[test]
fn sggx_reads_its_matrix_from_a_grid() {
    let grid = r#"<phase type="sggx"><volume name="S" type="gridvolume"><string name="filename" value="even.vol"/></volume></phase>"#;
    let (one, other) = (phase(SGGX), phase(grid));
    let [from, to] = sites();
    for (site, wo) in [(from, to.wi), (to, from.wi), (from, Vec3::X)] {
        let values = [one.eval(&site, wo), other.eval(&site, wo)];
        assert!((values[1] / values[0] - 1.0).abs() < 1e-5, "{values:?}");
        let areas = [one.projected_area(&site), other.projected_area(&site)];
        assert!((areas[1] / areas[0] - 1.0).abs() < 1e-6, "{areas:?}");
    }
    assert!(one.is_uniform() && !other.is_uniform());
}

/// Microflakes in the components of a blend make its area vary with its weight.
#[test]
fn a_mixture_is_uniform_where_its_weight_or_the_area_is() {
    let blend = |part: &str| {
        let weight = r#"<volume name="weight" type="gridvolume"><string name="filename" value="grey.vol"/></volume>"#;
        let parts = format!(r#"{part}<phase type="hg"/>"#);
        phase(&format!(r#"<phase type="blendphase">{weight}{parts}</phase>"#))
    };
    let flakes = format!(r#"<phase type="blendphase">{}<phase type="hg"/></phase>"#, SGGX);
    assert!(blend(RAYLEIGH).is_uniform() && phase(&flakes).is_uniform());
    assert!(!blend(SGGX).is_uniform() && !blend(&flakes).is_uniform());
}

#[test]
fn nonsense_is_refused_with_its_place() {
    let cases = [
        (r#"<phase type="hg"><float name="g" value="1"/></phase>"#, "must be between"),
        (r#"<phase type="hg"><float name="g" value="-1.5"/></phase>"#, "must be between"),
        (r#"<phase type="tabphase"><string name="values" value="1"/></phase>"#, "two values"),
        (r#"<phase type="tabphase"><string name="values" value="0 0"/></phase>"#, "two values"),
        (r#"<phase type="tabphase"><string name="values" value="1 -2"/></phase>"#, "`-2`"),
        (r#"<phase type="tabphase"><string name="values" value="1 x"/></phase>"#, "`x`"),
        (r#"<phase type="tabphase"/>"#, "values"),
        (r#"<phase type="sggx"/>"#, "`S`"),
        (r#"<phase type="sggx"><string name="S" value="1 2"/></phase>"#, "six numbers"),
        (r#"<phase type="sggx"><string name="S" value="1 1 1 2 0 0"/></phase>"#, "definite"),
        (
            r#"<phase type="sggx"><volume name="S" type="gridvolume"><string name="filename" value="bad.vol"/></volume></phase>"#,
            "cell 1, 0, 0",
        ),
        (
            r#"<phase type="sggx"><volume name="S" type="gridvolume"><string name="filename" value="grey.vol"/></volume></phase>"#,
            "six values",
        ),
        (r#"<phase type="blendphase"><phase type="hg"/></phase>"#, "two phase functions"),
        (r#"<phase type="mie"/>"#, "unknown phase"),
    ];
    for (text, part) in cases {
        let (phase, findings) = read(text);
        assert!(phase.is_none(), "{text}");
        assert!(findings.iter().any(|found| found.message.contains(part)), "{text}: {findings:?}");
    }
}
