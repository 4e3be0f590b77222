//! Parsers for argument values.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use etendue::image::FileFormat;
use etendue::{Region, SampleChoice, SampleId};

/// `WIDTHxHEIGHT` in pixels.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
        Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
    });
    sides
        .filter(|sides| !sides.contains(&0))
        .ok_or_else(|| "expected WIDTHxHEIGHT, such as 640x360".into())
}

/// `X,Y,WIDTH,HEIGHT` in pixels.
pub(crate) fn crop(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) => Ok(Region { x, y, width, height }),
        _ => Err("expected X,Y,WIDTH,HEIGHT, such as 100,50,64,64".into()),
    }
}

/// A finite number of stops.
pub(crate) fn exposure(text: &str) -> Result<f32, String> {
    let stops = text.parse().ok().filter(|stops: &f32| stops.is_finite());
    stops.ok_or_else(|| "the exposure is not a finite number".to_owned())
}

/// A number of zero or more.
pub(crate) fn limit(text: &str) -> Result<f64, String> {
    let limit = text.parse().ok().filter(|limit: &f64| *limit >= 0.0);
    limit.ok_or_else(|| "expected a number of zero or more".to_owned())
}

/// The name of a file format: one of its extensions.
pub(crate) fn format(text: &str) -> Result<FileFormat, String> {
    FileFormat::from_extension(text).ok_or_else(|| format!("the formats are {}", format_names()))
}

/// The first extension of every format that is written.
pub(crate) fn format_names() -> String {
    let names: Vec<_> = FileFormat::all().filter_map(|f| f.extensions().first().copied()).collect();
    names.join(", ")
}

/// `NAME=VALUE`.
pub(crate) fn define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if name.contains(['{', '}']) => {
            let name = name.trim_start_matches(['$', '{']).trim_end_matches('}');
            Err(format!("a name has no brackets: write -D {name}={value}"))
        }
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().trim_start_matches('$').to_owned(), value.to_owned()))
        }
        _ => Err("expected NAME=VALUE".into()),
    }
}

/// `10m`, `1h30m`, `90s`, `500ms`, or a number of seconds.
pub(crate) fn time(text: &str) -> Result<Duration, String> {
    let problem = || "expected a time such as 90s, 10m or 1h30m".to_owned();
    if let Ok(seconds) = text.parse() {
        let time = Duration::try_from_secs_f64(seconds).map_err(|_| problem())?;
        return at_most_a_century(time);
    }
    let mut total = Duration::ZERO;
    let mut rest = text;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or_else(problem)?;
        let (number, after) = rest.split_at(digits);
        let letters = after.find(|c: char| c.is_ascii_digit() || c == '.').unwrap_or(after.len());
        let (unit, next) = after.split_at(letters);
        let number: f64 = number.parse().map_err(|_| problem())?;
        let seconds = unit_in_seconds(unit).ok_or_else(problem)?;
        let part = Duration::try_from_secs_f64(number * seconds).map_err(|_| problem())?;
        total = total.checked_add(part).ok_or_else(problem)?;
        rest = next;
    }
    if text.is_empty() { Err(problem()) } else { at_most_a_century(total) }
}

/// Refuses times that the system's clock cannot reach.
fn at_most_a_century(time: Duration) -> Result<Duration, String> {
    const CENTURY: Duration = Duration::from_secs(36_525 * 86_400);
    if time <= CENTURY { Ok(time) } else { Err("expected at most 36525d, a century".to_owned()) }
}

/// `512MB`, `8GB`, `8GiB`, or a number of bytes.
pub(crate) fn memory(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, u64); 9] = [
        ("KiB", 1 << 10),
        ("MiB", 1 << 20),
        ("GiB", 1 << 30),
        ("TiB", 1 << 40),
        ("kB", 1000),
        ("MB", 1_000_000),
        ("GB", 1_000_000_000),
        ("TB", 1_000_000_000_000),
        ("", 1),
    ];
    let problem = || "expected a size such as 512MB or 8GB".to_owned();
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let (number, unit) = text.split_at(digits.len());
    let number: f64 = number.trim().parse().map_err(|_| problem())?;
    let unit = UNITS.into_iter().find(|(name, _)| name.eq_ignore_ascii_case(unit));
    let (_, unit) = unit.ok_or_else(problem)?;
    let bytes = number * unit as f64;
    // Not a number is in no range.
    if (1.0..u64::MAX as f64).contains(&bytes) { Ok(bytes as u64) } else { Err(problem()) }
}

/// Some threads, but not many more than there are processors: starting thousands takes seconds, and
/// they only wait for each other.
pub(crate) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    const ALWAYS_ALLOWED: usize = 256;
    const PER_PROCESSOR: usize = 4;
    let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let most = (PER_PROCESSOR * processors).max(ALWAYS_ALLOWED);
    match text.parse::<NonZeroUsize>() {
        Ok(count) if count.get() <= most => Ok(count),
        _ => Err(format!("expected a number from 1 to {most} on this machine")),
    }
}

/// A time above zero.
pub(crate) fn interval(text: &str) -> Result<Duration, String> {
    let interval = time(text)?;
    if interval.is_zero() { Err("expected a time above zero".to_owned()) } else { Ok(interval) }
}

/// A finite radiance above zero.
pub(crate) fn radiance(text: &str) -> Result<f32, String> {
    let radiance =
        text.parse().ok().filter(|radiance: &f32| radiance.is_finite() && *radiance > 0.0);
    radiance.ok_or_else(|| "expected a number above zero".to_owned())
}

