//! Reconstruction filters: the weight of a sample by its distance from a pixel.
//!
//! # Contract
//! - Offsets are in pixels from the pixel's centre.
//! - A filter is a product f(x)·f(y) of the same even function, which is zero at and beyond its
//!   radius. Its scale does not matter.
//! - The value of a pixel is ∫ f·L / ∫ f. A camera sample is made for one pixel: [`sample`] chooses
//!   its offset in proportion to |f|. The weight of the sample is then constant except for its sign
//!   (Ernst, Stamminger and Greiner, "Filter Importance Sampling", 2006).
//!
//! [`sample`]: ReconstructionFilter::sample

pub mod r#box;
pub mod catmullrom;
pub mod gaussian;
pub mod lanczos;
pub mod mitchell;
pub mod tent;

use crate::manual::Manual;
use crate::plugin::{Plugin, find};
use etendue_document::{Class, Parameters};
use etendue_sampling::TabulatedFilter;
use glam::Vec2;
use std::ops::RangeInclusive;

/// Two constructors: from a node, and with all parameters at their defaults.
#[derive(Clone, Copy, Debug)]
pub struct Constructors {
    build: fn(&Parameters<'_>) -> Option<ReconstructionFilter>,
    default: fn() -> ReconstructionFilter,
}

/// The reconstruction filters.
pub static FILTERS: &[Plugin<Constructors>] = &[
    plugin::<r#box::BoxFilter>("box", &r#box::MANUAL, r#box::build),
    plugin::<catmullrom::CatmullRom>("catmullrom", &catmullrom::MANUAL, catmullrom::build),
    plugin::<gaussian::Gaussian>("gaussian", &gaussian::MANUAL, gaussian::build),
    plugin::<lanczos::Lanczos>("lanczos", &lanczos::MANUAL, lanczos::build),
    plugin::<mitchell::Mitchell>("mitchell", &mitchell::MANUAL, mitchell::build),
    plugin::<tent::Tent>("tent", &tent::MANUAL, tent::build),
];

/// A plugin whose profile is `P`.
const fn plugin<P: Default + Into<Profile>>(
    name: &'static str,
    manual: &'static Manual,
    build: fn(&Parameters<'_>) -> Option<ReconstructionFilter>,
) -> Plugin<Constructors> {
    let default = || ReconstructionFilter::new(P::default().into());
    Plugin { name, manual, build: Constructors { build, default } }
}

/// The allowed radii of filters, in pixels.
const RADII: RangeInclusive<f64> = 1e-3..=64.0;

/// The filter of a film: its `rfilter` child, or the default Gaussian.
#[must_use]
pub fn build_child(film: &Parameters<'_>) -> Option<ReconstructionFilter> {
    let Some(child) = film.unnamed_child(Class::ReconstructionFilter) else {
        return Some(ReconstructionFilter::default());
    };
    let parameters = film.document().parameters(child.node, film.diagnostics());
    let filter = build(&parameters);
    parameters.finish();
    filter
}

/// Builds a filter from its node; `None` after an error has been reported.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<ReconstructionFilter> {
    find(FILTERS, parameters).and_then(|found| (found.build)(parameters))
}

/// The function f of a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Profile {
    Box(r#box::BoxFilter),
    Tent(tent::Tent),
    Gaussian(gaussian::Gaussian),
    Mitchell(mitchell::Mitchell),
    CatmullRom(catmullrom::CatmullRom),
    Lanczos(lanczos::Lanczos),
}

impl Profile {
    /// Where f ends, in pixels.
    fn radius(&self) -> f32 {
        match self {
            Self::Box(filter) => filter.radius(),
            Self::Tent(filter) => filter.radius(),
            Self::Gaussian(filter) => filter.radius(),
            Self::Mitchell(filter) => filter.radius(),
            Self::CatmullRom(filter) => filter.radius(),
            Self::Lanczos(filter) => filter.radius(),
        }
    }

