//! Texts shared by many rows: a grid of a million rows has only a few different names.

use std::collections::HashSet;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

/// A text that rows may share.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Word(Arc<str>);

impl Deref for Word {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Word {
    fn from(text: &str) -> Self {
        Self(text.into())
    }
}

impl PartialEq<&str> for Word {
    fn eq(&self, other: &&str) -> bool {
        *self.0 == **other
    }
}

impl Serialize for Word {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self)
    }
}

impl<'de> Deserialize<'de> for Word {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|text| text.as_str().into())
    }
}

/// All texts in use, each once.
#[derive(Default)]
pub(super) struct Words(Mutex<HashSet<Word>>);

impl Words {
    /// Replaces texts by the shared copies.
    pub(super) fn share<'a>(&self, words: impl Iterator<Item = &'a mut Word>) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for word in words {
            match known.get(word) {
                Some(shared) => *word = shared.clone(),
                None => {
                    known.insert(word.clone());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_words_become_one() {
        let words = Words::default();
        let mut all: Vec<Word> = ["a", "b", "a"].map(Word::from).to_vec();
        words.share(all.iter_mut());
        assert!(Arc::ptr_eq(&all[0].0, &all[2].0));
        assert!(all[0] == "a" && all[1] == "b");
    }
}
