//! `path`: unidirectional path tracing with next-event estimation.

mod batch;
mod wavefront;

use crate::nested::sample_alone;
use crate::{CameraRay, Integrator, Radiance, Start};
use etendue_document::{Fault, Parameters};
use etendue_sampling::Sampler;
use etendue_scene::{Manual, ParameterManual, Scene};
use wavefront::Wavefront;

/// The parameter that [`depths`] reads first.
pub(crate) const MAX_DEPTH: ParameterManual = ParameterManual {
    name: "max_depth",
    kind: "integer",
    default: "-1",
    meaning: "The longest path, in edges: 1 shows emitters alone, 2 direct light, −1 has no limit.",
};

/// The parameter that [`depths`] reads second.
pub(crate) const RR_DEPTH: ParameterManual = ParameterManual {
    name: "rr_depth",
    kind: "integer",
    default: "5",
    meaning: "From this depth on, paths end by Russian roulette.",
};

/// The parameter of every integrator that can pass through emitters.
pub(crate) const HIDE_EMITTERS: ParameterManual = ParameterManual {
    name: "hide_emitters",
    kind: "boolean",
    default: "false",
    meaning: "The camera does not see emitters.",
};

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Path tracing: at every vertex an emitter is sampled and the material is sampled, and both \
              are combined by multiple importance sampling.",
    parameters: &[
        MAX_DEPTH,
        RR_DEPTH,
        HIDE_EMITTERS,
        ParameterManual {
            name: "strict_normals",
            kind: "boolean",
            default: "false",
            meaning: "Light must be on the same side of the geometric as of the shading normal.",
        },
    ],
    sample: r#"<integrator type="path"><integer name="max_depth" value="8"/></integrator>"#,
};

/// The path tracer.
#[derive(Clone, Debug)]
pub struct Path {
    /// The longest path, in edges.
    pub max_depth: u32,
    /// From this depth on, paths end by Russian roulette.
    pub rr_depth: u32,
    /// Whether the camera passes through emitters.
    pub hide_emitters: bool,
    /// Whether light must be on the same side of the geometric as of the shading normal.
    pub strict_normals: bool,
    /// Whether emitters are sampled; without, light is found by chance alone.
    pub emitter_sampling: bool,
}

impl Path {
    /// Reads a path tracer.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, emitter_sampling: bool) -> Self {
        let (max_depth, rr_depth) = depths(parameters);
        Self {
            max_depth,
            rr_depth,
            hide_emitters: parameters.boolean("hide_emitters", false),
            strict_normals: parameters.boolean("strict_normals", false),
            emitter_sampling,
        }
    }
}

/// Reads the greatest length of paths, and the depth from which on they end by roulette.
pub(crate) fn depths(parameters: &Parameters<'_>) -> (u32, u32) {
    let max_depth = parameters.integer("max_depth", -1);
    if max_depth < -1 {
        let message = "expected −1 (no limit), or a length of 0 or more";
        parameters.error(Fault::BadValue, "max_depth", message);
    }
    let rr_depth = parameters.integer_in("rr_depth", 5, 1..=i64::from(u32::MAX)) as u32;
    (u32::try_from(max_depth).unwrap_or(u32::MAX), rr_depth)
}

impl Integrator for Path {
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        stream: &mut Sampler,
        layers: &mut [f32],
    ) -> Radiance {
        sample_alone(self, scene, start, stream, layers)
    }

    fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        _: &mut [f32],
        radiance: &mut Vec<Radiance>,
    ) {
        radiance.extend(Wavefront::new(self, scene, rays).trace());
    }
}
