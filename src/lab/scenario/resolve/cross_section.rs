//! Shapes of cross-sections.

use crate::scenario::resolved::CrossSection;
use crate::scenario::section::{POSITIVE, Section};
use crate::scenario::typed;

/// Resolves the shape of a cross-section.
pub fn cross_section_of(
    section: &Section<'_>,
    typed: Option<&typed::CrossSection>,
) -> CrossSection {
    match typed {
        None | Some(typed::CrossSection::Circle {}) => CrossSection::Circle,
        Some(typed::CrossSection::Tube { wall }) => CrossSection::Tube {
            wall: section.required("wall", wall, POSITIVE),
        },
        Some(typed::CrossSection::Rectangle { width, thickness }) => CrossSection::Rectangle {
            width: section.required("width", width, POSITIVE),
            thickness: section.required("thickness", thickness, POSITIVE),
        },
    }
}

/// Checks that the wall of a tube is not thicker than its radius, m.
pub fn check_wall(section: &Section<'_>, cross_section: &CrossSection, radius: f64) {
    if let CrossSection::Tube { wall } = cross_section
        && *wall > radius
    {
        let allowed = format_args!("at most the radius, {radius:?} m");
        section
            .below("cross_section")
            .out_of_range("wall", format_args!("{wall:?} m"), allowed);
    }
}
