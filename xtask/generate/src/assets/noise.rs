//! Value noise: the same on every machine, since nothing but a hash of integers is random.

/// Smooth noise in [0, 1] that repeats after `period` cells in both directions.
///
/// Random values at the corners of a unit grid, interpolated with zero slope at the corners
/// (Ebert et al., *Texturing and Modeling*, 3rd edition, chapter 2).
pub(super) fn value(x: f64, y: f64, period: u32, seed: u32) -> f64 {
    let (cell_x, cell_y) = (x.floor(), y.floor());
    let (s, t) = (smooth(x - cell_x), smooth(y - cell_y));
    let wrap = |cell: f64| (cell as i64).rem_euclid(i64::from(period)) as u32;
    let (left, right) = (wrap(cell_x), wrap(cell_x + 1.0));
    let (below, above) = (wrap(cell_y), wrap(cell_y + 1.0));
    let lower = mix(random(left, below, seed), random(right, below, seed), s);
    let upper = mix(random(left, above, seed), random(right, above, seed), s);
    mix(lower, upper, t)
}

/// Noise of several scales in [0, 1]: `octaves` of it, each twice as fine and half as strong.
pub(super) fn fractal(x: f64, y: f64, period: u32, octaves: u32) -> f64 {
    let mut sum = 0.0;
    let mut total = 0.0;
    for octave in 0..octaves {
        let scale = f64::from(1 << octave);
        sum += value(x * scale, y * scale, period << octave, octave) / scale;
        total += 1.0 / scale;
    }
    sum / total
}

/// A number in [0, 1) that only depends on its arguments, all of them mixed by multiplications and
/// shifts (the finisher of MurmurHash3).
pub(super) fn random(x: u32, y: u32, seed: u32) -> f64 {
    let mut hash = x ^ y.wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
    for multiplier in [0x85eb_ca6b, 0xc2b2_ae35] {
        hash = (hash ^ (hash >> 16)).wrapping_mul(multiplier);
        hash ^= hash >> 13;
    }
    f64::from(hash ^ (hash >> 16)) / 4_294_967_296.0
}

/// From `a` at 0 to `b` at 1.
pub(super) fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// From 0 to 1 as `x` goes from `start` to `end`, without a kink.
pub(super) fn step(start: f64, end: f64, x: f64) -> f64 {
    smooth(((x - start) / (end - start)).clamp(0.0, 1.0))
}

fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_repeats_and_stays_in_range() {
        for index in 0..1000 {
            let (x, y) = (random(index, 0, 1) * 8.0, random(index, 1, 1) * 8.0);
            let here = fractal(x, y, 8, 4);
            assert!((0.0..=1.0).contains(&here));
            assert!((here - fractal(x + 8.0, y - 8.0, 8, 4)).abs() < 1e-9);
        }
    }
}
