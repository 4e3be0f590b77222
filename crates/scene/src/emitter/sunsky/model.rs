//! The models of the clear sky and of the sun's disk by Hosek and Wilkie ("An Analytic Model for
//! Full Spectral Sky-Dome Radiance", 2012; "Adding a Solar-Radiance Function to the Hošek–Wilkie
//! Skylight Model", 2013), in linear Rec. 709.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// The coefficients; `data/README.md` gives their source.
static DATA: &[u8] = include_bytes!("../../../data/hosek_wilkie_rgb.bin");

const TURBIDITIES: usize = 10;
const CONTROL_POINTS: usize = 6;
const SKY_PARAMETERS: usize = 9;
const SEGMENTS: usize = 45;
const ELEVATION_POWERS: usize = 4;
const LIMB_POWERS: usize = 6;
/// Offsets of the tables, counted in numbers.
const RADIANCE_START: usize = TURBIDITIES * 2 * CONTROL_POINTS * 3 * SKY_PARAMETERS;
const SUN_START: usize = RADIANCE_START + TURBIDITIES * 2 * CONTROL_POINTS * 3;

/// Converts the tables' units, which sum the eye's sensitivity over wavelengths, to units in which
/// a spectrum of one is white. This is one over the integral of CIE Y, as Mitsuba rounds it.
const LUMINANCE_UNIT: f64 = 1.0 / 106.750_259_399_414_06;
/// A factor missing from the sun's table (Mitsuba's `sunsky`).
const SUN_UNIT: f64 = 467.069_280_386;

fn number(index: usize) -> f64 {
    let bytes = DATA.as_chunks::<8>().0.get(index).copied().unwrap_or_default();
    f64::from_le_bytes(bytes)
}

/// The conditions of the atmosphere and the ground, and the sun's elevation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conditions {
    /// Turbidity, from 1 to 10.
    pub(super) turbidity: f64,
    /// The ground's albedo in red, green and blue, from 0 to 1.
    pub(super) albedo: [f64; 3],
    /// The sun's elevation, from 0 to π/2.
    pub(super) elevation: f64,
}

/// Two neighbours in a table, and the weight of the second.
fn neighbours(position: f64, count: usize) -> [(usize, f64); 2] {
    let position = position.clamp(0.0, (count - 1) as f64);
    let low = (position as usize).min(count - 2);
    let share = position - low as f64;
    [(low, 1.0 - share), (low + 1, share)]
}

/// The sky, for one position of the sun.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sky {
    /// The parameters A to I of each colour channel.
    parameters: [[f32; SKY_PARAMETERS]; 3],
    radiance: [f32; 3],
}

impl Sky {
    pub(super) fn new(conditions: &Conditions) -> Self {
        let parameter = |color, index| {
            let place = |turbidity, albedo, point| {
                (((turbidity * 2 + albedo) * CONTROL_POINTS + point) * 3 + color) * SKY_PARAMETERS
                    + index
            };
            interpolate(conditions, color, place)
        };
        let radiance = |color| {
            let place = |turbidity, albedo, point| {
                let row = (turbidity * 2 + albedo) * CONTROL_POINTS + point;
                RADIANCE_START + row * 3 + color
            };
            interpolate(conditions, color, place) * LUMINANCE_UNIT
        };
        Self {
            parameters: std::array::from_fn(|color| {
                std::array::from_fn(|index| parameter(color, index) as f32)
            }),
            radiance: std::array::from_fn(|color| radiance(color) as f32),
        }
    }

    /// The radiance from a direction at the angle `gamma` from the sun. The cosine of its zenith
    /// angle is not negative. The radiance may be negative for colours outside the gamut.
    pub(super) fn radiance(&self, cos_theta: f32, gamma: f32) -> [f32; 3] {
        let cos_gamma = gamma.cos();
        let squared = cos_gamma * cos_gamma;
        std::array::from_fn(|color| {
            // Equation 8 of the paper; the data store H last.
            let [a, b, c, d, e, f, g, i, h] = self.parameters[color];
            let horizon = 1.0 + a * (b / (cos_theta + 0.01)).exp();
            let halo = (1.0 + squared) / (1.0 + h * h - 2.0 * h * cos_gamma).powf(1.5);
            let glow =
                c + d * (e * gamma).exp() + f * squared + g * halo + i * cos_theta.max(0.0).sqrt();
            horizon * glow * self.radiance[color]
        })
    }
}

