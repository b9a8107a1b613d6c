//! The onset of sliding: the derived column `sliding_onset_s`.
//!
//! A load, a clamp or the direction of gravity changes until rods begin to slide. Their speed is the mean of the tangential relative
//! speeds of all contacts, weighted by the normal forces N,
//!
//! ```text
//! v = Σ N |v_t| / Σ N
//! ```
//!
//! and the onset is the first time at which v exceeds the slip tolerance ν of the contact model, below which a contact sticks. Friction
//! reaches its limit μN there, to a millionth. Beyond it, with an excess force per mass that grows at the rate j, v = j t²/2: the onset is
//! late by √(2ν/j).
//!
//! The step in which v passes ν is repeated in small steps, and the time is interpolated, so that
//! it changes smoothly with friction.

use crate::run::{LiveRun, PreparedRun};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};

/// The column of the onset, s.
pub const ONSET: &str = "sliding_onset_s";
/// Number of small steps that replace the step in which sliding begins.
const PARTS: usize = 32;

/// A search for the onset.
pub struct Onset {
    threshold: f64,
    /// Time and speed before.
    last: (f64, f64),
    /// The onset, s.
    pub found: Option<f64>,
}

impl Onset {
    /// The search in a run.
    ///
    /// # Errors
    /// The scene has no friction, or has moving obstacles; the message names what is allowed.
    pub fn new(run: &PreparedRun) -> Result<Self, String> {
        let contact = run.scene.contact.as_ref();
        let contact = contact.filter(|contact| contact.slip_tolerance > 0.0);
        let Some(contact) = contact else {
            return Err(format!(
                "`{ONSET}` needs rods that slide with friction: [contact] with model = \"imc\" or \"ipc\""
            ));
        };
        if run.scene.obstacles.iter().any(|one| one.motion.moves()) {
            return Err(format!("`{ONSET}` needs obstacles that rest"));
        }
        Ok(Self {
            threshold: contact.slip_tolerance,
            last: (0.0, 0.0),
            found: None,
        })
    }

    /// Takes a step that ends at `until`, s, at the latest, and checks for sliding. Returns false
    /// if the caller asked to stop.
    ///
    /// # Errors
    /// The errors of the step.
    pub fn advance(
        &mut self,
        run: &mut LiveRun,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<bool, SimulationError> {
        if self.found.is_some() {
            return Ok(run.advance(until, goes_on)?.is_some());
        }
        let before = run.save();
        let start = run.simulation.time();
        if run.advance(until, goes_on)?.is_none() {
            return Ok(false);
        }
        let end = run.simulation.time();
        if speed(&run.simulation).is_none_or(|speed| speed < self.threshold) {
            self.last = (end, speed(&run.simulation).unwrap_or(0.0));
            return Ok(true);
        }
        let after = run.save();
        run.restore(before)?;
        for part in 1..=PARTS {
            let until = start + (end - start) * part as f64 / PARTS as f64;
            while run.simulation.time() < until {
                if run.advance(until, goes_on)?.is_none() {
                    return Ok(false);
                }
                self.look(run);
            }
        }
        run.restore(after)?;
        // The small steps may pass the threshold later than the large step.
        self.look(run);
        Ok(true)
    }

    /// Interpolates the time at which the speed passed the threshold.
    fn look(&mut self, run: &LiveRun) {
        let now = (run.simulation.time(), speed(&run.simulation).unwrap_or(0.0));
        if self.found.is_none() && now.1 >= self.threshold {
            let part = (self.threshold - self.last.1) / (now.1 - self.last.1);
            self.found = Some(self.last.0 + (now.0 - self.last.0) * part.clamp(0.0, 1.0));
        }
        self.last = now;
    }
}

/// Weighted mean of the tangential speeds of all contacts, m/s; `None` if nothing touches.
fn speed(simulation: &Simulation) -> Option<f64> {
    let velocities = simulation.velocities();
    let (mut force, mut product) = (0.0, 0.0);
    let mut add = |normal_force: f64, normal: &Vector3, velocity: Vector3| {
        if normal_force > 0.0 {
            force += normal_force;
            product += normal_force * (velocity - normal * normal.dot(&velocity)).norm();
        }
    };
    for touch in simulation.plane_contacts().iter() {
        let normal = simulation.planes()[touch.plane].normal;
        add(touch.normal_force, &normal, velocities[touch.node]);
    }
    for pair in simulation.contacts().iter() {
        let mut sides = [Vector3::zeros(); 2];
        let corners = pair.force.chunks_exact(3).map(Vector3::from_column_slice);
        for (corner, on_corner) in corners.enumerate() {
            let side = usize::from(corner >= pair.first_body);
            // The force on a corner gives its weight in the contact; bodies that are not rods
            // rest.
            let part = on_corner.dot(&pair.normal).abs() / pair.normal_force;
            if let Some(velocity) = velocities.get(pair.nodes[corner]) {
                sides[side] += velocity * part;
            }
        }
        add(pair.normal_force, &pair.normal, sides[0] - sides[1]);
    }
    (force > 0.0).then(|| product / force)
}
