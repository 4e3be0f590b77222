//! Merges parts of a picture that were rendered separately.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use etendue_document::printable;
use etendue_engine::{FilmFile, FilmFileError, FilmRecord, FilmSums, Statistics};

use crate::development::Development;
use crate::rendering::Rendering;
use crate::sums_file::{Difference, SumsFile, differences};

/// Why parts cannot be merged.
#[derive(Debug)]
#[non_exhaustive]
pub enum MergeError {
    /// There is nothing to merge.
    Nothing,
    /// A file cannot be read.
    File(PathBuf, FilmFileError),
    /// Two parts are of different pictures: the files, and where they differ.
    Different([PathBuf; 2], Vec<Difference>),
    /// Two parts hold the same samples.
    Overlap([PathBuf; 2], Range<u32>),
    /// A part is unfinished: it is a checkpoint that must be resumed.
    Unfinished(PathBuf),
    /// No part holds these samples.
    Missing(Vec<Range<u32>>),
}

/// Whether a picture may be made from incomplete samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Missing {
    /// Every planned sample must be present.
    #[default]
    Refused,
    /// Use the samples that are present; the picture has more noise.
    Allowed,
}

/// The result of merging parts.
#[derive(Debug)]
pub struct Merged {
    /// The sums.
    pub film: FilmSums,
    /// The metadata of the sums.
    pub record: FilmRecord,
    /// The planned samples that no part holds.
    pub missing: Vec<Range<u32>>,
}

/// A part and its header.
struct Part<'a> {
    file: &'a SumsFile,
    header: FilmFile,
}

impl Part<'_> {
    fn samples(&self) -> Range<u32> {
        let first = self.header.first_sample;
        first..first + self.header.samples_per_pixel
    }

    fn path(&self) -> PathBuf {
        self.file.path().to_owned()
    }
}

/// Merges parts of one picture in any order. Headers are compared before any sums are read. After
/// that, two films at a time are in memory, each of at most `memory_limit` bytes.
///
/// # Errors
///
/// [`MergeError`] if a part cannot be read, is of another picture, is unfinished or overlaps
/// another one, or if samples are missing and that is not allowed.
pub fn merge(
    files: &[SumsFile],
    missing: Missing,
    memory_limit: u64,
) -> Result<Merged, MergeError> {
    let mut parts = Vec::new();
    for file in files {
        let header = file.read_header();
        let header = header.map_err(|error| MergeError::File(file.path().to_owned(), error))?;
        parts.push(Part { file, header });
    }
    parts.sort_by_key(|part| part.header.first_sample);
    check_identities(&parts)?;
    let gaps = find_gaps(&parts)?;
    if missing == Missing::Refused && !gaps.is_empty() {
        return Err(MergeError::Missing(gaps));
    }
    let (first, others) = parts.split_first().ok_or(MergeError::Nothing)?;
    let mut film = read(first, memory_limit)?;
    let mut record = first.header.record.clone();
    for part in others {
        let other = read(part, memory_limit)?;
        film.merge(&other).map_err(|_| MergeError::Unfinished(part.path()))?;
        record.seconds += part.header.record.seconds;
    }
    Ok(Merged { film, record, missing: gaps })
}

fn read(part: &Part<'_>, memory_limit: u64) -> Result<FilmSums, MergeError> {
    let (_, film) = part
        .file
        .read(memory_limit)
        .map_err(|error| MergeError::File(part.file.path().to_owned(), error))?;
    let samples = film.samples_per_pixel();
    if samples.is_even() && samples.least > 0 {
        Ok(film)
    } else {
        Err(MergeError::Unfinished(part.path()))
    }
}

fn check_identities(parts: &[Part<'_>]) -> Result<(), MergeError> {
    for pair in parts.windows(2) {
        let (one, other) = (&pair[0], &pair[1]);
        let found = differences(&one.header.record.identity, &other.header.record.identity);
        if !found.is_empty() {
            return Err(MergeError::Different([one.path(), other.path()], found));
        }
    }
    Ok(())
}

/// The planned samples that no part holds.
fn find_gaps(parts: &[Part<'_>]) -> Result<Vec<Range<u32>>, MergeError> {
    let mut gaps = Vec::new();
    let mut end = 0;
    for (index, part) in parts.iter().enumerate() {
        let samples = part.samples();
        if samples.start < end {
            let paths = [parts[index - 1].path(), part.path()];
            return Err(MergeError::Overlap(paths, samples.start..end.min(samples.end)));
        }
        if samples.start > end {
            gaps.push(end..samples.start);
        }
        end = samples.end;
    }
    let planned = parts.iter().map(|part| part.header.record.planned_samples).max().unwrap_or(0);
    if end < planned {
        gaps.push(end..planned);
    }
    Ok(gaps)
}

impl Merged {
    /// The picture; `None` if a part lacks its development settings, or they do not fit its pixels.
    /// Parts written by this version have them.
    pub fn develop(&self) -> Option<Rendering> {
        let development = Development::from_notes(&self.record.notes)?;
        if !development.contains(self.film.region()) {
            return None;
        }
        let seconds = self.record.seconds;
        let statistics = Statistics {
            samples: self.film.sample_count(),
            samples_per_pixel: self.film.samples_per_pixel(),
            // A file may claim any time; an invalid duration is treated as none.
            duration: Duration::try_from_secs_f64(seconds).unwrap_or_default(),
            defects: self.film.defects(),
            ..Statistics::default()
        };
        Some(Rendering::new(&self.film, statistics, &development, seconds))
    }
}

impl fmt::Display for MergeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => write!(formatter, "there are no parts"),
            Self::File(path, error) => write!(formatter, "{}: {error}", shown(path)),
            Self::Different([one, other], found) => {
                let (one, other) = (shown(one), shown(other));
                write!(formatter, "{one} and {other} are parts of different pictures")?;
                for Difference { name, file, other } in found {
                    let line = format!("{name}: {file}; {other}");
                    write!(formatter, "\n  {}", printable(&line))?;
                }
                Ok(())
            }
            Self::Overlap([one, other], Range { start, end }) => {
                let (one, other) = (shown(one), shown(other));
                write!(formatter, "{one} and {other} both hold the samples {start}..{end}")
            }
            Self::Unfinished(path) => {
                write!(formatter, "{} is unfinished: render it again with --resume", shown(path))
            }
            Self::Missing(gaps) => {
                let gaps: Vec<String> =
                    gaps.iter().map(|gap| format!("{}..{}", gap.start, gap.end)).collect();
                write!(formatter, "no part holds the samples {}", gaps.join(", "))
            }
        }
    }
}

/// A file's name within a line of a message.
fn shown(path: &Path) -> String {
    printable(&path.to_string_lossy()).into_owned()
}

impl std::error::Error for MergeError {}
