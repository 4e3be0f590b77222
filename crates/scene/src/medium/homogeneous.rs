//! `homogeneous`: a medium that is the same everywhere.

use super::{ALBEDO, Common, Density, Medium, PHASE, SAMPLE_EMITTERS, SCALE, read_extinction};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use crate::volume::Volume;
use etendue_document::{Fault, Parameters};
use etendue_spectrum::Spectrum;
use glam::Vec3;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A medium with the same extinction everywhere, such as fog, milk or wax. Its albedo may \
              vary in space. The integrators `volpath` and `volpathmis` render it.",
    parameters: &[
        ALBEDO,
        parameter("sigma_t", "float or spectrum", "1", "The extinction per unit of length."),
        SCALE,
        SAMPLE_EMITTERS,
        PHASE,
    ],
    sample: r#"<medium type="homogeneous">
    <rgb name="albedo" value="0.99, 0.9, 0.96"/>
    <float name="sigma_t" value="5"/>
    <phase type="hg"><float name="g" value="0.7"/></phase>
</medium>"#,
};

/// A medium that is the same everywhere.
#[derive(Clone, Debug)]
pub struct Homogeneous {
    extinction: Spectrum,
    albedo: Volume,
}

/// Reads the medium.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Medium> {
    let common = Common::read(builder, parameters);
    let extinction = read_extinction(builder, parameters)?;
    let Common { albedo, scale, phase, sample_emitters } = common?;
    let Some(extinction) = extinction.as_constant().filter(|_| phase.is_uniform()) else {
        let message = "a `homogeneous` medium is the same everywhere: a `heterogeneous` one is not";
        parameters.error(Fault::BadValue, "sigma_t", message);
        return None;
    };
    let medium = Homogeneous { extinction: extinction * scale, albedo };
    Some(Medium { density: Density::Homogeneous(medium), phase, sample_emitters })
}

impl Homogeneous {
    /// σt, for microflakes of projected area one.
    #[inline]
    #[must_use]
    pub fn extinction(&self) -> Spectrum {
        self.extinction
    }

    /// The albedo at a point.
    #[inline]
    #[must_use]
    pub fn albedo(&self, point: Vec3) -> Spectrum {
        self.albedo.eval(point).min(Spectrum::ONE)
    }

    pub(super) fn volumes(&self) -> [&Volume; 1] {
        [&self.albedo]
    }
}
