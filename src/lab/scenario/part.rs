//! Parts of a scene that any experiment may have. Each kind of part has an array of tables.

use super::resolved::{Parts, Time};
use super::section::Section;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;

/// A kind of part as scenario files see it: a table of the array `[[KEY]]`, in SI units.
pub trait Part: Serialize + Any + Send + Sync + Sized {
    /// A typed table; its doc comments explain its keys.
    type Typed: DeserializeOwned + JsonSchema + Any;

    /// The array.
    const KEY: &'static str;
    /// Description of the array, one sentence.
    const DESCRIPTION: &'static str;
    /// Whether rods in a scene with such parts have lumped inertia unless the file says otherwise.
    const LUMPS_INERTIA: bool = false;

    /// Smallest radius of its surface in contact, m; infinite if the part touches nothing.
    fn contact_radius(&self) -> f64 {
        f64::INFINITY
    }

    /// Resolves a table.
    fn resolve(section: &Section<'_>, typed: &Self::Typed, index: usize) -> Self;

    /// Checks all tables against each other and against the mode of the run.
    fn judge(_array: &Section<'_>, _all: &[Self], _time: &Time) {}
}

/// Resolves the array of a kind of part and adds it to the other parts.
pub fn resolve<P: Part>(top: &Section<'_>, typed: &dyn Any, time: &Time, parts: &mut Parts) {
    let typed: Option<&Vec<P::Typed>> = typed.downcast_ref();
    let elements = top.elements(P::KEY, typed.map_or(&[], Vec::as_slice));
    let resolved = elements.enumerate();
    let resolved: Vec<P> = resolved
        .map(|(index, (section, typed))| P::resolve(&section, typed, index))
        .collect();
    P::judge(&top.below(P::KEY), &resolved, time);
    let radii = resolved.iter().map(P::contact_radius);
    parts.note_radius(radii.fold(f64::INFINITY, f64::min));
    parts.insert(P::KEY, resolved);
}