    /// f at a distance from 0 to the radius.
    fn eval(&self, distance: f32) -> f32 {
        match self {
            Self::Box(filter) => filter.eval(distance),
            Self::Tent(filter) => filter.eval(distance),
            Self::Gaussian(filter) => filter.eval(distance),
            Self::Mitchell(filter) => filter.eval(distance),
            Self::CatmullRom(filter) => filter.eval(distance),
            Self::Lanczos(filter) => filter.eval(distance),
        }
    }
}

/// A reconstruction filter, ready to be sampled.
#[derive(Clone, Debug)]
pub struct ReconstructionFilter {
    profile: Profile,
    table: TabulatedFilter,
}

impl Default for ReconstructionFilter {
    /// The Gaussian with a standard deviation of half a pixel.
    fn default() -> Self {
        Self::new(gaussian::Gaussian::default().into())
    }
}

impl ReconstructionFilter {
    fn new(profile: Profile) -> Self {
        let table = TabulatedFilter::new(profile.radius(), |x| profile.eval(x.abs()));
        // Parameter ranges guarantee this; the tests cover their ends.
        let table = table.expect("every profile is finite with a positive integral");
        Self { profile, table }
    }

    /// The filter with this XML `type` and default parameters.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        let plugin = FILTERS.iter().find(|plugin| plugin.name == name)?;
        Some((plugin.build.default)())
    }

    /// The extent of the filter along each axis, in pixels.
    #[must_use]
    pub fn radius(&self) -> f32 {
        self.profile.radius()
    }

    /// f(x)·f(y) at an offset in pixels.
    #[must_use]
    pub fn eval(&self, offset: Vec2) -> f32 {
        self.eval_axis(offset.x) * self.eval_axis(offset.y)
    }

    /// Samples an offset in proportion to |f(x)·f(y)|. The expected value of weight · g(offset) is
    /// ∫ f·g / ∫ f; the weight is constant, but negative where f is. `random` is uniform in
    /// [0, 1)². The map from it is continuous and increasing along each axis, so stratified numbers
    /// give stratified offsets.
    #[inline]
    #[must_use]
    pub fn sample(&self, random: Vec2) -> (Vec2, f32) {
        match &self.profile {
            // The search in the table took a tenth of a simple scene's time. The box does not need
            // it.
            Profile::Box(filter) => ((random * 2.0 - 1.0) * filter.radius(), 1.0),
            _ => self.table.sample_2d(random),
        }
    }

