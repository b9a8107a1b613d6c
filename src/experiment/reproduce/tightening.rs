//! A knot pulled tight, with the parameters of the thesis, section 2.5, and quasi-static.

use super::cases::{Case, Run};
use crate::experiment::{PreparedRun, prepare};
use crate::results::{KnotRow, ResultsError, SeriesRow, read_knot_series};
use crate::scenario::from_text_with;
use std::path::Path;

/// The trefoil of the thesis.
const BASE: &str = include_str!("../../../scenarios/trefoil.toml");

/// A knot pulled tight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tightening {
    /// Unknotting number n.
    pub unknotting_number: usize,
    /// Friction coefficient μ.
    pub friction: f64,
    /// Radius of the rod, m.
    pub radius: f64,
    /// Nodes of the rod.
    pub nodes: usize,
    /// Distance of the ends at the start, m.
    pub end_to_end: f64,
    /// Speed of each end, m/s.
    pub pull_speed: f64,
    /// Time for which the knot settles, s.
    pub settling: f64,
    /// Simulated time, s.
    pub end: f64,
}

/// Radius of the thesis' rods, m.
pub(super) const RADIUS: f64 = 1.6e-3;
/// Friction coefficients of figure 2.7.
pub(super) const FRICTIONS: [f64; 4] = [0.0, 0.05, 0.1, 0.2];
/// Friction coefficient of figure 2.8.
pub(super) const FRICTION_OF_FIGURE_2_8: f64 = 0.07;
/// Friction coefficient of the limit ε → 0: without any, a loose knot turns about its axis, and the forces never
/// come to rest; this adds at most 3 % to the traction, which is taken off again.
pub(super) const SLIGHT_FRICTION: f64 = 1e-3;
/// Radius (m) and nodes of the rods of the limit ε → 0.
const THIN_RODS: [(f64, usize); 4] = [(1.6e-3, 301), (8e-4, 451), (4e-4, 601), (2e-4, 901)];
/// Time for which the knots settle, s.
const SETTLING: f64 = 4.0;
/// Density at the radius of the thesis, kg/m³. The thesis has 1180, with which the loose loop takes seconds to swing
/// and 6 mm/s is no longer slow; force balance does not depend on the density.
const DENSITY: f64 = 10.0;
/// Simulated time of a quick look, s.
const QUICK_END: f64 = 14.0;

impl Tightening {
    /// A trefoil at each friction coefficient, then trefoils of ever thinner rods.
    pub fn of_figure_2_7(quick: bool) -> Vec<Self> {
        let thick = |friction: f64| Self {
            unknotting_number: 1,
            friction,
            radius: RADIUS,
            nodes: 301,
            end_to_end: 0.28,
            pull_speed: 6e-3,
            settling: SETTLING,
            end: if quick { QUICK_END } else { 54.0 },
        };
        let thin = |(radius, nodes): (f64, usize)| Self {
            friction: SLIGHT_FRICTION,
            radius,
            nodes,
            pull_speed: 1e-3,
            end: QUICK_END,
            ..thick(0.0)
        };
        let thick = FRICTIONS.map(thick).into_iter();
        thick.chain(THIN_RODS.map(thin)).collect()
    }

    /// The overhand knots of unknotting number 1 to 4.
    pub fn of_figure_2_8(quick: bool) -> Vec<Self> {
        (1..=4)
            .map(|unknotting_number| Self {
                unknotting_number,
                friction: FRICTION_OF_FIGURE_2_8,
                radius: RADIUS,
                nodes: 301,
                // Longer braids need more room.
                end_to_end: 0.26 + 0.02 * unknotting_number as f64,
                pull_speed: 3e-3,
                settling: SETTLING,
                end: if quick { QUICK_END } else { 90.0 },
            })
            .collect()
    }

    /// h²/EI, by which tractions are made dimensionless, 1/N.
    pub fn traction_unit(&self) -> f64 {
        let observer = self.prepare().knot.expect("a knot is observed");
        observer.radius.powi(2) / observer.bending_stiffness
    }

    /// Rough cost on one core, s.
    pub fn cost(&self) -> f64 {
        let steps = self.end / 2.5e-3;
        4e-6 * self.nodes as f64 * self.unknotting_number as f64 * steps
    }
}

impl Run for Tightening {
    /// Its name, such as `knot_n1_mu0.1_h1.6mm_54s`.
    fn id(&self) -> String {
        let Self {
            unknotting_number,
            friction,
            radius,
            end,
            ..
        } = self;
        let millimetres = (1e7 * radius).round() / 1e4;
        format!("knot_n{unknotting_number}_mu{friction}_h{millimetres}mm_{end}s")
    }

    fn prepare(&self) -> PreparedRun {
        let thinness = self.radius / RADIUS;
        let overrides = [
            format!("title=\"{}\"", self.id()),
            format!("knot.unknotting_number={}", self.unknotting_number),
            format!("rod.radius={:?}", self.radius),
            format!("rod.nodes={}", self.nodes),
            "knot.ends=\"pinned\"".to_owned(),
            format!("knot.pull_speed={:?}", self.pull_speed),
            format!("knot.end_to_end={:?}", self.end_to_end),
            format!("knot.settling_time={:?}", self.settling),
            // The frequency of the loop is as √(E/ρ) h.
            format!("material.density={:?}", DENSITY * thinness * thinness),
            format!("contact.friction={:?}", self.friction),
            format!("contact.distance_tolerance={:?}", self.radius / 80.0),
            format!("time.end={:?}", self.end),
            "output.interval=0.25".to_owned(),
        ];
        let loaded = from_text_with(&self.id(), BASE, Path::new(""), &overrides);
        let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
        prepare(&loaded.scenario).expect("a knot of the thesis is possible")
    }

    fn end(&self) -> f64 {
        self.end
    }
}

/// Part of the time of pulling that is left out, until friction has turned into the direction of slip everywhere.
const LEFT_OUT: f64 = 0.1;

/// The series of a run while its ends move, but for the beginning.
pub(super) fn pulled_series(
    case: &Case<Tightening>,
) -> Result<Vec<(SeriesRow, KnotRow)>, ResultsError> {
    let rows = read_knot_series(&case.directory)?.into_iter();
    let Tightening { settling, end, .. } = case.run;
    let start = settling + LEFT_OUT * (end - settling);
    Ok(rows.filter(|(series, _)| series.time_s > start).collect())
}

/// What was measured of the knot in [`pulled_series`].
pub(super) fn pulled_rows(case: &Case<Tightening>) -> Result<Vec<KnotRow>, ResultsError> {
    let rows = pulled_series(case)?.into_iter();
    Ok(rows.map(|(_, knot)| knot).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_say_what_is_run() {
        let runs = Tightening::of_figure_2_7(false);
        assert_eq!(runs[2].id(), "knot_n1_mu0.1_h1.6mm_54s");
        let prepared = runs[2].prepare();
        assert_eq!(prepared.scene.contact.unwrap().friction, 0.1);
        assert_eq!(prepared.knot.unwrap().determinant, 3);
    }
}
