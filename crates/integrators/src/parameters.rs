//! Parameters that several integrators share.

use crate::estimator::{ClampIndirect, HideEmitters, StrictNormals};
use crate::options::IntegratorOptions;
use etendue_document::{Fault, Parameters};
use etendue_scene::ParameterManual;

/// The first parameter of [`DepthLimits`].
pub(crate) const MAX_DEPTH: ParameterManual = ParameterManual {
    name: "max_depth",
    kind: "integer",
    default: "-1",
    meaning: "The longest path, in edges: 1 shows emitters alone, 2 direct light, −1 has no limit but 65,536.",
};

/// The second parameter of [`DepthLimits`].
pub(crate) const RR_DEPTH: ParameterManual = ParameterManual {
    name: "rr_depth",
    kind: "integer",
    default: "5",
    meaning: "From this depth on, paths end by Russian roulette.",
};

/// The parameter of integrators that can ignore emitters.
pub(crate) const HIDE_EMITTERS: ParameterManual = ParameterManual {
    name: "hide_emitters",
    kind: "boolean",
    default: "false",
    meaning: "The camera does not see emitters.",
};

/// The parameter of [`StrictNormals`].
pub(crate) const STRICT_NORMALS: ParameterManual = ParameterManual {
    name: "strict_normals",
    kind: "boolean",
    default: "false",
    meaning: "Light must be on the same side of the geometric as of the shading normal.",
};

/// The parameter of [`ClampIndirect`].
pub(crate) const CLAMP_INDIRECT: ParameterManual = ParameterManual {
    name: "clamp_indirect",
    kind: "float",
    default: "",
    meaning: "The most that one vertex of a path may add to its pixel of light that was scattered more than \
              once; without it there is no limit. It removes bright single pixels, and makes pictures darker \
              than they should be.",
};

/// The limits of path length, in edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthLimits {
    /// The maximum length of a path.
    pub(crate) max_depth: u32,
    /// The length at which Russian roulette begins.
    pub(crate) rr_depth: u32,
}

impl DepthLimits {
    /// Reads both limits.
    pub(crate) fn read(parameters: &Parameters<'_>) -> Self {
        let max_depth = parameters.integer("max_depth", -1);
        if max_depth < -1 {
            let message = "expected −1 (no limit), or a length of 0 or more";
            parameters.error(Fault::BadValue, "max_depth", message);
        }
        let rr_depth = parameters.integer_in("rr_depth", 5, 1..=i64::from(u32::MAX)) as u32;
        Self { max_depth: u32::try_from(max_depth).unwrap_or(u32::MAX), rr_depth }
    }
}

/// The parameters that all path tracers share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathParameters {
    pub(crate) limits: DepthLimits,
    pub(crate) hide_emitters: HideEmitters,
    pub(crate) strict_normals: StrictNormals,
    /// Whether emitters are sampled; otherwise paths find light only by hitting emitters.
    pub(crate) emitter_sampling: bool,
    pub(crate) clamp_indirect: ClampIndirect,
}

impl PathParameters {
    /// Reads all but `strict_normals`, which not every path tracer supports.
    pub(crate) fn read(parameters: &Parameters<'_>, options: &IntegratorOptions) -> Self {
        Self {
            limits: DepthLimits::read(parameters),
            hide_emitters: read_hide_emitters(parameters),
            strict_normals: StrictNormals(false),
            emitter_sampling: options.emitter_sampling,
            clamp_indirect: read_clamp_indirect(parameters, options),
        }
    }
}

/// Reads `hide_emitters`.
pub(crate) fn read_hide_emitters(parameters: &Parameters<'_>) -> HideEmitters {
    HideEmitters(parameters.boolean("hide_emitters", false))
}

/// Reads `clamp_indirect`, which the library's user may override.
fn read_clamp_indirect(parameters: &Parameters<'_>, options: &IntegratorOptions) -> ClampIndirect {
    let of_scene = parameters
        .has(CLAMP_INDIRECT.name)
        .then(|| parameters.float_in(CLAMP_INDIRECT.name, 0.0, 0.0..=f64::from(f32::MAX)) as f32);
    ClampIndirect::new(options.clamp_indirect.or(of_scene))
}

/// Reads `strict_normals`.
pub(crate) fn read_strict_normals(parameters: &Parameters<'_>) -> StrictNormals {
    StrictNormals(parameters.boolean("strict_normals", false))
}
