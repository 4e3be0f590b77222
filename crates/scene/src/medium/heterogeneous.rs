//! `heterogeneous`: a medium that varies from point to point.

use super::{ALBEDO, Common, Density, Medium, PHASE, SAMPLE_EMITTERS, SCALE, read_extinction};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use crate::models::majorants::{Majorants, Tracker};
use crate::volume::Volume;
use etendue_document::{Fault, Parameters};
use etendue_math::Ray;
use etendue_spectrum::Spectrum;
use glam::Vec3;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A medium whose extinction is a volume, such as smoke. It fills the box around that \
              volume and is empty outside. The integrators `volpath` and `volpathmis` render it.",
    parameters: &[
        ALBEDO,
        parameter(
            "sigma_t",
            "float, spectrum or volume",
            "1",
            "The extinction per unit of length.",
        ),
        SCALE,
        SAMPLE_EMITTERS,
        PHASE,
    ],
    sample: r#"<medium type="heterogeneous">
    <volume name="sigma_t" type="gridvolume"><string name="filename" value="smoke.vol"/></volume>
    <float name="albedo" value="0.9"/>
    <float name="scale" value="20"/>
</medium>"#,
};

/// A medium that varies from point to point.
#[derive(Clone, Debug)]
pub struct Heterogeneous {
    extinction: Volume,
    albedo: Volume,
    scale: f32,
    /// The greatest extinction, for microflakes of projected area one.
    limit: f32,
    majorants: Majorants,
}

/// The greatest number of mean free paths across a medium. Light enters denser matter by less than a
/// hundred-thousandth of its size, and the number of collisions would have no bound.
const MAX_MEAN_FREE_PATHS: f32 = 1e5;

/// Reads the medium.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Medium> {
    let common = Common::read(builder, parameters);
    let extinction = read_extinction(builder, parameters)?;
    let Common { albedo, scale, phase, sample_emitters } = common?;
    let majorants = Majorants::new(&extinction, scale * phase.greatest_area());
    let size = extinction.bounds().extent().length();
    let thickness = majorants.greatest() * size;
    if !thickness.is_finite() {
        let message = "the extinction is beyond what single precision can hold";
        parameters.error(Fault::BadValue, "sigma_t", message);
        return None;
    }
    let mut limit = f32::INFINITY;
    if thickness > MAX_MEAN_FREE_PATHS {
        limit = MAX_MEAN_FREE_PATHS / (size * phase.greatest_area());
        let message = format!(
            "light would meet this medium up to {thickness:.0e} times on its way across: its \
             extinction is limited to {limit:.3e}"
        );
        parameters.warning(Fault::Approximation, "sigma_t", message);
    }
    let majorants = majorants.limited(limit * phase.greatest_area());
    let medium = Heterogeneous { extinction, albedo, scale, limit, majorants };
    Some(Medium { density: Density::Heterogeneous(Box::new(medium)), phase, sample_emitters })
}

impl Heterogeneous {
    /// σt at a point, for microflakes of projected area one.
    #[inline]
    #[must_use]
    pub fn extinction(&self, point: Vec3) -> Spectrum {
        (self.extinction.eval(point) * self.scale).min(Spectrum::splat(self.limit))
    }

    /// The albedo at a point.
    #[inline]
    #[must_use]
    pub fn albedo(&self, point: Vec3) -> Spectrum {
        self.albedo.eval(point).min(Spectrum::ONE)
    }

    /// Finds the possible collisions along a ray.
    #[inline]
    #[must_use]
    pub fn track(&self, ray: &Ray) -> Tracker<'_> {
        self.majorants.track(ray)
    }

    pub(super) fn volumes(&self) -> [&Volume; 2] {
        [&self.extinction, &self.albedo]
    }

    pub(super) fn bounds_bytes(&self) -> usize {
        self.majorants.memory_bytes()
    }
}
