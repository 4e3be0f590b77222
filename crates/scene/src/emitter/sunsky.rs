//! `sunsky`: a clear sky with the sun, by time and place.

mod dome;
mod model;
mod position;

use super::{
    DirectionSample, Light, RaySample, SAMPLING_WEIGHT, SceneView, Target, sample_ray_from_afar,
};
use crate::builder::Builder;
use crate::inputs::transform::read_transform;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use crate::texture::ColorSource;
use dome::Dome;
use etendue_document::{Fault, Parameters};
use etendue_math::{Frame, Transform};
use etendue_sampling::{Distribution2D, warp};
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{DVec3, Vec2, Vec3};
use model::{Conditions, Disk, Sky};
use position::{Moment, Place};
use std::f32::consts::TAU;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The clear sky and the sun of Hosek and Wilkie. In its own space +z is up, +x lies to the \
              south and +y to the west: scenes whose up is +y turn it by `to_world`. Below the horizon \
              it is dark. One unit of radiance is 1 W·m⁻²·sr⁻¹·nm⁻¹. Colours beyond Rec. 709 are cut \
              off at zero, where Mitsuba goes on below.",
    parameters: &[
        parameter("turbidity", "float", "3", "From 1, the clearest air, to 10, haze."),
        parameter("albedo", "spectrum", "0.3", "What share of the light the ground sends back."),
        parameter("sun_direction", "vector", "", "Towards the sun; instead of time and place."),
        parameter("latitude", "float", "35.6894", "Degrees north; Tokyo's."),
        parameter("longitude", "float", "139.6917", "Degrees east."),
        parameter("timezone", "float", "9", "Hours ahead of universal time."),
        parameter("year", "integer", "2010", "Year."),
        parameter("month", "integer", "7", "Month, from 1."),
        parameter("day", "integer", "10", "Day of the month, from 1."),
        parameter("hour", "float", "15", "Hour of the day."),
        parameter("minute", "float", "0", "Minute."),
        parameter("second", "float", "0", "Second."),
        parameter("sun_scale", "float", "1", "A factor on the sun; 0 leaves it out."),
        parameter("sky_scale", "float", "1", "A factor on the sky; 0 leaves it out."),
        parameter(
            "sun_aperture",
            "float",
            "0.5358",
            "The angle that the sun's disk takes, in degrees. Its light stays the same.",
        ),
        parameter(
            "complex_sun",
            "boolean",
            "false",
            "The disk is darker at its rim, instead of the same all over.",
        ),
        parameter(
            "stretch",
            "float",
            "1",
            "From 1 to 2: polar angles of the sky and the sun are multiplied by it, which brings light \
             below the horizon (Mitsuba 0.6).",
        ),
        parameter(
            "extend",
            "boolean",
            "false",
            "Whether the sky fades out below the horizon, instead of ending there (Mitsuba 0.6).",
        ),
        parameter("to_world", "transform", "", "Turns the sky; `sun_direction` stays."),
        SAMPLING_WEIGHT,
    ],
    sample: r#"<emitter type="sunsky">
    <float name="turbidity" value="4"/>
    <vector name="sun_direction" x="0.3" y="0.2" z="0.5"/>
</emitter>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[
        r#"<emitter type="sunsky"><vector name="sun_direction" x="0.3" y="0.2" z="0.5"/><float name="sun_aperture" value="30"/><transform name="to_world"><rotate x="1" angle="30"/></transform></emitter>"#,
        r#"<emitter type="sunsky"><vector name="sun_direction" x="0.3" y="0.2" z="0.5"/><float name="sun_aperture" value="30"/><float name="stretch" value="1.5"/></emitter>"#,
        r#"<emitter type="sunsky"><vector name="sun_direction" x="0.3" y="0.2" z="0.5"/><float name="sun_aperture" value="30"/><boolean name="extend" value="true"/></emitter>"#,
    ],
    leaving: &[
        r#"<emitter type="sunsky"><vector name="sun_direction" x="0.3" y="0.2" z="0.5"/></emitter>"#,
    ],
    extreme: &[
        r#"<emitter type="sunsky"><vector name="sun_direction" x="1" y="0" z="0"/><float name="turbidity" value="10"/></emitter>"#,
    ],
};

/// The true angular diameter of the sun in degrees. The total power is that of a disk of this size.
const TRUE_APERTURE: f64 = 0.5358;
/// Cells for sampling, over azimuth and polar angle.
const CELLS: (u32, u32) = (128, 64);
/// The least weight of a cell, relative to the mean.
const FLOOR: f32 = 0.02;
/// The least probability of sampling the sky or the sun when both are present.
const LEAST_SHARE: f32 = 0.1;

