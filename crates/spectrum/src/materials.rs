//! Named materials: measured metals and the indices of refraction of dielectrics.

use crate::{SampledSpectrum, SpectrumUse, SpectrumValue};

/// Measured metals; the sources are in `data/README.md`.
const METALS: &str = include_str!("../data/metals.txt");

const REFRACTIVE_INDICES: &str = include_str!("../data/refractive_indices.txt");

/// The prefix of a line in [`METALS`] that starts a metal.
const METAL_HEADING: &str = "metal ";

/// The name of the perfect mirror, a conductor without measurements.
const PERFECT_MIRROR: &str = "none";

/// The complex index of refraction η + i·k of a conductor, relative to vacuum.
#[derive(Clone, Debug, PartialEq)]
pub struct Metal {
    /// The real part.
    pub eta: SpectrumValue,
    /// The imaginary part (absorption).
    pub k: SpectrumValue,
}

impl Metal {
    /// The real part in linear Rec. 709.
    #[must_use]
    pub fn eta_rgb(&self) -> [f32; 3] {
        self.eta.to_rgb(SpectrumUse::MeasuredIndex)
    }

    /// The imaginary part in linear Rec. 709.
    #[must_use]
    pub fn k_rgb(&self) -> [f32; 3] {
        self.k.to_rgb(SpectrumUse::MeasuredIndex)
    }
}

/// The English names of metals, and elements of which only Palik's measurements are here.
const OTHER_NAMES: [(&str, &str); 27] = [
    ("aluminium", "Al"),
    ("aluminum", "Al"),
    ("beryllium", "Be"),
    ("chrome", "Cr"),
    ("chromium", "Cr"),
    ("copper", "Cu"),
    ("gold", "Au"),
    ("iridium", "Ir"),
    ("lithium", "Li"),
    ("mercury", "Hg"),
    ("mirror", PERFECT_MIRROR),
    ("molybdenum", "Mo"),
    ("na", "Na_palik"),
    ("ni", "Ni_palik"),
    ("nickel", "Ni_palik"),
    ("niobium", "Nb"),
    ("potassium", "K"),
    ("rhodium", "Rh"),
    ("selenium", "Se"),
    ("silver", "Ag"),
    ("sodium", "Na_palik"),
    ("tantalum", "Ta"),
    ("tellurium", "Te"),
    ("tungsten", "W"),
    ("v", "V_palik"),
    ("vanadium", "V_palik"),
    ("wolfram", "W"),
];

/// The English name of a metal that is not here, though its letters are a symbol (`TiN`).
const NO_SYMBOL: &str = "tin";

/// A metal by its name in Mitsuba's `conductor`, such as `Au` or `Cu_palik`, in any case, or by its
/// English name. `none` is the perfect mirror, η = 0 and k = 1. `None` for unknown names.
#[must_use]
pub fn metal(name: &str) -> Option<Metal> {
    let name = metal_symbol(name)?;
    if name == PERFECT_MIRROR {
        return Some(Metal { eta: SpectrumValue::Constant(0.0), k: SpectrumValue::Constant(1.0) });
    }
    let mut lines = METALS.lines();
    lines.find(|line| line.strip_prefix(METAL_HEADING) == Some(name))?;
    let rows = lines.take_while(|line| !line.starts_with(METAL_HEADING));
    let (mut wavelengths, mut eta, mut k) = (Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        let mut columns = row.split(' ').map(str::parse::<f32>);
        for column in [&mut wavelengths, &mut eta, &mut k] {
            column.push(columns.next()?.ok()?);
        }
    }
    let eta = SampledSpectrum::new(wavelengths.clone(), eta).ok()?;
    let k = SampledSpectrum::new(wavelengths, k).ok()?;
    Some(Metal { eta: SpectrumValue::Sampled(eta), k: SpectrumValue::Sampled(k) })
}

/// The symbol of a metal given in any case, or by its English name.
fn metal_symbol(name: &str) -> Option<&'static str> {
    let name = name.trim();
    if let Some(exact) = metal_names().find(|known| *known == name) {
        return Some(exact);
    }
    let is_english = |(english, _): &&(&str, &str)| english.eq_ignore_ascii_case(name);
    if let Some((_, symbol)) = OTHER_NAMES.iter().find(is_english) {
        return Some(symbol);
    }
    let mut symbols = metal_names().filter(|_| !name.eq_ignore_ascii_case(NO_SYMBOL));
    symbols.find(|known| known.eq_ignore_ascii_case(name))
}

