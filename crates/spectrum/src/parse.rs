//! Parsing of spectra: `.spd` files and the `wavelength:value` pairs of scene files.

use std::fmt;
use std::str::FromStr;

use crate::sampled::SampleError;
use crate::{SampledSpectrum, SpectrumValue};

/// The maximum length of a bad token in an error message.
const EXCERPT_CHARACTERS: usize = 32;

/// Why the text of an `.spd` file is not a valid spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct SpdError {
    /// The line, starting at one; the last line if there are too few samples.
    pub line: usize,
    /// The problem.
    pub cause: SampleError,
}

/// Why the text of a parameter is not a valid spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectrumValueError {
    /// The `wavelength:value` pair, starting at one; the last pair if there are too few.
    pub pair: usize,
    /// The problem.
    pub cause: SampleError,
}

/// Parses an `.spd` file: a wavelength in nanometres and a value per line, separated by spaces, tabs
/// or a comma. A comment extends from `#` to the end of the line.
///
/// Further columns are ignored, as in Mitsuba. Wavelengths must increase.
///
/// # Errors
///
/// For the first line that is not a sample, or whose wavelength or value is invalid.
pub fn parse_spd(text: &str) -> Result<SampledSpectrum, SpdError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut spectrum = SampledSpectrum::empty();
    let mut line_number = 0;
    for line in text.lines() {
        line_number += 1;
        let content = line.split_once('#').map_or(line, |(content, _comment)| content);
        let mut columns = content.split([' ', '\t', ',', '\r']).filter(|column| !column.is_empty());
        if let Some(wavelength) = columns.next() {
            push_sample(&mut spectrum, wavelength, columns.next())
                .map_err(|cause| SpdError { line: line_number, cause })?;
        }
    }
    spectrum.finish().map_err(|cause| SpdError { line: line_number, cause })
}

/// Parses a single number (a constant), or `wavelength:value` pairs separated by commas or spaces.
impl FromStr for SpectrumValue {
    type Err = SpectrumValueError;

    fn from_str(text: &str) -> Result<Self, SpectrumValueError> {
        let mut pairs = text
            .split(|character: char| character == ',' || character.is_whitespace())
            .filter(|pair| !pair.is_empty());
        if !text.contains(':') {
            let error = |cause| SpectrumValueError { pair: 1, cause };
            let constant = pairs.next().ok_or(error(SampleError::TooFew))?;
            if pairs.next().is_some() {
                return Err(error(SampleError::Incomplete));
            }
            return finite(constant).map(Self::Constant).map_err(error);
        }
        let mut spectrum = SampledSpectrum::empty();
        let mut pair_number = 0;
        for pair in pairs {
            pair_number += 1;
            let (wavelength, value) = pair.split_once(':').unwrap_or((pair, ""));
            let value = Some(value).filter(|value| !value.is_empty());
            push_sample(&mut spectrum, wavelength, value)
                .map_err(|cause| SpectrumValueError { pair: pair_number, cause })?;
        }
        let spectrum = spectrum.finish();
        spectrum.map(Self::Sampled).map_err(|cause| SpectrumValueError { pair: pair_number, cause })
    }
}

fn push_sample(
    spectrum: &mut SampledSpectrum,
    wavelength: &str,
    value: Option<&str>,
) -> Result<(), SampleError> {
    let wavelength_nm = finite(wavelength)?;
    let value = finite(value.ok_or(SampleError::Incomplete)?)?;
    spectrum.push(wavelength_nm, value)
}

fn finite(token: &str) -> Result<f32, SampleError> {
    let number: f32 = token
        .parse()
        .map_err(|_| SampleError::NotANumber(token.chars().take(EXCERPT_CHARACTERS).collect()))?;
    if number.is_finite() { Ok(number) } else { Err(SampleError::NotFinite) }
}

impl fmt::Display for SpdError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = self.line;
        match &self.cause {
            // The text is not quoted, because a scene may name any file of the machine.
            SampleError::NotANumber(_) => {
                write!(formatter, "line {line}: expected a wavelength and a value")
            }
            cause => write!(formatter, "line {line}: {cause}"),
        }
    }
}

impl fmt::Display for SpectrumValueError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pair, cause } = self;
        write!(formatter, "{cause} (pair {pair}; expected a number or “wavelength:value” pairs)")
    }
}

impl std::error::Error for SpdError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.cause)
    }
}

