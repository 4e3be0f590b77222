//! A measured material: the contents of its file, validated and ready for lookup.

use super::grids::{Densities, Grids, Mix};
use super::tensor_file::{self, NumberKind, Tensor, TensorError};
use etendue_spectrum::{SampledSpectrum, SpectrumUse};
use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};

/// No measurement has more wavelengths than this.
const MAX_WAVELENGTHS: usize = 4096;

/// A measured material.
#[derive(Clone, Debug)]
pub(super) struct Measurement {
    /// Azimuths of the incident direction, ascending.
    phi: Vec<f32>,
    /// Its elevations, ascending from 0.
    theta: Vec<f32>,
    /// The distribution of microfacet normals.
    pub(super) normals: Grids,
    /// The area of the microfacets projected along a direction.
    pub(super) projected: Grids,
    /// The distribution for sampling visible normals, by incident direction.
    pub(super) visible: Densities,
    /// The distribution that adapts this sampling to the reflected luminance.
    pub(super) luminance: Densities,
    /// The reflectance: one table each of red, green and blue per incident direction.
    pub(super) colors: Grids,
    /// Whether the values must still be multiplied by the distribution of normals.
    pub(super) has_jacobian: bool,
    /// The number of equal parts into which the material's symmetry divides the circle of azimuths.
    pub(super) symmetry: Symmetry,
}

/// The symmetry of a material in azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symmetry {
    /// The material is isotropic.
    Isotropic,
    /// All azimuths are measured.
    Full,
    /// Half of the azimuths are measured. The other half is the point reflection.
    Half,
    /// A quarter of the azimuths is measured. The others are mirror images.
    Quarter,
}

/// A message about a defect in a file.
pub(super) type Problem = String;

struct Fields<'a>(BTreeMap<&'a [u8], Tensor<'a>>);

impl<'a> Fields<'a> {
    fn get(&self, name: &str, kind: NumberKind, dimensions: usize) -> Result<Tensor<'a>, Problem> {
        let tensor = self.0.get(name.as_bytes());
        let tensor = *tensor.ok_or_else(|| format!("the file has no field `{name}`"))?;
        if tensor.kind != kind || tensor.shape().len() != dimensions {
            return Err(format!("the field `{name}` has another type or shape than it should"));
        }
        Ok(tensor)
    }

    /// Reads a field of finite, non-negative numbers.
    fn positive(&self, name: &str, dimensions: usize) -> Result<(Tensor<'a>, Vec<f32>), Problem> {
        let tensor = self.get(name, NumberKind::Float32, dimensions)?;
        let values: Vec<f32> = tensor.floats().collect();
        if values.iter().any(|value| !(value.is_finite() && *value >= 0.0)) {
            return Err(format!(
                "the field `{name}` holds a number that is negative or not finite"
            ));
        }
        Ok((tensor, values))
    }

    /// Reads a field of finite numbers in ascending order.
    fn ascending(&self, name: &str) -> Result<Vec<f32>, Problem> {
        let tensor = self.get(name, NumberKind::Float32, 1)?;
        let values: Vec<f32> = tensor.floats().collect();
        let ordered = values.windows(2).all(|pair| pair[0] < pair[1]);
        if values.is_empty() || !ordered || values.iter().any(|value| !value.is_finite()) {
            return Err(format!("the numbers of the field `{name}` do not ascend"));
        }
        Ok(values)
    }

    /// Reads a single table.
    fn grid(&self, name: &str) -> Result<Grids, Problem> {
        let (tensor, values) = self.positive(name, 2)?;
        let &[rows, columns] = tensor.shape() else { return Err(too_small(name)) };
        Grids::new(columns, rows, values).ok_or_else(|| too_small(name))
    }

    /// Reads one table per incident direction.
    fn densities(&self, name: &str, directions: [usize; 2]) -> Result<Densities, Problem> {
        let (tensor, values) = self.positive(name, 4)?;
        let &[phi, theta, rows, columns] = tensor.shape() else { return Err(too_small(name)) };
        if [phi, theta] != directions {
            return Err(format!("the field `{name}` has another number of incident directions"));
        }
        let grids = Grids::new(columns, rows, values).ok_or_else(|| too_small(name))?;
        let nothing = || format!("a table of the field `{name}` is all zero");
        Densities::new(grids).ok_or_else(nothing)
    }

    /// Reads the reflectance tables, converted to colours.
    fn colors(&self, directions: [usize; 2]) -> Result<Grids, Problem> {
        let is_rgb = self.0.contains_key(&b"rgb"[..]);
        let name = if is_rgb { "rgb" } else { "spectra" };
        let (tensor, values) = self.positive(name, 5)?;
        let &[phi, theta, channels, rows, columns] = tensor.shape() else {
            return Err(too_small(name));
        };
        if [phi, theta] != directions {
            return Err(format!("the field `{name}` has another number of incident directions"));
        }
        let values = if is_rgb {
            if channels != 3 {
                return Err("the field `rgb` needs three channels".to_owned());
            }
            values
        } else {
            let wavelengths = self.ascending("wavelengths")?;
            if wavelengths.len() != channels {
                return Err("there are more or fewer spectra than wavelengths".to_owned());
            }
            to_colors(&values, &wavelengths, rows.saturating_mul(columns))?
        };
        Grids::new(columns, rows, values).ok_or_else(|| too_small(name))
    }
}

