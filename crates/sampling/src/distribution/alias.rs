//! The alias method: an index in constant time (Walker, 1977; Vose, 1991).

use super::weights::{WeightError, checked_sum};
use crate::hash::ONE_MINUS_EPSILON;
use glam::Vec2;

/// A table that samples an index in proportion to its weight, in constant time.
///
/// Unlike a [`Distribution1D`](crate::Distribution1D) it does not preserve order: strata of the uniform
/// numbers are not strata of the indices.
#[derive(Clone, Debug, PartialEq)]
pub struct AliasTable {
    slots: Vec<Slot>,
    sum: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Slot {
    /// The share of the slot that belongs to its own index.
    threshold: f32,
    /// The index that the rest belongs to.
    alias: u32,
    probability: f32,
}

/// A sample of an [`AliasTable`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AliasSample {
    /// The index.
    pub index: usize,
    /// Its probability.
    pub pmf: f32,
    /// The rest of the uniform numbers: uniform in [0, 1) again.
    pub rest: f32,
}

impl AliasTable {
    /// A table of `weights`, balanced in double precision.
    ///
    /// # Errors
    /// [`WeightError`], also where all weights are zero.
    pub fn new(weights: &[f32]) -> Result<Self, WeightError> {
        let sum = checked_sum(weights)?;
        if sum <= 0.0 {
            return Err(WeightError::ZeroSum);
        }
        let count = weights.len() as f64;
        let mut scaled: Vec<f64> =
            weights.iter().map(|&weight| f64::from(weight) / sum * count).collect();
        let mut slots: Vec<Slot> = weights
            .iter()
            .enumerate()
            .map(|(index, &weight)| Slot {
                threshold: 1.0,
                alias: index as u32,
                probability: (f64::from(weight) / sum) as f32,
            })
            .collect();
        let indices = 0..weights.len() as u32;
        let (mut small, mut large): (Vec<u32>, Vec<u32>) =
            indices.partition(|&index| scaled[index as usize] < 1.0);
        // A rich slot fills up each poor one, and may become poor itself.
        while let (Some(&poor), Some(&rich)) = (small.last(), large.last()) {
            small.pop();
            let own = scaled[poor as usize];
            slots[poor as usize].threshold = own as f32;
            slots[poor as usize].alias = rich;
            scaled[rich as usize] -= 1.0 - own;
            if scaled[rich as usize] < 1.0 {
                large.pop();
                small.push(rich);
            }
        }
        keep_empty_slots_empty(&mut slots, &small, weights);
        Ok(Self { slots, sum })
    }

    /// The number of weights.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Always false: a table has at least one weight.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The sum of the weights.
    #[inline]
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// The probability of `index`; zero beyond the end.
    #[inline]
    #[must_use]
    pub fn pmf(&self, index: usize) -> f32 {
        self.slots.get(index).map_or(0.0, |slot| slot.probability)
    }

    /// An index from one uniform number.
    ///
    /// Slot, threshold and rest share the 24 bits of the number, which suffice for a few thousand
    /// weights. For more, use [`sample_2d`](Self::sample_2d).
    #[inline]
    #[must_use]
    pub fn sample(&self, uniform: f32) -> AliasSample {
        self.pick((f64::from(uniform) * UNITS) as u64)
    }

    /// An index from the joined bits of two uniform numbers, which suffice for any number of weights.
    #[inline]
    #[must_use]
    pub fn sample_2d(&self, uniform: Vec2) -> AliasSample {
        let high = (uniform.x * HALF_UNITS) as u64;
        let low = (uniform.y * HALF_UNITS) as u64;
        self.pick(high << 24 | low)
    }

    /// The index at a number below 2⁴⁸.
    #[inline]
    fn pick(&self, number: u64) -> AliasSample {
        let product = u128::from(number) * self.slots.len() as u128;
        let place = ((product >> 48) as usize).min(self.slots.len() - 1);
        let within = (product as u64 & ((1 << 48) - 1)) as f64 * (1.0 / UNITS);
        let slot = self.slots[place];
        let threshold = f64::from(slot.threshold);
        let (index, rest) = if within < threshold {
            (place, within / threshold)
        } else {
            (slot.alias as usize, (within - threshold) / (1.0 - threshold))
        };
        let rest = (rest as f32).clamp(0.0, ONE_MINUS_EPSILON);
        AliasSample { index, pmf: self.slots[index].probability, rest }
    }
}

