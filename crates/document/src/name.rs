//! Interned names, because documents repeat them often.

use std::borrow::Borrow;
use std::collections::HashSet;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// A word of a document: the name of a plugin, a parameter or an object. It takes eight bytes and
/// is shared, because a scene may say `to_world` a million times.
///
/// `Arc<str>` would take sixteen bytes, and a document of instances consists mostly of names.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name(Arc<Box<str>>);

impl Name {
    /// The word.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Default for Name {
    fn default() -> Self {
        Self::from("")
    }
}

impl Deref for Name {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl AsRef<str> for Name {
    fn as_ref(&self) -> &str {
        &self.0
    }
}

/// Hashed and ordered like the word.
impl Borrow<str> for Name {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Name {
    fn from(word: &str) -> Self {
        Self(Arc::new(word.into()))
    }
}

impl From<String> for Name {
    fn from(word: String) -> Self {
        Self(Arc::new(word.into()))
    }
}

impl PartialEq<str> for Name {
    fn eq(&self, word: &str) -> bool {
        self.as_str() == word
    }
}

impl PartialEq<&str> for Name {
    fn eq(&self, word: &&str) -> bool {
        self.as_str() == *word
    }
}

impl fmt::Display for Name {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self.as_str(), formatter)
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), formatter)
    }
}

/// Interns names, so that each is stored once.
#[derive(Debug, Default)]
pub struct NameInterner {
    known: HashSet<Name>,
}

impl NameInterner {
    /// Interns a word; equal words share one name.
    pub fn name(&mut self, word: &str) -> Name {
        if let Some(name) = self.known.get(word) {
            return name.clone();
        }
        let name = Name::from(word);
        self.known.insert(name.clone());
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_kept_once() {
        let mut names = NameInterner::default();
        let [first, second, other] = ["to_world", "to_world", "toWorld"].map(|w| names.name(w));
        assert!(Arc::ptr_eq(&first.0, &second.0));
        assert!(first == second && first != other && first == "to_world");
        assert_eq!(size_of::<Option<Name>>(), 8);
    }
}
