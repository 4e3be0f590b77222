//! Reports samples that were left out of a picture, and replays single samples.

use etendue::document::printable;
use etendue::engine::SampleSource;
use etendue::{Defect, DefectiveSample, Defects, RenderJob, SampleId};

use crate::failure::Failure;
use crate::{terminal, text};

/// Warns about samples that were left out, with commands that replay the first ones.
pub(crate) fn report(defects: &Defects) {
    if defects.total() > 0 {
        report_count(defects);
        report_samples(defects);
    }
}

/// Warns about samples that were left out of parts. There is no scene to replay them with.
pub(crate) fn report_without_command(defects: &Defects) {
    if defects.total() > 0 {
        report_count(defects);
    }
}

fn report_count(defects: &Defects) {
    let left_out = text::counted(usize::try_from(defects.total()).unwrap_or(usize::MAX), "sample");
    let (non_finite, negative) = (defects.non_finite, defects.negative);
    terminal::warning(&format!(
        "{left_out} left out of the picture: {non_finite} not finite, {negative} negative"
    ));
}

fn report_samples(defects: &Defects) {
    let command = command_line();
    for DefectiveSample { id, defect } in &defects.first {
        let kind = match defect {
            Defect::NonFinite => "not finite",
            Defect::Negative => "negative",
        };
        let SampleId { index, y, x } = id;
        terminal::message_line(&format!("  {kind}: {command} --replay {x},{y},{index}"));
    }
}

/// This run's command line, quoted for a shell.
fn command_line() -> String {
    std::env::args_os()
        .map(|argument| quote(&printable(&argument.to_string_lossy())))
        .collect::<Vec<_>>()
        .join(" ")
}

/// Quotes an argument for a POSIX shell.
fn quote(argument: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:@+".contains(c);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', r"'\''"))
}

/// Renders one sample again and prints its values.
pub(crate) fn show(job: &RenderJob, id: SampleId) -> Result<(), Failure> {
    let film = &job.setup().film;
    if id.x >= film.width || id.y >= film.height {
        let (x, y, width, height) = (id.x, id.y, film.width, film.height);
        return Err(Failure::bad_input(format!(
            "pixel {x},{y} is outside the film of {width}x{height}"
        )));
    }
    let replay = job.camera().replay(id);
    let [red, green, blue] = replay.sample.color.rgb();
    let mut shown = format!("pixel {},{}  sample {}\n", id.x, id.y, id.index);
    shown.push_str(&format!("radiance  {red} {green} {blue}\n"));
    shown.push_str(&format!("alpha     {}\n", replay.sample.alpha));
    shown.push_str(&format!("weight    {}\n", replay.sample.weight));
    for (name, value) in job.camera().channels().iter().zip(&replay.channels) {
        shown.push_str(&format!("{name}  {value}\n"));
    }
    terminal::result(&shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_that_a_shell_would_split_or_expand_are_quoted() {
        assert_eq!(quote("a/b-c.xml"), "a/b-c.xml");
        assert_eq!(quote("two words"), "'two words'");
        assert_eq!(quote("it's"), r"'it'\''s'");
        assert_eq!(quote("$a"), "'$a'");
        assert_eq!(quote(""), "''");
    }
}
