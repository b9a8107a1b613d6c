//! Resolved sections of rods.

use serde::Serialize;

/// Shape of a cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum CrossSection {
    /// A full circle with the rod's radius.
    Circle,
    /// A hollow circle with the rod's radius.
    Tube {
        /// Thickness of its wall, m.
        wall: f64,
    },
    /// A full rectangle; `width` is measured along the first material director, `thickness` along
    /// the second.
    Rectangle {
        /// Extent along the first director, m.
        width: f64,
        /// Extent along the second director, m.
        thickness: f64,
    },
}

/// A part of a rod with its own cross-section, material and natural curvature.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RodSection {
    /// Arc length along the placed rod at which it begins, m.
    pub from: f64,
    /// Arc length at which it ends, m; `None`: the end of the rod.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
    /// Radius at its beginning, m.
    pub radius: f64,
    /// Radius at its end, m.
    pub end_radius: f64,
    /// Shape of the cross-section at its beginning.
    pub cross_section: CrossSection,
    /// Width of a rectangle at its end, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_width: Option<f64>,
    /// Thickness of a rectangle at its end, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_thickness: Option<f64>,
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Natural curvatures about both material directors, 1/m; `None`: those of the rod.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub natural_curvature: Option<[f64; 2]>,
    /// Natural twist, rad/m; `None`: that of the rod.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub natural_twist: Option<f64>,
    /// Own friction coefficient; `None`: that of the rod.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
}

impl RodSection {
    /// Radius (m) and shape at a part of the section, from 0 at its beginning to 1 at its end.
    pub fn at(&self, part: f64) -> (f64, CrossSection) {
        let between = |from: f64, to: f64| from + (to - from) * part;
        let cross_section = match self.cross_section {
            CrossSection::Rectangle { width, thickness } => CrossSection::Rectangle {
                width: between(width, self.end_width.unwrap_or(width)),
                thickness: between(thickness, self.end_thickness.unwrap_or(thickness)),
            },
            CrossSection::Circle | CrossSection::Tube { .. } => self.cross_section,
        };
        (between(self.radius, self.end_radius), cross_section)
    }

    /// Whether it has a natural curvature or twist of its own.
    pub fn is_naturally_bent(&self) -> bool {
        self.natural_curvature.is_some() || self.natural_twist.is_some()
    }
}
