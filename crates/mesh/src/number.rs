//! Number parsing: eight digits at a time, and correctly rounded floats.

/// Powers of ten up to the longest run of digits in one step.
const POWERS_OF_TEN: [u64; 9] =
    [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Powers of ten for a fraction of up to [`DIGITS_OF_U64`] digits, all exact in double precision.
const EXACT_POWERS_OF_TEN: [f64; DIGITS_OF_U64 + 1] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19,
];

/// The number of decimal digits that always fit a `u64`.
const DIGITS_OF_U64: usize = 19;

/// Integers up to this one are exact in double precision.
const EXACT_INTEGERS: u64 = 1 << 53;

/// The decimal integer at the start of `bytes`, with an optional sign, and its length in bytes.
/// `None` if there is none, or if it has more than 19 digits.
#[inline]
pub(crate) fn parse_integer(bytes: &[u8]) -> Option<(i64, usize)> {
    let (negative, start) = sign(bytes);
    let (magnitude, end) = digits(bytes, start);
    if end == start || end - start > DIGITS_OF_U64 {
        return None;
    }
    let magnitude = i64::try_from(magnitude).ok()?;
    Some((if negative { -magnitude } else { magnitude }, end))
}

/// [`parse_integer`] for one to seven digits without a sign that do not end the text: the great
/// majority of indices. `None` for all others.
#[inline(always)]
pub(crate) fn parse_short_integer(bytes: &[u8]) -> Option<(u32, usize)> {
    let (value, length) = digit_run(u64::from_le_bytes(*bytes.first_chunk()?));
    (1..8).contains(&length).then_some((value as u32, length))
}

/// The single-precision number nearest to the decimal at the start of `bytes` (ties to even), and
/// its length in bytes. Reads the syntax of `str::parse`, including `inf` and `nan`.
pub(crate) fn parse_any_float(bytes: &[u8]) -> Option<(f32, usize)> {
    fast_float2::parse_partial::<f32, _>(bytes).ok().filter(|&(_, end)| end > 0)
}

/// How the C library of Windows writes numbers that are not finite: `1.#IND`, `-1.#QNAN`, `1.#INF`,
/// `-nan(ind)`, `nan(snan)`; and the length of that. The signs of NaN do not matter.
pub(crate) fn parse_windows_non_finite(bytes: &[u8]) -> Option<(f32, usize)> {
    let is_end = |byte: &u8| byte.is_ascii_whitespace();
    let length = bytes.iter().position(is_end).unwrap_or(bytes.len());
    let word = bytes.get(..length.min(16)).filter(|_| length <= 16)?.to_ascii_lowercase();
    let (negative, rest) = match word.strip_prefix(b"-") {
        Some(rest) => (true, rest),
        None => (false, word.as_slice()),
    };
    let value = match rest {
        b"1.#inf" => f32::INFINITY,
        b"1.#ind" | b"1.#qnan" | b"1.#snan" | b"nan(ind)" | b"nan(snan)" | b"nan(qnan)" => f32::NAN,
        _ => return None,
    };
    Some((if negative { -value } else { value }, length))
}

/// Whether a number's point is followed by the rest of one that [`parse_windows_non_finite`] reads,
/// and not by a comment.
pub(crate) fn is_windows_non_finite(from_hash: &[u8]) -> bool {
    let starts = |mark: &[u8]| {
        from_hash.get(..mark.len()).is_some_and(|start| start.eq_ignore_ascii_case(mark))
    };
    [&b"#inf"[..], b"#ind", b"#qnan", b"#snan"].into_iter().any(starts)
}

/// [`parse_any_float`] for decimals without an exponent that do not end the text: the great
/// majority of numbers. `None` for all others, and for a few that this fast path cannot decide.
///
/// A mantissa m < 2⁵³ and a power of ten up to 10²² are both exact in double precision, so m/10ᵏ is
/// rounded once (Clinger, "How to Read Floating Point Numbers Accurately", PLDI 1990). A second
/// rounding to single precision is also correct, unless the double lies exactly halfway between two
/// singles: then the first rounding may have hidden on which side the decimal lies.
#[inline(always)]
pub(crate) fn parse_plain_float(bytes: &[u8]) -> Option<(f32, usize)> {
    // At most a sign, a point and three runs of digits, so nothing below is out of bounds.
    let window = bytes.first_chunk::<32>()?;
    let run = |place: usize| {
        let characters = window.get(place..place + 8)?.first_chunk()?;
        Some(digit_run(u64::from_le_bytes(*characters)))
    };
    let negative = window[0] == b'-';
    let start = usize::from(negative);
    let (mut mantissa, whole_digits) = run(start)?;
    let mut end = start + whole_digits;
    let mut fraction_digits = 0;
    if window[end] == b'.' {
        let first = end + 1;
        let (value, length) = run(first)?;
        mantissa = mantissa * POWERS_OF_TEN[length] + value;
        end = first + length;
        if length == 8 {
            let (value, length) = run(end)?;
            mantissa = mantissa.wrapping_mul(POWERS_OF_TEN[length]).wrapping_add(value);
            end += length;
        }
        fraction_digits = end - first;
    }
    let digits = whole_digits + fraction_digits;
    let continues = matches!(window[end], b'0'..=b'9' | b'e' | b'E');
    if continues || digits == 0 || digits > DIGITS_OF_U64 || mantissa > EXACT_INTEGERS {
        return None;
    }
    // Signed, because x86-64 has no single instruction for the conversion of unsigned integers.
    let double = mantissa as i64 as f64 / EXACT_POWERS_OF_TEN[fraction_digits];
    let magnitude = round_once_more(double)?;
    Some((f32::from_bits(magnitude.to_bits() | u32::from(negative) << 31), end))
}

