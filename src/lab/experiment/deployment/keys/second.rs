//! Resolves the second rod of a deployment.

use super::resolved::{Scheme, Second};
use super::{pattern, resolve_rod, typed, with_lead_in};
use crate::scenario::keys::Section;
use rodlab_planning::plan::pattern::Pattern;

/// The second rod with its pattern, if there is one; `None` after a fault.
pub fn resolve(
    section: &Section<'_>,
    deployment: &typed::Deployment,
    scheme_of_first: Scheme,
) -> Option<Option<(Second, Pattern)>> {
    let Some(typed) = &deployment.second else {
        return Some(None);
    };
    for (key, is_there) in [
        ("pegs", deployment.pegs.is_some()),
        ("clips", deployment.clips.is_some()),
        ("correction", deployment.correction.is_some()),
    ] {
        if is_there {
            section.fault(key, "this key is for one rod: leave it, or `second`, out");
            return None;
        }
    }
    let section = section.below("second");
    let help = "a table [deployment.second.rod] with the keys of [deployment.rod]";
    let rod = section.needed("rod", typed.rod.as_ref(), help);
    let rod = rod.and_then(|rod| resolve_rod(&section.below("rod"), rod));
    let help = "{ file = \"drawing.svg\", stroke = 2 }, in the frame of the first";
    let drawn = section.needed("pattern", typed.pattern.as_ref(), help);
    let pattern = drawn.and_then(|drawn| pattern::resolve(&section.below("pattern"), drawn));
    let (rod, pattern) = (rod?, pattern?);
    let is_tied = deployment.knot.is_some();
    let curve = with_lead_in(&section, typed.lead_in.as_ref(), is_tied, &rod, &pattern)?;
    let second = Second {
        scheme: typed.scheme.unwrap_or(scheme_of_first),
        lead_in: curve.lead_in(),
        pattern,
        rod,
    };
    Some(Some((second, curve)))
}