/// The sky and the sun.
#[derive(Clone, Debug)]
pub struct SunSky {
    to_world: Transform,
    dome: Dome,
    sky_scale: f32,
    sun: Option<Sun>,
    /// Over azimuth and polar angle of the dome.
    distribution: Distribution2D,
    sun_probability: f32,
}

/// The sun's disk.
#[derive(Clone, Debug)]
struct Sun {
    /// 1 − cos of half the angular diameter.
    one_minus_cosine: f32,
    sine: f64,
    radiance: SunRadiance,
    frame: Frame,
}

#[derive(Clone, Debug)]
enum SunRadiance {
    Uniform(Spectrum),
    Darkened { disk: Disk, scale: f32 },
}

/// Reads the sky and the sun.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<SunSky> {
    let turbidity = parameters.float_in("turbidity", 3.0, 1.0..=10.0);
    let albedo = read_albedo(builder, parameters);
    let range = 0.0..=f64::from(f32::MAX);
    let sun_scale = parameters.float_in("sun_scale", 1.0, range.clone()) as f32;
    let sky_scale = parameters.float_in("sky_scale", 1.0, range) as f32;
    let aperture = parameters.float_in("sun_aperture", TRUE_APERTURE, 1e-3..180.0);
    let complex_sun = parameters.boolean("complex_sun", false);
    let stretch = parameters.float_in("stretch", 1.0, 1.0..=2.0) as f32;
    let extend = parameters.boolean("extend", false);
    let to_world = read_transform(parameters, "to_world")?;
    let sun_direction = read_sun_direction(parameters, &to_world)?;
    if sun_direction.z < 0.0 {
        let message = "the sun is below the horizon: there is no light";
        parameters.warning(Fault::BadValue, "sun_direction", message);
    }
    let elevation = sun_direction.z.clamp(0.0, 1.0).asin();
    let sky = Sky::new(&Conditions { turbidity, albedo, elevation });
    let half_angle = (0.5 * aperture).to_radians();
    let true_half_angle = (0.5 * TRUE_APERTURE).to_radians();
    let smaller = (0.5 * true_half_angle).sin() / (0.5 * half_angle).sin();
    let scale = sun_scale * (smaller * smaller) as f32;
    let is_up = sun_direction.z >= 0.0;
    let direction = sun_direction.as_vec3().normalize();
    let dome = Dome { sky, sun_direction: direction, stretch, extend };
    let sun = (sun_scale > 0.0 && is_up).then(|| {
        let disk = Disk::new(turbidity);
        let radiance = if complex_sun {
            SunRadiance::Darkened { disk, scale }
        } else {
            SunRadiance::Uniform(Spectrum::from_rgb(disk.mean_radiance(elevation)) * scale)
        };
        Sun {
            one_minus_cosine: warp::uniform_cone::one_minus_cosine(half_angle as f32),
            sine: half_angle.sin(),
            radiance,
            frame: Frame::from_normal(stretched(direction, stretch)),
        }
    });
    SunSky::new(to_world, (dome, if is_up { sky_scale } else { 0.0 }), sun)
}

