//! Manual pages: what a plugin is and which parameters it takes, kept beside its code.

/// A plugin's manual page. The documentation, `--help` and the tests are generated from it.
#[derive(Clone, Copy, Debug)]
pub struct Manual {
    /// What the plugin is, in one or a few sentences of Markdown.
    pub summary: &'static str,
    /// Every parameter that the plugin reads. A test compares this list with what the code
    /// requests.
    pub parameters: &'static [ParameterManual],
    /// A sample that a test builds: XML, or Rust code that makes the node for a plugin that needs
    /// buffers.
    pub sample: &'static str,
}

impl Manual {
    /// The language tag of the sample's Markdown code block.
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
    /// Its type, in the manual's terms: "float", "spectrum or texture", "bsdf".
    pub kind: &'static str,
    /// The default, as one would type it; empty if the parameter is required or absent by default.
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

/// The page with all plugins and all names of materials, for messages that list only some.
pub(crate) const PLUGINS_PAGE: &str = "docs/plugins.md";
