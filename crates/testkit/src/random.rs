//! The random number generator of the tests: xoshiro256++ seeded by SplitMix64.

use glam::{Vec2, Vec3};

/// A generator with a fixed sequence per seed.
///
/// xoshiro256++ (Blackman and Vigna, *Scrambled Linear Pseudorandom Number Generators*, 2021). It
/// is unrelated to the generators under test.
#[derive(Clone, Debug)]
pub struct TestRng {
    state: [u64; 4],
}

impl TestRng {
    /// A generator whose sequence is determined by `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut counter = seed;
        Self { state: std::array::from_fn(|_| split_mix(&mut counter)) }
    }

    /// 64 uniform bits.
    pub fn next_u64(&mut self) -> u64 {
        let [a, b, c, d] = self.state;
        let output = a.wrapping_add(d).rotate_left(23).wrapping_add(a);
        let (c, d) = (c ^ a, d ^ b);
        self.state = [a ^ d, b ^ c, c ^ (b << 17), d.rotate_left(45)];
        output
    }

    /// 32 uniform bits.
    pub fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }

    /// A uniform number in [0, 1) with 24 bits.
    pub fn next_f32(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 * (1.0 / 16_777_216.0)
    }

    /// A uniform number in [0, 1) with 53 bits.
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// A uniform point of [0, 1)².
    pub fn next_vec2(&mut self) -> Vec2 {
        Vec2::new(self.next_f32(), self.next_f32())
    }

    /// A uniform number in [`low`, `high`).
    pub fn range_f32(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next_f32()
    }

    /// A uniform integer below `bound`; zero if `bound` is zero.
    ///
    /// The bias is below 2⁻³² × `bound` (multiplication rather than rejection).
    pub fn below(&mut self, bound: u32) -> u32 {
        ((u64::from(self.next_u32()) * u64::from(bound)) >> 32) as u32
    }

    /// A uniform direction (Archimedes' cylinder map, in double precision).
    pub fn unit_vector(&mut self) -> Vec3 {
        let z = 2.0 * self.next_f64() - 1.0;
        let (sine, cosine) = (std::f64::consts::TAU * self.next_f64()).sin_cos();
        let radius = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new((radius * cosine) as f32, (radius * sine) as f32, z as f32)
    }

    /// A standard normal number (Box and Muller, 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.next_f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.next_f64()).cos()
    }
}

/// The next output of SplitMix64 (Steele, Lea and Flood, 2014), which never returns four zeros in a
/// row.
fn split_mix(counter: &mut u64) -> u64 {
    *counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mixed = (*counter ^ (*counter >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Accumulator, z_test};

    #[test]
    fn split_mix_returns_the_published_outputs() {
        // The test vector of the reference implementation for state 1234567.
        let mut counter = 1_234_567;
        assert_eq!(split_mix(&mut counter), 6_457_827_717_110_365_317);
        assert_eq!(split_mix(&mut counter), 3_203_168_211_198_807_973);
    }

    #[test]
    fn xoshiro_returns_the_published_outputs() {
        // The first outputs of xoshiro256++ from the state 1, 2, 3, 4.
        let mut random = TestRng { state: [1, 2, 3, 4] };
        let outputs: [u64; 4] = std::array::from_fn(|_| random.next_u64());
        assert_eq!(outputs, [41_943_041, 58_720_359, 3_588_806_011_781_223, 3_591_011_842_654_386]);
    }

    #[test]
    fn moments_match_the_distributions() {
        let mut random = TestRng::new(1);
        let mut uniform = Accumulator::default();
        let mut normal = Accumulator::default();
        let mut square = Accumulator::default();
        for _ in 0..100_000 {
            uniform.add(random.next_f64());
            let value = random.normal();
            normal.add(value);
            square.add(value * value);
        }
        assert!(z_test(&uniform, 0.5, 1.0 / 12.0).accepts(1e-3));
        assert!(z_test(&normal, 0.0, 1.0).accepts(1e-3));
        assert!(z_test(&square, 1.0, 2.0).accepts(1e-3));
    }

    #[test]
    fn bounded_integers_stay_below_the_bound() {
        let mut random = TestRng::new(2);
        let mut seen = [false; 7];
        for _ in 0..1000 {
            seen[random.below(7) as usize] = true;
        }
        assert_eq!(seen, [true; 7]);
        assert_eq!(random.below(0), 0);
    }
}
