//! Colour spaces: linear Rec. 709 (the primaries and white of sRGB), CIE XYZ, xyY and the sRGB
//! transfer function.
//!
//! XYZ values are scaled so that white, `[1, 1, 1]` in Rec. 709, has Y = 1.

use glam::{Mat3, Vec3};

/// The Y row of the matrix from linear Rec. 709 to XYZ: the luminance of a unit of red, green and
/// blue. Sums to 1.
pub(crate) const LUMINANCE_WEIGHTS: [f32; 3] = {
    let [red, green, blue] = XYZ_FROM_RGB_ROWS[1];
    [red as f32, green as f32, blue as f32]
};

/// Linear Rec. 709 to XYZ, row by row. From the primaries (0.640, 0.330), (0.300, 0.600),
/// (0.150, 0.060) and the white point D65 (0.3127, 0.3290) of ITU-R BT.709, to six digits.
const XYZ_FROM_RGB_ROWS: [[f64; 3]; 3] = [
    [0.412_453, 0.357_580, 0.180_423],
    [0.212_671, 0.715_160, 0.072_169],
    [0.019_334, 0.119_193, 0.950_227],
];

/// The inverse of [`XYZ_FROM_RGB_ROWS`].
const RGB_FROM_XYZ_ROWS: [[f64; 3]; 3] = [
    [3.240_479, -1.537_150, -0.498_535],
    [-0.969_256, 1.875_991, 0.041_556],
    [0.055_648, -0.204_043, 1.057_311],
];

const XYZ_FROM_RGB: Mat3 = single_precision(XYZ_FROM_RGB_ROWS);
const RGB_FROM_XYZ: Mat3 = single_precision(RGB_FROM_XYZ_ROWS);

/// The relative luminance, CIE Y, of a linear Rec. 709 colour.
#[inline]
#[must_use]
pub fn luminance(rgb: [f32; 3]) -> f32 {
    Vec3::from_array(rgb).dot(Vec3::from_array(LUMINANCE_WEIGHTS))
}

/// CIE XYZ of a linear Rec. 709 colour.
#[inline]
#[must_use]
pub fn rgb_to_xyz(rgb: [f32; 3]) -> [f32; 3] {
    (XYZ_FROM_RGB * Vec3::from_array(rgb)).to_array()
}

/// The linear Rec. 709 colour of CIE XYZ; components are negative if the colour is out of gamut.
#[inline]
#[must_use]
pub fn xyz_to_rgb(xyz: [f32; 3]) -> [f32; 3] {
    (RGB_FROM_XYZ * Vec3::from_array(xyz)).to_array()
}

