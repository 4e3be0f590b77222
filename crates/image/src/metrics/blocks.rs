//! A statistical test of whether two renders of a scene agree, block by block.

use super::error_map::{ErrorMap, is_finite};
use crate::{ColorImage, ImageError};

/// An estimated image and its variance.
#[derive(Debug, Clone, Copy)]
pub struct Estimate<'a> {
    /// The image.
    pub mean: &'a ColorImage,
    /// The variance of the mean, per pixel and channel: the sample variance divided by their number.
    pub variance: &'a ColorImage,
}

/// The criteria for a block to differ. Both must hold in at least one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockThresholds {
    /// The edge length of the square blocks in pixels. Blocks at the right and bottom edges may be
    /// smaller.
    pub block_size: u32,
    /// The means differ by more than this many standard errors.
    pub standard_errors: f64,
    /// The means differ by more than this fraction of the reference. Zero disables the criterion.
    pub relative_difference: f64,
}

impl Default for BlockThresholds {
    /// Blocks of 8 × 8, four standard errors, no relative criterion.
    fn default() -> Self {
        Self { block_size: 8, standard_errors: 4.0, relative_difference: 0.0 }
    }
}

/// The result of [`block_test`].
#[derive(Debug, Clone, PartialEq)]
pub struct BlockReport {
    /// The number of blocks.
    pub block_count: usize,
    /// The number of blocks that differ.
    pub off_count: usize,
    /// A map with one value per block: the largest difference of any channel in standard errors.
    /// Infinite if the means differ although their variances are zero, or if an image is not
    /// finite.
    pub standard_errors: ErrorMap,
}

impl BlockReport {
    /// The fraction of blocks that differ, in [0, 1].
    pub fn share(&self) -> f64 {
        self.off_count as f64 / self.block_count as f64
    }
}

/// Compares the means of blocks relative to their standard errors.
///
/// If both images are unbiased and the variances are correct, the means of a block with many pixels
/// differ by more than four standard errors in about one of 16,000 channels. A block with a NaN or
/// an infinity always differs.
///
/// # Errors
/// [`ImageError`] if any sizes differ or there are no pixels.
pub fn block_test(
    image: Estimate<'_>,
    reference: Estimate<'_>,
    thresholds: &BlockThresholds,
) -> Result<BlockReport, ImageError> {
    for other in [image.variance, reference.mean, reference.variance] {
        image.mean.check_comparable(other)?;
    }
    let edge = thresholds.block_size.max(1);
    let (width, height) = (image.mean.width, image.mean.height);
    let mut off_count = 0;
    let mut values = Vec::new();
    for top in (0..height).step_by(edge as usize) {
        for left in (0..width).step_by(edge as usize) {
            let block = Block {
                columns: [left, left.saturating_add(edge).min(width)],
                rows: [top, top.saturating_add(edge).min(height)],
            };
            let (a, b) = (block.summarize(image), block.summarize(reference));
            let (largest, is_off) = compare(&a, &b, thresholds);
            off_count += usize::from(is_off);
            values.push(largest as f32);
        }
    }
    let size = ColorImage {
        width: width.div_ceil(edge),
        height: height.div_ceil(edge),
        pixels: Vec::new(),
    };
    let block_count = values.len();
    Ok(BlockReport { block_count, off_count, standard_errors: ErrorMap::new(&size, values) })
}

/// The ranges of columns and rows of a block, each with an exclusive end.
struct Block {
    columns: [u32; 2],
    rows: [u32; 2],
}

/// The mean of a block and its variance, per channel.
struct Summary {
    mean: [f64; 3],
    variance: [f64; 3],
    is_finite: bool,
}

