//! The table of test scenes, `scenes/cases.txt`. Besides the tests, `cargo xtask references` and
//! `cargo xtask bits` read it.

use std::path::Path;

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    /// The scene's name, without `.xml`.
    pub(crate) scene: String,
    /// The expected picture.
    pub(crate) expected: Expected,
    /// The options of each render to compare with it.
    pub(crate) variants: Vec<Vec<String>>,
}

/// The expected picture of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expected {
    /// `references/SCENE.exr`.
    Stored {
        /// The options that it was rendered with.
        options: Vec<String>,
        /// Its samples per pixel.
        samples: u32,
    },
    /// The same colour everywhere, from a closed-form solution.
    Constant([f32; 3]),
}

/// Reads `cases.txt` in `folder`.
///
/// # Errors
/// If the file cannot be read or a row is malformed.
pub(crate) fn read(folder: &Path) -> Result<Vec<Row>, String> {
    let path = folder.join("cases.txt");
    let text = std::fs::read_to_string(&path);
    let text = text.map_err(|error| format!("{}: {error}", path.display()))?;
    let lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| parse(line).ok_or_else(|| format!("malformed row: {line}"))).collect()
}

/// `SCENE | REFERENCE | VARIANT; VARIANT; …`
fn parse(line: &str) -> Option<Row> {
    let mut columns = line.split('|').map(str::trim);
    let scene = columns.next()?.to_owned();
    let expected = parse_expected(columns.next()?)?;
    let variants: Option<Vec<_>> = columns.next()?.split(';').map(options).collect();
    Some(Row { scene, expected, variants: variants? })
}

fn parse_expected(text: &str) -> Option<Expected> {
    if let Some(numbers) = text.strip_prefix('=') {
        let numbers: Option<Vec<f32>> =
            numbers.split_whitespace().map(|number| number.parse().ok()).collect();
        return Some(Expected::Constant(numbers?.try_into().ok()?));
    }
    let (made_by, samples) = text.rsplit_once(' ')?;
    Some(Expected::Stored { options: options(made_by)?, samples: samples.parse().ok()? })
}

/// The command-line options for `INTEGRATOR OPTION…`.
fn options(text: &str) -> Option<Vec<String>> {
    let mut words = text.split_whitespace().map(str::to_owned);
    let integrator = words.next()?;
    let start = match integrator.as_str() {
        "own" => Vec::new(),
        _ => vec!["--integrator".to_owned(), integrator],
    };
    Some(start.into_iter().chain(words).collect())
}
