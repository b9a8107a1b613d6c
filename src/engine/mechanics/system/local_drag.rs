//! The drag of a fluid as a term: F₀ − D ((q − qₙ)/h − v₀), the drag of a motion near that of the
//! stage with its local resistance D. Only this local part is implicit
//! ([`crate::mechanics::dynamics`], `drag`).

use super::build::Assembly;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::mechanics::SceneError;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::Scene;

/// Local drag of a fluid in a stage.
pub(crate) struct LocalDrag;

impl Term for LocalDrag {
    fn new(_: &Scene, _: &mut Assembly) -> Result<Self, SceneError> {
        Ok(Self)
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
