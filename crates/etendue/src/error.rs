//! Why a render failed.

use std::fmt;
use std::ops::Range;

use etendue_document::printable;
use etendue_engine::{EngineError, Region};

use crate::diagnostic_report::DiagnosticReport;
use crate::options::SensorChoice;

/// Why a render failed.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The scene cannot be loaded.
    Scene(Box<DiagnosticReport>),
    /// The scene has no camera, or not the requested one.
    Sensor {
        /// The requested camera.
        choice: SensorChoice,
        /// The existing cameras: the `id` of each, if it has one.
        available: Vec<Option<String>>,
    },
    /// The region to render does not lie within the film.
    Region {
        /// The region.
        region: Region,
        /// The film's width and height in pixels.
        film: [u32; 2],
    },
    /// The requested samples are not among those of the picture.
    Samples {
        /// The requested samples.
        samples: Range<u32>,
        /// The number of samples of the picture.
        planned: u32,
    },
    /// The render cannot be started.
    Engine(EngineError),
}

impl From<EngineError> for Error {
    fn from(error: EngineError) -> Self {
        Self::Engine(error)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostics) => diagnostics.fmt(formatter),
            Self::Sensor { choice, available } => fmt_sensor(formatter, choice, available),
            Self::Region { region: Region { x, y, width, height }, film: [columns, rows] } => {
                write!(
                    formatter,
                    "a part of {width}x{height} pixels from ({x}, {y}) does not fit a film of \
                 {columns}x{rows}"
                )
            }
            Self::Samples { samples: Range { start, end }, planned } => write!(
                formatter,
                "the samples {start}..{end} are not among the {planned} that a pixel has"
            ),
            Self::Engine(error) => error.fmt(formatter),
        }
    }
}

fn fmt_sensor(
    formatter: &mut fmt::Formatter<'_>,
    choice: &SensorChoice,
    available: &[Option<String>],
) -> fmt::Result {
    match choice {
        _ if available.is_empty() => return write!(formatter, "the scene has no sensor"),
        SensorChoice::Index(index) => write!(formatter, "the scene has no sensor {index}")?,
        SensorChoice::Id(id) => write!(formatter, "the scene has no sensor `{}`", printable(id))?,
    }
    let names = available.iter().enumerate().map(|(index, id)| match id {
        Some(id) => format!("{index} (`{}`)", printable(id)),
        None => index.to_string(),
    });
    write!(formatter, ", but {}", names.collect::<Vec<_>>().join(", "))
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Engine(error) => Some(error),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_sensor_is_told_what_there_is() {
        let available = vec![None, Some("top".to_owned())];
        let choice = SensorChoice::from("side");
        let error = Error::Sensor { choice, available: available.clone() };
        assert_eq!(error.to_string(), "the scene has no sensor `side`, but 0, 1 (`top`)");
        let error = Error::Sensor { choice: SensorChoice::from("2"), available };
        assert_eq!(error.to_string(), "the scene has no sensor 2, but 0, 1 (`top`)");
    }
}
