//! The primaries and the white of a picture, and their conversion to those of BT.709.

use crate::ImageError;
use crate::numeric::Matrix;

/// x and y of red, green, blue and white of ITU-R BT.709.
pub(crate) const BT709: [f32; 8] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];

/// Points whose squared distances sum to less than this are those of BT.709: files round them.
const SAME_POINTS: f64 = 1e-6;

/// The matrix that converts linear colours of these primaries and this white to BT.709; `None` if
/// they are those of BT.709.
///
/// The colours keep their CIE XYZ values, as in Mitsuba: there is no adaptation to the white of
/// BT.709.
///
/// # Errors
/// [`ImageError::Unsupported`] if the points span no colour space: they lie on a line, are not
/// finite, or have their white outside.
pub(crate) fn to_bt709(points: &[f32; 8]) -> Result<Option<Matrix>, ImageError> {
    let distance = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)).powi(2);
    if points.iter().zip(&BT709).map(distance).sum::<f64>() < SAME_POINTS {
        return Ok(None);
    }
    let matrix = xyz_of_rgb(points).zip(xyz_of_rgb(&BT709).as_ref().and_then(inverse));
    let matrix = matrix.map(|(to_xyz, from_xyz)| product(&from_xyz, &to_xyz));
    let matrix = matrix.map(|matrix| matrix.map(|row| row.map(|value| value as f32)));
    match matrix {
        Some(matrix) if matrix.as_flattened().iter().all(|value| value.is_finite()) => {
            Ok(Some(matrix))
        }
        _ => Err(ImageError::unsupported("chromaticities", format!("{points:?}"))),
    }
}

/// The shares of red, green and blue in luminance; those of BT.709 for degenerate points.
pub(crate) fn luminance_weights(points: &[f32; 8]) -> [f32; 3] {
    let row = xyz_of_rgb(points).or_else(|| xyz_of_rgb(&BT709)).map(|matrix| matrix[1]);
    // The primaries of BT.709 are not degenerate.
    row.unwrap_or([0.2126, 0.7152, 0.0722]).map(|weight| weight as f32)
}

type Matrix64 = [[f64; 3]; 3];

/// The matrix from linear RGB to CIE XYZ, where white has Y = 1. `None` for degenerate points.
fn xyz_of_rgb(points: &[f32; 8]) -> Option<Matrix64> {
    let [red, green, blue, white] = [0, 2, 4, 6].map(|start| {
        let (x, y) = (f64::from(points[start]), f64::from(points[start + 1]));
        [x, y, 1.0 - x - y]
    });
    let columns = [0, 1, 2].map(|row| [red[row], green[row], blue[row]]);
    let white = white.map(|value| value / white[1]);
    // The share of each primary in white.
    let shares =
        inverse(&columns)?.map(|row| row[0] * white[0] + row[1] * white[1] + row[2] * white[2]);
    if shares.iter().any(|share| !share.is_finite() || *share <= 0.0) {
        return None;
    }
    Some(columns.map(|row| [row[0] * shares[0], row[1] * shares[1], row[2] * shares[2]]))
}

/// The inverse, unless the matrix is nearly singular.
fn inverse(matrix: &Matrix64) -> Option<Matrix64> {
    /// Twice the least area of a triangle of primaries: that of BT.709 has 0.22.
    const LEAST_DETERMINANT: f64 = 1e-6;
    let cofactor = |row: usize, column: usize| {
        let [r1, r2] = [(row + 1) % 3, (row + 2) % 3];
        let [c1, c2] = [(column + 1) % 3, (column + 2) % 3];
        matrix[r1][c1] * matrix[r2][c2] - matrix[r1][c2] * matrix[r2][c1]
    };
    let determinant: f64 = (0..3).map(|column| matrix[0][column] * cofactor(0, column)).sum();
    let is_regular = determinant.is_finite() && determinant.abs() > LEAST_DETERMINANT;
    is_regular
        .then(|| [0, 1, 2].map(|row| [0, 1, 2].map(|column| cofactor(column, row) / determinant)))
}

fn product(a: &Matrix64, b: &Matrix64) -> Matrix64 {
    a.map(|row| [0, 1, 2].map(|column| (0..3).map(|k| row[k] * b[k][column]).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::multiply;

    const BT2020: [f32; 8] = [0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329];

    /// The matrix of Recommendation ITU-R BT.2087, rounded there to four digits.
    #[test]
    fn bt2020_has_the_published_matrix() {
        let expected =
            [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
        let found = to_bt709(&BT2020).unwrap().unwrap();
        for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn white_of_the_same_point_stays_white_and_other_whites_keep_their_tint() {
        let white = |points: &[f32; 8]| multiply(&to_bt709(points).unwrap().unwrap(), [1.0; 3]);
        assert!(white(&BT2020).iter().all(|value| (value - 1.0).abs() < 1e-5));
        // The equal-energy white of XYZ, in BT.709.
        let xyz = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0];
        for (found, expected) in white(&xyz).iter().zip([1.2048, 0.9483, 0.9089]) {
            assert!((found - expected).abs() < 1e-3, "{found} {expected}");
        }
    }

    #[test]
    fn bt709_needs_no_matrix_even_rounded() {
        let mut rounded = BT709;
        rounded[6] = 0.31271;
        assert!(to_bt709(&BT709).unwrap().is_none() && to_bt709(&rounded).unwrap().is_none());
    }

    #[test]
    fn degenerate_points_are_errors() {
        let line = [0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.25, 0.25];
        let white_outside = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.7, 0.7];
        let black = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3, 0.0];
        for points in [[0.0; 8], [f32::NAN; 8], [f32::INFINITY; 8], line, white_outside, black] {
            assert!(to_bt709(&points).is_err(), "{points:?}");
        }
    }
}