    fn eval_axis(&self, offset: f32) -> f32 {
        let distance = offset.abs();
        if distance < self.profile.radius() { self.profile.eval(distance) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::{Fault, Value};
    use etendue_testkit::ChiSquare;
    use etendue_testkit::quadrature::adaptive_simpson;

    fn node(plugin: &str) -> TestNode {
        TestNode::new(Class::ReconstructionFilter, plugin)
    }

    fn default_filters() -> Vec<(&'static str, ReconstructionFilter)> {
        FILTERS.iter().map(|plugin| (plugin.name, (plugin.build.default)())).collect()
    }

    /// ∫ `function` over one axis; pieces of the filters meet at multiples of half a pixel.
    fn integrate(radius: f32, function: impl Fn(f32) -> f64) -> f64 {
        let pieces = (2.0 * radius).ceil() as i32;
        let piece = |index: i32| {
            let start = f64::from(index) * 0.5;
            adaptive_simpson(|x| function(x as f32), start, start + 0.5, 1e-9)
        };
        (-pieces..pieces).map(piece).sum()
    }

    /// Values from Mitsuba 3.9.1 (`eval` of the plugins). The Gaussian is computed as exp(−2x²) −
    /// exp(−8), because Mitsuba approximates it to three digits.
    #[test]
    fn values_are_those_of_mitsuba() {
        let distances = [0.0, 0.3, 0.9, 1.3, 1.7, 2.5, 2.9];
        let expected: [(&str, [f32; 7]); 6] = [
            ("box", [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            ("tent", [1.0, 0.7, 0.1, 0.0, 0.0, 0.0, 0.0]),
            (
                "gaussian",
                [0.999_664_5, 0.834_934_7, 0.197_563_2, 0.033_711_97, 0.002_753_248, 0.0, 0.0],
            ),
            ("mitchell", [0.888_888_9, 0.740_388_9, 0.119_388_9, -0.029_944_44, -0.0195, 0.0, 0.0]),
            ("catmullrom", [1.0, 0.8155, 0.0685, -0.0735, -0.0315, 0.0, 0.0]),
            (
                "lanczos",
                [
                    1.0,
                    0.844_343_1,
                    0.093_815_93,
                    -0.142_330_1,
                    -0.083_231_09,
                    0.024_317_07,
                    0.001_167_455,
                ],
            ),
        ];
        for (name, values) in expected {
            let filter = node(name).build_cleanly(|_, parameters| build(parameters));
            let peak = filter.eval(Vec2::ZERO).sqrt();
            for (distance, value) in distances.into_iter().zip(values) {
                for offset in [distance, -distance] {
                    let found = filter.eval(Vec2::new(offset, 0.0)) / peak;
                    assert!(
                        (found - value).abs() < 1e-6,
                        "{name} at {offset}: {found}, not {value}"
                    );
                }
            }
        }
    }

    #[test]
    fn offsets_follow_the_magnitude_of_the_filter() {
        let filters = default_filters();
        for (name, filter) in &filters {
            let radius = filter.radius();
            let total = integrate(radius, |x| f64::from(filter.eval_axis(x).abs())) as f32;
            let outcome = ChiSquare::one_of(filters.len() as u32).plane(
                (Vec2::splat(-radius), Vec2::splat(radius)),
                |random| Some(filter.sample(random.next_vec2()).0),
                |offset| filter.eval(offset).abs() / (total * total),
            );
            assert!(outcome.accepted(), "{name}: {outcome}");
        }
    }

    #[test]
    fn weighted_samples_give_the_filtered_function() {
        let functions: [fn(f32) -> f64; 3] =
            [|_| 1.0, |x| f64::from(x * x * x + x * x), |x| f64::from((2.0 * x).cos())];
        for (name, filter) in default_filters() {
            let radius = filter.radius();
            let total = integrate(radius, |x| f64::from(filter.eval_axis(x)));
            for (index, function) in functions.into_iter().enumerate() {
                let expected =
                    integrate(radius, |x| f64::from(filter.eval_axis(x)) * function(x)) / total;
                // Midpoints of strata along x. y does not matter: its mean weight is one.
                let count = 100_000;
                let sum: f64 = (0..count)
                    .map(|stratum| (stratum as f32 + 0.5) / count as f32)
                    .map(|random| filter.table.sample(random))
                    .map(|sample| f64::from(sample.weight) * function(sample.offset))
                    .sum();
                let found = sum / f64::from(count);
                // The table is constant in each of its 1024 cells.
                assert!(
                    (found - expected).abs() < 2e-4,
                    "{name}, {index}: {found}, not {expected}"
                );
            }
        }
    }

    #[test]
    fn the_weight_is_constant_but_for_its_sign_which_is_that_of_the_filter() {
        for (name, filter) in default_filters() {
            let magnitude = filter.sample(Vec2::splat(0.5)).1.abs();
            for index in 0..10_000 {
                let random = Vec2::new(index as f32 / 1e4, (index * 37 % 10_000) as f32 / 1e4);
                let (offset, weight) = filter.sample(random);
                assert!(offset.abs().max_element() <= filter.radius(), "{name}: {offset}");
                assert!((weight.abs() - magnitude).abs() < 1e-5, "{name}: {weight}");
                // At a zero, rounding decides.
                let value = filter.eval(offset);
                assert!(value.abs() < 1e-4 || (value < 0.0) == (weight < 0.0), "{name}: {offset}");
            }
        }
    }

    #[test]
    fn the_ends_of_the_random_numbers_are_the_ends_of_the_filter() {
        for (name, filter) in default_filters() {
            let (first, last) =
                (filter.sample(Vec2::ZERO), filter.sample(Vec2::splat(0.999_999_94)));
            let radius = Vec2::splat(filter.radius());
            assert!((first.0 + radius).length() < 0.05 * radius.x, "{name}: {first:?}");
            assert!((last.0 - radius).length() < 0.05 * radius.x, "{name}: {last:?}");
        }
    }

    #[test]
    fn the_defaults_of_the_names_are_those_of_the_plugins() {
        let distances = [0.0, 0.4, 0.7, 1.4].map(|x| Vec2::new(x, 0.1));
        for (name, by_name) in default_filters() {
            let built = node(name).build_cleanly(|_, parameters| build(parameters));
            assert_eq!(by_name.radius(), built.radius(), "{name}");
            assert_eq!(distances.map(|x| by_name.eval(x)), distances.map(|x| built.eval(x)));
            assert!(ReconstructionFilter::by_name(name).is_some());
        }
        assert!(ReconstructionFilter::by_name("boxx").is_none());
    }

    #[test]
    fn parameters_change_the_filter() {
        let tent =
            node("tent").float("radius", 2.0).build_cleanly(|_, parameters| build(parameters));
        assert_eq!((tent.radius(), tent.eval(Vec2::new(1.0, 0.0))), (2.0, 0.5));
        let gaussian =
            node("gaussian").float("stddev", 0.8).build_cleanly(|_, parameters| build(parameters));
        assert!((gaussian.radius() - 3.2).abs() < 1e-6);
        let mitchell = node("mitchell")
            .float("B", 0.2)
            .float("C", 0.6)
            .build_cleanly(|_, parameters| build(parameters));
        let ratio = mitchell.eval(Vec2::new(1.3, 0.0)) / mitchell.eval(Vec2::ZERO);
        assert!((ratio - -0.076_766_84 / 0.933_333_3).abs() < 1e-6, "as in Mitsuba: {ratio}");
        let lanczos =
            node("lanczos").integer("lobes", 2).build_cleanly(|_, parameters| build(parameters));
        assert_eq!(lanczos.radius(), 2.0);
        assert!((lanczos.eval(Vec2::new(1.3, 0.0)) - -0.086_433_49).abs() < 1e-6);
    }

    #[test]
    fn filters_at_the_ends_of_their_ranges_can_be_sampled() {
        let cases = [
            node("tent").float("radius", *RADII.start()),
            node("tent").float("radius", *RADII.end()),
            node("gaussian").float("stddev", *RADII.start()),
            node("gaussian").float("stddev", *RADII.end() / 4.0),
            node("mitchell").float("B", 0.0).float("C", 0.0),
            node("mitchell").float("B", 0.0).float("C", 1.0),
            node("mitchell").float("B", 1.0).float("C", 0.0),
            node("mitchell").float("B", 1.0).float("C", 1.0),
            node("lanczos").integer("lobes", 1),
            node("lanczos").integer("lobes", 16),
        ];
        for node in cases {
            let filter = node.build_cleanly(|_, parameters| build(parameters));
            let (offset, weight) = filter.sample(Vec2::new(0.3, 0.9));
            assert!(offset.abs().max_element() <= filter.radius(), "{filter:?}");
            assert!(weight.abs() >= 1.0 - 1e-6 && weight.abs() < 10.0, "{weight}");
        }
    }

    #[test]
    fn hostile_parameters_are_errors() {
        let cases = [
            ("tent", "radius", Value::Float(0.0)),
            ("tent", "radius", Value::Float(-1.0)),
            ("tent", "radius", Value::Float(1e-60)),
            ("tent", "radius", Value::Float(1e30)),
            ("gaussian", "stddev", Value::Float(f64::NAN)),
            ("gaussian", "stddev", Value::Float(0.0)),
            ("mitchell", "B", Value::Float(f64::INFINITY)),
            ("lanczos", "lobes", Value::Integer(0)),
            ("lanczos", "lobes", Value::Integer(i64::MAX)),
        ];
        for (plugin, name, value) in cases {
            let node = node(plugin).with(name, value);
            let filter =
                node.build(|_, parameters| build(parameters)).expect("the default takes its place");
            assert!(filter.eval(Vec2::ZERO) > 0.0);
            let faults: Vec<Fault> = node.findings().iter().map(|found| found.fault).collect();
            assert_eq!(faults, [Fault::BadValue], "{plugin} {name}");
        }
        let unknown = node("boxx");
        assert!(unknown.build(|_, parameters| build(parameters)).is_none());
        assert_eq!(unknown.findings()[0].fault, Fault::UnknownPlugin);
    }
}
