//! Manual pages: what a plugin is and takes, kept beside its code.

/// A plugin's manual page. The documentation, `--help` and the tests are made from it.
#[derive(Clone, Copy, Debug)]
pub struct Manual {
    /// What the plugin is, in a sentence or a few; Markdown.
    pub summary: &'static str,
    /// Every parameter it reads. A test compares this list with what the code asks for.
    pub parameters: &'static [ParameterManual],
    /// A sample that a test builds: XML, or the code of a node for a plugin that needs buffers.
    pub sample: &'static str,
}

impl Manual {
    /// The language of the sample, as Markdown calls it.
    #[must_use]
    pub fn sample_language(&self) -> &'static str {
        if self.sample.starts_with('<') { "xml" } else { "rust" }
    }
}

/// One parameter of a manual page.
#[derive(Clone, Copy, Debug)]
pub struct ParameterManual {
    /// The name in a scene file.
    pub name: &'static str,
    /// Its type, as a reader of the manual would call it: "float", "spectrum or texture", "bsdf".
    pub kind: &'static str,
    /// The default, as it would be typed; empty where the parameter is required or absent by default.
    pub default: &'static str,
    /// What it means, with units.
    pub meaning: &'static str,
}

/// Writes a [`ParameterManual`] on one line.
pub(crate) const fn parameter(
    name: &'static str,
    kind: &'static str,
    default: &'static str,
    meaning: &'static str,
) -> ParameterManual {
    ParameterManual { name, kind, default, meaning }
}