const HALF_UNITS: f32 = 16_777_216.0;
const UNITS: f64 = 281_474_976_710_656.0;

/// Rounding may exhaust the rich slots before the poor ones. A poor slot that is left over keeps all of
/// its share, unless its weight is zero.
fn keep_empty_slots_empty(slots: &mut [Slot], left_over: &[u32], weights: &[f32]) {
    let heaviest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
    for &index in left_over {
        if weights[index as usize] == 0.0 {
            slots[index as usize].threshold = 0.0;
            slots[index as usize].alias = heaviest.unwrap_or(0) as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng, chi2_discrete};

    fn assert_follows(weights: &[f32], draw: impl Fn(&AliasTable, &mut TestRng) -> AliasSample) {
        let table = AliasTable::new(weights).unwrap();
        let mut random = TestRng::new(1);
        let mut counts = vec![0_u64; weights.len()];
        for _ in 0..300_000 {
            let sample = draw(&table, &mut random);
            assert_eq!(sample.pmf, table.pmf(sample.index));
            assert!((0.0..1.0).contains(&sample.rest));
            counts[sample.index] += 1;
        }
        let expected: Vec<f64> = weights.iter().map(|&weight| f64::from(weight)).collect();
        chi2_discrete(&counts, &expected).assert();
        for (count, weight) in counts.iter().zip(weights) {
            assert!(*weight > 0.0 || *count == 0);
        }
    }

    #[test]
    fn indices_follow_the_weights() {
        let mut random = TestRng::new(2);
        let skewed: Vec<f32> = (0..1000).map(|_| random.next_f32().powi(8)).collect();
        let sparse: Vec<f32> = (0..997).map(|index| f32::from(u8::from(index % 7 == 3))).collect();
        for weights in [&skewed[..], &sparse[..], &[5.0, 0.0, 1e-3, 2.0]] {
            assert_follows(weights, |table, random| table.sample(random.next_f32()));
            assert_follows(weights, |table, random| table.sample_2d(random.next_vec2()));
        }
    }

    #[test]
    fn many_weights_are_exact_with_two_numbers() {
        // The slots are narrower than the spacing of one number; two numbers still tell them apart.
        let weights: Vec<f32> = (0..3_000_001).map(|index| 1.0 + (index % 3) as f32).collect();
        let table = AliasTable::new(&weights).unwrap();
        let mut random = TestRng::new(3);
        let mut counts = [0_u64; 3];
        for _ in 0..1_000_000 {
            counts[table.sample_2d(random.next_vec2()).index % 3] += 1;
        }
        chi2_discrete(&counts, &[1.0, 2.0, 3.0]).assert();
    }

    #[test]
    fn the_rest_is_uniform() {
        let table = AliasTable::new(&[1.0, 3.0, 0.0, 2.5, 0.1]).unwrap();
        let one = |random: &mut TestRng| Some(table.sample(random.next_f32()).rest);
        ChiSquare::one_of(2).line((0.0, 1.0), one, |_| 1.0).assert();
        let two = |random: &mut TestRng| Some(table.sample_2d(random.next_vec2()).rest);
        ChiSquare::one_of(2).line((0.0, 1.0), two, |_| 1.0).assert();
    }

    #[test]
    fn bad_weights_are_refused() {
        assert_eq!(AliasTable::new(&[]), Err(WeightError::Empty));
        assert_eq!(AliasTable::new(&[0.0]), Err(WeightError::ZeroSum));
        assert_eq!(AliasTable::new(&[-0.5]), Err(WeightError::Invalid { index: 0 }));
        assert_eq!(AliasTable::new(&[2.0]).unwrap().sample(0.3).index, 0);
    }
}
