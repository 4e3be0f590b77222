//! Compares lanes with scalars bit by bit, at every level of this machine.

use super::*;
use crate::with_lanes;

const VALUES: [f32; MAX_LANES] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    3.25,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    1e-40,
    -1e-45,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    0.1,
    -7.7,
    1e9,
];

fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![baseline(), best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(best.as_avx2().map(Simd::level));
    levels
}

/// Asserts that a function gives the same bits in lanes as for scalars.
macro_rules! assert_same {
    ($name:literal, |$x:ident| $body:expr) => {
        for level in levels() {
            let mut results = LaneArray::ZERO;
            with_lanes!(level, simd => apply(simd, &mut results, |$x| $body));
            for (lane, &value) in VALUES.iter().enumerate() {
                let $x = value;
                let expected: f32 = $body;
                let same = results.0[lane].to_bits() == expected.to_bits()
                    || results.0[lane].is_nan() && expected.is_nan();
                assert!(same, "{}({value}): {} {expected}", $name, results.0[lane]);
            }
        }
    };
}

#[inline(always)]
fn apply<S: Simd>(simd: S, results: &mut LaneArray, function: impl Fn(Lanes<S>) -> Lanes<S>) {
    for first in (0..MAX_LANES).step_by(Lanes::<S>::COUNT) {
        function(Lanes::load(simd, &LaneArray(VALUES), first)).store(results, first);
    }
}

#[test]
fn lanes_give_the_bits_of_scalars() {
    assert_same!("next_up", |x| Real::next_up(x));
    assert_same!("next_down", |x| Real::next_down(x));
    for direction in [2.0, -1e-45, 0.0, -0.0, f32::NAN, f32::NEG_INFINITY] {
        assert_same!("next_towards", |x| Real::next_towards(x, Real::like(x, direction)));
    }
    assert_same!("sqrt", |x| Real::sqrt(x));
    assert_same!("safe_sqrt", |x| Real::safe_sqrt(x));
    assert_same!("reciprocal", |x| Real::reciprocal(x));
    assert_same!("arithmetic", |x| -(x * 3.0 - x / (x * x + 0.5)));
    assert_same!("max", |x| Real::max(x, Real::like(x, 0.5)));
    assert_same!("min", |x| Real::min(x, Real::like(x, 0.5)));
    assert_same!("copysign", |x| Real::copysign(Real::like(x, 2.0), x));
    assert_same!("finite", |x| Real::select(Real::is_finite(x), x, Real::zero(x)));
}

#[test]
fn rounding_and_exponents_are_consistent() {
    assert_same!("floor", |x| {
        let inside = Real::select(Real::abs(x).below(1e9), x, Real::zero(x));
        Real::floor(inside)
    });
    assert_same!("power_of_two", |x| {
        let inside = Real::select(Real::abs(x).below(100.0), x, Real::zero(x));
        Real::power_of_two(Real::floor(inside))
    });
    assert_same!("mantissa and exponent", |x| {
        let normal = Real::select(Real::is_finite(x), Real::abs(x), Real::like(x, 1.0));
        let (mantissa, exponent) =
            Real::mantissa_and_exponent(Real::max(normal, normal.like(1e-30)));
        mantissa + exponent
    });
    let (mantissa, exponent) = Real::mantissa_and_exponent(40.0_f32);
    assert_eq!((mantissa, exponent), (1.25, 5.0));
    assert_eq!(Real::floor(-0.5_f32), -1.0);
    assert_eq!([-1.5, -0.5, 0.4, 2.5].map(<f32 as Real>::nearest), [-2.0, 0.0, 0.0, 2.0]);
    assert_eq!(
        [-126.0, 0.0, 127.0].map(<f32 as Real>::power_of_two),
        [-126, 0, 127].map(|n| 2.0_f32.powi(n))
    );
}

#[test]
fn functions_give_the_bits_of_scalars() {
    assert_same!("exp", |x| Real::exp(x));
    assert_same!("exp nearer zero", |x| Real::exp(Real::min(x, x.like(1.0)) * 0.37));
    assert_same!("ln", |x| {
        let positive = Real::select(Real::is_finite(x), Real::abs(x), Real::like(x, 1.0));
        Real::ln(Real::max(positive, positive.like(f32::MIN_POSITIVE)))
    });
    assert_same!("sine and cosine", |x| {
        let inside = Real::select(Real::abs(x).below(1e8), x, Real::zero(x));
        let (sine, cosine) = Real::sin_cos_turn(inside);
        sine - cosine * 3.0
    });
}

