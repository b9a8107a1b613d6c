//! The canonical form of a scenario: TOML with every value, in SI units.

use super::resolved::Scenario;

impl Scenario {
    /// The scenario as a file that needs no other file and reads back to the same scenario.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("every part of a scenario is a TOML value")
    }
}