fn too_small(name: &str) -> Problem {
    format!("the tables of the field `{name}` need two rows and columns")
}

/// Converts spectra to colours. Each wavelength has `table` consecutive numbers. A colour is linear
/// in the spectrum, so each wavelength contributes its own colour to the sum.
fn to_colors(values: &[f32], wavelengths: &[f32], table: usize) -> Result<Vec<f32>, Problem> {
    if wavelengths.len() > MAX_WAVELENGTHS {
        return Err(format!("more than {MAX_WAVELENGTHS} wavelengths"));
    }
    let color_of = |index: usize| {
        let only = (0..wavelengths.len()).map(|i| if i == index { 1.0 } else { 0.0 }).collect();
        let spectrum = SampledSpectrum::new(wavelengths.to_vec(), only);
        spectrum.map(|spectrum| spectrum.to_rgb_unlimited(SpectrumUse::Unbounded))
    };
    let colors: Vec<[f32; 3]> = (0..wavelengths.len())
        .map(color_of)
        .collect::<Result<_, _>>()
        .map_err(|error| error.to_string())?;
    let of_direction = |spectra: &[f32]| -> Vec<f32> {
        let sum = |place: usize, channel: usize| -> f32 {
            let terms = colors.iter().enumerate();
            terms.map(|(i, color)| spectra[i * table + place] * color[channel]).sum()
        };
        // Clamp colours outside the gamut.
        (0..3)
            .flat_map(|c| (0..table).map(move |p| (p, c)))
            .map(|(p, c)| sum(p, c).max(0.0))
            .collect()
    };
    let size = table.saturating_mul(wavelengths.len()).max(1);
    Ok(values.chunks_exact(size).flat_map(of_direction).collect())
}

impl Measurement {
    /// Reads a file.
    ///
    /// # Errors
    /// A message if the file is not a measurement, or is incomplete.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Problem> {
        let fields = tensor_file::read(bytes).map_err(|error: TensorError| error.to_string())?;
        let fields = Fields(fields);
        let (phi, theta) = (fields.ascending("phi_i")?, fields.ascending("theta_i")?);
        let directions = [phi.len(), theta.len()];
        let jacobian = fields.get("jacobian", NumberKind::Uint8, 1)?;
        Ok(Self {
            normals: fields.grid("ndf")?,
            projected: fields.grid("sigma")?,
            visible: fields.densities("vndf", directions)?,
            luminance: fields.densities("luminance", directions)?,
            colors: fields.colors(directions)?,
            has_jacobian: jacobian.bytes().first().is_some_and(|flag| *flag != 0),
            symmetry: Symmetry::of(&phi),
            phi,
            theta,
        })
    }

    /// The tables around an incident direction, with their weights.
    pub(super) fn mix(&self, phi: f32, theta: f32) -> Mix {
        let [low_phi, high_phi] = between(&self.phi, phi);
        let [low_theta, high_theta] = between(&self.theta, theta);
        [(low_phi, low_theta), (low_phi, high_theta), (high_phi, low_theta), (high_phi, high_theta)]
            .map(|((row, a), (column, b))| (row * self.theta.len() + column, a * b))
    }

    /// The tables of one colour channel.
    pub(super) fn color_mix(mix: &Mix, channel: usize) -> Mix {
        mix.map(|(table, share)| (3 * table + channel, share))
    }
}

