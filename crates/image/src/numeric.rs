//! Numeric helpers.

/// A 3 × 3 matrix, row by row.
pub(crate) type Matrix = [[f32; 3]; 3];

/// The product of a matrix and a column vector.
pub(crate) fn multiply(matrix: &Matrix, vector: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// As `f32::clamp`, but NaN becomes `min`.
pub(crate) fn clamp_number(value: f32, min: f32, max: f32) -> f32 {
    value.max(min).min(max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_becomes_the_minimum() {
        assert_eq!(clamp_number(f32::NAN, -1.0, 2.0), -1.0);
        assert_eq!(clamp_number(f32::INFINITY, -1.0, 2.0), 2.0);
        assert_eq!(clamp_number(0.5, -1.0, 2.0), 0.5);
    }

    #[test]
    fn each_row_times_the_column() {
        let matrix = [[1.0, 2.0, 3.0], [0.0, 1.0, 0.0], [4.0, 0.0, 0.0]];
        assert_eq!(multiply(&matrix, [1.0, 10.0, 100.0]), [321.0, 10.0, 4.0]);
    }
}