fn read_albedo(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> [f64; 3] {
    let color = match builder.color(parameters, "albedo", 0.3, SpectrumUse::Reflectance) {
        ColorSource::Constant(color) => color,
        ColorSource::Texture(_) => {
            let message = "the ground has one colour: no texture can stand here";
            parameters.error(Fault::BadValue, "albedo", message);
            Spectrum::splat(0.3)
        }
    };
    if color.max_component() > 1.0 {
        parameters.error(Fault::BadValue, "albedo", "an albedo is at most 1");
    }
    color.rgb().map(f64::from)
}

/// A unit direction whose polar angle is multiplied by `stretch`.
fn stretched(direction: Vec3, stretch: f32) -> Vec3 {
    if stretch == 1.0 {
        return direction;
    }
    let theta = direction.truncate().length().atan2(direction.z);
    let (sin, cos) = (stretch * theta).sin_cos();
    (sin * direction.truncate().normalize_or(Vec2::X)).extend(cos)
}

/// The unit direction towards the sun in the emitter's space.
fn read_sun_direction(parameters: &Parameters<'_>, to_world: &Transform) -> Option<DVec3> {
    const OTHERS: [&str; 9] =
        ["latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"];
    let given = parameters.optional_vector("sun_direction");
    let place = Place {
        latitude: parameters.float_in("latitude", 35.6894, -90.0..=90.0),
        longitude: parameters.float_in("longitude", 139.6917, -360.0..=360.0),
        timezone: parameters.float_in("timezone", 9.0, -24.0..=24.0),
    };
    let moment = Moment {
        year: parameters.integer_in("year", 2010, -4000..=10_000),
        month: parameters.integer_in("month", 7, 1..=12),
        day: parameters.integer_in("day", 10, 1..=31),
        hour: parameters.float_in("hour", 15.0, -48.0..=48.0),
        minute: parameters.float_in("minute", 0.0, -3600.0..=3600.0),
        second: parameters.float_in("second", 0.0, -86_400.0..=86_400.0),
    };
    let Some(given) = given else {
        return Some(position::direction(&moment, &place));
    };
    if let Some(other) = OTHERS.into_iter().find(|other| parameters.has(other)) {
        let message = "`sun_direction` and time or place say the same thing: give one of them";
        parameters.error(Fault::BadValue, other, message);
        return None;
    }
    let local = to_world.inverse_vector(given.as_vec3()).as_dvec3().try_normalize();
    if local.is_none() {
        parameters.error(Fault::BadValue, "sun_direction", "the direction has no length");
    }
    local
}

impl Light for SunSky {
    fn is_black(&self) -> bool {
        false
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn sample_direction(
        &self,
        _scene: &impl SceneView,
        _reference: Vec3,
        random: Vec2,
    ) -> Option<DirectionSample> {
        self.sample(random)
    }

    fn pdf_direction(
        &self,
        _scene: &impl SceneView,
        _reference: Vec3,
        direction: Vec3,
        _surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        self.pdf(direction)
    }

    fn distant_radiance(&self, direction: Vec3) -> Spectrum {
        self.radiance(direction)
    }

    fn sample_ray(
        &self,
        scene: &impl SceneView,
        place: Vec2,
        direction: Vec2,
    ) -> Option<RaySample> {
        sample_ray_from_afar(self, scene, place, direction)
    }
}

impl SunSky {
    /// Never `None`, because every cell has a minimum weight.
    fn new(to_world: Transform, (dome, sky_scale): (Dome, f32), sun: Option<Sun>) -> Option<Self> {
        let (columns, rows) = CELLS;
        let cell = Vec2::new(1.0 / columns as f32, 1.0 / rows as f32);
        let mut weights = Vec::with_capacity((columns * rows) as usize);
        for row in 0..rows {
            for column in 0..columns {
                let place = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) * cell;
                let radiance = dome.radiance(dome.unmap(place));
                let sin_theta = (place.y * dome.reach()).sin();
                weights.push(radiance.luminance() * sin_theta);
            }
        }
        let mean = weights.iter().sum::<f32>() / weights.len() as f32;
        let floor = if mean > 0.0 { FLOOR * mean } else { 1.0 };
        weights.iter_mut().for_each(|weight| *weight += floor);
        // The map stretches the unit square to 2π by π/2, or more of a stretched dome.
        let sky_light = sky_scale * mean * TAU * dome.reach();
        let sun_light = sun.as_ref().map_or(0.0, |sun| {
            sun.radiance(0.0, dome.sun_direction.z).luminance() * TAU * sun.one_minus_cosine
        });
        let sun_probability = match (sun_light > 0.0, sky_light > 0.0) {
            (true, true) => {
                (sun_light / (sun_light + sky_light)).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE)
            }
            (true, false) => 1.0,
            _ => 0.0,
        };
        let distribution = Distribution2D::new(&weights, CELLS).ok()?;
        Some(Self { to_world, dome, sky_scale, sun, distribution, sun_probability })
    }

    /// Radiance from the unit world direction `direction`.
    fn radiance(&self, direction: Vec3) -> Spectrum {
        self.local_radiance(self.local(direction))
    }

    fn local(&self, direction: Vec3) -> Vec3 {
        self.to_world.inverse_vector(direction).normalize_or(-Vec3::Z)
    }

    fn local_radiance(&self, local: Vec3) -> Spectrum {
        if !self.dome.covers(local) {
            return Spectrum::ZERO;
        }
        let sky = self.dome.radiance(local) * self.sky_scale;
        match &self.sun {
            Some(sun) if sun.holds(local) => {
                // The disk of a stretched dome is that of the sun's true height.
                let height =
                    if self.dome.stretch == 1.0 { local.z } else { self.dome.sun_direction.z };
                sky + sun.radiance(sun.frame.n.cross(local).length(), height)
            }
            _ => sky,
        }
    }

    /// Samples a direction of incoming light.
    fn sample(&self, random: Vec2) -> Option<DirectionSample> {
        let local = match &self.sun {
            Some(sun) if random.x < self.sun_probability => {
                let random = Vec2::new(random.x / self.sun_probability, random.y);
                let random = random.min(Vec2::splat(1.0 - f32::EPSILON));
                sun.frame.to_world(warp::uniform_cone::sample(random, sun.one_minus_cosine))
            }
            _ => {
                let rest = (random.x - self.sun_probability) / (1.0 - self.sun_probability);
                let random = Vec2::new(rest, random.y);
                let place = self.distribution.sample(random.min(Vec2::splat(1.0 - f32::EPSILON))).0;
                self.dome.unmap(place)
            }
        };
        let direction = self.to_world.vector(local).try_normalize()?;
        let pdf = self.local_pdf(local);
        (pdf.is_finite() && pdf > 0.0).then(|| DirectionSample {
            direction,
            radiance: self.local_radiance(local),
            pdf,
            delta: false,
            target: Target::Afar,
        })
    }

    /// The density with which [`sample`](Self::sample) chooses a direction.
    fn pdf(&self, direction: Vec3) -> f32 {
        self.local_pdf(self.local(direction))
    }

    fn local_pdf(&self, local: Vec3) -> f32 {
        if !self.dome.covers(local) {
            return 0.0;
        }
        let sin_theta = local.truncate().length();
        let area = TAU * self.dome.reach() * sin_theta;
        let place = self.dome.map(local);
        let sky = if area > 0.0 { self.distribution.pdf(place) / area } else { 0.0 };
        let sun = match &self.sun {
            Some(sun) if sun.holds(local) => 1.0 / (TAU * sun.one_minus_cosine),
            _ => 0.0,
        };
        sky * (1.0 - self.sun_probability) + sun * self.sun_probability
    }
}

