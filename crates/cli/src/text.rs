//! Formats names, numbers and times for people.

use std::path::Path;
use std::time::Duration;

use etendue::document::printable;

/// A file's name as people may see it: what would act on the terminal is escaped.
pub(crate) fn path(path: &Path) -> String {
    printable(&path.to_string_lossy()).into_owned()
}

/// `12.3 M`: three digits and a decimal prefix.
pub(crate) fn scaled(value: f64) -> String {
    let prefixes = [(1e9, " G"), (1e6, " M"), (1e3, " k")];
    let fitting = prefixes.into_iter().find(|(size, _)| value >= *size);
    let (size, prefix) = fitting.unwrap_or((1.0, " "));
    let shown = value / size;
    let digits = match shown {
        shown if shown >= 100.0 => 0,
        shown if shown >= 10.0 => 1,
        _ => 2,
    };
    format!("{shown:.digits$}{prefix}")
}

/// `12.3 MB`.
pub(crate) fn bytes(count: usize) -> String {
    format!("{}B", scaled(count as f64))
}

/// `1,050,933`.
pub(crate) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `0.34 s`, `12 s`, `3 min 05 s`, `2 h 07 min`.
pub(crate) fn duration(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.2} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

/// `1 warning`, `2 warnings`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{} {noun}s", grouped(count)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(scaled(0.0), "0.00 ");
        assert_eq!(scaled(950.0), "950 ");
        assert_eq!(scaled(3_240_000.0), "3.24 M");
        assert_eq!(bytes(120_000_000), "120 MB");
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_050_933), "1,050,933");
        assert_eq!(counted(1, "error"), "1 error");
        assert_eq!(counted(2, "error"), "2 errors");
    }

    #[test]
    fn times_have_at_most_two_units() {
        let shown = |seconds: f64| duration(Duration::from_secs_f64(seconds));
        assert_eq!(shown(0.034), "0.03 s");
        assert_eq!(shown(12.4), "12 s");
        assert_eq!(shown(59.7), "1 min 00 s");
        assert_eq!(shown(185.0), "3 min 05 s");
        assert_eq!(shown(7620.0), "2 h 07 min");
    }
}
