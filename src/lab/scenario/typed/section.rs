//! Sections of rods as typed.

use super::kinds::allow_text;
use crate::scenario::declaration::keys;
use crate::scenario::quantity::Quantity;
use crate::scenario::section::{FINITE, NON_NEGATIVE, POISSONS_RATIO, POSITIVE};
use crate::scenario::units::{Curvature, Density, Dimensionless, Length, Pressure, Twist};
use schemars::{JsonSchema, Schema};
use serde::Deserialize;

keys! {
    /// A part of a rod with its own cross-section, material or natural curvature. Keys that are
    /// not given are those of the rod.
    table RodSection "rod_section" {
        /// Arc length along the placed rod at which the section begins. Default: the end of the
        /// previous section, or 0. Parts of the rod without a section have the rod's own keys.
        from: number(Length, NON_NEGATIVE) optional,
        /// Arc length at which the section ends. Default: the beginning of the next section if it
        /// is given, or the end of the rod.
        to: number(Length, POSITIVE) optional,
        /// Radius at the beginning of the section. Default: that of the rod; for a rectangle with
        /// sides of its own, half its smaller side.
        radius: number(Length, POSITIVE) optional,
        /// Radius at the end of the section; in between it is linear. Default: `radius`.
        end_radius: number(Length, POSITIVE) optional,
        /// Shape of the cross-section, as for a rod. Default: that of the rod.
        cross_section: raw(CrossSection) raw,
        /// Width of a rectangle at the end of the section; in between it is linear. Default: its
        /// width.
        end_width: number(Length, POSITIVE) optional,
        /// Thickness of a rectangle at the end of the section; in between it is linear. Default:
        /// its thickness.
        end_thickness: number(Length, POSITIVE) optional,
        /// Young's modulus. Default: that of the rod. Material damping keeps the proportion of the
        /// rod's material.
        youngs_modulus: number(Pressure, POSITIVE) optional,
        /// Poisson's ratio. Default: that of the rod.
        poissons_ratio: number(Dimensionless, POISSONS_RATIO) optional,
        /// Density. Default: that of the rod.
        density: number(Density, POSITIVE) optional,
        /// Natural curvatures [a, b] about both material directors, as for a rod that is otherwise
        /// naturally straight or has a `natural_curvature`. Default: that of the rod.
        natural_curvature: numbers(Curvature, 2, FINITE) optional,
        /// Natural twist per length. Default: that of the rod.
        natural_twist: number(Twist, FINITE) optional,
        /// Friction coefficient, as for a rod. Default: that of the rod.
        friction: number(Dimensionless, NON_NEGATIVE) optional,
    }
}

/// Radius of a rod over the arc length along the placed rod; give `file`, or lists of equal
/// lengths. Between the rows the radius is linear. The profile is short for `sections` from row to
/// row, with the circle or tube and the material of the rod.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "profile")]
pub struct Profile {
    /// CSV file with a header line and columns arc_length and radius (m), relative to the scenario
    /// file.
    pub file: Option<String>,
    /// Arc lengths, increasing.
    pub arc_length: Option<Vec<Quantity<Length>>>,
    /// Radii, greater than 0.
    pub radius: Option<Vec<Quantity<Length>>>,
}

/// Shape of a cross-section.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(
    tag = "kind",
    deny_unknown_fields,
    rename = "cross_section",
    transform = plain_cross_sections
)]
pub enum CrossSection {
    /// A full circle of the rod's radius: A = πr², I = πr⁴/4, J = πr⁴/2.
    Circle {},
    /// A hollow circle of the rod's radius r with a wall: the inner radius is q = r − wall, A =
    /// π(r² − q²), I = π(r⁴ − q⁴)/4, J = π(r⁴ − q⁴)/2.
    Tube {
        /// Thickness of the wall, at most the radius.
        wall: Option<Quantity<Length>>,
    },
    /// A full rectangle: I₁ = width · thickness³/12 for bending about the first material director m₁ (an axis along the
    /// width), I₂ = thickness · width³/12 for bending about the second one, m₂.
    Rectangle {
        /// Side along the first material director.
        width: Option<Quantity<Length>>,
        /// Side along the second material director.
        thickness: Option<Quantity<Length>>,
    },
}

/// Adds the cross-sections that need no further keys, as text.
fn plain_cross_sections(schema: &mut Schema) {
    allow_text(schema, &["circle"]);
}
