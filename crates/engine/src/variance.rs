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
/// Beyond the edges the picture goes on mirrored. So each pixel has the same weight in all windows
/// together, and the mean over the picture stays what it is.
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
        *sum = total(window(column, width).map(|column| known[row * width + column]));
    }
    (0..known.len())
        .map(|place| {
            let (row, column) = (place / width, place % width);
            let Known { sum, count } =
                total(window(row, height).map(|row| rows[row * width + column]));
            sum / f64::from(count.max(1))
        })
        .collect()
}

/// The places around one of `count` places in a row.
fn window(center: usize, count: usize) -> impl Iterator<Item = usize> {
    (center..=center + 2 * RADIUS).map(move |shifted| {
        let mirrored = match shifted.checked_sub(RADIUS) {
            None => RADIUS - 1 - shifted,
            Some(place) if place < count => place,
            Some(place) => (2 * count - 1).saturating_sub(place),
        };
        // Of a picture narrower than the window, the mirrored one ends as well.
        mirrored.min(count - 1)
    })
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
        // In the middle row, at columns 0 and 6.
        estimates[7] = Some(4.0);
        estimates[13] = Some(2.0);
        let row = [4.0, 4.0, 4.0, 0.0, 2.0, 2.0, 2.0];
        assert_eq!(local_means(&estimates, 7), row.repeat(3));
    }

    #[test]
    fn the_mean_over_the_picture_stays() {
        for place in 0..7 * 6 {
            let mut estimates = vec![Some(0.0); 7 * 6];
            estimates[place] = Some(25.0);
            let sum: f64 = local_means(&estimates, 7).iter().sum();
            assert!((sum - 25.0).abs() < 1e-9, "{place}: {sum}");
        }
    }

    #[test]
    fn windows_are_mirrored_at_the_edges() {
        assert!(window(0, 6).eq([1, 0, 0, 1, 2]));
        assert!(window(4, 6).eq([2, 3, 4, 5, 5]));
        assert!(window(0, 1).eq([0; 5]));
        assert_eq!(local_means(&[Some(3.0)], 1), [3.0]);
    }
}
