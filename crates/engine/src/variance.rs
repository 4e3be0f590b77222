//! Averages of estimates that are too noisy alone.

/// How far the average reaches: 5 × 5 pixels. An estimate with one degree of freedom is off by a factor
/// of two and more; 25 of them are off by 30 %. Larger windows would mix different parts of a picture.
const RADIUS: usize = 2;

/// The bytes per pixel that [`local_means`] needs while it runs, beside the result.
pub(crate) const BYTES_PER_PIXEL: u64 = (size_of::<Option<f64>>() + 2 * size_of::<Known>()) as u64;

/// A sum of estimates and how many there are.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    sum: f64,
    count: u32,
}

/// The mean of the estimates in the window around each pixel, as far as there are any; zero without.
///
/// The windows of all pixels overlap evenly, so the mean over the picture stays, apart from its edge.
pub(crate) fn local_means(estimates: &[Option<f64>], width: usize) -> Vec<f64> {
    let known = estimates.iter().map(|estimate| Known {
        sum: estimate.unwrap_or(0.0),
        count: u32::from(estimate.is_some()),
    });
    let known: Vec<Known> = known.collect();
    let height = known.len() / width.max(1);
    let mut rows = vec![Known::default(); known.len()];
    for (place, sum) in rows.iter_mut().enumerate() {
        let (row, column) = (place / width, place % width);
        let window = column.saturating_sub(RADIUS)..=(column + RADIUS).min(width - 1);
        *sum = total(window.map(|column| known[row * width + column]));
    }
    (0..known.len())
        .map(|place| {
            let (row, column) = (place / width, place % width);
            let window = row.saturating_sub(RADIUS)..=(row + RADIUS).min(height - 1);
            let Known { sum, count } = total(window.map(|row| rows[row * width + column]));
            sum / f64::from(count.max(1))
        })
        .collect()
}

fn total(all: impl Iterator<Item = Known>) -> Known {
    all.fold(Known::default(), |total, one| Known {
        sum: total.sum + one.sum,
        count: total.count + one.count,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_of_the_known_estimates_nearby() {
        let mut estimates = vec![Some(1.0); 7 * 3];
        assert_eq!(local_means(&estimates, 7), vec![1.0; 21]);
        estimates.fill(None);
        assert_eq!(local_means(&estimates, 7), vec![0.0; 21]);
        // In the first row, at columns 1 and 6.
        estimates[1] = Some(4.0);
        estimates[6] = Some(2.0);
        let row = [4.0, 4.0, 4.0, 4.0, 2.0, 2.0, 2.0];
        assert_eq!(local_means(&estimates, 7), row.repeat(3));
    }

    #[test]
    fn windows_end_at_the_edges() {
        let mut estimates = vec![Some(0.0); 6 * 6];
        estimates[0] = Some(9.0);
        let means = local_means(&estimates, 6);
        assert_eq!([means[0], means[2 * 6 + 2], means[3]], [1.0, 9.0 / 25.0, 0.0]);
        assert_eq!(local_means(&[Some(3.0)], 1), [3.0]);
    }
}
