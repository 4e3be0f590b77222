//! `envmap`: an environment map.

use super::{
    DirectionSample, Light, RaySample, SAMPLING_WEIGHT, SceneView, Target, sample_ray_from_afar,
};
use crate::builder::{Assets, Builder};
use crate::inputs::picture_in_memory;
use crate::inputs::transform::read_transform;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use etendue_document::{Fault, Parameters};
use etendue_image::{Bitmap, Samples};
use etendue_math::Transform;
use etendue_sampling::Distribution2D;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Surrounds the scene with a picture in latitude–longitude coordinates: +y is the top row, and \
              the middle of the picture lies along +z. Bright parts are sampled in proportion.",
    parameters: &[
        parameter(
            "filename",
            "string",
            "",
            "The picture: EXR, HDR, PFM, PNG, JPEG and others; required unless there is `data`.",
        ),
        parameter("data", "buffer", "", "Instead of a file: texels in memory, as of `bitmap`."),
        parameter("scale", "float", "1", "A factor on the radiance."),
        parameter("to_world", "transform", "", "Rotates the environment."),
        parameter(
            "mis_compensation",
            "boolean",
            "false",
            "Sample only what is brighter than the mean, and leave the rest to the materials' samples \
             (Karlík et al. 2019): less noise for most scenes, but wrong for integrators that do not \
             sample materials.",
        ),
        SAMPLING_WEIGHT,
    ],
    sample: r#"<emitter type="envmap"><string name="filename" value="sample.exr"/><float name="scale" value="2"/></emitter>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[
        r#"<emitter type="envmap"><string name="filename" value="sky.exr"/><transform name="to_world"><rotate x="1" y="2" z="0.5" angle="40"/></transform></emitter>"#,
    ],
    leaving: &[
        r#"<emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>"#,
    ],
    extreme: &[
        r#"<emitter type="envmap"><string name="filename" value="sky.exr"/><transform name="to_world"><scale x="1e-10" y="1" z="1e10"/></transform></emitter>"#,
    ],
};

/// An environment map. Clones share the image.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    to_world: Transform,
    picture: Arc<Panorama>,
}

/// The image and its data for sampling directions.
#[derive(Debug)]
struct Panorama {
    width: usize,
    height: usize,
    /// RGB radiance, row by row from the top.
    texels: Vec<[f32; 3]>,
    /// Whether colours of wider primaries became negative in those of BT.709.
    is_out_of_gamut: bool,
    /// Over cells whose corners are four neighbouring texels; `None` if all of them are black.
    distribution: Option<Distribution2D>,
}

/// Reads the image and prepares its sampling.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<EnvironmentMap> {
    let to_world = read_transform(parameters, "to_world");
    let picture = builder.assets.kept(parameters, &["to_world"], |assets, parameters| {
        read_picture(assets, parameters).map(Arc::new)
    });
    Some(EnvironmentMap { to_world: to_world?, picture: picture? })
}