impl Block {
    fn summarize(&self, estimate: Estimate<'_>) -> Summary {
        let mut summary = Summary { mean: [0.0; 3], variance: [0.0; 3], is_finite: true };
        let mut count = 0.0;
        for row in self.rows[0]..self.rows[1] {
            for column in self.columns[0]..self.columns[1] {
                let index = row as usize * estimate.mean.width as usize + column as usize;
                let (mean, variance) =
                    (&estimate.mean.pixels[index], &estimate.variance.pixels[index]);
                summary.is_finite &= is_finite(mean) && is_finite(variance);
                for channel in 0..3 {
                    summary.mean[channel] += f64::from(mean[channel]);
                    summary.variance[channel] += f64::from(variance[channel]);
                }
                count += 1.0;
            }
        }
        summary.mean = summary.mean.map(|sum| sum / count);
        // Pixels are independent: the variance of a mean of n is the sum over n².
        summary.variance = summary.variance.map(|sum| sum / (count * count));
        summary
    }
}

/// The largest difference in standard errors, and whether the block differs.
fn compare(a: &Summary, b: &Summary, thresholds: &BlockThresholds) -> (f64, bool) {
    if !a.is_finite || !b.is_finite {
        return (f64::INFINITY, true);
    }
    let mut largest: f64 = 0.0;
    let mut is_off = false;
    for channel in 0..3 {
        let difference = (a.mean[channel] - b.mean[channel]).abs();
        if difference == 0.0 {
            continue;
        }
        let standard_errors = difference / (a.variance[channel] + b.variance[channel]).sqrt();
        largest = largest.max(standard_errors);
        is_off |= standard_errors > thresholds.standard_errors
            && difference > thresholds.relative_difference * b.mean[channel].abs();
    }
    (largest, is_off)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(size: (u32, u32), value: f32) -> ColorImage {
        let pixels = vec![[value; 3]; size.0 as usize * size.1 as usize];
        ColorImage { width: size.0, height: size.1, pixels }
    }

    /// A block of 64 pixels, each with a variance of 0.32 in both images: the standard error of the
    /// difference of means is √(2 · 0.32 / 64) = 0.1.
    #[test]
    fn threshold_is_in_standard_errors_of_the_difference() {
        let variance = constant((8, 8), 0.32);
        let reference = constant((8, 8), 10.0);
        let test = |value, thresholds: &BlockThresholds| {
            let image = constant((8, 8), value);
            let image = Estimate { mean: &image, variance: &variance };
            let reference = Estimate { mean: &reference, variance: &variance };
            block_test(image, reference, thresholds).unwrap()
        };
        let thresholds = BlockThresholds::default();
        assert_eq!(test(10.39, &thresholds).off_count, 0);
        assert_eq!(test(10.41, &thresholds).off_count, 1);
        assert_eq!(test(9.59, &thresholds).share(), 1.0);
        assert!((test(10.41, &thresholds).standard_errors.values[0] - 4.1).abs() < 1e-4);
        let relative = BlockThresholds { relative_difference: 0.05, ..thresholds };
        assert_eq!(test(10.49, &relative).off_count, 0);
        assert_eq!(test(10.51, &relative).off_count, 1);
    }

    #[test]
    fn one_block_of_a_ragged_grid_is_found() {
        let (mut mean, reference) = (constant((20, 9), 1.0), constant((20, 9), 1.0));
        let none = constant((20, 9), 0.0);
        mean.pixels[8 * 20 + 19] = [1.0, 1.0, 1.001];
        let image = Estimate { mean: &mean, variance: &none };
        let reference = Estimate { mean: &reference, variance: &none };
        let report = block_test(image, reference, &BlockThresholds::default()).unwrap();
        assert_eq!((report.block_count, report.off_count), (6, 1));
        let map = &report.standard_errors;
        assert_eq!((map.width, map.height), (3, 2));
        assert_eq!(map.values, [0.0, 0.0, 0.0, 0.0, 0.0, f32::INFINITY]);
    }

    #[test]
    fn blocks_with_nan_differ() {
        let (mut mean, none) = (constant((8, 8), 1.0), constant((8, 8), 0.0));
        mean.pixels[3][1] = f32::NAN;
        let image = Estimate { mean: &mean, variance: &none };
        let reference = Estimate { mean: &mean, variance: &none };
        assert_eq!(block_test(image, reference, &BlockThresholds::default()).unwrap().off_count, 1);
    }
}
