//! `direct`: emitters, and light that is scattered once.

use crate::light::{NextEvent, Origin, distant, emitted, first_sight};
use crate::path::HIDE_EMITTERS;
use crate::{Integrator, Radiance, Start};
use etendue_document::{Fault, Parameters};
use etendue_sampling::Sampler;
use etendue_scene::bsdf::{Bsdf, Lobe, Transport};
use etendue_scene::{Manual, ParameterManual, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Direct light: what is seen glows, or is lit by emitters without a detour.",
    parameters: &[
        ParameterManual {
            name: "shading_samples",
            kind: "integer",
            default: "1",
            meaning: "Sets both counts below.",
        },
        ParameterManual {
            name: "emitter_samples",
            kind: "integer",
            default: "1",
            meaning: "Emitter samples for each camera sample.",
        },
        ParameterManual {
            name: "bsdf_samples",
            kind: "integer",
            default: "1",
            meaning: "Material samples for each camera sample.",
        },
        HIDE_EMITTERS,
        ParameterManual {
            name: "strict_normals",
            kind: "boolean",
            default: "false",
            meaning: "Light must be on the same side of the geometric as of the shading normal.",
        },
    ],
    sample: r#"<integrator type="direct"><integer name="emitter_samples" value="2"/></integrator>"#,
};

/// More samples than this for one camera sample only waste time.
const MAX_SAMPLES: i64 = 4096;

/// Direct light.
#[derive(Clone, Debug)]
pub struct Direct {
    emitter_samples: u32,
    bsdf_samples: u32,
    hide_emitters: bool,
    strict_normals: bool,
}

impl Direct {
    /// Reads the counts. Without emitter sampling, the material's samples do all the work.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, emitter_sampling: bool) -> Self {
        let both = parameters.integer_in("shading_samples", 1, 1..=MAX_SAMPLES);
        let emitter_samples =
            parameters.integer_in("emitter_samples", both, 0..=MAX_SAMPLES) as u32;
        let bsdf_samples = parameters.integer_in("bsdf_samples", both, 0..=MAX_SAMPLES) as u32;
        if emitter_samples == 0 && bsdf_samples == 0 {
            let message = "without emitter samples and without material samples there is no light";
            parameters.error(Fault::BadValue, "bsdf_samples", message);
        }
        Self {
            emitter_samples: if emitter_sampling { emitter_samples } else { 0 },
            bsdf_samples: if emitter_sampling { bsdf_samples } else { bsdf_samples.max(1) },
            hide_emitters: parameters.boolean("hide_emitters", false),
            strict_normals: parameters.boolean("strict_normals", false),
        }
    }

    fn by_emitters(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        stream: &mut Sampler,
    ) -> Spectrum {
        if self.emitter_samples == 0 || !bsdf.has_smooth_lobe() {
            return Spectrum::ZERO;
        }
        let scatter_ratio = self.bsdf_samples as f32 / self.emitter_samples as f32;
        let next_event = NextEvent { strict_normals: self.strict_normals, scatter_ratio };
        let sum: Spectrum = (0..self.emitter_samples)
            .map(|_| next_event.estimate(scene, surface, bsdf, stream.next_2d()))
            .sum();
        sum / self.emitter_samples as f32
    }

    fn by_material(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        stream: &mut Sampler,
    ) -> Spectrum {
        let scatter_ratio = self.bsdf_samples as f32 / self.emitter_samples as f32;
        let mut sum = Spectrum::ZERO;
        for _ in 0..self.bsdf_samples {
            let (lobe, direction) = (stream.next_1d(), stream.next_2d());
            let Some(sample) = bsdf.sample(surface.wi, lobe, direction, Transport::Radiance) else {
                continue;
            };
            let direction = surface.to_world(sample.wo);
            let inconsistent = direction.dot(surface.normal) * sample.wo.z <= 0.0;
            if self.strict_normals && sample.lobe != Lobe::Null && inconsistent {
                continue;
            }
            let competing = self.emitter_samples > 0 && sample.lobe.is_smooth();
            let pdf = competing.then_some(sample.pdf * scatter_ratio);
            let origin = Origin { point: surface.point, pdf };
            let found = match scene.intersect(&surface.spawn_ray(direction)) {
                Some(light) => emitted(scene, &light, direction, &origin),
                None => distant(scene, direction, &origin),
            };
            sum += sample.weight * found;
        }
        if self.bsdf_samples == 0 { sum } else { sum / self.bsdf_samples as f32 }
    }
}

impl Integrator for Direct {
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        stream: &mut Sampler,
        _: &mut [f32],
    ) -> Radiance {
        let ray = &start.ray;
        let surface = match first_sight(scene, ray, self.hide_emitters) {
            Ok(surface) => surface,
            Err(background) => return background,
        };
        let seen = Origin { point: ray.origin, pdf: None };
        let bsdf = scene.prepare_bsdf(&surface);
        let color = emitted(scene, &surface, ray.direction, &seen)
            + self.by_emitters(scene, &surface, &bsdf, stream)
            + self.by_material(scene, &surface, &bsdf, stream);
        Radiance { color, alpha: 1.0 }
    }
}
