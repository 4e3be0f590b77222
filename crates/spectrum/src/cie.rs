//! The CIE 1931 standard observer, illuminant D65, and the integral that converts a spectrum to a
//! colour.

use crate::color::xyz_to_rgb_f64;
use crate::table::parse_table;

/// The shortest wavelength of the observer's table, in nanometres.
pub const WAVELENGTH_MIN: f64 = 360.0;

/// The longest wavelength of the observer's table, in nanometres.
pub const WAVELENGTH_MAX: f64 = 830.0;

const TABLE_STEP: f64 = 5.0;
const TABLE_ROWS: usize = 95;

/// Wavelength, x̄, ȳ, z̄.
const OBSERVER: [[f64; 4]; TABLE_ROWS] = parse_table(include_str!("../data/cie_1931_observer.txt"));

/// Wavelength, relative power.
const D65: [[f64; 2]; TABLE_ROWS] = parse_table(include_str!("../data/cie_d65.txt"));

/// The divisor of D65's power that gives white a luminance of 1. This is the value of Mitsuba 3, to
/// match its colours. The sum in [`integrate`] would need 98.888, which is 0.1 % less, so a
/// reflectance of 1 gives 0.9989.
const D65_POWER: f64 = 98.997_417_518_762_55;

/// The number of samples in the sums below, as in Mitsuba 3, including both ends of the range.
const SAMPLE_COUNT: u32 = 1000;

/// x̄, ȳ and z̄ at a wavelength in nanometres, interpolated linearly between 5 nm steps; zero outside
/// 360 to 830 nm.
#[must_use]
pub fn color_matching(wavelength_nm: f64) -> [f64; 3] {
    let [_, x, y, z] = interpolate(&OBSERVER, wavelength_nm);
    [x, y, z]
}

/// The relative power of illuminant D65 at a wavelength in nanometres, scaled so that white has a
/// luminance of 1; zero outside 360 to 830 nm.
#[must_use]
pub fn d65(wavelength_nm: f64) -> f64 {
    let [_, power] = interpolate(&D65, wavelength_nm);
    power / D65_POWER
}

/// The linear Rec. 709 colour of a spectral density: the sum of density · (x̄, ȳ, z̄) divided by the
/// sum of ȳ. A density of 1 everywhere (equal-energy white) has a luminance of 1.
pub(crate) fn integrate(density: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    let mut luminance_of_one = 0.0;
    for sample in 0..SAMPLE_COUNT {
        let fraction = f64::from(sample) / f64::from(SAMPLE_COUNT - 1);
        let wavelength_nm = WAVELENGTH_MIN + fraction * (WAVELENGTH_MAX - WAVELENGTH_MIN);
        let matching = color_matching(wavelength_nm);
        let value = density(wavelength_nm);
        for (sum, weight) in xyz.iter_mut().zip(matching) {
            *sum += weight * value;
        }
        luminance_of_one += matching[1];
    }
    xyz_to_rgb_f64(xyz.map(|sum| sum / luminance_of_one))
}

/// The row of a 5 nm table at a wavelength, interpolated linearly; zero outside.
fn interpolate<const COLUMNS: usize>(
    table: &[[f64; COLUMNS]; TABLE_ROWS],
    wavelength_nm: f64,
) -> [f64; COLUMNS] {
    if !(WAVELENGTH_MIN..=WAVELENGTH_MAX).contains(&wavelength_nm) {
        return [0.0; COLUMNS];
    }
    let position = (wavelength_nm - WAVELENGTH_MIN) / TABLE_STEP;
    // The last row ends the last interval; it does not start another.
    let index = (position as usize).min(TABLE_ROWS - 2);
    let t = position - index as f64;
    std::array::from_fn(|column| (1.0 - t) * table[index][column] + t * table[index + 1][column])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_steps_of_five_nanometres() {
        for (row, (observer, daylight)) in OBSERVER.iter().zip(&D65).enumerate() {
            let wavelength = WAVELENGTH_MIN + TABLE_STEP * row as f64;
            assert_eq!((observer[0], daylight[0]), (wavelength, wavelength));
        }
        assert_eq!(OBSERVER[TABLE_ROWS - 1][0], WAVELENGTH_MAX);
    }

    #[test]
    fn the_observer_peaks_at_one_in_the_green() {
        assert_eq!(color_matching(555.0), [0.512_050_1, 1.0, 0.005_749_999]);
        assert_eq!(color_matching(600.0), [1.0622, 0.631, 0.0008]);
    }

    #[test]
    fn values_outside_the_range_are_zero() {
        for wavelength in [359.9, 830.1, f64::NAN, f64::INFINITY, -1.0] {
            assert_eq!(color_matching(wavelength), [0.0; 3]);
            assert_eq!(d65(wavelength), 0.0);
        }
        assert!(color_matching(830.0)[1] > 0.0 && d65(360.0) > 0.0);
    }

    #[test]
    fn values_between_rows_are_interpolated_linearly() {
        let middle = d65(562.5);
        assert!((middle - (d65(560.0) + d65(565.0)) / 2.0).abs() < 1e-12);
        assert!((d65(560.0) - 100.0 / D65_POWER).abs() < 1e-12);
    }

    #[test]
    fn equal_energy_has_luminance_one_and_is_reddish() {
        let rgb = integrate(|_| 1.0);
        for (actual, expected) in rgb.into_iter().zip([1.204_88, 0.948_228, 0.909_267]) {
            assert!((actual - expected).abs() < 1e-5, "{rgb:?}");
        }
    }

    #[test]
    fn daylight_is_white() {
        let rgb = integrate(d65);
        for component in rgb {
            // 1.2e-3 covers the 0.1 % of D65_POWER and the rounding of the table.
            assert!((component - 1.0).abs() < 1.2e-3, "{rgb:?}");
        }
        assert!((rgb[0] - rgb[2]).abs() < 2e-4 && (rgb[0] - rgb[1]).abs() < 2e-4, "{rgb:?}");
    }
}
