//! The fingers of a gripper as its arm reports them, to detect whether they still hold the object.

use super::resolved::Cell;
use std::cell::RefCell;

/// The fingers count as closed below this distance from their empty closed position, m; a sheet of
/// paper is twice as thick.
const CLOSED: f64 = 5e-5;
/// Fraction of their range above which fingers count as open.
const OPEN: f64 = 0.95;
/// The object is lost when the opening falls below this fraction of the opening with the object.
const LOST: f64 = 0.5;

/// The fingers of a gripper that reports its opening.
pub struct Fingers {
    driver: RefCell<Box<dyn rodlab_robot::Driver>>,
    /// Opening at first, m.
    first: f64,
    open: f64,
    closed: f64,
}

impl Cell {
    /// The fingers of an arm as they are now; `None` if the cell file does not name their joint.
    ///
    /// # Errors
    /// A message: no report of the fingers arrives in time.
    pub fn fingers(&self, arm: usize) -> Result<Option<Fingers>, String> {
        let arm = &self.arms[arm];
        let known = arm.gripper.as_ref();
        let Some((gripper, joint)) = known.and_then(|known| Some((known, known.joint.clone()?)))
        else {
            return Ok(None);
        };
        let (driver, found) = self.heard(&arm.name, arm.driver.as_ref(), &[joint])?;
        Ok(Some(Fingers {
            driver: RefCell::new(driver),
            first: found[0],
            open: gripper.open,
            closed: gripper.closed,
        }))
    }
}

impl Fingers {
    /// Whether they held something at first.
    pub fn hold(&self) -> bool {
        let apart = self.first - self.closed;
        apart > CLOSED && apart < OPEN * (self.open - self.closed)
    }

    /// Message that the object held at first has slipped out, if so. The motion reports a lost connection.
    pub fn slipped(&self) -> Option<String> {
        let state = self.driver.borrow_mut().state().ok().flatten()?;
        let apart = state.positions[0];
        (apart - self.closed < LOST * (self.first - self.closed)).then(|| {
            format!(
                "the object slipped out of the gripper: its fingers closed from {:.2} mm to {:.2} mm",
                1e3 * self.first,
                1e3 * apart
            )
        })
    }
}