/// [`xyz_to_rgb`] in double precision, for the sums over a spectrum.
pub(crate) fn xyz_to_rgb_f64(xyz: [f64; 3]) -> [f64; 3] {
    RGB_FROM_XYZ_ROWS.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// The chromaticity x, y and luminance Y of CIE XYZ. Black has the chromaticity of D65.
#[must_use]
pub fn xyz_to_xyy([x, y, z]: [f32; 3]) -> [f32; 3] {
    let sum = x + y + z;
    if sum == 0.0 {
        let [white_x, white_y, white_z] = rgb_to_xyz([1.0; 3]);
        let white_sum = white_x + white_y + white_z;
        return [white_x / white_sum, white_y / white_sum, 0.0];
    }
    [x / sum, y / sum, y]
}

/// CIE XYZ from a chromaticity x, y and luminance Y; black if y is zero.
#[must_use]
pub fn xyy_to_xyz([x, y, luminance]: [f32; 3]) -> [f32; 3] {
    if y == 0.0 {
        return [0.0; 3];
    }
    let sum = luminance / y;
    [x * sum, luminance, (1.0 - x - y) * sum]
}

/// The sRGB encoding of a linear component (IEC 61966-2-1). The curve continues beyond 1 and is odd,
/// so every finite value round-trips.
#[must_use]
pub fn linear_to_srgb(linear: f32) -> f32 {
    let magnitude = linear.abs();
    let encoded = if magnitude <= 0.003_130_8 {
        magnitude * 12.92
    } else {
        1.055 * magnitude.powf(1.0 / 2.4) - 0.055
    };
    encoded.copysign(linear)
}

/// Decodes an sRGB component: the inverse of [`linear_to_srgb`].
#[must_use]
pub fn srgb_to_linear(encoded: f32) -> f32 {
    let magnitude = encoded.abs();
    let linear = if magnitude <= 0.040_45 {
        magnitude / 12.92
    } else {
        ((magnitude + 0.055) / 1.055).powf(2.4)
    };
    linear.copysign(encoded)
}

const fn single_precision(rows: [[f64; 3]; 3]) -> Mat3 {
    let mut columns = [[0.0; 3]; 3];
    let mut row = 0;
    while row < 3 {
        let mut column = 0;
        while column < 3 {
            columns[column][row] = rows[row][column] as f32;
            column += 1;
        }
        row += 1;
    }
    Mat3::from_cols_array_2d(&columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(actual: [f32; 3], expected: [f32; 3], tolerance: f32) {
        for (a, e) in actual.iter().zip(expected) {
            assert!((a - e).abs() <= tolerance, "{actual:?} instead of {expected:?}");
        }
    }

    #[test]
    fn white_has_the_xyz_of_d65() {
        assert_near(rgb_to_xyz([1.0; 3]), [0.950_456, 1.0, 1.088_754], 1e-6);
        assert!((luminance([1.0; 3]) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn primaries_have_the_chromaticities_of_rec_709() {
        let primaries = [
            ([1.0, 0.0, 0.0], [0.640, 0.330]),
            ([0.0, 1.0, 0.0], [0.300, 0.600]),
            ([0.0, 0.0, 1.0], [0.150, 0.060]),
        ];
        for (rgb, [x, y]) in primaries {
            let actual = xyz_to_xyy(rgb_to_xyz(rgb));
            assert_near(actual, [x, y, luminance(rgb)], 2e-6);
        }
    }

    #[test]
    fn xyz_round_trips() {
        for rgb in [[0.2, 0.5, 0.9], [0.0, 1.0, 0.0], [-0.1, 3.0, 7.0]] {
            assert_near(xyz_to_rgb(rgb_to_xyz(rgb)), rgb, 2e-5);
        }
    }

    #[test]
    fn chromaticities_round_trip() {
        for xyz in [[0.3, 0.4, 0.5], [0.95, 1.0, 1.09]] {
            assert_near(xyy_to_xyz(xyz_to_xyy(xyz)), xyz, 1e-6);
        }
    }

    #[test]
    fn black_has_the_chromaticity_of_white() {
        assert_near(xyz_to_xyy([0.0; 3]), [0.312_731, 0.329_033, 0.0], 1e-5);
        assert_eq!(xyy_to_xyz([0.3, 0.0, 1.0]), [0.0; 3]);
    }

    #[test]
    fn transfer_function_has_reference_values() {
        assert_eq!(linear_to_srgb(0.0), 0.0);
        assert!((linear_to_srgb(1.0) - 1.0).abs() < 1e-6);
        // Middle grey: 18 % is 118 of 255; an encoded 0.5 is 21.4 % linear.
        assert!((linear_to_srgb(0.18) * 255.0 - 117.6).abs() < 0.1);
        assert!((srgb_to_linear(0.5) - 0.214_041).abs() < 1e-6);
    }

    #[test]
    fn transfer_function_round_trips() {
        for step in -60..=60_i16 {
            let linear = f32::from(step) / 40.0;
            let back = srgb_to_linear(linear_to_srgb(linear));
            assert!((back - linear).abs() <= 1e-6 * linear.abs().max(1.0), "{linear} → {back}");
        }
    }
}
