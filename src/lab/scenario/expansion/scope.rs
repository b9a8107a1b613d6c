//! Values of names in an expression, and the random numbers.

use super::parameters::Parameters;
use crate::scenario::expression::{Amount, Names};
use crate::scenario::issue::KeyPath;
use rodlab_engine::random::uniform_numbers;

/// Names of the indices of a copy.
pub const INDICES: [&str; 3] = ["i", "j", "k"];

/// Words that are allowed at numeric keys.
pub const WORDS: [&str; 5] = ["auto", "start", "end", "half", "diagonal"];

/// Place of an expression.
#[derive(Clone, Debug, Default)]
pub struct Place {
    /// The key, as written.
    pub path: KeyPath,
    /// The key with names in place of indices of elements. This key seeds random numbers, so that
    /// other tables before this one do not change them.
    pub named: KeyPath,
    /// Number of the copy.
    pub copy: Option<usize>,
    /// Names of the copy: its indices, its random place, and its own definitions.
    pub locals: Vec<(String, Amount)>,
}

impl Place {
    /// A key outside of copied tables.
    pub fn uncopied(path: KeyPath) -> Self {
        Self {
            named: path.clone(),
            path,
            ..Self::default()
        }
    }

    /// A key below this one.
    pub fn key(&self, step: &str) -> Self {
        self.element(step, step)
    }

    /// An element of the array at this place; `name` is its name or index.
    pub fn element(&self, number: &str, name: &str) -> Self {
        Self {
            path: self.path.key(number),
            named: self.named.key(name),
            copy: self.copy,
            locals: self.locals.clone(),
        }
    }
}

/// The names that an expression at a place may use.
pub struct Scope<'a> {
    /// Those of the whole file.
    pub parameters: &'a Parameters,
    /// The place.
    pub place: &'a Place,
}

impl Names for Scope<'_> {
    fn value(&self, name: &str) -> Option<Amount> {
        let mut locals = self.place.locals.iter();
        let local = locals.find(|(known, _)| known == name);
        local
            .map(|(_, amount)| *amount)
            .or_else(|| self.parameters.value(name))
    }

    fn all(&self) -> Vec<String> {
        let locals = self.place.locals.iter().map(|(name, _)| name.clone());
        locals
            .chain(self.parameters.names().map(str::to_owned))
            .collect()
    }

    fn uniform(&self, draw: usize) -> Box<dyn FnMut() -> f64> {
        let copy = self
            .place
            .copy
            .map_or(String::new(), |copy| copy.to_string());
        let key = format!("{}\n{copy}\n{draw}", self.place.named);
        Box::new(uniform(self.parameters.seed(), &key))
    }
}

/// Uniform random numbers in [0, 1) that depend only on a seed and on their purpose.
pub fn uniform(seed: u64, purpose: &str) -> impl FnMut() -> f64 + use<> {
    let hash = blake3::hash(format!("{seed}\n{purpose}").as_bytes());
    let mut first = [0; 8];
    first.copy_from_slice(&hash.as_bytes()[..8]);
    uniform_numbers(u64::from_le_bytes(first))
}
