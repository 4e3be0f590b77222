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

/// The maximum number of names in [`list_some`].
const LISTED: usize = 12;

/// Of many names, the dozen that resemble `wanted` most, and where the whole list stands:
/// "`Au`, `Ag`, … (all 60 are in docs/plugins.md)".
pub fn list_some<'a>(
    wanted: &str,
    names: impl IntoIterator<Item = &'a str>,
    place: &str,
) -> String {
    let mut names: Vec<&str> = names.into_iter().collect();
    if names.len() <= LISTED {
        return list_names(names);
    }
    let count = names.len();
    let wanted: String = plain(wanted).chars().take(COMPARED_LENGTH).collect();
    names.sort_by_cached_key(|name| {
        let distance = strsim::osa_distance(&wanted, &plain(name));
        (distance, *name)
    });
    names.truncate(LISTED);
    format!("{}, … (all {count} are in {place})", list_names(names))
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
    fn long_lists_are_cut_to_what_resembles_the_name() {
        let names: Vec<String> = (0..50).map(|index| format!("name{index}")).collect();
        let list = list_some("nmae7", names.iter().map(String::as_str), "the manual");
        assert!(
            list.starts_with("`name7`") && list.ends_with("(all 50 are in the manual)"),
            "{list}"
        );
        assert_eq!(list.matches('`').count(), 2 * LISTED);
        assert_eq!(list_some("x", ["b", "a"], "the manual"), "`b`, `a`");
    }

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