/// The single nearest to the exact value that was rounded to `double`. `None` if the first rounding
/// makes it undecidable.
#[inline]
fn round_once_more(double: f64) -> Option<f32> {
    // Halfway between two singles: the 29 bits that single precision drops are a one and zeros.
    const DROPPED_BITS: u64 = (1 << 29) - 1;
    const HALF: u64 = 1 << 28;
    let is_tie = double.to_bits() & DROPPED_BITS == HALF;
    let is_subnormal = double < f64::from(f32::MIN_POSITIVE) && double != 0.0;
    (!is_tie && !is_subnormal).then_some(double as f32)
}

#[inline]
fn sign(bytes: &[u8]) -> (bool, usize) {
    match bytes.first() {
        Some(b'-') => (true, 1),
        Some(b'+') => (false, 1),
        _ => (false, 0),
    }
}

/// The value of the digits from `position` on, and their end. The value is meaningless for more than
/// 19 digits; the caller checks their number.
#[inline]
fn digits(bytes: &[u8], mut position: usize) -> (u64, usize) {
    let mut value = 0_u64;
    while let Some(chunk) = bytes.get(position..position + 8).and_then(<[u8]>::first_chunk::<8>) {
        let (run_value, run_length) = digit_run(u64::from_le_bytes(*chunk));
        value = value.wrapping_mul(POWERS_OF_TEN[run_length]).wrapping_add(run_value);
        position += run_length;
        if run_length < 8 {
            return (value, position);
        }
    }
    while let Some(digit) = bytes.get(position).map(|byte| byte.wrapping_sub(b'0')) {
        if digit > 9 {
            break;
        }
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        position += 1;
    }
    (value, position)
}

