//! The boundary of the stable helices: a row for each direction.

use super::comparison::{compare, remarks};
use super::discrete_rod::DiscreteRod;
use super::keys::HelixStability;
use super::sections::draw_sections;
use super::surface::write_surfaces;
use crate::mechanics::kirchhoff::{Helix, critical_distance};
use crate::results::{BOUNDARY, ResultsError, read_whole_rows};
use crate::run::TableJob;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// All directions of an experiment.
#[derive(Debug)]
pub struct Boundary {
    plan: HelixStability,
    rod: DiscreteRod,
    directions: Vec<(Part, [f64; 3])>,
}

/// Which part of the boundary a direction belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// The surface.
    Surface,
    /// Its section ω = 0.
    KappaTau,
    /// Its section τ = 0.
    KappaOmega,
    /// Its section κ = 0: straight rods.
    TauOmega,
}

/// What becomes of the rod along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It loses stability.
    Buckles,
    /// It loses stability, but touches itself before.
    TouchesItself,
    /// It is stable up to the largest distance.
    Stable,
    /// No equilibrium was found next to the helix.
    NoConvergence,
}

/// A row of `boundary.csv`. Distances are norms ‖(κ, τ, ω)‖ for a rod of length 1 and bending stiffness 1.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct BoundaryRow {
    /// Part of the boundary.
    pub part: Part,
    /// Unit direction: curvature.
    pub kappa: f64,
    /// Unit direction: torsion.
    pub tau: f64,
    /// Unit direction: twisting moment.
    pub omega: f64,
    /// What becomes of the rod.
    pub outcome: Outcome,
    /// Distance at which the discrete rod loses stability; empty where it does not.
    pub critical: Option<f64>,
    /// The same in the limit of a fine mesh, by the error's falling with the square of the edge length; empty where
    /// it is not asked for or the rod of half as many edges does not lose stability.
    pub extrapolated: Option<f64>,
    /// The same by the conjugate points of the smooth rod; empty where there are none up to 100.
    pub theory: Option<f64>,
    /// critical/theory − 1.
    pub relative_difference: Option<f64>,
    /// extrapolated/theory − 1.
    pub relative_difference_extrapolated: Option<f64>,
    /// Distance at which the rod first touches itself; empty where it does not before it loses stability.
    pub contact: Option<f64>,
}

/// The rows in a results directory.
///
/// # Errors
/// Where `boundary.csv` cannot be read.
pub fn read_boundary(directory: &Path) -> Result<Vec<BoundaryRow>, ResultsError> {
    Ok(read_whole_rows(&directory.join(BOUNDARY))?.rows)
}

impl Boundary {
    /// The surface in the directions of the plan, then the sections.
    pub fn new(plan: HelixStability) -> Self {
        let surface = plan.directions.unit_vectors().into_iter();
        let mut directions: Vec<(Part, [f64; 3])> = surface
            .map(|direction| (Part::Surface, direction))
            .collect();
        let count = plan.section_directions;
        // Half planes with κ ≥ 0, their edges included, and the whole plane of straight rods.
        let half = |k: usize| PI * (k as f64 / (count.max(2) - 1) as f64 - 0.5);
        let whole = |k: usize| TAU * k as f64 / count as f64;
        for k in 0..count {
            let (sine, cosine) = half(k).sin_cos();
            directions.push((Part::KappaTau, [cosine.max(0.0), sine, 0.0]));
        }
        for k in 0..count {
            let (sine, cosine) = half(k).sin_cos();
            directions.push((Part::KappaOmega, [cosine.max(0.0), 0.0, sine]));
        }
        for k in 0..count {
            let (sine, cosine) = whole(k).sin_cos();
            directions.push((Part::TauOmega, [0.0, cosine, sine]));
        }
        Self {
            rod: DiscreteRod {
                edges: plan.edges,
                stiffness_ratio: plan.stiffness_ratio,
                bending_stiffness: 1.0,
            },
            directions,
            plan,
        }
    }
}

impl TableJob for Boundary {
    type Row = BoundaryRow;

    const TABLE: &'static str = BOUNDARY;
    const ROWS: &'static str = "directions";

    fn count(&self) -> usize {
        self.directions.len()
    }

    fn row(&self, index: usize) -> BoundaryRow {
        let (part, direction) = self.directions[index];
        let helix = Helix::from(direction);
        let HelixStability {
            search,
            largest_distance,
            extrapolate,
            ..
        } = self.plan;
        let coarse = extrapolate.then(|| {
            let coarse = self.rod.coarsened();
            let found = coarse.critical_distance(&helix, search, largest_distance, None);
            found.ok().flatten()
        });
        let coarse = coarse.flatten();
        let found = self
            .rod
            .critical_distance(&helix, search, largest_distance, coarse);
        let theory = critical_distance(&helix).map(|critical| critical.distance);
        let critical = found.as_ref().ok().copied().flatten();
        let contact =
            critical.and_then(|distance| helix.contact_distance(self.plan.radius, distance));
        let extrapolated = critical
            .zip(coarse)
            .map(|(fine, coarse)| (4.0 * fine - coarse) / 3.0);
        let difference = |distance: Option<f64>| {
            distance
                .zip(theory)
                .map(|(distance, theory)| distance / theory - 1.0)
        };
        let [kappa, tau, omega] = direction;
        BoundaryRow {
            part,
            kappa,
            tau,
            omega,
            outcome: match (&found, contact) {
                (Err(_), _) => Outcome::NoConvergence,
                (Ok(None), _) => Outcome::Stable,
                (Ok(Some(_)), None) => Outcome::Buckles,
                (Ok(Some(_)), Some(_)) => Outcome::TouchesItself,
            },
            critical,
            extrapolated,
            theory,
            relative_difference: difference(critical),
            relative_difference_extrapolated: difference(extrapolated),
            contact,
        }
    }

    fn conclude(
        &self,
        rows: &[BoundaryRow],
        directory: &Path,
    ) -> Result<Vec<String>, ResultsError> {
        let comparison = compare(rows);
        comparison.write(directory)?;
        draw_sections(rows, directory)?;
        write_surfaces(rows, directory)?;
        Ok(remarks(rows, &comparison))
    }
}
