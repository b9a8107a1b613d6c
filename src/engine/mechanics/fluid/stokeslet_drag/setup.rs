//! Setup of the flow: a wall, spheres, connected filaments.

use super::{StokesletDrag, TOLERANCE};
use crate::mechanics::fluid::age::Age;
use crate::mechanics::fluid::flow::Flow;
use crate::mechanics::fluid::gmres::Gmres;
use crate::mechanics::fluid::initial_guess::InitialGuess;
use crate::mechanics::fluid::points::Points;
use crate::mechanics::fluid::preconditioner::{NEIGHBOURHOOD, Preconditioner};
use crate::mechanics::fluid::spheres::Spheres;
use crate::mechanics::fluid::stations::nodes_of;
use crate::mechanics::fluid::ties::{Ties, rails};
use crate::mechanics::fluid::wall::{FlowWall, Wall};
use crate::mechanics::fluid::{Connections, FluidError};
use crate::mechanics::{Matrix3, Vector3};

/// Most nodes beside a wall. All pairs are stored, 36 bytes each: this number takes 0.9 GB.
const MOST_NODES_BESIDE_A_WALL: usize = 5000;

impl StokesletDrag {
    /// Adds a wall. To be called before filaments are connected and anything is solved;
    /// `regularization` as in [`new`](Self::new).
    ///
    /// # Errors
    /// [`FluidError::BadInput`] for more nodes than a wall allows.
    pub(crate) fn set_wall(&mut self, regularization: f64, wall: Wall) -> Result<(), FluidError> {
        let nodes = self.positions.len();
        if nodes > MOST_NODES_BESIDE_A_WALL {
            return Err(FluidError::BadInput(format!(
                "the flow beside a wall has no far-field approximation and is limited to {MOST_NODES_BESIDE_A_WALL} nodes, but there are {nodes}: \
                 use fewer nodes, or set planes.wall = false"
            )));
        }
        let wall = FlowWall::new(wall, &self.filaments);
        self.operator = Flow::beside_wall(&self.filaments, regularization, wall.clone());
        self.tolerance = TOLERANCE;
        self.preconditioner = Preconditioner::new(&self.filaments, &self.operator, NEIGHBOURHOOD);
        self.wall = Some(wall);
        Ok(())
    }

    /// Adds spheres. To be called before filaments are connected and anything is solved.
    ///
    /// # Errors
    /// [`FluidError::BadInput`] beside a wall.
    pub(crate) fn set_spheres(&mut self, spheres: Spheres) -> Result<(), FluidError> {
        if spheres.is_empty() {
            return Ok(());
        }
        if self.wall.is_some() {
            return Err(FluidError::BadInput(
                "the flow supports a wall or spheres, but not both; set planes.wall = false (the fluid then passes \
                 through the plane), or give the bodies another shape (they are then not part of the flow)"
                    .into(),
            ));
        }
        self.operator.take_spheres(spheres);
        self.resize();
        Ok(())
    }

    /// Ties joined nodes, and nodes at one place, in filaments at `positions` (m, of all nodes).
    pub(crate) fn connect(&mut self, connections: &Connections, positions: &[Vector3]) {
        for (own, node) in self.positions.iter_mut().zip(nodes_of(&self.filaments)) {
            *own = positions[node];
        }
        self.rails = rails(&self.filaments, connections);
        self.ties = Ties::find(
            &self.filaments,
            connections,
            &self.rails,
            &self.links,
            &self.positions,
        );
        if !self.ties.is_empty() {
            self.take_points();
        }
    }

    /// Sets the points of the present ties.
    pub(super) fn take_points(&mut self) {
        let points = Points::new(&self.ties, &self.rails, &self.positions);
        self.operator.take_points(points);
        self.resize();
    }

    /// Sets up the data that depend on the number of unknowns, and discards earlier solutions.
    pub(super) fn resize(&mut self) {
        let nodes = self.operator.nodes();
        let unknowns = self.operator.unknowns();
        self.preconditioner = Preconditioner::new(&self.filaments, &self.operator, NEIGHBOURHOOD);
        self.preconditioned_at.clear();
        self.age = Age::default();
        self.guess = InitialGuess::new(unknowns);
        self.gmres = Gmres::new(unknowns);
        self.inverses = vec![Matrix3::zeros(); nodes];
        for vector in [
            &mut self.right_hand_side,
            &mut self.residual,
            &mut self.image,
            &mut self.densities,
        ] {
            vector.clear();
            vector.resize(unknowns, 0.0);
        }
    }
}