/// The value and the length of the run of digits at the start (low end) of eight characters,
/// without a loop or a branch per digit (after Lemire, "Quickly parsing eight digits", 2018).
#[inline]
fn digit_run(characters: u64) -> (u64, usize) {
    let offsets = characters ^ 0x3030_3030_3030_3030;
    // Sets the top bit of every byte above 9, by adding 0x76 if it is not set already. A carry out
    // of one byte only affects bytes after the first non-digit.
    let non_digits =
        (offsets.wrapping_add(0x7676_7676_7676_7676) | offsets) & 0x8080_8080_8080_8080;
    let length = non_digits.trailing_zeros() as usize / 8;
    if length == 0 {
        return (0, 0);
    }
    // Shifting the run to the high end puts zeros before it, and drops what follows it.
    let aligned = offsets << (8 * (8 - length));
    let pairs = aligned.wrapping_mul(10).wrapping_add(aligned >> 8);
    let fours = (pairs & 0x0000_00FF_0000_00FF).wrapping_mul(100 + (1_000_000 << 32));
    let others = ((pairs >> 16) & 0x0000_00FF_0000_00FF).wrapping_mul(1 + (10_000 << 32));
    (fours.wrapping_add(others) >> 32, length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The combination that `TextCursor` uses.
    fn parse_float(bytes: &[u8]) -> Option<(f32, usize)> {
        parse_plain_float(bytes).or_else(|| parse_any_float(bytes))
    }

    #[test]
    fn numbers_that_windows_calls_not_finite_are_read() {
        for word in ["1.#IND", "-1.#IND", "1.#QNAN", "-nan(ind)", "nan(snan)"] {
            let (value, length) = parse_windows_non_finite(format!("{word} 1").as_bytes()).unwrap();
            assert!(value.is_nan() && length == word.len(), "{word}");
        }
        assert_eq!(parse_windows_non_finite(b"-1.#INF"), Some((f32::NEG_INFINITY, 7)));
        assert_eq!(parse_windows_non_finite(b"1.#comment"), None);
        assert!(is_windows_non_finite(b"#IND 2") && !is_windows_non_finite(b"# ind"));
    }

    /// Compares bits with the standard library, so the sign of zero counts.
    fn assert_as_std(text: &str) {
        let expected: f32 = text.parse().expect("the standard library reads it");
        // The fast path is for numbers that do not end the text.
        let long = " 123456789".repeat(4);
        for padding in ["", " 123456789", "/12345678", &long] {
            let padded = format!("{text}{padding}");
            let (value, end) = parse_float(padded.as_bytes()).expect(text);
            assert_eq!(end, text.len(), "{padded}");
            assert_eq!(value.to_bits(), expected.to_bits(), "{padded}: {value} != {expected}");
        }
    }

    #[test]
    fn chosen_numbers_agree_with_the_standard_library() {
        for text in [
            "0",
            "-0",
            "+1",
            "-2.455112",
            "0.000001",
            "123456789",
            "1.",
            ".5",
            "-.5e1",
            "1e10",
            "1E-10",
            "1e+5",
            "3.4028235e38",
            "3.4028236e38",
            "1e39",
            "-1e400",
            "1e-45",
            "7e-46",
            "1.17549435e-38",
            "1.1754943e-38",
            "16777217",
            "16777219",
            "33554435",
            "16777217.0000000000000000000000000001",
            "0.1e-6",
            "9007199254740993",
            "18446744073709551615",
            "99999999999999999999",
            "00000000000000000000000001.5",
            "1.00000017881393432617187499",
            "1.00000017881393432617187500",
            "1.00000017881393432617187501",
            "8.589973e9",
            "4.7019774032891500318749461488889827112746622270883501e-38",
        ] {
            assert_as_std(text);
        }
    }

    #[test]
    fn malformed_numbers_are_rejected() {
        for text in ["", "-", ".", "+.", "e5", "x", "/1", " 1"] {
            assert_eq!(parse_float(text.as_bytes()), None, "{text:?}");
        }
        assert!(parse_float(b"nan").is_some_and(|(value, _)| value.is_nan()));
        assert_eq!(parse_float(b"-inf"), Some((f32::NEG_INFINITY, 4)));
        for text in ["", "-", "x", "99999999999999999999", "9999999999999999999"] {
            assert_eq!(parse_integer(text.as_bytes()), None, "{text:?}");
        }
    }

    #[test]
    fn short_integers_have_one_to_seven_digits_and_do_not_end_the_text() {
        assert_eq!(parse_short_integer(b"7/123456"), Some((7, 1)));
        assert_eq!(parse_short_integer(b"1234567 "), Some((1_234_567, 7)));
        assert_eq!(parse_short_integer(b"0000012//"), Some((12, 7)));
        for text in ["12345678 ", "/1234567", "-1234567", "1234567", ""] {
            assert_eq!(parse_short_integer(text.as_bytes()), None, "{text:?}");
        }
    }

    #[test]
    fn integers_end_after_their_last_digit() {
        assert_eq!(parse_integer(b"12/3"), Some((12, 2)));
        assert_eq!(parse_integer(b"-7 "), Some((-7, 2)));
        assert_eq!(
            parse_integer(b"123456789012345678/99999999"),
            Some((123_456_789_012_345_678, 18))
        );
        assert_eq!(parse_integer(b"+8"), Some((8, 2)));
    }

    proptest! {
        #[test]
        fn shortest_decimals_round_trip(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            assert_as_std(&value.to_string());
            assert_as_std(&format!("{value:e}"));
            assert_as_std(&format!("{value:.6}"));
        }

        #[test]
        fn decimals_near_ties_agree_with_the_standard_library(
            bits in any::<u32>(),
            nudge in -1_i64..=1,
            digits in 1_usize..25,
        ) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            let between = f64::midpoint(f64::from(value), f64::from(value.next_up()));
            prop_assume!(between.is_finite() && between != 0.0);
            let near = f64::from_bits(between.to_bits().wrapping_add_signed(nudge));
            assert_as_std(&format!("{near:e}"));
            assert_as_std(&format!("{near:.digits$e}"));
        }

        #[test]
        fn plain_decimals_agree_with_the_standard_library(
            text in "[+-]?[0-9]{1,12}(\\.[0-9]{0,12})?([eE][+-]?[0-9]{1,3})?",
        ) {
            assert_as_std(&text);
        }

        #[test]
        fn digit_runs_have_the_right_length_and_value(text in "[0-9]{0,8}[^0-9][ -~]{8}") {
            prop_assume!(text.is_ascii());
            let length = text.bytes().take_while(u8::is_ascii_digit).count();
            let value = text[..length].parse::<u64>().unwrap_or(0);
            prop_assert_eq!(super::digits(text.as_bytes(), 0), (value, length));
        }
    }
}
