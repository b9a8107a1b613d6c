//! The boundary of the stable helices: a row for each direction.

use super::comparison::{compare, remarks};
use super::discrete_rod::DiscreteRod;
use super::files::BOUNDARY;
use super::keys::HelixStability;
use super::row::{BoundaryRow, Outcome, Part};
use super::sections::draw_sections;
use super::surface::write_surfaces;
use crate::run::TableJob;
use rodlab_engine::mechanics::kirchhoff::{Helix, critical_distance};
use rodlab_files::results::ResultsError;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// All directions of an experiment.
#[derive(Debug)]
pub struct Boundary {
    plan: HelixStability,
    rod: DiscreteRod,
    directions: Vec<(Part, [f64; 3])>,
}

impl Boundary {
    /// The surface in the directions of the plan, then the sections.
    pub fn new(plan: HelixStability) -> Self {
        let surface = plan.directions.unit_vectors().into_iter();
        let mut directions: Vec<(Part, [f64; 3])> = surface
            .map(|direction| (Part::Surface, direction))
            .collect();
        let count = plan.section_directions;
        // Half planes with κ ≥ 0 including their edges, and the whole plane of straight rods.
        let half = |k: usize| PI * (k as f64 / (count.max(2) - 1) as f64 - 0.5);
        let whole = |k: usize| TAU * k as f64 / count as f64;
        for k in 0..count {
            let (sine, cosine) = libm::sincos(half(k));
            directions.push((Part::KappaTau, [cosine.max(0.0), sine, 0.0]));
        }
        for k in 0..count {
            let (sine, cosine) = libm::sincos(half(k));
            directions.push((Part::KappaOmega, [cosine.max(0.0), 0.0, sine]));
        }
        for k in 0..count {
            let (sine, cosine) = libm::sincos(whole(k));
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

    fn row(&self, index: usize, goes_on: &(dyn Fn() -> bool + Sync)) -> Option<BoundaryRow> {
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
            let found = coarse.critical_distance(&helix, search, largest_distance, None, goes_on);
            found.ok().flatten()
        });
        let coarse = coarse.flatten();
        let found = self
            .rod
            .critical_distance(&helix, search, largest_distance, coarse, goes_on);
        if !goes_on() {
            return None;
        }
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
        Some(BoundaryRow {
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
        })
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
