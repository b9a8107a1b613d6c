//! The values of `[parameters]`.

use super::SEED;
use crate::scenario::expression::Amount;
use std::collections::BTreeMap;

/// The parameters of a file.
#[derive(Clone, Debug, Default)]
pub struct Parameters(BTreeMap<String, Amount>);

impl FromIterator<(String, Amount)> for Parameters {
    fn from_iter<T: IntoIterator<Item = (String, Amount)>>(values: T) -> Self {
        Self(values.into_iter().collect())
    }
}

impl Parameters {
    /// The value of a name.
    pub fn value(&self, name: &str) -> Option<Amount> {
        self.0.get(name).copied()
    }

    /// All names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Seed of the random numbers.
    pub fn seed(&self) -> u64 {
        // Seeds are checked to be whole numbers within this range.
        self.value(SEED).map_or(0, |seed| seed.value as u64)
    }
}
