//! The CIE 1931 standard observer and illuminant D65, and the integrals that turn a spectrum into
//! a colour.

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

/// What D65's power is divided by to give white a luminance of one. This is the figure that
/// Mitsuba 3 uses, so that its scenes keep their colours: the sum in [`integrate`] asks for
/// 98.888, a thousandth less, and so a reflectance of one gives 0.9989.
const D65_POWER: f64 = 98.997_417_518_762_55;

/// Samples of the sums below, as many as Mitsuba 3 takes. Both ends of the range are samples.
const SAMPLE_COUNT: u32 = 1000;

/// x̄, ȳ and z̄ at a wavelength in nanometres, linear between the tabulated 5 nm; zero outside
/// 360 to 830 nm.
#[must_use]
pub fn color_matching(wavelength_nm: f64) -> [f64; 3] {
    let [_, x, y, z] = interpolate(&OBSERVER, wavelength_nm);
    [x, y, z]
}

/// The relative power of illuminant D65 at a wavelength in nanometres, scaled so that white has a
/// luminance of one; zero outside 360 to 830 nm.
#[must_use]
pub fn d65(wavelength_nm: f64) -> f64 {
    let [_, power] = interpolate(&D65, wavelength_nm);
    power / D65_POWER
}

/// The linear Rec. 709 colour of a spectral density: the sum of density · (x̄, ȳ, z̄) over the sum
/// of ȳ, so that a density of one everywhere (equal-energy white) has a luminance of one.
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

/// The row of a 5 nm table at a wavelength, linear between its neighbours; zero outside.
fn interpolate<const COLUMNS: usize>(
    table: &[[f64; COLUMNS]; TABLE_ROWS],
    wavelength_nm: f64,
) -> [f64; COLUMNS] {
    if !(WAVELENGTH_MIN..=WAVELENGTH_MAX).contains(&wavelength_nm) {
        return [0.0; COLUMNS];
    }
    let position = (wavelength_nm - WAVELENGTH_MIN) / TABLE_STEP;
    // The last row is the end of the last interval, not the beginning of another.
    let index = (position as usize).min(TABLE_ROWS - 2);
    let t = position - index as f64;
    std::array::from_fn(|column| (1.0 - t) * table[index][column] + t * table[index + 1][column])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_hold_every_fifth_nanometre() {
        for (row, (observer, daylight)) in OBSERVER.iter().zip(&D65).enumerate() {
            let wavelength = WAVELENGTH_MIN + TABLE_STEP * row as f64;
            assert_eq!((observer[0], daylight[0]), (wavelength, wavelength));
        }
        assert_eq!(OBSERVER[TABLE_ROWS - 1][0], WAVELENGTH_MAX);
    }

    #[test]
    fn observer_peaks_in_the_green_with_one() {
        assert_eq!(color_matching(555.0), [0.512_050_1, 1.0, 0.005_749_999]);
        assert_eq!(color_matching(600.0), [1.0622, 0.631, 0.0008]);
    }

    #[test]
    fn nothing_is_seen_outside_the_range() {
        for wavelength in [359.9, 830.1, f64::NAN, f64::INFINITY, -1.0] {
            assert_eq!(color_matching(wavelength), [0.0; 3]);
            assert_eq!(d65(wavelength), 0.0);
        }
        assert!(color_matching(830.0)[1] > 0.0 && d65(360.0) > 0.0);
    }

    #[test]
    fn values_between_rows_lie_on_a_line() {
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
            // 1.2e-3 covers the thousandth that D65_POWER costs and the table's own rounding.
            assert!((component - 1.0).abs() < 1.2e-3, "{rgb:?}");
        }
        assert!((rgb[0] - rgb[2]).abs() < 2e-4 && (rgb[0] - rgb[1]).abs() < 2e-4, "{rgb:?}");
    }
}
