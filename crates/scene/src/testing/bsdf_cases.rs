//! The cases for the tests of all materials. Each BSDF plugin defines them in its own file.

use super::material::TestMaterial;
use crate::bsdf::{self, bsdf_list};

/// The cases of a plugin. Each is a `<bsdf>` element.
pub(crate) struct Cases {
    /// Typical materials: samples against densities, energy, reciprocity.
    pub(crate) usual: &'static [Configuration],
    /// Extreme materials, whose formulas lose precision: nothing may become infinite, negative or
    /// NaN.
    pub(crate) extreme: &'static [&'static str],
    /// Materials whose closures share a batch, with parameters up to their limits. For each kind of
    /// closure, there is at least one without textures, one with a texture and, unless light passes
    /// through, one inside `twosided`. Empty for plugins whose closures are shaded one by one.
    pub(crate) batched: &'static [&'static str],
}

/// A material and its expected properties.
pub(crate) struct Configuration {
    /// The `<bsdf>` element.
    pub(crate) xml: &'static str,
    /// Whether it is reciprocal, apart from the adjoint of refraction.
    pub(crate) reciprocal: bool,
    /// Whether it scatters all light, including light that passes straight through.
    pub(crate) lossless: bool,
}

/// A reciprocal material with absorption.
pub(crate) const fn plain(xml: &'static str) -> Configuration {
    Configuration { xml, reciprocal: true, lossless: false }
}

/// A reciprocal material without absorption.
pub(crate) const fn lossless(xml: &'static str) -> Configuration {
    Configuration { xml, reciprocal: true, lossless: true }
}

/// A material that is not reciprocal, such as shadowed bumps, `principledthin`, or made-up
/// measurements.
pub(crate) const fn one_way(xml: &'static str) -> Configuration {
    Configuration { xml, reciprocal: false, lossless: false }
}

impl Configuration {
    pub(crate) fn material(&self) -> TestMaterial {
        TestMaterial::read(self.xml)
    }
}

/// Generates `plugins` and `batched` from the list of BSDFs.
macro_rules! cases {
    (
        batched { $($batched:ident => $batched_name:ident $kinds:tt;)* }
        single { $($single:ident => $single_name:ident;)* }
        wrappers { $($wrapper:ident => $wrapper_name:ident;)* }
        aliases { $($alias:ident => $alias_name:ident;)* }
    ) => {
        /// The name and the cases of every plugin.
        pub(crate) const PLUGINS: &[(&str, &Cases)] = &[
            $((stringify!($batched), &bsdf::$batched::CASES),)*
            $((stringify!($single), &bsdf::$single::CASES),)*
            $((stringify!($wrapper), &bsdf::$wrapper::CASES),)*
            $((stringify!($alias), &bsdf::$alias::CASES),)*
        ];

        /// The plugins whose closures share batches.
        const BATCHED: &[&str] = &[$(stringify!($batched)),*];
    };
}

bsdf_list!(cases);

/// The typical cases of all plugins.
pub(crate) fn configurations() -> impl Iterator<Item = &'static Configuration> {
    PLUGINS.iter().flat_map(|(_, cases)| cases.usual)
}

#[test]
fn every_plugin_has_its_cases() {
    for (name, cases) in PLUGINS {
        let names_itself = |xml: &&str| xml.contains(&format!("type=\"{name}\""));
        let usual: Vec<&str> = cases.usual.iter().map(|usual| usual.xml).collect();
        assert!(usual.iter().any(names_itself), "`{name}` has no usual case");
        assert!(cases.extreme.iter().any(names_itself), "`{name}` has no extreme case");
        let is_batched = cases.batched.iter().any(names_itself);
        assert_eq!(is_batched, BATCHED.contains(name), "the batched cases of `{name}`");
    }
}
