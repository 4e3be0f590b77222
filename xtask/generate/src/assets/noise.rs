//! Value noise. It is the same on every machine because the only source of randomness is an integer
//! hash.

/// Smooth noise in [0, 1] with a period of `period` cells in both directions.
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

/// Fractal noise in [0, 1]: `octaves` layers, each twice as fine and half as strong as the one
/// before.
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

/// Smooth non-repeating noise in [0, 1] over space, with several octaves like [`fractal`].
pub(super) fn fractal_solid(place: [f64; 3], octaves: u32, seed: u32) -> f64 {
    let mut sum = 0.0;
    let mut total = 0.0;
    for octave in 0..octaves {
        let scale = f64::from(1 << octave);
        sum += solid(place.map(|coordinate| coordinate * scale), seed + 16 * octave) / scale;
        total += 1.0 / scale;
    }
    sum / total
}

/// Smooth noise in [0, 1] over space, from random values at the corners of a unit grid.
fn solid(place: [f64; 3], seed: u32) -> f64 {
    let cell = place.map(f64::floor);
    let [s, t, u] = std::array::from_fn(|axis| smooth(place[axis] - cell[axis]));
    let corner = |x: i64, y: i64, z: i64| {
        let [x, y, z] = [cell[0] as i64 + x, cell[1] as i64 + y, cell[2] as i64 + z];
        let layer = (z as u32).wrapping_mul(0xc2b2_ae3d);
        random(x as u32, y as u32, seed.wrapping_add(layer))
    };
    let row = |y, z| mix(corner(0, y, z), corner(1, y, z), s);
    let layer = |z| mix(row(0, z), row(1, z), t);
    mix(layer(0), layer(1), u)
}

/// A number in [0, 1) that depends only on its arguments, which are mixed by multiplications and
/// shifts (the finaliser of MurmurHash3).
pub(crate) fn random(x: u32, y: u32, seed: u32) -> f64 {
    let mut hash = x ^ y.wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
    for multiplier in [0x85eb_ca6b, 0xc2b2_ae35] {
        hash = (hash ^ (hash >> 16)).wrapping_mul(multiplier);
        hash ^= hash >> 13;
    }
    f64::from(hash ^ (hash >> 16)) / 4_294_967_296.0
}

/// Interpolates linearly from `a` at 0 to `b` at 1.
pub(super) fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// Rises smoothly from 0 to 1 as `x` goes from `start` to `end`.
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
    fn solid_noise_has_its_random_values_at_whole_places_and_stays_in_range() {
        assert_eq!(solid([3.0, 4.0, 0.0], 7), random(3, 4, 7));
        let steps = |step: u32| f64::from(step) * 0.37 - 4.0;
        for step in 0..1000 {
            let place = [steps(step), steps(step / 3), steps(step / 7)];
            assert!((0.0..=1.0).contains(&fractal_solid(place, 4, 1)));
        }
    }

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
