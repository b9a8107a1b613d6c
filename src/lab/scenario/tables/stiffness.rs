//! Stiffnesses of cross-sections.

use crate::scenario::declaration::keys;
use crate::scenario::section::POSITIVE;
use crate::scenario::units::{Force, Rigidity};

keys! {
    /// Stiffnesses of a cross-section that replace the derived ones.
    table StiffnessKeys "stiffness" => #[derive(Copy)] Stiffness(derived: Stiffness) {
        /// Stretching stiffness EA. Default: the value from material and cross-section.
        stretching: number(Force, POSITIVE) derived(derived.stretching),
        /// Bending stiffness EI₁ about the first material director. Default: the value from
        /// material and cross-section.
        bending_1: number(Rigidity, POSITIVE) derived(derived.bending_1),
        /// Bending stiffness EI₂ about the second material director. Default: the value from
        /// material and cross-section.
        bending_2: number(Rigidity, POSITIVE) derived(derived.bending_2),
        /// Twisting stiffness GJ. Default: the value from material and cross-section.
        twisting: number(Rigidity, POSITIVE) derived(derived.twisting),
    }
}
