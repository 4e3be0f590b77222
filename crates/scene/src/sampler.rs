//! Samplers: how the random numbers of a pixel's samples are distributed.
//!
//! A plugin gives a [`SamplerKind`] and a number of samples. [`etendue_sampling`] computes the
//! numbers as a function of seed, pixel, sample and dimension. They differ from Mitsuba's.

pub mod halton;
pub mod hammersley;
pub mod independent;
pub mod ldsampler;
pub mod multijitter;
pub mod orthogonal;
pub mod sobol;
pub mod stratified;

use crate::manual::{ParameterManual, parameter};
use crate::plugin::{Plugin, find};
use etendue_document::{Class, Fault, Parameters};
use etendue_sampling::{SamplerKind, SamplerSpec};

/// Builds a sampler.
pub type BuildSampler = fn(&Parameters<'_>) -> Option<SamplerSpec>;

/// The list of samplers.
pub static SAMPLERS: &[Plugin<BuildSampler>] = &[
    Plugin { name: "halton", manual: &halton::MANUAL, build: halton::build },
    Plugin { name: "hammersley", manual: &hammersley::MANUAL, build: hammersley::build },
    Plugin { name: "independent", manual: &independent::MANUAL, build: independent::build },
    Plugin { name: "ldsampler", manual: &ldsampler::MANUAL, build: ldsampler::build },
    Plugin { name: "multijitter", manual: &multijitter::MANUAL, build: multijitter::build },
    Plugin { name: "orthogonal", manual: &orthogonal::MANUAL, build: orthogonal::build },
    Plugin { name: "sobol", manual: &sobol::MANUAL, build: sobol::build },
    Plugin { name: "stratified", manual: &stratified::MANUAL, build: stratified::build },
];

const SAMPLE_COUNT: ParameterManual =
    parameter("sample_count", "integer", "4", "Samples per pixel, at least 1.");
const SEED: ParameterManual =
    parameter("seed", "integer", "0", "Another seed gives another picture of the same scene.");
const JITTER: ParameterManual = parameter(
    "jitter",
    "boolean",
    "true",
    "Accepted; samples are always jittered within their strata, with a warning if this is false.",
);
const SCRAMBLE: ParameterManual = parameter(
    "scramble",
    "integer",
    "-1",
    "Accepted, without effect: the points are always scrambled, by `seed`.",
);

/// The default number of samples per pixel.
const DEFAULT_SAMPLE_COUNT: i64 = 4;
/// The greatest number of samples per pixel.
const MAX_SAMPLE_COUNT: i64 = 1 << 30;

/// The sampler of a sensor: its `sampler` child, or the independent sampler.
#[must_use]
pub fn build_child(sensor: &Parameters<'_>) -> Option<SamplerSpec> {
    let Some(child) = sensor.unnamed_child(Class::Sampler) else {
        return Some(SamplerSpec::new(SamplerKind::Independent, DEFAULT_SAMPLE_COUNT as u32, 0));
    };
    let parameters = sensor.document().parameters(child.node, sensor.diagnostics());
    let build = find(SAMPLERS, &parameters)?;
    let sampler = build(&parameters);
    parameters.finish();
    sampler
}

/// Reads the settings that all samplers have.
fn read(parameters: &Parameters<'_>, kind: SamplerKind) -> SamplerSpec {
    let range = 1..=MAX_SAMPLE_COUNT;
    let sample_count = parameters.integer_in("sample_count", DEFAULT_SAMPLE_COUNT, range);
    // Negative seeds are valid too.
    let seed = parameters.integer("seed", 0) as u64;
    // In range, because reading checks it.
    SamplerSpec::new(kind, sample_count as u32, seed)
}

/// Reads `jitter`, which cannot be turned off.
fn read_jitter(parameters: &Parameters<'_>) {
    if !parameters.boolean("jitter", true) {
        let message = "samples are jittered within their strata regardless";
        parameters.warning(Fault::Approximation, "jitter", message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::Value;

    fn kinds() -> [(&'static str, SamplerKind); 8] {
        [
            ("halton", SamplerKind::Halton),
            ("hammersley", SamplerKind::Hammersley),
            ("independent", SamplerKind::Independent),
            ("ldsampler", SamplerKind::LowDiscrepancy),
            ("multijitter", SamplerKind::Multijitter),
            ("orthogonal", SamplerKind::Orthogonal),
            ("sobol", SamplerKind::Sobol),
            ("stratified", SamplerKind::Stratified),
        ]
    }

    /// Builds the sampler of a sensor without other settings.
    fn plugin(name: &str) -> BuildSampler {
        let found = SAMPLERS.iter().find(|plugin| plugin.name == name);
        found.expect("the sampler is in the table").build
    }

    #[test]
    fn every_sampler_has_its_kind_and_its_defaults() {
        assert_eq!(kinds().len(), SAMPLERS.len());
        for (name, kind) in kinds() {
            let node = TestNode::new(Class::Sampler, name);
            let spec = node.build_cleanly(|_, parameters| plugin(name)(parameters));
            assert_eq!(spec, SamplerSpec::new(kind, 4, 0), "{name}");
        }
    }

    #[test]
    fn count_and_seed_are_read() {
        for (name, kind) in kinds() {
            let node = TestNode::new(Class::Sampler, name).integer("sample_count", 7);
            let node = node.integer("seed", -3);
            let spec = node.build_cleanly(|_, parameters| plugin(name)(parameters));
            assert_eq!(spec, SamplerSpec::new(kind, 7, u64::MAX - 2), "{name}");
        }
    }

    #[test]
    fn hostile_counts_are_errors() {
        for count in [0, -1, i64::MAX, 2_000_000_000] {
            for (name, _) in kinds() {
                let node = TestNode::new(Class::Sampler, name).integer("sample_count", count);
                let spec = node.build(|_, parameters| plugin(name)(parameters));
                assert_eq!(node.findings()[0].fault, Fault::BadValue, "{name} {count}");
                assert!(spec.is_some_and(|spec| spec.rounded_sample_count() < 10), "the default");
            }
        }
    }

    #[test]
    fn what_cannot_be_had_is_reported() {
        for (name, parameter, value) in [
            ("stratified", "jitter", Value::Boolean(false)),
            ("multijitter", "jitter", Value::Boolean(false)),
            ("orthogonal", "jitter", Value::Boolean(false)),
            ("orthogonal", "strength", Value::Integer(3)),
        ] {
            let node = TestNode::new(Class::Sampler, name).with(parameter, value);
            node.build(|_, parameters| plugin(name)(parameters));
            let faults: Vec<Fault> = node.findings().iter().map(|found| found.fault).collect();
            assert_eq!(faults, [Fault::Approximation], "{name} {parameter}");
        }
    }

    #[test]
    fn a_sensor_has_a_sampler_without_saying_so() {
        let bare = TestNode::new(Class::Sensor, "perspective");
        let spec = bare.build_cleanly(|_, parameters| build_child(parameters));
        assert_eq!(spec, SamplerSpec::new(SamplerKind::Independent, 4, 0));
        let sensor = TestNode::new(Class::Sensor, "perspective").child(Class::Sampler, "sobol");
        let spec = sensor.build_cleanly(|_, parameters| build_child(parameters));
        assert_eq!(spec.kind(), SamplerKind::Sobol);
        let unknown = TestNode::new(Class::Sensor, "perspective").child(Class::Sampler, "sobel");
        assert!(unknown.build(|_, parameters| build_child(parameters)).is_none());
        assert_eq!(unknown.findings()[0].fault, Fault::UnknownPlugin);
    }
}
