//! Similar names, for "did you mean".

use crate::printable::printable;

/// The maximum number of suggestions.
const SUGGESTION_LIMIT: usize = 3;

/// The minimum similarity of a suggestion.
const NEAR: f64 = 0.6;

/// Longer names are not compared, because the cost is quadratic in the length.
const COMPARED_LENGTH: usize = 64;

/// The candidates similar to `name`, the most similar first, at most three.
///
/// Similarity is the optimal string alignment distance (insertions, deletions, replacements and
/// swaps of neighbours) relative to the longer name, ignoring case, underscores and hyphens. A name
/// that contains the other one counts as similar too.
pub fn near_names<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    if name.len() > COMPARED_LENGTH {
        return Vec::new();
    }
    let wanted = plain(name);
    let mut scored: Vec<(f64, &str)> = candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= COMPARED_LENGTH)
        .map(|candidate| (similarity(&wanted, &plain(candidate)), candidate))
        .filter(|(score, _)| *score >= NEAR)
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    scored.dedup_by_key(|(_, candidate)| *candidate);
    scored.truncate(SUGGESTION_LIMIT);
    scored.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Names in backquotes with commas: `` `a`, `b`, `c` ``.
pub fn list_names<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<String> =
        names.into_iter().map(|name| format!("`{}`", printable(name))).collect();
    quoted.join(", ")
}

fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// From 0 to 1; values below [`NEAR`] may be returned as 0.
fn similarity(a: &str, b: &str) -> f64 {
    let contained = a.len().min(b.len()) >= 3 && (a.contains(b) || b.contains(a));
    let (a_length, b_length) = (a.chars().count(), b.chars().count());
    let longer = a_length.max(b_length).max(1) as f64;
    // The length difference is a lower bound of the distance and cheaper to compute.
    let bound = 1.0 - a_length.abs_diff(b_length) as f64 / longer;
    let similarity =
        if bound < NEAR { 0.0 } else { 1.0 - strsim::osa_distance(a, b) as f64 / longer };
    if contained { similarity.max(0.7) } else { similarity }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_errors_find_their_name() {
        let names = ["alpha", "alpha_u", "distribution", "int_ior", "material"];
        assert_eq!(near_names("aplha", names)[0], "alpha");
        assert_eq!(near_names("intIOR", names), ["int_ior"]);
        assert_eq!(near_names("alpah_u", names)[0], "alpha_u");
        assert!(near_names("radiance", names).is_empty());
        assert!(near_names(&"alpha".repeat(100_000), names).is_empty());
    }
}