impl std::error::Error for SpectrumValueError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.cause)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    fn samples(text: &str) -> Vec<(f32, f32)> {
        let spectrum = parse_spd(text).expect("a valid file");
        let values = spectrum.values().iter().copied();
        spectrum.wavelengths_nm().iter().copied().zip(values).collect()
    }

    #[test]
    fn files_have_one_sample_per_line() {
        let expected = [(400.0, 1.0), (700.0, -0.25)];
        for text in [
            "400 1\n700 -0.25\n",
            "400 1\n700 -2.5e-1",
            "\u{feff}# measured\r\n\r\n400\t1 \r\n  700  -.25\r\n",
            "   # indented\n400 1 # remark\n\n700 -0.25 17",
            "400, 1\n700,-0.25\n",
        ] {
            assert_eq!(samples(text), expected, "{text:?}");
        }
    }

    #[test]
    fn malformed_files_are_rejected_with_their_line() {
        let not_a_number = |text: &str| SampleError::NotANumber(text.to_owned());
        let cases = [
            ("", 0, SampleError::TooFew),
            ("400 1\n", 1, SampleError::TooFew),
            ("# only\n# comments\n", 2, SampleError::TooFew),
            ("400 1\nfoo\n700 1\n", 2, not_a_number("foo")),
            ("400 1\n500\n700 1\n", 2, SampleError::Incomplete),
            ("400 1\n\n700 x1\n", 3, not_a_number("x1")),
            ("400:1\n700:1\n", 1, not_a_number("400:1")),
            ("700 1\n400 1\n", 2, SampleError::NotIncreasing),
            ("400 1\n400 2\n700 1\n", 2, SampleError::NotIncreasing),
            ("400 nan\n700 1\n", 1, SampleError::NotFinite),
            ("400 1\n1e99 1\n", 2, SampleError::NotFinite),
            ("400 1 \0\n7\u{0}0 1\n", 2, not_a_number("7\u{0}0")),
        ];
        for (text, line, cause) in cases {
            assert_eq!(parse_spd(text), Err(SpdError { line, cause }), "{text:?}");
        }
    }

    #[test]
    fn errors_shorten_long_tokens() {
        let error = parse_spd(&"é".repeat(1_000_000)).expect_err("not a number");
        assert!(error.to_string().len() < 200 && error.to_string().starts_with("line 1: "));
    }

    #[test]
    fn parameters_are_constants_or_pairs() {
        for (text, value) in [("0.5", 0.5), (" 1e-1 ", 0.1), ("+.5,", 0.5), ("-2", -2.0)] {
            assert_eq!(text.parse(), Ok(SpectrumValue::Constant(value)), "{text:?}");
        }
        let expected = SampledSpectrum::new(vec![400.0, 700.0], vec![0.25, 3.0]).expect("valid");
        for text in ["400:0.25,700:3", "400:0.25, 700:3", " 400:.25 \n 700:3 ,", "400:.25,,700:3"] {
            assert_eq!(text.parse(), Ok(SpectrumValue::Sampled(expected.clone())), "{text:?}");
        }
    }

    #[test]
    fn malformed_parameters_are_rejected_with_their_pair() {
        let not_a_number = |text: &str| SampleError::NotANumber(text.to_owned());
        let cases = [
            ("", 1, SampleError::TooFew),
            (" , ", 1, SampleError::TooFew),
            ("red", 1, not_a_number("red")),
            ("nan", 1, SampleError::NotFinite),
            ("0.1, 0.2", 1, SampleError::Incomplete),
            ("500:1", 1, SampleError::TooFew),
            ("400:1, 700", 2, SampleError::Incomplete),
            ("400: 1, 500: 1", 1, SampleError::Incomplete),
            ("400:1:2,700:1", 1, not_a_number("1:2")),
            ("400nm:1,700nm:1", 1, not_a_number("400nm")),
            ("400:1,400:2", 2, SampleError::NotIncreasing),
            ("400:1,500:inf", 2, SampleError::NotFinite),
        ];
        for (text, pair, cause) in cases {
            let error = SpectrumValueError { pair, cause };
            assert_eq!(text.parse::<SpectrumValue>(), Err(error), "{text:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 500,
            rng_seed: RngSeed::Fixed(7),
            failure_persistence: None,
            ..ProptestConfig::default()
        })]

        #[test]
        fn accepted_text_is_a_valid_spectrum(text in "[0-9 .:,e#\\-\n]{0,40}|\\PC{0,40}") {
            let from_file = parse_spd(&text).ok();
            let from_parameter = match text.parse() {
                Ok(SpectrumValue::Sampled(spectrum)) => Some(spectrum),
                Ok(SpectrumValue::Constant(value)) => {
                    prop_assert!(value.is_finite());
                    None
                }
                Err(_) => None,
            };
            for spectrum in [from_file, from_parameter].into_iter().flatten() {
                let wavelengths = spectrum.wavelengths_nm().to_vec();
                let rebuilt = SampledSpectrum::new(wavelengths, spectrum.values().to_vec());
                prop_assert_eq!(Ok(spectrum), rebuilt);
            }
        }

        #[test]
        fn written_samples_are_read_back(
            values in prop::collection::vec(-1e6_f32..1e6, 2..20),
            first in -500.0_f32..500.0,
            step in 0.5_f32..50.0,
        ) {
            let wavelengths: Vec<f32> = (0..values.len()).map(|i| first + step * i as f32).collect();
            let lines = wavelengths.iter().zip(&values).map(|(w, v)| format!("{w} {v}"));
            let text = lines.collect::<Vec<_>>().join("\n");
            let expected = SampledSpectrum::new(wavelengths, values).expect("increasing");
            prop_assert_eq!(parse_spd(&text), Ok(expected.clone()));
            let pairs = text.replace(' ', ":").replace('\n', ", ");
            prop_assert_eq!(pairs.parse(), Ok(SpectrumValue::Sampled(expected)));
        }
    }
}
