//! Rotation of the surfaces of rods in a step, and the contacts at which friction turns them.

use super::contacts::CandidatePair;
use super::levers::{EdgesAtNodes, Levers};
use super::parameters::{ContactParameters, FrictionAt};
use super::surface::ContactSurface;
use super::turning::{ANGLES, Row, Square, Turn, Turning};
use crate::mechanics::Vector3;

/// The angles of all edges in the present step.
#[derive(Clone, Debug, Default)]
pub(super) struct SurfaceTurns {
    pub edges: EdgesAtNodes,
    /// Change of the angle of each edge since the stage began, rad. Each edge is identified by the
    /// node at which it starts.
    now: Vec<f64>,
    /// These changes at the last linearisation, rad; empty before the first of a step.
    linearised: Vec<f64>,
    /// Rotation of each edge under a unit moment within a step by inertia alone, rad/(N m); zero
    /// if it is held or has no inertia.
    mobilities: Vec<f64>,
}

/// The bodies of a contact that turns edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TurnedBodies {
    /// Number of the candidate pair.
    Pair(usize),
    /// A plane and a node.
    Plane { plane: usize, node: usize },
}

/// A contact at which friction acts at the surfaces.
#[derive(Clone, Debug)]
pub(crate) struct TurnedContact {
    pub bodies: TurnedBodies,
    pub levers: Levers,
    /// Moments on the angles of edges (N m) and couples of forces on nodes (N), in addition to the
    /// forces of the contact.
    pub moments: Row,
    /// Derivative of the force with respect to all unknowns of the contact; `None` if it was not
    /// requested.
    pub jacobian: Option<Square>,
    /// Difference between the force of the linearised laws and the present force.
    pub correction: Row,
}

impl SurfaceTurns {
    /// Creates the turns of the rods of a surface; `None` if friction does not act at surfaces.
    pub(crate) fn of(surface: &ContactSurface, parameters: &ContactParameters) -> Option<Self> {
        (parameters.friction_at == FrictionAt::Surface).then(|| Self {
            edges: EdgesAtNodes::of(surface),
            ..Self::default()
        })
    }

    /// Starts the iterations of a step.
    pub(crate) fn begin(&mut self) {
        self.linearised.clear();
    }

    /// Sets the rotation of each edge under a unit moment within the step.
    pub(crate) fn set_mobilities(&mut self, mobilities: impl Iterator<Item = f64>) {
        self.mobilities.clear();
        self.mobilities.extend(mobilities);
    }

    /// Sets the angles by which edges have turned since the stage began, rad.
    pub(crate) fn set_angles(&mut self, angles: impl Iterator<Item = f64>) {
        self.now.clear();
        self.now.extend(angles);
    }

    /// Angle by which an edge has turned since the stage began, rad.
    pub(crate) fn turn_of(&self, edge: usize) -> f64 {
        self.now.get(edge).copied().unwrap_or(0.0)
    }

    /// Marks the present angles as those of a linearisation.
    pub(crate) fn linearised(&mut self) {
        self.linearised.clone_from(&self.now);
    }

    /// Rotation of a contact with these levers.
    pub(crate) fn turning(
        &self,
        levers: Levers,
        [positions, previous]: [&[Vector3]; 2],
        time_step: f64,
    ) -> Turning {
        let turns = levers.edges.map(|lever| match lever {
            None => Turn::default(),
            Some(lever) => {
                let [from, to] = lever.ends.map(|end| levers.nodes[end]);
                Turn {
                    span: [positions, previous].map(|all| all[to] - all[from]),
                    angle: self.turn_of(lever.edge),
                }
            }
        });
        Turning {
            levers,
            turns,
            time_step,
        }
    }

    /// Displacements of the unknowns of a contact since the last linearisation; `moved` gives
    /// those of the nodes, m.
    pub(crate) fn displacement(
        &self,
        levers: &Levers,
        moved: impl Fn(usize) -> Option<Vector3>,
    ) -> Row {
        let mut row = Row::zeros();
        for (place, node) in levers.all_nodes() {
            if let Some(moved) = moved(node) {
                row.fixed_rows_mut::<3>(3 * place).copy_from(&moved);
            }
        }
        for (k, lever) in levers.edges.iter().enumerate() {
            let edge = lever.map(|lever| lever.edge);
            let both =
                edge.and_then(|edge| Some((self.now.get(edge)?, self.linearised.get(edge)?)));
            if let Some((now, before)) = both {
                row[ANGLES + k] = now - before;
            }
        }
        row
    }

    /// Slip of the surfaces under a unit friction within the step due to the rotation of edges, by
    /// inertia alone, m/N.
    pub(crate) fn mobility(&self, levers: &Levers) -> f64 {
        let of_edge = |edge: usize| self.mobilities.get(edge).copied().unwrap_or(0.0);
        let levers = levers.edges.iter().flatten();
        levers
            .map(|lever| lever.arm * lever.arm * of_edge(lever.edge))
            .sum()
    }
}

impl TurnedContact {
    /// The nodes that the contact moves, with their positions among its unknowns.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (usize, usize)> {
        self.levers.all_nodes()
    }

    /// The edges whose angles the contact turns, with their positions among its unknowns.
    pub(crate) fn edges(&self) -> impl Iterator<Item = (usize, usize)> {
        let edges = self.levers.edges.into_iter().enumerate();
        edges.filter_map(|(k, lever)| Some((ANGLES + k, lever?.edge)))
    }
}

/// Renumbers the contacts from an old list of candidates to a new one and discards their
/// Jacobians.
pub(super) fn renumber(
    turned: &mut Vec<TurnedContact>,
    old: &[CandidatePair],
    new: &[CandidatePair],
) {
    turned.retain_mut(|one| {
        one.jacobian = None;
        let TurnedBodies::Pair(candidate) = &mut one.bodies else {
            return true;
        };
        let found = new.binary_search(&old[*candidate]);
        found.is_ok_and(|found| {
            *candidate = found;
            true
        })
    });
}