/// Interpolates linearly in turbidity and albedo, and with a quintic Bézier curve over the cube
/// root of the sun's elevation.
fn interpolate(
    conditions: &Conditions,
    color: usize,
    place: impl Fn(usize, usize, usize) -> usize,
) -> f64 {
    const BINOMIALS: [f64; CONTROL_POINTS] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    let x = (conditions.elevation * FRAC_2_PI).cbrt().clamp(0.0, 1.0);
    let mut sum = 0.0;
    for (turbidity, turbidity_share) in neighbours(conditions.turbidity - 1.0, TURBIDITIES) {
        for (albedo, albedo_share) in neighbours(conditions.albedo[color], 2) {
            for (point, binomial) in BINOMIALS.iter().enumerate() {
                let power = point as i32;
                let weight = binomial * x.powi(power) * (1.0 - x).powi(5 - power);
                let value = number(place(turbidity, albedo, point));
                sum += turbidity_share * albedo_share * weight * value;
            }
        }
    }
    sum
}

/// The sun's disk for one turbidity: polynomials in elevation and limb darkening.
#[derive(Clone, Debug)]
pub(super) struct Disk {
    coefficients: Vec<[[[f64; LIMB_POWERS]; ELEVATION_POWERS]; 3]>,
}

impl Disk {
    pub(super) fn new(turbidity: f64) -> Self {
        let shares = neighbours(turbidity - 1.0, TURBIDITIES);
        let coefficient = |segment, color, power, limb| -> f64 {
            let value = |turbidity| {
                let row = ((turbidity * SEGMENTS + segment) * 3 + color) * ELEVATION_POWERS + power;
                number(SUN_START + row * LIMB_POWERS + limb)
            };
            shares.iter().map(|(turbidity, share)| share * value(*turbidity)).sum()
        };
        let segment = |segment| {
            std::array::from_fn(|color| {
                std::array::from_fn(|power| {
                    std::array::from_fn(|limb| coefficient(segment, color, power, limb))
                })
            })
        };
        Self { coefficients: (0..SEGMENTS).map(segment).collect() }
    }

    /// The radiance at an elevation. `limb` gives the powers of the cosine of the angle between the
    /// line of sight and the sun's surface normal: 1 at the centre and 0 at the rim. Not negative.
    fn evaluate(&self, elevation: f64, limb: impl Fn(usize) -> f64) -> [f32; 3] {
        let elevation = elevation.clamp(0.0, FRAC_PI_2);
        let segment = (elevation * FRAC_2_PI).cbrt() * SEGMENTS as f64;
        let segment = (segment as usize).min(SEGMENTS - 1);
        let start = FRAC_PI_2 * (segment as f64 / SEGMENTS as f64).powi(3);
        let x = elevation - start;
        self.coefficients[segment].map(|powers| {
            let mut sum = 0.0;
            for (power, limbs) in powers.iter().enumerate() {
                let along: f64 =
                    limbs.iter().enumerate().map(|(index, value)| limb(index) * value).sum();
                sum += x.powi(power as i32) * along;
            }
            (sum * SUN_UNIT * LUMINANCE_UNIT).max(0.0) as f32
        })
    }

    /// The radiance where that cosine is `cos_psi`.
    pub(super) fn radiance(&self, elevation: f64, cos_psi: f64) -> [f32; 3] {
        self.evaluate(elevation, |power| cos_psi.powi(power as i32))
    }

    /// The mean over the disk at one elevation. The mean of cosⁿψ is 2 / (n + 2).
    pub(super) fn mean_radiance(&self, elevation: f64) -> [f32; 3] {
        self.evaluate(elevation, |power| 2.0 / (power as f64 + 2.0))
    }
}
