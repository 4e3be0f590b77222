//! Cumulative shares, and the cells between them.

/// Fills `cdf` (one longer than `weights`) with the cumulative shares from 0 to 1, and returns the
/// sum. If all weights are zero, the shares are equal.
pub(super) fn fill_cdf(weights: &[f32], cdf: &mut [f32]) -> f64 {
    let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
    let mut running = 0.0;
    cdf[0] = 0.0;
    for (index, &weight) in weights.iter().enumerate() {
        running += f64::from(weight);
        cdf[index + 1] = if sum > 0.0 {
            (running / sum).min(1.0) as f32
        } else {
            (index + 1) as f32 / weights.len() as f32
        };
    }
    // Rounding must neither leave a gap before one nor give trailing zeros a share.
    for (index, &weight) in weights.iter().enumerate().rev() {
        cdf[index + 1] = 1.0;
        if weight > 0.0 {
            break;
        }
        if sum == 0.0 {
            break;
        }
    }
    sum
}

/// The cell of `cdf` (from 0 to 1) that contains `uniform` in [0, 1). Its width is never zero.
#[inline]
pub(super) fn find_cell(cdf: &[f32], uniform: f32) -> usize {
    // The cell ends at the first edge above the number, so its width is positive.
    let edge = cdf.partition_point(|&edge| edge <= uniform);
    edge.clamp(1, cdf.len() - 1) - 1
}

/// The position at share `rest` of cell `index` out of `count`, inside that cell.
#[inline]
pub(super) fn position_in_cell(index: usize, rest: f32, count: usize) -> f32 {
    let position = ((index as f64 + f64::from(rest)) / count as f64) as f32;
    // Rounding up at the end of a cell would give the sample its neighbour's density.
    match cell_of(position, count) {
        Some(cell) if cell == index => position,
        Some(cell) if cell < index => position.next_up(),
        _ => position.next_down(),
    }
}

/// The cell out of `count` that contains `position`, if it lies in [0, 1).
#[inline]
pub(super) fn cell_of(position: f32, count: usize) -> Option<usize> {
    let inside = (0.0..1.0).contains(&position);
    inside.then(|| ((f64::from(position) * count as f64) as usize).min(count - 1))
}
