//! Resolving sections of rods.

use super::cross_section::{check_wall, cross_section_of};
use super::profile;
use crate::scenario::resolved::{CrossSection, NaturalShape, Rod, RodSection, Shape};
use crate::scenario::section::Section;
use crate::scenario::typed;

/// Resolves the sections of a rod, or its profile. Their ends are compared with its length where it
/// is placed.
pub fn sections(section: &Section<'_>, rod_as_typed: &typed::Rod, rod: &Rod) -> Vec<RodSection> {
    let typed = rod_as_typed.sections.as_slice();
    if let Some(profile) = &rod_as_typed.profile {
        if !typed.is_empty() {
            section.fault("profile", "give `profile` or `sections`, not both");
        }
        return profile::sections(&section.below("profile"), profile, rod);
    }
    let mut sections: Vec<RodSection> = Vec::new();
    for (index, (below, one)) in section.elements("sections", typed).enumerate() {
        let next = typed.get(index + 1);
        let previous = sections.last();
        let before = previous.map_or(Some(0.0), |previous| previous.to);
        if index > 0 && before.is_none() && one.from.is_none() {
            below.missing(
                "from",
                "where the section begins, or `to` of the previous section",
            );
        }
        let from = one.from(&below).or(before).unwrap_or(f64::NAN);
        let next_from = next.and_then(|next| next.from.as_ref()?.si().ok());
        let to = one.to(&below).or(next_from);
        check_order(&below, one, before, [Some(from), to]);
        sections.push(resolved(&below, one, rod, from, to));
    }
    if sections.iter().any(RodSection::is_naturally_bent) {
        check_natural_shape(section, rod);
    }
    sections
}

/// Checks that a section comes after the previous one, which ends at `before`, m.
fn check_order(
    section: &Section<'_>,
    typed: &typed::RodSection,
    before: Option<f64>,
    [from, to]: [Option<f64>; 2],
) {
    if let (Some(before), Some(from)) = (before, from)
        && from < before
    {
        let allowed = format_args!("at least {before:?} m, where the previous section ends");
        section.out_of_range("from", format_args!("{from:?} m"), allowed);
    }
    if let (Some(from), Some(to)) = (from, to)
        && to <= from
    {
        let key = if typed.to.is_some() { "to" } else { "from" };
        let message =
            format!("the section runs from {from:?} m to {to:?} m; it must have a length");
        section.fault(key, message);
    }
}

fn resolved(
    section: &Section<'_>,
    typed: &typed::RodSection,
    rod: &Rod,
    from: f64,
    to: Option<f64>,
) -> RodSection {
    let cross_section = match &typed.cross_section {
        Some(own) => cross_section_of(&section.below("cross_section"), Some(own)),
        None => rod.cross_section,
    };
    let end_width = typed.end_width(section);
    let end_thickness = typed.end_thickness(section);
    let (radius, end_radius) = match cross_section {
        CrossSection::Rectangle { width, thickness } => {
            let half = |width: f64, thickness: f64| width.min(thickness) / 2.0;
            let own = match typed.cross_section {
                Some(_) => half(width, thickness),
                None => rod.radius,
            };
            let ends = [
                end_width.unwrap_or(width),
                end_thickness.unwrap_or(thickness),
            ];
            let tapers = end_width.is_some() || end_thickness.is_some();
            let start = typed.radius(section);
            let end = match start {
                None if tapers => half(ends[0], ends[1]),
                _ => start.unwrap_or(own),
            };
            (
                start.unwrap_or(own),
                typed.end_radius(section).unwrap_or(end),
            )
        }
        CrossSection::Circle | CrossSection::Tube { .. } => {
            let only = "only a rectangle has a width and a thickness";
            let given = [
                ("end_width", end_width.is_some()),
                ("end_thickness", end_thickness.is_some()),
            ];
            section.refuse(&given, only);
            let radius = typed.radius(section).unwrap_or(rod.radius);
            (radius, typed.end_radius(section).unwrap_or(radius))
        }
    };
    check_wall(section, &cross_section, radius.min(end_radius));
    RodSection {
        from,
        to,
        radius,
        end_radius,
        cross_section,
        end_width,
        end_thickness,
        youngs_modulus: typed
            .youngs_modulus(section)
            .unwrap_or(rod.material.youngs_modulus),
        poissons_ratio: typed
            .poissons_ratio(section)
            .unwrap_or(rod.material.poissons_ratio),
        density: typed.density(section).unwrap_or(rod.material.density),
        natural_curvature: typed.natural_curvature(section),
        natural_twist: typed.natural_twist(section),
        friction: typed.friction(section),
    }
}

/// Checks that the natural curvatures of sections add to a rod that is otherwise straight or
/// uniformly curved.
fn check_natural_shape(section: &Section<'_>, rod: &Rod) {
    let fits = match &rod.natural_shape {
        NaturalShape::Straight | NaturalShape::Curved { .. } => true,
        NaturalShape::AsPlaced => matches!(rod.shape, Shape::Straight { .. }),
        NaturalShape::Curve(_) | NaturalShape::Strains(_) => false,
    };
    if !fits || rod.closed {
        section.fault(
            "sections",
            "natural curvatures of sections need an open rod that is otherwise naturally straight or has a \
             `natural_curvature`; set natural_shape = \"straight\"",
        );
    }
}