impl Sun {
    /// Whether a unit direction points to the disk. The squared chord resolves small angles: half
    /// of it is 1 − cos.
    fn holds(&self, local: Vec3) -> bool {
        0.5 * (local - self.frame.n).length_squared() <= self.one_minus_cosine
    }

    /// The radiance at the angle with sine `sin_gamma` from the disk's centre. `height` is the sine
    /// of the elevation.
    fn radiance(&self, sin_gamma: f32, height: f32) -> Spectrum {
        match &self.radiance {
            SunRadiance::Uniform(radiance) => *radiance,
            SunRadiance::Darkened { disk, scale } => {
                let ratio = f64::from(sin_gamma) / self.sine;
                let cos_psi = (1.0 - ratio * ratio).max(0.0).sqrt();
                let elevation = f64::from(height.clamp(0.0, 1.0)).asin();
                Spectrum::from_rgb(disk.radiance(elevation, cos_psi)) * *scale
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::{Class, Value};

    fn node() -> TestNode {
        TestNode::new(Class::Emitter, "sunsky")
    }

    fn with_sun(x: f64, y: f64, z: f64) -> TestNode {
        node().with("sun_direction", Value::Vector(DVec3::new(x, y, z)))
    }

    fn assert_close(found: Spectrum, expected: [f32; 3], tolerance: f32, what: &str) {
        for (found, expected) in found.rgb().into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found} {expected}");
        }
    }

    /// Values from Mitsuba 3.9.1.
    #[test]
    fn the_sky_is_that_of_mitsuba() {
        let clear = with_sun(0.3, 0.2, 0.5);
        let hazy = with_sun(0.3, 0.2, 0.5)
            .float("turbidity", 6.3)
            .with("albedo", Value::Rgb(DVec3::new(0.1, 0.5, 0.9)));
        let low = with_sun(0.8, -0.6, 0.05).float("turbidity", 2.5);
        let cases = [
            (&clear, Vec3::Z, [0.029_990_56, 0.049_319_14, 0.097_193_89]),
            (&clear, Vec3::new(0.5, 0.1, 0.3), [0.088_136_31, 0.128_220_81, 0.198_913_5]),
            (&clear, Vec3::new(0.1, -1.0, 1e-3), [0.144_351_44, 0.168_594_27, 0.158_543_36]),
            (&hazy, Vec3::Z, [0.063_674_41, 0.092_438_78, 0.157_179_89]),
            (&hazy, Vec3::new(-0.7, 0.4, 0.1), [0.093_660_57, 0.193_185_25, 0.343_076_85]),
            (&low, Vec3::new(0.5, 0.1, 0.3), [0.022_786_65, 0.027_664_15, 0.029_191_2]),
        ];
        for (node, direction, expected) in cases {
            let sky = node.build_cleanly(build);
            let found = sky.radiance(direction.normalize());
            assert_close(found, expected, 2e-3, &format!("{direction}"));
        }
    }

    /// Values from Mitsuba 3.9.1, at the centre of the disk, 0.15° and 0.25° away.
    #[test]
    fn the_sun_is_that_of_mitsuba() {
        let sun = Vec3::new(0.3, 0.2, 0.5).normalize();
        let aside = sun.cross(Vec3::Z).normalize();
        let expected = [
            (0.0_f32, [26_187.324, 22_622.883, 18_186.91]),
            (0.15, [24_132.822, 20_496.002, 16_047.568]),
            (0.25, [17_344.484, 13_678.634, 9_489.934]),
        ];
        let node = with_sun(0.3, 0.2, 0.5);
        let uniform = node.build_cleanly(build);
        let darkened = node.with("complex_sun", Value::Boolean(true)).build_cleanly(build);
        for (degrees, expected) in expected {
            let direction = (sun + aside * degrees.to_radians().tan()).normalize();
            assert_close(darkened.radiance(direction), expected, 3e-3, "darkened");
            assert_close(
                uniform.radiance(direction),
                [21_721.39, 18_083.188, 13_739.587],
                3e-3,
                "uniform",
            );
        }
        let beyond = (sun + aside * 0.28_f32.to_radians().tan()).normalize();
        assert!(uniform.radiance(beyond).luminance() < 10.0);
    }

    #[test]
    fn both_disks_send_the_same_light_whatever_their_size() {
        let light = |node: TestNode| {
            let sky = node.float("sky_scale", 0.0).build_cleanly(build);
            let count = 64;
            let mut sum = 0.0;
            for x in 0..count {
                for y in 0..count {
                    let random = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / count as f32;
                    let sample = sky.sample(random).expect("the sun is up");
                    sum += f64::from(sample.radiance.luminance() / sample.pdf);
                }
            }
            sum / f64::from(count * count)
        };
        let simple = light(with_sun(0.3, 0.2, 0.5));
        let darkened = light(with_sun(0.3, 0.2, 0.5).with("complex_sun", Value::Boolean(true)));
        let large = light(with_sun(0.3, 0.2, 0.5).float("sun_aperture", 5.0));
        assert!((darkened / simple - 1.0).abs() < 2e-3, "{darkened} {simple}");
        assert!((large / simple - 1.0).abs() < 1e-4, "{large} {simple}");
    }

    /// With `stretch`, what lies at the angle θ from the zenith is what lay at θ / `stretch`; with
    /// `extend`, the sky fades from the horizon to the nadir.
    #[test]
    fn a_stretched_sky_reaches_below_the_horizon() {
        let at = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Vec3::new(0.0, sin, cos)
        };
        let plain = with_sun(0.3, 0.2, 0.5).build_cleanly(build);
        let wide = with_sun(0.3, 0.2, 0.5).float("stretch", 1.5).build_cleanly(build);
        for degrees in [10.0, 50.0, 88.0] {
            let expected = plain.radiance(at(degrees)).rgb();
            assert_close(wide.radiance(at(1.5 * degrees)), expected, 1e-3, "stretched");
        }
        assert_eq!(wide.radiance(at(136.0)), Spectrum::ZERO, "1.5 times 90° is where it ends");
        let sun = plain.dome.sun_direction;
        let theta = sun.z.acos();
        let lower = Vec3::new(0.3, 0.2, 0.0).normalize() * (1.5 * theta).sin()
            + Vec3::Z * (1.5 * theta).cos();
        assert!(wide.radiance(lower).luminance() > 1e4, "the sun moves along");

        let extended =
            with_sun(0.3, 0.2, 0.5).with("extend", Value::Boolean(true)).build_cleanly(build);
        assert_eq!(extended.radiance(at(60.0)), plain.radiance(at(60.0)));
        let horizon = plain.radiance(at(89.99)).rgb();
        assert_close(extended.radiance(at(135.0)), horizon.map(|value| 0.5 * value), 2e-2, "faded");
        assert!(extended.radiance(at(180.0)).luminance() < 1e-6);
    }

    #[test]
    fn at_night_it_is_dark_and_two_suns_are_an_error() {
        let night = with_sun(0.3, 0.2, -0.5);
        let sky = night.build(build).expect("a warning is no error");
        assert_eq!(night.findings()[0].fault, Fault::BadValue);
        assert_eq!(sky.radiance(Vec3::Z), Spectrum::ZERO);
        let both = with_sun(0.3, 0.2, 0.5).float("hour", 12.0);
        assert!(both.build(build).is_none());
    }
}
