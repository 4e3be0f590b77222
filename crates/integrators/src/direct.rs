//! `direct`: emitted light and single scattering.

use crate::estimator::{
    Alpha, Continuation, HideEmitters, NextEvent, PathVertex, PathWeight, ScatterNumbers,
    StrictNormals, ThinSheet, distant, emitted, first_surface, skip_hits,
};
use crate::integrator::{Integrator, Radiance, Start};
use crate::options::IntegratorOptions;
use crate::parameters::{HIDE_EMITTERS, STRICT_NORMALS, read_hide_emitters, read_strict_normals};
use crate::watch::Watch;
use etendue_document::{Fault, Parameters};
use etendue_sampling::Sampler;
use etendue_scene::bsdf::Bsdf;
use etendue_scene::{Manual, ParameterManual, Scene, SurfaceInteraction};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

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
        STRICT_NORMALS,
    ],
    sample: r#"<integrator type="direct"><integer name="emitter_samples" value="2"/></integrator>"#,
};

/// More light samples than this per camera sample only waste time.
const MAX_SAMPLES: i64 = 4096;

/// Direct light.
#[derive(Clone, Debug)]
pub struct Direct {
    emitter_samples: u32,
    bsdf_samples: u32,
    hide_emitters: HideEmitters,
    strict_normals: StrictNormals,
}

impl Direct {
    /// Reads the sample counts. Without emitter sampling, all samples come from the material.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, options: &IntegratorOptions) -> Self {
        let both = parameters.integer_in("shading_samples", 1, 1..=MAX_SAMPLES);
        let emitter_samples =
            parameters.integer_in("emitter_samples", both, 0..=MAX_SAMPLES) as u32;
        let bsdf_samples = parameters.integer_in("bsdf_samples", both, 0..=MAX_SAMPLES) as u32;
        if emitter_samples == 0 && bsdf_samples == 0 {
            let message = "without emitter samples and without material samples there is no light";
            parameters.error(Fault::BadValue, "bsdf_samples", message);
        }
        let emitter_sampling = options.emitter_sampling;
        Self {
            emitter_samples: if emitter_sampling { emitter_samples } else { 0 },
            bsdf_samples: if emitter_sampling { bsdf_samples } else { bsdf_samples.max(1) },
            hide_emitters: read_hide_emitters(parameters),
            strict_normals: read_strict_normals(parameters),
        }
    }

    /// Direct light from emitter sampling.
    fn by_emitters(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        sampler: &mut Sampler,
    ) -> Spectrum {
        if self.emitter_samples == 0 || !bsdf.has_smooth_lobe() {
            return Spectrum::ZERO;
        }
        let scatter_ratio = self.bsdf_samples as f32 / self.emitter_samples as f32;
        let next_event = NextEvent { strict_normals: self.strict_normals, scatter_ratio };
        let sum: Spectrum = (0..self.emitter_samples)
            .filter_map(|_| next_event.propose(scene, surface, bsdf, sampler.next_2d()))
            .filter(|light| !scene.occluded(&light.shadow_ray))
            .map(|light| light.radiance)
            .sum();
        sum / self.emitter_samples as f32
    }

    /// Direct light from BSDF sampling, and alpha: less than one if the surface lets the background
    /// show through.
    fn by_material(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        sampler: &mut Sampler,
    ) -> Radiance {
        if self.bsdf_samples == 0 {
            return Radiance { color: Spectrum::ZERO, alpha: 1.0 };
        }
        let scatter_ratio = self.bsdf_samples as f32 / self.emitter_samples as f32;
        let start = PathWeight { throughput: SpectrumLanes::grey(1.0), eta: 1.0 };
        let mut sum = Radiance::NONE;
        for _ in 0..self.bsdf_samples {
            let (lobe, direction) = (sampler.next_1d(), sampler.next_2d().into());
            let numbers = ScatterNumbers { lobe, direction };
            let next = Continuation::at_hit(surface, bsdf, start, &numbers, self.strict_normals);
            let mut alpha = Alpha::default();
            if !next.null {
                alpha.cover();
            }
            if !next.exists {
                sum.alpha += alpha.value();
                continue;
            }
            let competes = self.emitter_samples > 0 && next.smooth;
            let pdf = competes.then_some(next.pdf * scatter_ratio);
            let vertex = PathVertex { point: surface.point, pdf };
            let light =
                self.light_along(scene, surface, &vertex, (next.direction.into(), &mut alpha));
            sum.color += Spectrum::from(next.weight.throughput) * light;
            sum.alpha += alpha.value();
        }
        let count = self.bsdf_samples as f32;
        Radiance { color: sum.color / count, alpha: sum.alpha / count }
    }

    /// The weighted light that arrives at `surface` from a sampled direction. If the camera ray
    /// continues there, it sees no hidden emitters and ignores the back of a thin sheet.
    fn light_along(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        vertex: &PathVertex,
        (direction, alpha): (Vec3, &mut Alpha),
    ) -> Spectrum {
        let hide_emitters = self.hide_emitters.seen_by(*alpha);
        let mut ray = surface.spawn_ray(direction);
        let mut hit = scene.closest_hit(&ray);
        if alpha.is_camera_ray() {
            let mut sheet = ThinSheet::default();
            sheet.enter(surface.shape, surface.point);
            skip_hits(scene, &mut ray, &mut hit, &mut |surface| {
                sheet.holds(surface) || hide_emitters.hides(scene, surface)
            });
        }
        if let Some(hit) = hit {
            alpha.cover();
            let light = scene.interaction(&ray, &hit);
            return emitted(scene, &light, direction, vertex);
        }
        if hide_emitters.0 {
            return Spectrum::ZERO;
        }
        alpha.escape(scene, hide_emitters);
        distant(scene, direction, vertex)
    }
}

impl Integrator for Direct {
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        _: &mut [f32],
        _: &Watch<'_>,
    ) -> Radiance {
        let ray = &start.ray;
        let surface = match first_surface(scene, ray, self.hide_emitters) {
            Ok(surface) => surface,
            Err(background) => return background,
        };
        let bsdf = scene.prepare_bsdf(&surface);
        let color = emitted(scene, &surface, ray.direction, &PathVertex::camera(ray.origin))
            + self.by_emitters(scene, &surface, &bsdf, sampler);
        let scattered = self.by_material(scene, &surface, &bsdf, sampler);
        Radiance { color: color + scattered.color, alpha: scattered.alpha }
    }
}
