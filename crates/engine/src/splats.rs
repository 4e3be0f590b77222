//! Light that lands anywhere on the film.

use std::sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use crate::exact_sums::ExactSums;
use crate::region::Region;

/// Light that a particle adds to one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelSplat {
    /// The column in the whole film, from 0 at the left.
    pub x: u32,
    /// The row in the whole film, from 0 at the top.
    pub y: u32,
    /// Red, green and blue. The mean over all particles is added to the pixel's radiance.
    pub color: [f64; 3],
}

/// Red, green and blue.
const CHANNELS: usize = 3;

/// The sums of all splats. Their order does not change them (`exact_sums`).
///
/// Every thread adds to every row; each row has a lock.
#[derive(Debug)]
pub(crate) struct Splats {
    region: Region,
    rows: Vec<Mutex<ExactSums>>,
    /// Threads share it while they render a tile. Who holds it alone sees the splats of whole turns:
    /// those of all samples that the tiles count, and no others.
    turns: RwLock<()>,
}

impl Splats {
    /// The bytes of one pixel.
    pub(crate) const BYTES_PER_PIXEL: u64 = CHANNELS as u64 * ExactSums::BYTES;

    /// Sums without splats.
    pub(crate) fn new(region: Region) -> Self {
        let row = || Mutex::new(ExactSums::new(region.width as usize * CHANNELS));
        let rows = (0..region.height).map(|_| row()).collect();
        Self { region, rows, turns: RwLock::new(()) }
    }

    /// A thread holds this while it takes the samples of a tile.
    pub(crate) fn begin_turn(&self) -> RwLockReadGuard<'_, ()> {
        self.turns.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the current turns end, and holds up new ones.
    pub(crate) fn pause(&self) -> RwLockWriteGuard<'_, ()> {
        self.turns.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// The sums row by row, each locked while the caller has it.
    pub(crate) fn rows(&self) -> impl Iterator<Item = MutexGuard<'_, ExactSums>> {
        self.rows.iter().map(lock)
    }

    /// Adds the splats of another film of the same size.
    pub(crate) fn merge(&self, other: &Self) {
        for (mut row, other) in self.rows().zip(other.rows()) {
            row.merge(&other);
        }
    }

    /// Adds a splat if it lies in the region. It must be finite.
    pub(crate) fn add(&self, splat: &PixelSplat) {
        let (Some(column), Some(row)) =
            (splat.x.checked_sub(self.region.x), splat.y.checked_sub(self.region.y))
        else {
            return;
        };
        if column >= self.region.width {
            return;
        }
        let Some(sums) = self.rows.get(row as usize) else { return };
        let mut sums = lock(sums);
        for (channel, value) in splat.color.into_iter().enumerate() {
            sums.add(column as usize * CHANNELS + channel, value);
        }
    }

    /// Adds the sum of each pixel of a channel, divided by the number of particles, to a plane.
    pub(crate) fn add_to(&self, plane: &mut [f32], channel: usize, particle_count: u64) {
        let width = self.region.width as usize;
        for (row, pixels) in self.rows.iter().zip(plane.chunks_mut(width)) {
            let sums = lock(row);
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let sum = sums.value(column * CHANNELS + channel);
                *pixel = (f64::from(*pixel) + sum / particle_count.max(1) as f64) as f32;
            }
        }
    }
}

/// A poisoned lock is no harm: splats are computed before they are added, so a panic leaves the sums
/// whole.
fn lock(row: &Mutex<ExactSums>) -> MutexGuard<'_, ExactSums> {
    row.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    const REGION: Region = Region { x: 2, y: 1, width: 3, height: 2 };

    #[test]
    fn splats_land_in_their_pixels_and_beyond_the_region_nowhere() {
        let splats = Splats::new(REGION);
        for (x, y) in [(4, 2), (5, 2), (1, 1), (2, 3), (2, 0), (u32::MAX, u32::MAX)] {
            splats.add(&PixelSplat { x, y, color: [1.0, 2.0, 4.0] });
        }
        let mut plane = vec![0.5; 6];
        splats.add_to(&mut plane, 1, 8);
        assert_eq!(plane, [0.5, 0.5, 0.5, 0.5, 0.5, 0.75]);
    }
}