#[test]
fn both_table_lookups_agree_with_indexing() {
    let table: [f32; TABLE_ENTRIES] = std::array::from_fn(|entry| 0.1 * entry as f32 - 3.0);
    for level in levels() {
        for shift in [0, 13, 48] {
            let indices = LaneArray(std::array::from_fn(|lane| (lane + shift) as f32));
            let mut entries = [LaneArray::ZERO; 2];
            with_lanes!(level, simd => read(simd, &table, &indices, &mut entries));
            for lane in 0..MAX_LANES {
                let expected = table[lane + shift];
                assert_eq!(entries.map(|entries| entries.0[lane]), [expected; 2], "{level:?}");
            }
        }
    }
}

#[inline(always)]
fn read<S: Simd>(
    simd: S,
    table: &[f32; TABLE_ENTRIES],
    indices: &LaneArray,
    entries: &mut [LaneArray; 2],
) {
    for first in (0..MAX_LANES).step_by(Lanes::<S>::COUNT) {
        let index = Lanes::load(simd, indices, first);
        Lanes::of_table(simd, table, index).store(&mut entries[0], first);
        Lanes::of_tables(simd, index, |_| table).store(&mut entries[1], first);
    }
}

#[test]
fn mask_bits_round_trip() {
    for level in levels() {
        let bits = with_lanes!(level, simd => masks(simd));
        assert!(bits.0 && bits.1 && bits.2, "{level:?}");
    }
}

#[inline(always)]
fn masks<S: Simd>(simd: S) -> (bool, bool, bool) {
    let count = Lanes::<S>::COUNT;
    let numbers = Lanes::from_fn(simd, |lane| lane as f32);
    let low = numbers.below(2.0);
    let round_trip = LaneMask::from_bits(simd, low.bits()).bits() == 0b11;
    let all = (low | !low).all() && !(low & !low).any();
    let inverse = (!low).bits() == (1 << count) - 1 - 0b11;
    (round_trip, all, inverse)
}

#[test]
fn generic_frames_equal_scalar_frames() {
    use glam::Vec3;
    let n = Vec3::new(0.48, -0.6, 0.64);
    for tangent in [Vec3::X, Vec3::ZERO, n * 2.0, Vec3::splat(f32::NAN), Vec3::splat(f32::MAX)] {
        let single = crate::Frame::from_normal_and_tangent(n, tangent);
        let generic = Frame3::<f32>::from_normal_and_tangent(n.into(), tangent.into());
        assert_eq!([single.s, single.t], [generic.s, generic.t].map(Vec3::from), "{tangent}");
    }
}

#[test]
fn words_in_lanes_equal_scalar_words() {
    let words: [u64; MAX_LANES] = std::array::from_fn(|lane| {
        (lane as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (0xffff_ffff << (2 * lane))
    });
    for level in levels() {
        let mut results = [WordArray32::default(); 4];
        with_lanes!(level, simd => words_in_lanes(simd, &WordArray64(words), &mut results));
        for (lane, &word) in words.iter().enumerate() {
            let expected = work_on_words(word);
            let lanes = [0, 1, 2].map(|result| results[result].0[lane]);
            assert_eq!(lanes, expected, "{level:?}, lane {lane}");
            assert_eq!(f32::from_bits(results[3].0[lane]), (expected[0] >> 8) as f32);
            assert_eq!(expected[1], expected[0].reverse_bits());
        }
    }
}

/// The results of an expression that uses every operation on words: a value, its bits reversed, and
/// another value.
#[inline(always)]
fn work_on_words<W: Word64>(word: W) -> [W::Half; 3] {
    let long = word.times(0xbf58_476d_1ce4_e5b9) ^ (word >> 27 | word << 11);
    let long = long.wrapping_mul(word.plus(0x1234_5678_9abc_def1)) & 0xffff_0fff_ffff_fff7 | 2;
    let long = long.wrapping_add(word);
    let (upper, lower) = (long.upper(), long.lower());
    let half = upper.wrapping_mul(lower).plus(0x8000_0007).wrapping_add(lower.times(0x0552_6c57));
    let [first, second] = Word32::reverse_bits_of_both(half, upper);
    [half, first, second ^ (lower & 0xff | 3)]
}

#[inline(always)]
fn words_in_lanes<S: Simd>(simd: S, words: &WordArray64, results: &mut [WordArray32; 4]) {
    for first in (0..MAX_LANES).step_by(Lanes::<S>::COUNT) {
        let computed = work_on_words(WordLanes64::load(simd, words, first));
        let [a, b, c, real] = results;
        computed[0].store(a, first);
        computed[1].store(b, first);
        computed[2].store(c, first);
        let exact = (computed[0] >> 8).to_real();
        for lane in 0..Lanes::<S>::COUNT {
            real.0[first + lane] = exact.lane(lane).to_bits();
        }
    }
}
