//! Small helpers on numbers.

/// A 3 × 3 matrix of rows.
pub(crate) type Matrix = [[f32; 3]; 3];

/// The product of a matrix and a column.
pub(crate) fn multiply(matrix: &Matrix, vector: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// Clamps as `f32::clamp` does, but turns NaN into `least` where that keeps it.
pub(crate) fn clamp_number(value: f32, least: f32, greatest: f32) -> f32 {
    value.max(least).min(greatest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn not_a_number_becomes_the_least() {
        assert_eq!(clamp_number(f32::NAN, -1.0, 2.0), -1.0);
        assert_eq!(clamp_number(f32::INFINITY, -1.0, 2.0), 2.0);
        assert_eq!(clamp_number(0.5, -1.0, 2.0), 0.5);
    }

    #[test]
    fn rows_times_column() {
        let matrix = [[1.0, 2.0, 3.0], [0.0, 1.0, 0.0], [4.0, 0.0, 0.0]];
        assert_eq!(multiply(&matrix, [1.0, 10.0, 100.0]), [321.0, 10.0, 4.0]);
    }
}
