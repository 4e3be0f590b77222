//! Rectangles of pixels, and how a picture is divided into them.

/// A rectangle of pixels of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The leftmost column.
    pub x: u32,
    /// The topmost row.
    pub y: u32,
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
}

/// Side lengths of tiles in pixels, the preferred one first. The sums of a tile fit the second-level
/// cache with all of them; the smaller ones give work to many threads.
pub(crate) const TILE_SIDES: [u32; 3] = [16, 8, 4];

/// With this many tiles per thread, waiting for the last tile of a pass costs little.
const TILES_PER_THREAD: u64 = 32;

impl Region {
    /// Width times height.
    pub fn pixel_count(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// The tiles of the region along a Morton curve, so that consecutive tiles see the same part of
    /// the scene.
    pub(crate) fn tiles(&self, side: u32) -> Vec<Region> {
        let (columns, rows) = (self.width.div_ceil(side), self.height.div_ceil(side));
        let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let mut cells: Vec<(u32, u32)> = all.collect();
        cells.sort_unstable_by_key(|&(column, row)| morton(column, row));
        cells.into_iter().map(|(column, row)| self.tile(column * side, row * side, side)).collect()
    }

    /// The largest side with enough tiles for every thread, or the smallest one.
    pub(crate) fn tile_side(&self, thread_count: usize) -> u32 {
        let wanted = TILES_PER_THREAD * thread_count as u64;
        let tile_count = |side: u32| {
            u64::from(self.width.div_ceil(side)) * u64::from(self.height.div_ceil(side))
        };
        let enough = TILE_SIDES.into_iter().find(|&side| tile_count(side) >= wanted);
        enough.unwrap_or(TILE_SIDES[TILE_SIDES.len() - 1])
    }

    /// The tile with its top left corner `left` and `top` pixels inside this region.
    fn tile(&self, left: u32, top: u32, side: u32) -> Region {
        Region {
            x: self.x + left,
            y: self.y + top,
            width: side.min(self.width - left),
            height: side.min(self.height - top),
        }
    }
}

/// The bits of two numbers, interleaved (Morton, 1966).
fn morton(x: u32, y: u32) -> u64 {
    spread(x) | spread(y) << 1
}

/// Moves bit i to bit 2i.
fn spread(value: u32) -> u64 {
    let mut bits = u64::from(value);
    bits = (bits | bits << 16) & 0x0000_ffff_0000_ffff;
    bits = (bits | bits << 8) & 0x00ff_00ff_00ff_00ff;
    bits = (bits | bits << 4) & 0x0f0f_0f0f_0f0f_0f0f;
    bits = (bits | bits << 2) & 0x3333_3333_3333_3333;
    (bits | bits << 1) & 0x5555_5555_5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once_for_any_thread_count() {
        let region = Region { x: 3, y: 5, width: 37, height: 50 };
        for thread_count in [1, 2, 5, 128] {
            let mut seen = vec![0; 37 * 50];
            for tile in region.tiles(region.tile_side(thread_count)) {
                for y in tile.y..tile.y + tile.height {
                    for x in tile.x..tile.x + tile.width {
                        seen[((y - 5) * 37 + x - 3) as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&count| count == 1), "{thread_count} threads");
        }
    }

    #[test]
    fn many_threads_get_many_tiles() {
        let region = Region { x: 0, y: 0, width: 256, height: 256 };
        assert_eq!(region.tiles(region.tile_side(2)).len(), 256);
        assert_eq!(region.tiles(region.tile_side(128)).len(), 4096);
    }

    #[test]
    fn four_consecutive_tiles_form_a_square() {
        let region = Region { x: 0, y: 0, width: 64, height: 64 };
        let side = region.tile_side(1);
        let corners: Vec<_> = region.tiles(side)[..4].iter().map(|tile| (tile.x, tile.y)).collect();
        assert_eq!(corners, [(0, 0), (side, 0), (0, side), (side, side)]);
    }

    #[test]
    fn spread_bits_interleave() {
        assert_eq!(morton(0b11, 0b00), 0b0101);
        assert_eq!(morton(u32::MAX, 0) | morton(0, u32::MAX), u64::MAX);
    }
}
