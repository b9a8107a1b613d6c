//! The drag of a fluid as a term: F₀ − D ((q − qₙ)/h − v₀), the drag of a motion near that of the
//! stage with its local resistance D, and the torques with which a background flow spins edges. Only
//! this local part is implicit ([`crate::mechanics::dynamics`], `drag`).

use super::build::Assembly;
use super::demand::Demand;
use super::events::Event;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::mechanics::SceneError;
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::Scene;

const NOT_AT_REST: SceneError = SceneError::Unsuitable(
    "an equilibrium in a flow needs fluid.model = \"quadratic\"; with other models, let a dynamic run come to rest",
);

/// Local drag of a fluid in a stage.
pub(crate) struct LocalDrag {
    /// Corners of the schedule of a background flow, s.
    corners: Vec<f64>,
    /// Whether a viscous fluid flows.
    flows: bool,
}

impl Term for LocalDrag {
    fn new(scene: &Scene, _: &mut Assembly) -> Result<Self, SceneError> {
        let schedule = scene.flow.iter().flat_map(|flow| &flow.schedule);
        let is_viscous = !matches!(scene.fluid, None | Some(FluidModel::Quadratic { .. }));
        Ok(Self {
            corners: schedule.map(|corner| corner.0).collect(),
            flows: is_viscous && scene.flow.is_some(),
        })
    }

    fn kind(&self) -> Kind {
        Kind::Motion
    }

    /// In a stage without fluid there is no drag.
    fn has_copies(&self) -> bool {
        true
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        let Some(stage) = at.stage else { return };
        let per_step = 1.0 / stage.step;
        for (node, (drag, resistance)) in stage.drag.iter().zip(&stage.resistance).enumerate() {
            let moved = position(at.unknowns, node) - position(&stage.start, node);
            let change = moved * per_step - stage.drag_velocity[node];
            let force = drag - resistance * change;
            for axis in 0..3 {
                residual[STRIDE * node + axis] -= force[axis];
            }
        }
        for (node, torque) in stage.flow_torque.iter().enumerate() {
            residual[STRIDE * node + 3] -= torque;
        }
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        events.extend(self.corners.iter().map(|time| Event::of_load(*time)));
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        let rests = matches!(
            demand,
            Demand::Equilibrium | Demand::NearbyEquilibrium | Demand::Path
        );
        (rests && self.flows).then_some(NOT_AT_REST)
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        let Some(stage) = at.stage else { return };
        let per_step = 1.0 / stage.step;
        let columns = entries.columns();
        for (node, resistance) in stage.resistance.iter().enumerate() {
            for j in 0..3 {
                for i in j..3 {
                    columns[STRIDE * node + j][i - j] += resistance[(i, j)] * per_step;
                }
            }
        }
    }
}