fn read_picture(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Panorama> {
    let scale = parameters.float_in("scale", 1.0, 0.0..=f64::from(f32::MAX)) as f32;
    let in_memory = parameters.has("data");
    let (name, mut bitmap) = if in_memory {
        ("`data`".to_owned(), picture_in_memory::read(parameters)?)
    } else {
        read_file(assets, parameters)?
    };
    let source = if in_memory { "data" } else { "filename" };
    for warning in &bitmap.warnings {
        parameters.warning(Fault::Unsupported, source, format!("{name}: {warning}"));
    }
    if let Some(problem) = mend(&mut bitmap) {
        parameters.warning(Fault::BadValue, source, format!("{name}: {problem}"));
    }
    let image = bitmap.to_color_image();
    let size = [image.width as usize, image.height as usize];
    let texels: Vec<[f32; 3]> =
        image.pixels.into_iter().map(|texel| texel.map(|x| x * scale)).collect();
    let compensation = match parameters.boolean("mis_compensation", false) {
        true => Compensation::AboveMean,
        false => Compensation::None,
    };
    let picture = Panorama::new(size, texels, compensation);
    if picture.is_none() {
        let message = format!("{name}: the picture is too bright for single precision");
        parameters.error(Fault::BadValue, source, message);
    }
    picture
}

/// The memory of a texel: its colour, twice while the map is built, and its weight in the tables.
const BYTES_PER_TEXEL: u64 = 2 * 12 + 8;

/// What stands for an infinite texel: the greatest half float, because most infinities come from
/// numbers beyond it.
const BRIGHTEST: f32 = 65504.0;

/// Replaces texels that are not finite or negative, and says which; `None` if there are none. The
/// texels are those of the file: in the primaries of BT.709, colours beyond them are negative.
fn mend(bitmap: &mut Bitmap) -> Option<String> {
    if matches!(bitmap.samples, Samples::U8(_) | Samples::U16(_)) {
        return None;
    }
    let channels = bitmap.channels as usize;
    let color_count = if bitmap.has_alpha() { channels - 1 } else { channels };
    let mut values = bitmap.to_raw();
    let is_sound = |value: &f32| value.is_finite() && *value >= 0.0;
    let texels = values.chunks_exact(channels).map(|texel| &texel[..color_count]).enumerate();
    let mut broken = texels.filter(|(_, texel)| !texel.iter().all(is_sound));
    let (first, texel) = broken.next()?;
    let more = match broken.count() {
        0 => String::new(),
        count => format!(", and {count} others are broken too"),
    };
    let width = bitmap.width as usize;
    let (x, y) = (first % width, first / width);
    let texel = texel.iter().map(f32::to_string).collect::<Vec<_>>().join(", ");
    let problem = format!(
        "texel {x}, {y} is {texel}{more}: NaN and negative values count as 0, infinity as {BRIGHTEST}"
    );
    for texel in values.chunks_exact_mut(channels) {
        for value in texel[..color_count].iter_mut().filter(|value| !is_sound(value)) {
            *value = if *value == f32::INFINITY { BRIGHTEST } else { 0.0 };
        }
    }
    bitmap.samples = Samples::F32(values);
    Some(problem)
}

/// The image of the file and the file's name; `None` after an error has been reported.
fn read_file(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<(String, Bitmap)> {
    let (path, bytes) = assets.read_file(parameters, "filename")?;
    match assets.decode_picture((&path, &bytes), BYTES_PER_TEXEL) {
        Ok(bitmap) => Some((path.display().to_string(), bitmap)),
        Err((fault, message)) => {
            parameters.error(fault, "filename", message);
            None
        }
    }
}

/// The part of the radiance that is left to BSDF sampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Compensation {
    /// Nothing.
    None,
    /// The mean (Karlík, Šik, Vévoda, Skřivan and Křivánek, "MIS Compensation: Optimizing Sampling
    /// Techniques in Multiple Importance Sampling", 2019).
    AboveMean,
}

/// The weights of cells, from the luminance and the sine of the polar angle of each. Cells at or
/// below the mean get no weight, unless none would remain.
fn compensated(cells: &[(f32, f32)]) -> Vec<f32> {
    let sum = |value: fn(&(f32, f32)) -> f32| {
        cells.iter().map(|cell| f64::from(value(cell))).sum::<f64>()
    };
    let mean = (sum(|(luminance, sine)| luminance * sine) / sum(|(_, sine)| *sine)) as f32;
    let weights: Vec<f32> =
        cells.iter().map(|(luminance, sine)| (luminance - mean).max(0.0) * sine).collect();
    // A uniform image equals its mean, up to rounding.
    if weights.iter().all(|weight| *weight <= 1e-6 * mean) {
        return cells.iter().map(|(luminance, sine)| luminance * sine).collect();
    }
    weights
}

impl Light for EnvironmentMap {
    fn is_black(&self) -> bool {
        self.picture.distribution.is_none()
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn is_out_of_gamut(&self) -> bool {
        self.picture.is_out_of_gamut
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

impl Panorama {
    fn new(
        [width, height]: [usize; 2],
        texels: Vec<[f32; 3]>,
        compensation: Compensation,
    ) -> Option<Self> {
        if texels.iter().flatten().any(|value| !value.is_finite()) {
            return None;
        }
        let is_out_of_gamut = texels.iter().flatten().any(|value| *value < 0.0);
        if texels.iter().flatten().all(|value| *value == 0.0) {
            return Some(Self { width, height, texels, is_out_of_gamut, distribution: None });
        }
        // Colours beyond those of real lights may have a negative luminance.
        let luminance = texels.iter().map(|texel| Spectrum::from_rgb(*texel).luminance().max(0.0));
        let luminance: Vec<f32> = luminance.collect();
        // There is one row of cells less than rows of texels, because the first and last rows of
        // texels lie on the poles.
        let rows = (height - 1).max(1);
        let mut cells = Vec::with_capacity(width * rows);
        for y in 0..rows {
            let sin_theta = ((y as f32 + 0.5) / rows as f32 * PI).sin();
            for x in 0..width {
                let below = (y + 1).min(height - 1) * width;
                let corners = [
                    y * width + x,
                    y * width + (x + 1) % width,
                    below + x,
                    below + (x + 1) % width,
                ];
                let around = corners.iter().map(|corner| luminance[*corner]).sum::<f32>();
                cells.push((around, sin_theta));
            }
        }
        let weights = match compensation {
            Compensation::None => cells.iter().map(|(around, sine)| around * sine).collect(),
            Compensation::AboveMean => compensated(&cells),
        };
        let distribution = Distribution2D::new(&weights, (width as u32, rows as u32)).ok()?;
        Some(Self { width, height, texels, is_out_of_gamut, distribution: Some(distribution) })
    }
}

impl EnvironmentMap {
    /// Radiance from the unit world direction `direction`.
    fn radiance(&self, direction: Vec3) -> Spectrum {
        let picture = &*self.picture;
        let cell = self.cell_coordinates(direction);
        let x = cell.x * picture.width as f32;
        let y = cell.y * (picture.height - 1) as f32;
        let (left, top) =
            ((x as usize).min(picture.width - 1), (y as usize).min(picture.height - 1));
        let right = if left + 1 == picture.width { 0 } else { left + 1 };
        let bottom = (top + 1).min(picture.height - 1);
        let texel = |x: usize, y: usize| Spectrum::from_rgb(picture.texels[y * picture.width + x]);
        let across = x - left as f32;
        let upper = texel(left, top).lerp(texel(right, top), across);
        let lower = texel(left, bottom).lerp(texel(right, bottom), across);
        upper.lerp(lower, y - top as f32)
    }

    /// The cell coordinates of a direction: x spans the image's width, starting at the centre of
    /// the first texel; y is the polar angle over π.
    fn cell_coordinates(&self, direction: Vec3) -> Vec2 {
        let local = self.to_world.inverse_vector(direction).normalize_or(Vec3::Y);
        let u = local.x.atan2(-local.z) / TAU - 0.5 / self.picture.width as f32;
        // The arc cosine would lose precision near the poles.
        let v = local.x.hypot(local.z).atan2(local.y) / PI;
        // Rounding may yield one, which is out of range.
        Vec2::new(u - u.floor(), v).min(Vec2::splat(1.0 - f32::EPSILON))
    }

    /// Samples a direction of incoming light.
    fn sample(&self, random: Vec2) -> Option<DirectionSample> {
        let (cell, density) = self.picture.distribution.as_ref()?.sample(random);
        let (sin_azimuth, cos_azimuth) =
            ((cell.x + 0.5 / self.picture.width as f32) * TAU).sin_cos();
        let (sin_theta, cos_theta) = (cell.y * PI).sin_cos();
        let local = Vec3::new(sin_azimuth * sin_theta, cos_theta, -cos_azimuth * sin_theta);
        let direction = self.to_world.vector(local).try_normalize()?;
        let pdf = density / (2.0 * PI * PI * sin_theta);
        (pdf.is_finite() && pdf > 0.0).then(|| DirectionSample {
            direction,
            radiance: self.radiance(direction),
            pdf,
            delta: false,
            target: Target::Afar,
        })
    }

    /// The density with which [`sample`](Self::sample) chooses a direction.
    fn pdf(&self, direction: Vec3) -> f32 {
        let cell = self.cell_coordinates(direction);
        let sin_theta = (cell.y * PI).sin();
        match &self.picture.distribution {
            Some(distribution) if sin_theta > 0.0 => {
                distribution.pdf(cell) / (2.0 * PI * PI * sin_theta)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::TestRng;

    /// Red is the column, green is the row.
    fn counting_map() -> EnvironmentMap {
        let texels = (0..4).flat_map(|y| (0..8).map(move |x| [x as f32, y as f32, 1.0])).collect();
        let picture = Panorama::new([8, 4], texels, Compensation::None).expect("it is bright");
        EnvironmentMap { to_world: Transform::IDENTITY, picture: Arc::new(picture) }
    }

    /// Values from Mitsuba 3.9.1 for the same image.
    #[test]
    fn directions_fall_where_mitsuba_puts_them() {
        let expected = [
            ([0.0, 0.0, 1.0], [3.5, 1.5]),
            ([0.0, 0.0, -1.0], [3.5, 1.5]),
            ([1.0, 0.0, 0.0], [1.5, 1.5]),
            ([-1.0, 0.0, 0.0], [5.5, 1.5]),
            ([0.3, 0.5, -0.7], [0.015_523_9, 0.945_23]),
            ([-0.1, 0.05, -1.0], [4.388_31, 1.452_53]),
            ([0.9, -0.3, 0.2], [1.778_42, 1.800_41]),
        ];
        for (direction, [red, green]) in expected {
            let found = counting_map().radiance(Vec3::from(direction).normalize()).rgb();
            assert!(
                (found[0] - red).abs() < 1e-4 && (found[1] - green).abs() < 1e-4,
                "{direction:?}: {found:?}"
            );
        }
    }

    #[test]
    fn the_density_of_a_sample_is_that_of_its_direction() {
        let mut random = TestRng::new(7);
        let map = counting_map();
        for _ in 0..1000 {
            let sample =
                map.sample(Vec2::new(random.next_f32(), random.next_f32())).expect("bright");
            let pdf = map.pdf(sample.direction);
            assert!((pdf / sample.pdf - 1.0).abs() < 2e-3, "{sample:?}: {pdf}");
        }
    }

    #[test]
    fn broken_texels_are_replaced_and_named() {
        let picture = |texels: &[[f32; 3]]| Bitmap {
            width: 3,
            height: 2,
            channels: 3,
            samples: Samples::F32(texels.as_flattened().to_vec()),
            ..Bitmap::default()
        };
        let mut texels = vec![[0.5; 3]; 6];
        assert_eq!(mend(&mut picture(&texels)), None);
        texels[4] = [f32::INFINITY, f32::NAN, -1.0];
        texels[5][0] = f32::NEG_INFINITY;
        let mut broken = picture(&texels);
        let problem = mend(&mut broken).expect("a problem");
        assert!(problem.contains("texel 1, 1 is inf, NaN, -1, and 1 others"), "{problem}");
        let mended = [[0.5; 3], [BRIGHTEST, 0.0, 0.0], [0.0, 0.5, 0.5]];
        assert_eq!(broken.to_raw()[9..], *mended.as_flattened());
    }

    #[test]
    fn a_black_picture_is_never_sampled() {
        for compensation in [Compensation::None, Compensation::AboveMean] {
            let picture =
                Panorama::new([2, 2], vec![[0.0; 3]; 4], compensation).expect("a picture");
            let map = EnvironmentMap { to_world: Transform::IDENTITY, picture: Arc::new(picture) };
            assert!(map.is_black() && map.sample(Vec2::splat(0.5)).is_none());
            assert_eq!((map.pdf(Vec3::X), map.radiance(Vec3::X)), (0.0, Spectrum::ZERO));
        }
    }

    #[test]
    fn pictures_beyond_single_precision_are_refused() {
        let texels = vec![[f32::MAX; 3]; 4];
        assert!(Panorama::new([2, 2], texels, Compensation::None).is_none());
    }

    #[test]
    fn compensation_leaves_out_what_is_below_the_mean_but_not_everything() {
        let cells = [(1.0, 1.0), (2.0, 0.5), (4.0, 0.5)];
        assert_eq!(compensated(&cells), [0.0, 0.0, 1.0], "the mean is 2");
        assert_eq!(compensated(&[(3.0, 1.0), (3.0, 0.5)]), [3.0, 1.5]);
    }
}
