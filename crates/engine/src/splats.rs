//! Light that particles leave anywhere on the film.

use std::sync::{Mutex, PoisonError};

use crate::EngineError;
use crate::exact_sums::ExactSums;
use crate::region::Region;

/// What one particle adds to one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// The column in the whole film, from 0 at the left.
    pub x: u32,
    /// The row in the whole film, from 0 at the top.
    pub y: u32,
    /// Red, green and blue. The mean over all particles is what the pixel's radiance gains.
    pub color: [f64; 3],
}

/// Red, green and blue.
const CHANNELS: usize = 3;

/// The sums of all splats, in sums that do not depend on any order (`exact_sums`).
///
/// Every thread adds to every row, each of which has a lock.
#[derive(Debug)]
pub(crate) struct Splats {
    region: Region,
    rows: Vec<Mutex<ExactSums>>,
}

impl Splats {
    /// Sums without splats.
    ///
    /// # Errors
    /// [`EngineError::FilmTooLarge`] if they would take more than `limit` bytes.
    pub(crate) fn new(region: Region, limit: u64) -> Result<Self, EngineError> {
        let Region { width, height, .. } = region;
        let bytes = region.pixel_count().saturating_mul(CHANNELS as u64 * ExactSums::BYTES);
        if bytes > limit {
            return Err(EngineError::FilmTooLarge { width, height, bytes, limit });
        }
        let row = || Mutex::new(ExactSums::new(width as usize * CHANNELS));
        Ok(Self { region, rows: (0..height).map(|_| row()).collect() })
    }

    /// Adds a splat, if it lies in the region; those that are not finite are the caller's to leave out.
    pub(crate) fn add(&self, splat: &Splat) {
        let (Some(column), Some(row)) =
            (splat.x.checked_sub(self.region.x), splat.y.checked_sub(self.region.y))
        else {
            return;
        };
        if column >= self.region.width {
            return;
        }
        let Some(sums) = self.rows.get(row as usize) else { return };
        let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
        for (channel, value) in splat.color.into_iter().enumerate() {
            sums.add(column as usize * CHANNELS + channel, value);
        }
    }

    /// Adds the sum of each pixel of a channel, divided by the number of particles, to a plane.
    pub(crate) fn add_to(&self, plane: &mut [f32], channel: usize, particle_count: u64) {
        let width = self.region.width as usize;
        for (row, pixels) in self.rows.iter().zip(plane.chunks_mut(width)) {
            let sums = row.lock().unwrap_or_else(PoisonError::into_inner);
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let sum = sums.value(column * CHANNELS + channel);
                *pixel = (f64::from(*pixel) + sum / particle_count.max(1) as f64) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REGION: Region = Region { x: 2, y: 1, width: 3, height: 2 };

    #[test]
    fn splats_land_in_their_pixels_and_beyond_the_region_nowhere() {
        let splats = Splats::new(REGION, 1 << 20).unwrap();
        for (x, y) in [(4, 2), (5, 2), (1, 1), (2, 3), (2, 0), (u32::MAX, u32::MAX)] {
            splats.add(&Splat { x, y, color: [1.0, 2.0, 4.0] });
        }
        let mut plane = vec![0.5; 6];
        splats.add_to(&mut plane, 1, 8);
        assert_eq!(plane, [0.5, 0.5, 0.5, 0.5, 0.5, 0.75]);
    }

    #[test]
    fn too_much_memory_is_an_error() {
        assert!(matches!(Splats::new(REGION, 100), Err(EngineError::FilmTooLarge { .. })));
    }
}