/// The two numbers around a value, with their weights. Values outside the range use the ends.
fn between(numbers: &[f32], value: f32) -> [(usize, f32); 2] {
    let high = numbers.partition_point(|number| *number <= value);
    if high == 0 || high == numbers.len() {
        let end = high.saturating_sub(1);
        return [(end, 1.0), (end, 0.0)];
    }
    let share = (value - numbers[high - 1]) / (numbers[high] - numbers[high - 1]);
    [(high - 1, 1.0 - share), (high, share)]
}

impl Symmetry {
    fn of(phi: &[f32]) -> Self {
        let (Some(first), Some(last)) = (phi.first(), phi.last()) else { return Self::Isotropic };
        if phi.len() <= 2 {
            return Self::Isotropic;
        }
        match TAU / (last - first) {
            parts if parts < 1.5 => Self::Full,
            parts if parts < 2.5 => Self::Half,
            parts if parts > 3.5 && parts < 4.5 => Self::Quarter,
            _ => Self::Full,
        }
    }
}

/// Maps a direction to the unit square: the square root of the elevation over π/2, because
/// reflection varies fastest around the normal, and the azimuth from −π to π.
pub(super) fn place(theta: f32, phi: f32) -> glam::Vec2 {
    let across = (phi + PI) / TAU;
    glam::Vec2::new((theta * (2.0 / PI)).sqrt(), across - across.floor())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spectra_become_the_colors_that_they_have() {
        let wavelengths = [360.0, 450.0, 550.0, 650.0, 830.0];
        // Two incident directions with one entry each: grey, and a red that extends into the
        // infrared.
        let values = [[0.5; 5], [0.0, 0.0, 0.0, 1.0, 1.0]].concat();
        let colors = to_colors(&values, &wavelengths, 1).expect("colours");
        assert!(colors[..3].iter().all(|grey| (grey - 0.5).abs() < 1e-3), "{colors:?}");
        let red = SampledSpectrum::new(wavelengths.to_vec(), values[5..].to_vec());
        let red = red.expect("a spectrum").to_rgb(SpectrumUse::Unbounded);
        assert!(colors[3..].iter().zip(red).all(|(a, b)| (a - b).abs() < 1e-6), "{colors:?}");
    }

    #[test]
    fn shares_between_measured_angles_sum_to_one() {
        let numbers = [-1.0, 0.0, 2.0];
        assert_eq!(between(&numbers, 0.5), [(1, 0.75), (2, 0.25)]);
        assert_eq!(between(&numbers, -3.0)[0], (0, 1.0));
        assert_eq!(between(&numbers, 2.0)[0], (2, 1.0));
        assert_eq!(between(&numbers, f32::NAN).iter().map(|(_, share)| share).sum::<f32>(), 1.0);
    }

    #[test]
    fn the_measured_azimuths_tell_the_symmetry() {
        let circle = |parts: f32| [0.0, 0.5, 1.0].map(|share| -PI + share * TAU / parts);
        assert_eq!(Symmetry::of(&[0.0]), Symmetry::Isotropic);
        assert_eq!(Symmetry::of(&circle(1.0)), Symmetry::Full);
        assert_eq!(Symmetry::of(&circle(2.0)), Symmetry::Half);
        assert_eq!(Symmetry::of(&circle(4.0)), Symmetry::Quarter);
    }
}
