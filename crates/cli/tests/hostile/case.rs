//! A broken scene, and the checks that all of them share.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::run::{Outcome, Workplace, binary};

/// A longer run counts as a hang, even for an unoptimised build on a busy machine.
const TIME_LIMIT: Duration = Duration::from_secs(10);

/// The address space of a run, in kilobytes. An allocation beyond it aborts the process. The
/// threads' stacks and the file's actual size fit easily; the sizes that broken headers announce do
/// not.
const MEMORY_LIMIT: u64 = 1 << 20;

/// A scene that must be rejected.
pub(crate) struct Case {
    /// The name of the case in failure messages.
    pub(crate) name: String,
    /// The bytes of `scene.xml`.
    pub(crate) scene: Vec<u8>,
    /// Files beside the scene.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    /// Arguments after `render scene.xml`.
    pub(crate) arguments: &'static [&'static str],
    /// Text that the first error must contain.
    pub(crate) message: String,
    /// The line of the scene file that the first error points at; `None` if it has no place.
    pub(crate) line: Option<usize>,
}

/// The replaceable parts of the scene that all cases are based on.
pub(crate) struct Parts<'a> {
    /// Inside the sensor, on line 2.
    pub(crate) sensor: &'a str,
    /// Line 3.
    pub(crate) film: &'a str,
    /// Line 4.
    pub(crate) sampler: &'a str,
    /// Line 7.
    pub(crate) content: &'a str,
}

impl Default for Parts<'_> {
    fn default() -> Self {
        Self {
            sensor: "",
            film: r#"<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>"#,
            sampler: r#"<sampler type="independent"><integer name="sample_count" value="4"/></sampler>"#,
            content: "",
        }
    }
}

impl Parts<'_> {
    /// The whole scene.
    pub(crate) fn scene(&self) -> String {
        let Self { sensor, film, sampler, content } = self;
        format!(
            "<scene version=\"3.0.0\">\n<sensor type=\"perspective\">{sensor}\n{film}\n{sampler}\n\
             </sensor>\n<emitter type=\"constant\"/>\n{content}\n</scene>\n"
        )
    }
}

impl Case {
    /// A case with its mistake on line 7.
    pub(crate) fn content(content: &str, message: &str) -> Self {
        Self {
            name: content.chars().take(200).collect(),
            scene: Parts { content, ..Parts::default() }.scene().into_bytes(),
            files: Vec::new(),
            arguments: &[],
            message: message.to_owned(),
            line: Some(7),
        }
    }

    /// A case that refers to a broken file on line 7.
    pub(crate) fn file(
        content: &str,
        (file, bytes): (&'static str, Vec<u8>),
        defect: &str,
        message: &str,
    ) -> Self {
        let name = format!("{file}, {defect}");
        Self { name, files: vec![(file, bytes)], ..Self::content(content, message) }
    }

    /// Renders the scene and checks what all broken scenes have in common.
    pub(crate) fn check(&self) {
        let workplace = Workplace::new();
        fs::write(workplace.path("scene.xml"), &self.scene).unwrap();
        for (name, bytes) in &self.files {
            fs::write(workplace.path(name), bytes).unwrap();
        }
        let before = workplace.files();
        let started = Instant::now();
        let arguments = [&["render", "scene.xml", "-t", "2"], self.arguments].concat();
        let outcome = run_in_little_memory(&workplace.path(""), &arguments);
        let (name, text) = (&self.name, &outcome.stderr);
        assert!(started.elapsed() < TIME_LIMIT, "{name} took {:?}", started.elapsed());
        assert_eq!(outcome.code, Some(2), "{name}: {text}");
        assert!(!text.contains("panicked"), "{name}: {text}");
        assert_eq!(workplace.files(), before, "{name} left files behind");
        assert!(text.len() < 100_000, "{name} prints too much: {} bytes", text.len());
        // Messages may contain `error: `, but not at the start of a line.
        let first = format!("\n{text}").split("\nerror: ").nth(1).unwrap_or_default().to_owned();
        assert!(first.contains(&self.message), "{name} must say {}: {text}", self.message);
        if let Some(line) = self.line {
            assert!(first.contains(&format!("scene.xml:{line}:")), "{name}, line {line}: {text}");
            assert!(first.contains('^') || first.contains('╭'), "{name}, no caret: {text}");
        }
    }
}

/// Runs the command; on Linux, with a limit on its address space.
pub(crate) fn run_in_little_memory(folder: &Path, arguments: &[&str]) -> Outcome {
    let binary = binary();
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        let script = format!("ulimit -v {MEMORY_LIMIT}; exec \"$0\" \"$@\"");
        shell.args(["-c", &script]).arg(binary);
        shell
    } else {
        Command::new(binary)
    };
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command.output().unwrap().into()
}
