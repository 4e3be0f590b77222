//! Values of the sample nearest to each pixel's centre: identifiers, which have no mean.

/// For some pixels, the values of the nearest sample so far. Of samples at the same distance, the one
/// of the least index counts. So the result depends on the set of samples alone, not on their order or
/// on how films were merged.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Nearest {
    keys: Vec<Key>,
    /// The values of each pixel, pixel after pixel.
    values: Vec<f32>,
    values_per_pixel: usize,
}

/// The place of a sample in the order of closeness, the nearest first. The bits of distances, which
/// are not negative, sort as the distances do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key {
    distance_bits: u32,
    index: u32,
}

impl Key {
    /// Farther than every sample.
    const NONE: Self = Self { distance_bits: f32::INFINITY.to_bits(), index: u32::MAX };

    pub(crate) fn new(squared_distance: f32, index: u32) -> Self {
        // Negative zero would be the farthest.
        Self { distance_bits: squared_distance.abs().to_bits(), index }
    }

    /// The key of these numbers from a file, if it is valid.
    pub(crate) fn from_raw([distance_bits, index]: [u32; 2]) -> Option<Self> {
        (distance_bits <= f32::INFINITY.to_bits()).then_some(Self { distance_bits, index })
    }

    pub(crate) fn raw(self) -> [u32; 2] {
        [self.distance_bits, self.index]
    }
}

impl Nearest {
    /// Zero values for so many pixels, which have no samples yet.
    pub(crate) fn new(pixel_count: usize, values_per_pixel: usize) -> Self {
        let key_count = if values_per_pixel == 0 { 0 } else { pixel_count };
        Self {
            keys: vec![Key::NONE; key_count],
            values: vec![0.0; pixel_count * values_per_pixel],
            values_per_pixel,
        }
    }

    /// The bytes of a pixel with so many values.
    pub(crate) fn bytes_per_pixel(values_per_pixel: usize) -> u64 {
        let bytes = size_of::<Key>() + values_per_pixel * size_of::<f32>();
        if values_per_pixel == 0 { 0 } else { bytes as u64 }
    }

    /// Whether there are no values.
    pub(crate) fn is_empty(&self) -> bool {
        self.values_per_pixel == 0
    }

    /// Takes the values of a sample if it is the nearest so far.
    pub(crate) fn add(&mut self, pixel: usize, key: Key, values: impl Iterator<Item = f32>) {
        if key < self.keys[pixel] {
            self.keys[pixel] = key;
            let start = pixel * self.values_per_pixel;
            let own = &mut self.values[start..start + self.values_per_pixel];
            for (own, value) in own.iter_mut().zip(values) {
                *own = value;
            }
        }
    }

    /// Takes the values of a pixel of others if its sample is nearer.
    pub(crate) fn merge_pixel(&mut self, pixel: usize, other: &Self, other_pixel: usize) {
        let (key, values) = other.pixel(other_pixel);
        self.add(pixel, key, values.iter().copied());
    }

    /// The key and the values of a pixel.
    pub(crate) fn pixel(&self, pixel: usize) -> (Key, &[f32]) {
        let start = pixel * self.values_per_pixel;
        (self.keys[pixel], &self.values[start..start + self.values_per_pixel])
    }

    /// One of the values of a pixel.
    pub(crate) fn value(&self, pixel: usize, index: usize) -> f32 {
        self.values[pixel * self.values_per_pixel + index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_sample_wins_in_any_order_and_by_any_merge() {
        let samples =
            [(0.5, 3, 1.0), (0.25, 7, 2.0), (0.25, 2, 3.0), (-0.0, 9, 4.0), (0.0, 8, 5.0)];
        for count in 1..=samples.len() {
            let samples = &samples[..count];
            let of = |samples: &mut dyn Iterator<Item = &(f32, u32, f32)>| {
                let mut nearest = Nearest::new(2, 1);
                for (distance, index, value) in samples {
                    nearest.add(1, Key::new(*distance, *index), std::iter::once(*value));
                }
                nearest
            };
            let expected = [1.0, 2.0, 3.0, 4.0, 5.0][count - 1];
            let forward = of(&mut samples.iter());
            assert_eq!(forward.value(1, 0), expected);
            assert_eq!(forward.value(0, 0), 0.0);
            assert_eq!(forward, of(&mut samples.iter().rev()));
            let mut merged = of(&mut samples.iter().step_by(2));
            let other = of(&mut samples.iter().skip(1).step_by(2));
            merged.merge_pixel(1, &other, 1);
            assert_eq!(forward, merged);
        }
    }

    #[test]
    fn keys_of_files_must_be_distances() {
        assert!(Key::from_raw(Key::new(0.5, 3).raw()).is_some());
        assert!(Key::from_raw(Key::NONE.raw()).is_some());
        assert!(Key::from_raw([f32::NAN.to_bits(), 0]).is_none());
        assert!(Key::from_raw([(-1.0_f32).to_bits(), 0]).is_none());
    }
}
