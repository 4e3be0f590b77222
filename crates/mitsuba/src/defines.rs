//! Substitution of `$name` in attribute values.

use std::borrow::Cow;
use std::collections::BTreeMap;

use etendue_document::near_names;

/// The maximum length in bytes of a name after a dollar sign.
pub(crate) const NAME_LENGTH: usize = 64;

/// The maximum number of names searched for similar ones.
const COMPARED_NAMES: usize = 1000;

/// The values of `$names`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Defines {
    values: BTreeMap<String, Define>,
    expanded_bytes: usize,
    expansion_limit: usize,
    /// The limit has been reached.
    pub(crate) exhausted: bool,
}

#[derive(Clone, Debug)]
struct Define {
    /// `None` for a value that could not be expanded, which has been reported.
    value: Option<String>,
    /// Given by the caller, not by the scene.
    given: bool,
    used: bool,
}

/// Why a value cannot be expanded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ExpansionError {
    /// There is no such name.
    Undefined { name: String, offset: usize, near: Vec<String> },
    /// The name is written in brackets, as in a shell: `${name}`.
    Bracketed { name: String, offset: usize },
    /// The expansions exceed the limit.
    TooLong,
    /// The name's own value could not be expanded.
    Broken,
}

impl Defines {
    /// Starts with the caller's values.
    pub(crate) fn new(given: &[(String, String)], expansion_limit: usize) -> Self {
        let define =
            |value: &String| Define { value: Some(value.clone()), given: true, used: false };
        let values = given.iter().map(|(name, value)| (name.clone(), define(value))).collect();
        Self { values, expanded_bytes: 0, expansion_limit, exhausted: false }
    }

    /// Sets a default, used unless the name already has a value; `None` is a default that could not
    /// be expanded.
    pub(crate) fn add_default(&mut self, name: &str, value: Option<&str>) {
        match self.values.get_mut(name) {
            Some(define) => define.used = true,
            None => {
                let value = value.map(str::to_owned);
                let define = Define { value, given: false, used: true };
                self.values.insert(name.to_owned(), define);
            }
        }
    }

    /// Replaces every `$name`. Inserted values are not expanded again.
    pub(crate) fn expand<'a>(&mut self, text: &'a str) -> Result<Cow<'a, str>, ExpansionError> {
        if !text.contains('$') {
            return Ok(Cow::Borrowed(text));
        }
        let mut expanded = String::new();
        let mut position = 0;
        while let Some(found) = text[position..].find('$') {
            let dollar = position + found;
            expanded.push_str(&text[position..dollar]);
            let (length, value) = self.lookup(text, dollar)?;
            expanded.push_str(value);
            position = dollar + 1 + length;
            if self.expanded_bytes + expanded.len() > self.expansion_limit {
                self.exhausted = true;
                return Err(ExpansionError::TooLong);
            }
        }
        expanded.push_str(&text[position..]);
        self.expanded_bytes += expanded.len();
        Ok(Cow::Owned(expanded))
    }

    /// The caller's names that the scene does not use, and the names that it does use.
    pub(crate) fn unused(&self) -> (Vec<&str>, Vec<&str>) {
        let unused = self.values.iter().filter(|(_, define)| define.given && !define.used);
        let known = self.values.iter().filter(|(_, define)| define.used);
        let names = |(name, _)| String::as_str(name);
        (unused.map(names).collect(), known.map(names).collect())
    }

    /// The value of the name after the dollar sign at `dollar`, and the length of the name.
    ///
    /// As in Mitsuba, the longest known name wins: `$resx` is `$res` followed by an `x` if only
    /// `res` is known.
    fn lookup(&mut self, text: &str, dollar: usize) -> Result<(usize, &str), ExpansionError> {
        let rest = &text[dollar + 1..];
        if let Some((name, _)) = rest.strip_prefix('{').and_then(|rest| rest.split_once('}')) {
            let name = name.chars().take(NAME_LENGTH).collect();
            return Err(ExpansionError::Bracketed { name, offset: dollar });
        }
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let is_known =
            |length: &usize| rest.get(..*length).is_some_and(|name| self.values.contains_key(name));
        let Some(length) = (1..=rest.len().min(NAME_LENGTH)).rev().find(is_known) else {
            let names = self.values.keys().map(String::as_str).take(COMPARED_NAMES);
            let near = near_names(&rest[..end], names).into_iter().map(str::to_owned).collect();
            let name = rest[..end].to_owned();
            return Err(ExpansionError::Undefined { name, offset: dollar, near });
        };
        let define = self.values.get_mut(&rest[..length]).ok_or(ExpansionError::Broken)?;
        define.used = true;
        Ok((length, define.value.as_deref().ok_or(ExpansionError::Broken)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn defines() -> Defines {
        let given = [("spp", "16"), ("sppx", "17"), ("dead", "")];
        let given = given.map(|(name, value)| (name.to_owned(), value.to_owned()));
        Defines::new(&given, 100)
    }

    #[test]
    fn names_are_replaced_anywhere_the_longest_first() {
        let mut defines = defines();
        defines.add_default("spp", Some("99"));
        defines.add_default("x", Some("7"));
        assert_eq!(defines.expand("$spp").unwrap(), "16", "the caller's value wins");
        assert_eq!(defines.expand("a$spp/$x.b").unwrap(), "a16/7.b");
        assert_eq!(defines.expand("$sppx$spp_").unwrap(), "1716_");
        assert_eq!(defines.expand("plain").unwrap(), "plain");
    }

    #[test]
    fn what_comes_in_is_not_expanded_again() {
        let mut defines = defines();
        defines.add_default("loop", Some("$loop$loop"));
        assert_eq!(defines.expand("$loop").unwrap(), "$loop$loop");
    }

    #[test]
    fn unknown_names_suggest_near_ones() {
        let error = defines().expand("ä $sp").unwrap_err();
        let ExpansionError::Undefined { name, offset, near } = error else {
            panic!("{error:?}");
        };
        assert_eq!((name.as_str(), offset), ("sp", 3));
        assert_eq!(near[0], "spp");
        let bracketed = defines().expand("5 ${spp}").unwrap_err();
        assert_eq!(bracketed, ExpansionError::Bracketed { name: "spp".to_owned(), offset: 2 });
        let lone = defines().expand("5 $").unwrap_err();
        assert!(matches!(lone, ExpansionError::Undefined { name, .. } if name.is_empty()));
    }

    #[test]
    fn growth_is_bounded_over_all_expansions() {
        let mut defines = defines();
        defines.add_default("a", Some(&"x".repeat(30)));
        assert!(defines.expand("$a").is_ok());
        assert!(defines.expand("$a").is_ok());
        assert_eq!(defines.expand("$a$a"), Err(ExpansionError::TooLong));
    }

    #[test]
    fn a_name_whose_value_is_broken_is_known_but_has_none() {
        let mut defines = defines();
        defines.add_default("a", None);
        assert_eq!(defines.expand("$a"), Err(ExpansionError::Broken));
    }

    #[test]
    fn given_names_that_nothing_mentions_are_listed() {
        let mut defines = defines();
        defines.add_default("sppx", Some("1"));
        defines.expand("$spp").unwrap();
        assert_eq!(defines.unused(), (vec!["dead"], vec!["spp", "sppx"]));
    }
}
