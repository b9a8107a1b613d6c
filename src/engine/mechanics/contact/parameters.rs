//! Parameters of the contact model.

use super::{barrier, friction, potential};

/// Largest increase of a gap by the smoothing of closest points, in units of δ.
///
/// The contact force at a gap then changes by at most 1.5 %. A reef knot with straight tails that
/// become parallel in contact takes 2.1 iterations a step with a tenth of this value and with 30
/// times this value; without smoothing it does not advance.
const SMOOTHING: f64 = 5e-4;

/// Largest increase of a gap by smoothing with a barrier, in units of δ. The barrier begins that
/// much outside the surfaces, so that they never touch.
///
/// Without smoothing, time steps fall to the minimum when two rods press on each other and become
/// parallel: the closest points of the edges jump, and the forces on the nodes jump with them.
const BARRIER_SMOOTHING: f64 = 5e-3;

/// Contact models, all with Coulomb friction (thesis Eqs. 2.7–2.14).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactModel {
    /// The implicit contact model (thesis 2.2–2.3): a smooth penalty, which a large force may exceed.
    ImplicitContact,
    /// Incremental potential contact (Li et al. 2020): a barrier that is infinite at contact, and steps that
    /// never cross it.
    IncrementalPotential,
    /// Rigid contact by Signorini's and Coulomb's laws (thesis 3.3): no contact energy, and true sticking.
    Complementarity,
}

/// Where friction acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionAt {
    /// On the centrelines, as in the thesis: no contact turns a rod about its axis.
    #[default]
    Centreline,
    /// On the surfaces, which turn with the rods: see `turning`.
    Surface,
}

/// Geometry of the centrelines in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Geometry {
    /// Straight edges between the nodes.
    #[default]
    Polyline,
    /// Smooth curves through the nodes: see `curve_points`.
    Smooth,
}

/// Parameters of a contact model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParameters {
    /// The model.
    pub model: ContactModel,
    /// Geometry of the centrelines.
    pub geometry: Geometry,
    /// Distance tolerance δ, m: contact forces act within δ of the surfaces (Eqs. 2.1, 2.2). A
    /// smaller value is more exact and stiffer; the thesis uses 1e-5 m for a radius of 1 mm.
    pub distance_tolerance: f64,
    /// Friction coefficient μ.
    pub friction: f64,
    /// Where friction acts.
    pub friction_at: FrictionAt,
    /// Slip tolerance ν, m/s: slower sliding counts as sticking (Eq. 2.10).
    pub slip_tolerance: f64,
    /// Factor s of the adaptive contact stiffness. The implicit contact model has k = s max‖F‖ (Eq. 2.19),
    /// the default; the barrier carries the force s max‖F‖ at a gap of δ/2, for which 1 is suitable.
    pub stiffness_factor: f64,
    /// Penetration that ends the run, as a fraction of the sum of the two radii. Ignored by
    /// incremental potential contact, which allows no penetration.
    pub maximum_penetration: f64,
}

impl ContactParameters {
    /// Ratio of the contact stiffness k to the force near contact (J/N), for surfaces of radius
    /// `radius` (m).
    pub(crate) fn stiffness_per_force(&self, radius: f64) -> f64 {
        let factor = self.stiffness_factor;
        match self.model {
            ContactModel::ImplicitContact => factor,
            ContactModel::IncrementalPotential => {
                factor * barrier::stiffness_per_force(radius, self.distance_tolerance)
            }
            ContactModel::Complementarity => 0.0,
        }
    }

    /// Largest surface gap at which there is a force, m.
    pub(super) fn reach(&self) -> f64 {
        match self.model {
            ContactModel::ImplicitContact => potential::reach(self.distance_tolerance),
            ContactModel::IncrementalPotential | ContactModel::Complementarity => {
                self.distance_tolerance
            }
        }
    }

    /// Smoothing c of the closest points of edges that touch at the distance `threshold` (m), m².
    ///
    /// Zero for complementarity, whose contacts have no gap.
    pub(super) fn smoothing(&self, threshold: f64) -> f64 {
        let part = match self.model {
            ContactModel::ImplicitContact => SMOOTHING,
            ContactModel::IncrementalPotential => BARRIER_SMOOTHING,
            ContactModel::Complementarity => 0.0,
        };
        4.0 * part * self.distance_tolerance * threshold
    }

    /// Distance between the surfaces of two edges at which the gap of the force law is zero, m.
    ///
    /// The smoothed distance Δ of [`ClosestPoints`](super::closest_points::ClosestPoints) exceeds
    /// the true distance d by at most c/(4 d), so with a barrier at Δ = h_i + h_j + c/(4 (h_i +
    /// h_j)) surfaces never touch. Penalties have no such offset.
    pub(super) fn standoff(&self) -> f64 {
        match self.model {
            ContactModel::IncrementalPotential => BARRIER_SMOOTHING * self.distance_tolerance,
            ContactModel::ImplicitContact | ContactModel::Complementarity => 0.0,
        }
    }

    /// Largest slope of smoothed friction over the slip speed, per normal force, s/m; zero for
    /// complementarity. `coefficient` is that of the surfaces.
    pub(crate) fn friction_slope(&self, coefficient: f64) -> f64 {
        match self.model {
            ContactModel::ImplicitContact | ContactModel::IncrementalPotential => {
                friction::steepest_slope(coefficient, self.slip_tolerance)
            }
            ContactModel::Complementarity => 0.0,
        }
    }

    /// Whether the model prevents surfaces from ever touching.
    pub fn is_barrier(&self) -> bool {
        self.model == ContactModel::IncrementalPotential
    }

    /// Whether contact forces are solved together for a whole step instead of being functions of
    /// the gap.
    pub fn is_complementarity(&self) -> bool {
        self.model == ContactModel::Complementarity
    }
}

impl Default for ContactParameters {
    fn default() -> Self {
        Self {
            model: ContactModel::ImplicitContact,
            geometry: Geometry::Polyline,
            distance_tolerance: 1e-5,
            friction: 0.0,
            friction_at: FrictionAt::Centreline,
            slip_tolerance: 1e-4,
            stiffness_factor: 1e5,
            maximum_penetration: 0.05,
        }
    }
}
