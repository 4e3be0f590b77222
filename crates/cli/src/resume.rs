//! Handles a checkpoint that exists when a render starts.

use std::io::{BufRead, IsTerminal, stderr, stdin};

use etendue::document::printable;
use etendue::sums_file::{Difference, differences};
use etendue::{FilmFile, FilmFileError, FilmSums, RenderJob, SumsFile};

use crate::checkpoint_writer::Resume;
use crate::failure::Failure;
use crate::{terminal, text};

/// Decides whether to resume from a checkpoint, and reads its header if so.
pub(crate) fn find(
    checkpoint: &SumsFile,
    resume: Option<Resume>,
) -> Result<Option<FilmFile>, Failure> {
    let path = text::path(checkpoint.path());
    if !checkpoint.exists() {
        return match resume {
            Some(Resume::Yes) => {
                Err(Failure::bad_input(format!("cannot resume: there is no checkpoint {path}")))
            }
            _ => Ok(None),
        };
    }
    if resume == Some(Resume::Never) {
        return Ok(None);
    }
    let header = checkpoint.read_header().map_err(|error| unreadable(checkpoint, &error))?;
    if resume.is_some() || ask(checkpoint, &header)? { Ok(Some(header)) } else { Ok(None) }
}

/// Asks the user whether to resume; without a terminal, this is an error.
fn ask(checkpoint: &SumsFile, header: &FilmFile) -> Result<bool, Failure> {
    let path = text::path(checkpoint.path());
    let held = text::counted(header.samples_per_pixel as usize, "sample");
    if !stdin().is_terminal() || !stderr().is_terminal() {
        return Err(Failure::bad_input(format!(
            "{path} holds {held} per pixel from an earlier run: --resume continues it, \
             --resume=never starts over"
        )));
    }
    loop {
        terminal::message(&format!(
            "{path} holds {held} per pixel from an earlier run. Resume it? \
             [y]es, [n]o (start over), [q]uit: "
        ));
        let mut answer = String::new();
        let read = stdin().lock().read_line(&mut answer);
        match (read, answer.trim().to_ascii_lowercase().as_str()) {
            (Ok(1..), "y" | "yes") => return Ok(true),
            (Ok(1..), "n" | "no") => return Ok(false),
            (Ok(1..), answer) if !matches!(answer, "q" | "quit") => {}
            _ => return Err(Failure::bad_input("cancelled before rendering")),
        }
    }
}

/// Reads the sums of a checkpoint, if they belong to this job.
pub(crate) fn read(
    checkpoint: &SumsFile,
    header: &FilmFile,
    job: &RenderJob,
) -> Result<FilmSums, Failure> {
    check(checkpoint, header, job)?;
    let limit = job.job().memory_limit;
    let (_, film) = checkpoint.read(limit).map_err(|error| unreadable(checkpoint, &error))?;
    if !job.owns(&film) {
        let problem = FilmFileError::Invalid("its sums are not those that its header announces");
        return Err(unreadable(checkpoint, &problem));
    }
    let most = film.samples_per_pixel().most;
    let wanted = job.job().budget.samples_per_pixel;
    if let Some(wanted) = wanted.map(|end| end - film.first_sample())
        && most > wanted
    {
        let path = text::path(checkpoint.path());
        return Err(Failure::bad_input(format!(
            "{path} holds up to {} per pixel, more than the {wanted} requested",
            text::counted(most as usize, "sample")
        )));
    }
    Ok(film)
}

/// Rejects sums of another picture, and lists what differs.
fn check(checkpoint: &SumsFile, header: &FilmFile, job: &RenderJob) -> Result<(), Failure> {
    let mut found = differences(&header.record.identity, &job.identity());
    let first = job.job().first_sample;
    if header.first_sample != first {
        found.push(Difference {
            name: "first sample".to_owned(),
            file: header.first_sample.to_string(),
            other: first.to_string(),
        });
    }
    if found.is_empty() {
        return Ok(());
    }
    let path = text::path(checkpoint.path());
    let mut message = format!("{path} belongs to another picture and was left unchanged:");
    for Difference { name, file, other } in &found {
        let line = format!("{name}: {file}; now {other}");
        message.push_str(&format!("\n  {}", printable(&line)));
    }
    message.push_str("\n--resume=never starts over and overwrites it");
    Err(Failure::bad_input(message))
}

fn unreadable(checkpoint: &SumsFile, error: &FilmFileError) -> Failure {
    let path = text::path(checkpoint.path());
    let message = format!(
        "cannot resume from {path}: {error}; the file was left unchanged; --resume=never starts \
         over and overwrites it"
    );
    match error {
        FilmFileError::Io(_) => Failure::failed(message),
        _ => Failure::bad_input(message),
    }
}
