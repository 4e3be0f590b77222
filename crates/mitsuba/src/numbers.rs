//! Parses numbers in attribute values.

use std::ops::Range;

/// An error in a number or a list of numbers, and where in the value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NumberError {
    /// One sentence without a full stop.
    pub(crate) message: String,
    /// In bytes of the value.
    pub(crate) range: Range<usize>,
    /// What to write instead, if that is clear.
    pub(crate) help: Option<String>,
}

impl NumberError {
    fn new(message: String, range: Range<usize>) -> Self {
        Self { message, range, help: None }
    }
}

/// The words of a value, separated by any run of commas and white space.
pub(crate) fn words(value: &str) -> impl Iterator<Item = (usize, &str)> {
    let separates = |c: char| c == ',' || c.is_ascii_whitespace();
    let mut position = 0;
    std::iter::from_fn(move || {
        let start = position + value[position..].find(|c| !separates(c))?;
        position = value[start..].find(separates).map_or(value.len(), |length| start + length);
        Some((start, &value[start..position]))
    })
}

/// A finite number.
pub(crate) fn number(value: &str) -> Result<f64, NumberError> {
    let trimmed = value.trim();
    let offset = value.len() - value.trim_start().len();
    number_at(offset, trimmed)
}

fn number_at(offset: usize, word: &str) -> Result<f64, NumberError> {
    let range = offset..offset + word.len();
    let fail = |message: String| Err(NumberError::new(message, range.clone()));
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) if word.contains(|c: char| c.is_ascii_digit()) => {
            fail(format!("`{}` is too large a number", shorten(word)))
        }
        Ok(_) => fail(format!("`{}` is not a finite number", shorten(word))),
        Err(_) if word.is_empty() => fail("a number is missing here".to_owned()),
        Err(_) => {
            let message = format!("`{}` is not a number", shorten(word));
            Err(NumberError { help: advice(word), ..NumberError::new(message, range) })
        }
    }
}

/// What to write instead of a word that is not a number.
fn advice(word: &str) -> Option<String> {
    let with_point = word.replacen(',', ".", 1);
    if word.contains(',') && with_point.parse::<f64>().is_ok() {
        return Some(format!("decimals have a point: write `{with_point}`"));
    }
    let unit = word.trim_end_matches(|letter: char| letter.is_alphabetic() || letter == '%');
    if unit.len() < word.len() && unit.parse::<f64>().is_ok() {
        return Some(format!("numbers have no unit: write `{unit}`"));
    }
    let has_digits = word.contains(|letter: char| letter.is_ascii_digit());
    (has_digits && word.contains(['*', '/', '+', '(', '-']))
        .then(|| "nothing is calculated here: write the result".to_owned())
}

/// Whether a list of numbers looks as if its commas were decimal points: `0,5 0,25 1,0`.
pub(crate) fn has_decimal_commas(value: &str) -> bool {
    let mut words = value.split_ascii_whitespace().peekable();
    let is_decimal = |word: &str| {
        let digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
        word.split_once(',').is_some_and(|(whole, rest)| {
            !whole.is_empty() && !rest.is_empty() && digits(whole) && digits(rest)
        })
    };
    words.peek().is_some() && words.all(is_decimal)
}

/// An integer; a fraction of zero is accepted.
pub(crate) fn integer(value: &str) -> Result<i64, NumberError> {
    if let Ok(integer) = value.trim().parse() {
        return Ok(integer);
    }
    let float = number(value)?;
    let fail = |message: String| Err(NumberError::new(message, 0..value.len()));
    if float.fract() != 0.0 {
        return fail(format!("`{}` is not a whole number", shorten(value.trim())));
    }
    // Beyond 2^53, floats cannot represent every integer.
    if float.abs() > 2f64.powi(53) {
        return fail(format!("`{}` is too large a whole number", shorten(value.trim())));
    }
    Ok(float as i64)
}

/// Finite numbers separated by commas or spaces.
pub(crate) fn numbers(value: &str) -> Result<Vec<f64>, NumberError> {
    words(value).map(|(offset, word)| number_at(offset, word)).collect()
}

/// Pairs of wavelength and value, `400:0.1, 500:0.2`, the wavelengths in nanometres, ascending.
pub(crate) fn pairs(value: &str) -> Result<Vec<(f64, f64)>, NumberError> {
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for (offset, word) in words(value) {
        let fail = |message: String| NumberError::new(message, offset..offset + word.len());
        let Some((left, right)) = word.split_once(':') else {
            return Err(fail(format!("`{}` is not a pair `wavelength:value`", shorten(word))));
        };
        let wavelength = number_at(offset, left)?;
        let value = number_at(offset + left.len() + 1, right)?;
        if pairs.last().is_some_and(|(before, _)| *before >= wavelength) {
            return Err(fail("wavelengths must ascend".to_owned()));
        }
        pairs.push((wavelength, value));
    }
    Ok(pairs)
}

/// The start of a word, for a message.
pub(crate) fn shorten(word: &str) -> String {
    match word.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &word[..end]),
        None => word.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_and_spaces_separate_alone_or_together() {
        for text in ["1 -2.5 3e2", "1,-2.5,3e2", " 1, -2.5,\n\t3e2 ", "1 ,-2.5 , +300."] {
            assert_eq!(numbers(text).unwrap(), [1.0, -2.5, 300.0], "{text:?}");
        }
        assert_eq!(numbers("-2.91046e-011").unwrap(), [-2.91046e-11]);
        assert_eq!(numbers(" ").unwrap(), []);
    }

    #[test]
    fn the_word_at_fault_is_pointed_at() {
        let error = numbers("1, 2x, 3").unwrap_err();
        assert_eq!((error.message.as_str(), error.range), ("`2x` is not a number", 3..5));
        assert_eq!(numbers("1 inf").unwrap_err().message, "`inf` is not a finite number");
        assert_eq!(number(" 1e999").unwrap_err().range, 1..6);
        assert_eq!(number("").unwrap_err().message, "a number is missing here");
        assert_eq!(number("nan").unwrap_err().message, "`nan` is not a finite number");
    }

    #[test]
    fn usual_mistakes_are_told_what_to_write() {
        let help = |text: &str| number(text).unwrap_err().help.unwrap_or_default();
        assert!(help("0,5").contains("write `0.5`"));
        assert!(help("45deg").contains("write `45`"));
        assert!(help("16*2").contains("write the result"));
        assert_eq!(help("abc"), "");
        assert!(has_decimal_commas("0,5 0,5 0,25"));
        assert!(!has_decimal_commas("0, 5, 0, 5"));
        assert!(!has_decimal_commas("1 2 3 4"));
    }

    #[test]
    fn whole_numbers_may_carry_a_zero_fraction() {
        assert_eq!(integer(" 16 "), Ok(16));
        assert_eq!(integer("10.0"), Ok(10));
        assert_eq!(integer("1e3"), Ok(1000));
        assert_eq!(integer("9223372036854775807"), Ok(i64::MAX));
        assert!(integer("1.5").unwrap_err().message.contains("whole"));
        assert!(integer("1e30").unwrap_err().message.contains("large"));
    }

    #[test]
    fn spectra_are_pairs_in_order() {
        assert_eq!(pairs("400:0.1, 500:0.2").unwrap(), [(400.0, 0.1), (500.0, 0.2)]);
        assert_eq!(pairs("500:1 400:2").unwrap_err().range, 6..11);
        assert_eq!(pairs("500:x").unwrap_err().range, 4..5);
        assert!(pairs("500:1, 3").unwrap_err().message.contains("pair"));
    }
}