/// `A..B`: sample indices from A to B - 1; or `I/N`: part I of N, counted from 1.
pub(crate) fn samples(text: &str) -> Result<SampleChoice, String> {
    let numbers = |separator: &str| {
        let (first, second) = text.split_once(separator)?;
        Some((first.parse::<u32>().ok()?, second.parse::<u32>().ok()?))
    };
    match (numbers(".."), numbers("/")) {
        (Some((start, end)), _) if start < end => Ok(SampleChoice::Indices(start..end)),
        (_, Some((number, count))) if (1..=count).contains(&number) => {
            Ok(SampleChoice::Part { number, count })
        }
        _ => {
            Err("expected A..B, such as 0..64 for the first 64 samples, or I/N, such as 1/8".into())
        }
    }
}

fn unit_in_seconds(unit: &str) -> Option<f64> {
    match unit {
        "ms" => Some(1e-3),
        "s" => Some(1.0),
        "m" | "min" => Some(60.0),
        "h" => Some(3600.0),
        "d" => Some(86400.0),
        _ => None,
    }
}

/// A variance file: `FILE`, or `FILE@COUNT` if it holds the variance of single samples and the
/// picture is the mean of `COUNT` samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VarianceFile {
    pub(crate) path: PathBuf,
    /// The number of samples in the mean; 1 if the file already holds the variance of the mean.
    pub(crate) count: f64,
}

/// `FILE` or `FILE@COUNT`.
pub(crate) fn variance_file(text: &str) -> Result<VarianceFile, String> {
    let Some((path, count)) = text.rsplit_once('@') else {
        return Ok(VarianceFile { path: text.into(), count: 1.0 });
    };
    match count.parse::<f64>() {
        Ok(count) if count >= 1.0 && count.is_finite() => {
            Ok(VarianceFile { path: path.into(), count })
        }
        _ => Err("expected FILE or FILE@COUNT, such as variance.exr@4096".into()),
    }
}

/// `X,Y,INDEX`: a pixel of the film and the index of one of its samples.
pub(crate) fn sample_id(text: &str) -> Result<SampleId, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, index]) => Ok(SampleId { index, y, x }),
        _ => Err("expected X,Y,INDEX, such as 100,50,3".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_crops() {
        assert_eq!(size("640x360"), Ok([640, 360]));
        for wrong in ["640", "x", "0x5", "-1x5", "1x2x3", "1e3x5", "99999999999x1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(crop("1, 2,3,4"), Ok(Region { x: 1, y: 2, width: 3, height: 4 }));
        for wrong in ["1,2,3", "1,2,3,4,5", "a,b,c,d", "-1,0,2,2", ""] {
            assert!(crop(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn times_with_and_without_units() {
        let cases = [
            ("90", 90.0),
            ("1.5", 1.5),
            ("10m", 600.0),
            ("1h30m", 5400.0),
            ("500ms", 0.5),
            ("1d", 86400.0),
            ("2min5s", 125.0),
        ];
        for (text, seconds) in cases {
            assert_eq!(time(text).unwrap().as_secs_f64(), seconds, "{text}");
        }
        for wrong in [
            "",
            "m",
            "10x",
            "-5",
            "1h30q",
            "nan",
            "inf",
            "1e300",
            "5 m",
            "1.2.3s",
            "1e18",
            "99999999d",
        ] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_of_memory_have_units() {
        let cases =
            [("1", 1), ("512MB", 512_000_000), ("1.5GiB", 3 << 29), ("8 gb", 8_000_000_000)];
        for (text, bytes) in cases {
            assert_eq!(memory(text), Ok(bytes), "{text}");
        }
        for wrong in ["", "0", "-1", "nan", "inf", "1e30TB", "5x", "GB", "ä", "1ß"] {
            assert!(memory(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_of_threads_are_those_of_machines() {
        assert_eq!(threads("64").map(NonZeroUsize::get), Ok(64));
        for wrong in ["0", "-1", "", "nan", "1000000", "18446744073709551616", "2.0"] {
            assert!(threads(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn empty_intervals_and_ranges_are_rejected() {
        assert_eq!(interval("5s"), Ok(Duration::from_secs(5)));
        assert!(interval("0").is_err());
        assert_eq!(samples("16..32"), Ok(SampleChoice::Indices(16..32)));
        assert_eq!(samples("8/8"), Ok(SampleChoice::Part { number: 8, count: 8 }));
        for wrong in
            ["16", "16..16", "32..16", "..4", "a..b", "-1..4", "0..4294967296", "0/4", "5/4"]
        {
            assert!(samples(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn definitions_keep_everything_after_the_first_equals_sign() {
        assert_eq!(define("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert_eq!(define("$a="), Ok(("a".into(), String::new())));
        assert!(define("a").is_err());
        assert!(define("=b").is_err());
    }

    #[test]
    fn variances_with_and_without_a_count() {
        let plain = VarianceFile { path: "a.exr".into(), count: 1.0 };
        assert_eq!(variance_file("a.exr"), Ok(plain.clone()));
        assert_eq!(variance_file("a.exr@64"), Ok(VarianceFile { count: 64.0, ..plain }));
        assert!(variance_file("a.exr@many").is_err());
        assert!(variance_file("a.exr@0").is_err());
    }

    #[test]
    fn sample_ids_have_a_pixel_and_an_index() {
        assert_eq!(sample_id("1,2,3"), Ok(SampleId { x: 1, y: 2, index: 3 }));
        assert!(sample_id("1,2").is_err());
    }
}
