//! `measured`: a material from laboratory measurements.

mod data;
mod grids;
mod tensor_file;

use super::{BsdfSample, Closure, ClosureMaterial, Lobe, Transport};
use crate::builder::{Assets, Builder};
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::models::fresnel;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, one_way};
use crate::texture::Textures;
use data::{Measurement, Symmetry, place};
use etendue_document::{Fault, Parameters};
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use grids::{Mix, ONLY};
use std::f32::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A material measured in the laboratory, from a file of the RGL material database \
              (<https://rgl.epfl.ch/materials>): Dupuy and Jakob, *An Adaptive Parameterization \
              for Efficient Material Acquisition and Rendering*, 2018. Isotropic and anisotropic \
              ones, with spectra or in RGB. Black from behind; see `twosided`.",
    parameters: &[parameter("filename", "string", "", "The `.bsdf` file; required.")],
    sample: r#"<bsdf type="measured">
    <string name="filename" value="sample.bsdf"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        one_way(r#"<bsdf type="measured"><string name="filename" value="isotropic.bsdf"/></bsdf>"#),
        one_way(r#"<bsdf type="measured"><string name="filename" value="anisotropic.bsdf"/></bsdf>"#),
        one_way(r#"<bsdf type="measured"><string name="filename" value="quarter.bsdf"/></bsdf>"#),
        one_way(r#"<bsdf type="measured"><string name="filename" value="spectral.bsdf"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="twosided"><bsdf type="measured"><string name="filename" value="quarter.bsdf"/></bsdf></bsdf>"#,
    ],
    batched: &[],
};

/// A measured material. Copies share the measurement.
#[derive(Clone, Debug)]
pub struct Measured {
    measurement: Arc<Measurement>,
}

/// Reads the file.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Measured> {
    builder.assets.kept(parameters, &[], read)
}

fn read(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Measured> {
    let (path, bytes) = assets.read_file(parameters, "filename")?;
    match Measurement::read(&bytes) {
        Ok(measurement) => Some(Measured { measurement: Arc::new(measurement) }),
        Err(problem) => {
            let message = format!("{}: {problem}", path.display());
            parameters.error(Fault::Syntax, "filename", message);
            None
        }
    }
}

impl ClosureMaterial for Measured {
    type Closure<'a> = MeasuredClosure<'a>;

    fn transmits(&self) -> bool {
        false
    }

    fn resolve<'a>(&'a self, _: Textures<'a>, _: &SurfaceInteraction) -> MeasuredClosure<'a> {
        MeasuredClosure { measurement: &self.measurement }
    }
}

/// A measured material at a hit.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredClosure<'a> {
    measurement: &'a Measurement,
}

/// Everything that depends on the incident direction.
struct Incident<'a> {
    measurement: &'a Measurement,
    wi: Vec3,
    /// The signs that mirror both directions into the measured range of azimuths, and back.
    mirror: Vec3,
    theta: f32,
    phi: f32,
    mix: Mix,
}

/// The angle between a direction and the normal, accurate also for small angles.
fn elevation(v: Vec3) -> f32 {
    2.0 * (0.5 * (v - Vec3::Z).length()).min(1.0).asin()
}

impl<'a> Incident<'a> {
    fn new(measurement: &'a Measurement, wi: Vec3) -> Self {
        // Azimuths are measured from −π: the lower half, or the left quarter of it.
        let below = |coordinate: f32| if coordinate > 0.0 { -1.0 } else { 1.0 };
        let mirror = match measurement.symmetry {
            Symmetry::Isotropic | Symmetry::Full => Vec3::ONE,
            Symmetry::Half => Vec3::new(below(wi.y), below(wi.y), 1.0),
            Symmetry::Quarter => Vec3::new(below(wi.x), below(wi.y), 1.0),
        };
        let wi = wi * mirror;
        let (theta, phi) = (elevation(wi), wi.y.atan2(wi.x));
        Self { measurement, wi, mirror, theta, phi, mix: measurement.mix(phi, theta) }
    }

    /// The origin of the normals' azimuths: for isotropic materials, the azimuth of the incident
    /// direction.
    fn origin(&self) -> f32 {
        if self.measurement.symmetry == Symmetry::Isotropic { self.phi } else { 0.0 }
    }

    /// The value with the normal at `normal` in the unit square, selected by `uniform`.
    fn value(&self, normal: Vec2, uniform: Vec2) -> Spectrum {
        let measurement = self.measurement;
        let channel = |channel: usize| {
            measurement.colors.eval(&Measurement::color_mix(&self.mix, channel), uniform)
        };
        let color = Spectrum::from_rgb([0, 1, 2].map(channel));
        if !measurement.has_jacobian {
            return color;
        }
        let incident = place(self.theta, self.phi);
        let projected = measurement.projected.eval(&ONLY, incident);
        if projected <= 0.0 {
            return Spectrum::ZERO;
        }
        color * (measurement.normals.eval(&ONLY, normal) / (4.0 * projected))
    }

    /// The solid angle of `wo` per unit of the square that normals are sampled in.
    fn jacobian(&self, normal: Vec2, m: Vec3) -> f32 {
        let sine = m.truncate().length();
        (2.0 * PI * PI * normal.x * sine).max(1e-6) * 4.0 * self.wi.dot(m)
    }

    fn eval_pdf(&self, wo: Vec3) -> (Spectrum, f32) {
        let m = (self.wi + wo * self.mirror).normalize_or_zero();
        let normal = place(elevation(m), m.y.atan2(m.x) - self.origin());
        let (uniform, visible) = self.measurement.visible.invert(&self.mix, normal);
        let luminance = self.measurement.luminance.pdf(&self.mix, uniform);
        let pdf = visible * luminance / self.jacobian(normal, m);
        let value = self.value(normal, uniform);
        if pdf.is_finite() && pdf >= 0.0 { (value, pdf) } else { (Spectrum::ZERO, 0.0) }
    }

    fn sample(&self, uniform: Vec2) -> Vec3 {
        let (uniform, _) = self.measurement.luminance.sample(&self.mix, uniform);
        let (normal, _) = self.measurement.visible.sample(&self.mix, uniform);
        let (sin_theta, cos_theta) = (normal.x * normal.x * FRAC_PI_2).sin_cos();
        let (sin_phi, cos_phi) = ((2.0 * normal.y - 1.0) * PI + self.origin()).sin_cos();
        let m = Vec3::new(cos_phi * sin_theta, sin_phi * sin_theta, cos_theta);
        fresnel::reflect(self.wi, m) * self.mirror
    }
}

impl Closure for MeasuredClosure<'_> {
    /// Not inlined, like [`Self::sample`]: rare code must not bloat the loops that all materials
    /// share.
    #[inline(never)]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        Incident::new(self.measurement, wi).eval_pdf(wo)
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Vec3,
        _lobe: f32,
        direction: Vec2,
        _transport: Transport,
    ) -> Option<BsdfSample> {
        if wi.z <= 0.0 {
            return None;
        }
        let incident = Incident::new(self.measurement, wi);
        let wo = incident.sample(direction);
        if wo.z <= 0.0 {
            return None;
        }
        let (value, pdf) = incident.eval_pdf(wo);
        let sample = || BsdfSample { wo, weight: value / pdf, pdf, eta: 1.0, lobe: Lobe::Smooth };
        (pdf > 0.0).then(sample)
    }

    fn has_smooth_lobe(&self) -> bool {
        true
    }

    /// The mean weight of a few samples; there is no simpler formula.
    fn albedo(&self, wi: Vec3) -> Spectrum {
        const SIDE: u16 = 4;
        let at = |index: u16| (f32::from(index) + 0.5) / f32::from(SIDE);
        let weights = (0..SIDE * SIDE).filter_map(|index| {
            let uniform = Vec2::new(at(index % SIDE), at(index / SIDE));
            Some(self.sample(wi, 0.0, uniform, Transport::Radiance)?.weight)
        });
        weights.sum::<Spectrum>() / f32::from(SIDE * SIDE)
    }
}

#[cfg(test)]
mod tests;