/// The names that [`metal`] knows in their usual spelling: `none`, then the measured ones in alphabetical order.
pub fn metal_names() -> impl Iterator<Item = &'static str> {
    let measured = METALS.lines().filter_map(|line| line.strip_prefix(METAL_HEADING));
    std::iter::once(PERFECT_MIRROR).chain(measured)
}

/// The index of refraction of a dielectric at 589 nm, relative to vacuum, by its name in Mitsuba's
/// `int_ior` and `ext_ior`, such as `bk7` or `water ice`. Case-insensitive.
#[must_use]
pub fn refractive_index(name: &str) -> Option<f32> {
    refractive_indices()
        .find(|(_, known)| known.eq_ignore_ascii_case(name))
        .and_then(|(index, _)| index.parse().ok())
}

/// The names that [`refractive_index`] knows: gases, liquids, then solids.
pub fn refractive_index_names() -> impl Iterator<Item = &'static str> {
    refractive_indices().map(|(_, name)| name)
}

/// The index (as text) and name of each dielectric.
fn refractive_indices() -> impl Iterator<Item = (&'static str, &'static str)> {
    REFRACTIVE_INDICES
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split_once(' '))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metals_have_their_names_in_any_spelling() {
        for (spellings, symbol) in [
            (["gold", "Gold", "AU", "au"], "Au"),
            (["silver", "SILVER", "ag", "AG"], "Ag"),
            (["aluminium", "Aluminum", "al", "AL"], "Al"),
            (["nickel", "Ni", "ni_PALIK", "NI"], "Ni_palik"),
            (["mirror", "None", "NONE", "Mirror"], "none"),
        ] {
            for spelling in spellings {
                assert_eq!(metal(spelling), metal(symbol), "{spelling}");
            }
        }
        assert!(OTHER_NAMES.iter().all(|(name, _)| metal(name).is_some()));
        for unknown in ["glas", "tin", "Tin", "", "steel"] {
            assert_eq!(metal(unknown), None, "{unknown}");
        }
    }

    /// The values of Mitsuba 3.9.1 in `scalar_rgb` for all materials: name, η in RGB, k in RGB.
    const MITSUBA: &str = include_str!("../data/metals_rgb.txt");

    #[test]
    fn every_metal_has_the_colors_of_mitsuba() {
        let rows = MITSUBA.lines().filter(|line| !line.starts_with('#'));
        let mut names: Vec<&str> = Vec::new();
        for row in rows {
            let (name, figures) = row.split_once(' ').expect("a name and figures");
            let metal = metal(name).expect(name);
            let actual = [metal.eta_rgb(), metal.k_rgb()].concat();
            for (index, figure) in figures.split(' ').enumerate() {
                let expected: f32 = figure.parse().expect("a number");
                let difference = (actual[index] - expected).abs();
                assert!(difference <= 2e-5 * expected.max(1.0), "{row}: {actual:?}");
            }
            names.push(name);
        }
        let mut known: Vec<&str> = metal_names().collect();
        known.sort_unstable();
        names.sort_unstable();
        assert_eq!(known, names);
        assert_eq!(known.len(), 72);
    }

    #[test]
    fn gold_is_yellow_and_has_its_measured_values() {
        let gold = metal("Au").expect("a known metal");
        let SpectrumValue::Sampled(eta) = &gold.eta else { panic!("gold was measured") };
        assert_eq!((eta.wavelengths_nm()[1], eta.values()[1]), (302.400_42, 1.812));
        let [red, _, blue] = gold.eta_rgb();
        assert!(red < 0.2 && blue > 1.0);
    }

    #[test]
    fn unknown_metals_are_rejected() {
        for name in ["", "Unobtainium", "metal Au", "#"] {
            assert_eq!(metal(name), None, "{name:?}");
        }
    }

    #[test]
    fn dielectrics_are_found_by_name() {
        assert_eq!(refractive_index("vacuum"), Some(1.0));
        assert_eq!(refractive_index("bk7"), Some(1.5046));
        assert_eq!(refractive_index("Water Ice"), Some(1.31));
        assert_eq!(refractive_index("diamond"), Some(2.419));
        assert_eq!(refractive_index("glass"), None);
        assert_eq!(refractive_index_names().count(), 23);
        for name in refractive_index_names() {
            assert!(refractive_index(name).is_some_and(|index| (1.0..3.0).contains(&index)));
        }
    }
}
