//! A rod between the chuck and a hand of a virtual cell: clamped at both ends, moved and twisted.

use super::axis::served_axes;
use super::grip::Grip;
use super::rod::{RodError, prepared};
use super::simulated_rod::{HANDING_OVER, advance_for_a_while};
use crate::cell::Cell;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::mechanics::scene::Motion;
use rodlab_lab::experiment::ClampedRod;
use rodlab_lab::run::PreparedRun;
use rodlab_robot::{Pose, distance_and_angle};
use std::path::Path;

/// Largest distance of the hand from the end of the straight rod at the hand-over, relative to the
/// length of the rod, and largest rotation, rad. The user can bend the rod by these amounts.
const REACH: [f64; 2] = [0.05, 0.2];
/// Index of the clamp of the chuck.
const CHUCK: usize = 0;
/// Index of the clamp of the hand.
const HAND: usize = 1;

/// Supplies rods of one kind, one after another, to a chuck.
pub struct ChuckedSupply {
    rod: ClampedRod,
    prepared: PreparedRun,
    /// Pose of the chuck in the cell.
    chuck: Pose,
    /// Index of the moving part that turns the chuck: arms are counted first, then the served
    /// axes.
    part: usize,
}

impl ChuckedSupply {
    /// Reads the description of the rods from a file, for the chuck of a cell; `None` if the cell
    /// has no chuck.
    ///
    /// # Errors
    /// The file cannot be read, or is invalid, or the axis of the chuck is not served.
    pub fn new(file: &Path, cell: &Cell) -> Result<Option<Self>, RodError> {
        let Some(chuck) = cell.chuck else {
            return Ok(None);
        };
        let served = served_axes(cell).position(|axis| axis == chuck.axis);
        let Some(served) = served else {
            return Err(RodError::Impossible(format!(
                "axis {}: a virtual cell turns a chuck with a driver of kind \"rosbridge\"",
                cell.axes[chuck.axis].name
            )));
        };
        let rod = ClampedRod::read(file).map_err(Box::new)?;
        let up = chuck.pose.rotation.inverse() * Vector3::z();
        let (_, prepared) = prepared("rod", rod.scenario(&up))?;
        Ok(Some(Self {
            rod,
            prepared,
            chuck: chuck.pose,
            part: cell.arms.len() + served,
        }))
    }

    /// Pose of the hand at the end of the straight rod, in the frame of the chuck.
    fn end(&self) -> Pose {
        Pose::translation(self.rod.length, 0.0, 0.0)
    }

    /// Hands the end of a straight rod to a hand at the time `now`, s. `hand` is the pose of the
    /// hand in the cell, `angle` the angle of the chuck, rad.
    ///
    /// # Errors
    /// A message: the hand is not at the end of the straight rod, or the rod cannot be simulated.
    fn handed(&self, arm: usize, hand: &Pose, angle: f64, now: f64) -> Result<ChuckedRod, String> {
        let (distance, turned) = distance_and_angle(&self.end(), &(self.chuck.inverse() * hand));
        let [most, most_turned] = [REACH[0] * self.rod.length, REACH[1]];
        if !(distance <= most && turned <= most_turned) {
            return Err(format!(
                "the rod between chuck and hand is {:.3} m long and straight when it is clamped; the hand is {distance:.3} m and \
                 {turned:.2} rad away from its end; allowed: {most:.3} m and {most_turned} rad",
                self.rod.length
            ));
        }
        let simulation = Simulation::new(&self.prepared.scene, &self.prepared.integration);
        let end = self.prepared.scene.rods[0].centreline.len() - 1;
        let grip = Grip::new(arm, end, HAND, self.end());
        Ok(ChuckedRod {
            simulation: simulation.map_err(|error| error.to_string())?,
            grip: Some(grip.handed_by(HANDING_OVER).about_its_middle()),
            first_angle: angle,
            last_angle: angle,
            led_until: 0.0,
            begin: now,
        })
    }
}

/// The chuck of a cell, with its rod.
pub struct Chuck {
    supply: ChuckedSupply,
    rod: Option<ChuckedRod>,
}

impl Chuck {
    /// An empty chuck.
    pub fn new(supply: ChuckedSupply) -> Self {
        Self { supply, rod: None }
    }

    /// Index of the moving part that turns the chuck.
    pub fn part(&self) -> usize {
        self.supply.part
    }

    /// The arm that holds the rod.
    pub fn holder(&self) -> Option<usize> {
        let grip = self.rod.as_ref()?.grip.as_ref();
        grip.map(|grip| grip.holder)
    }

    /// Clamps a new rod between the chuck and the hand of an arm that holds none.
    ///
    /// # Errors
    /// A message: the hand is not at the end of the straight rod, or the rod cannot be simulated.
    pub fn take(&mut self, arm: usize, hand: &Pose, angle: f64, now: f64) -> Result<(), String> {
        if self.holder().is_none() {
            self.rod = Some(self.supply.handed(arm, hand, angle, now)?);
        }
        Ok(())
    }

    /// Releases the rod from the hand.
    ///
    /// # Errors
    /// The simulation rejects the release.
    pub fn let_go(&mut self) -> Result<(), SimulationError> {
        let Some(rod) = &mut self.rod else {
            return Ok(());
        };
        let grip = rod.grip.take();
        grip.map_or(Ok(()), |grip| rod.simulation.release(grip.clamp))
    }

    /// Advances the rod towards `now`, s, clamped by the chuck and by the hand of the arm that
    /// took it. Returns whether the simulation has reached that time.
    ///
    /// # Errors
    /// The simulation of the rod finds no step.
    pub fn lead(
        &mut self,
        hand: impl Fn(usize) -> Pose,
        angle: f64,
        now: f64,
    ) -> Result<bool, SimulationError> {
        let Some(rod) = &mut self.rod else {
            return Ok(true);
        };
        let inwards = self.supply.chuck.inverse();
        rod.advance(|arm| inwards * hand(arm), angle, now)
    }

    /// Nodes of the rod in the cell, m.
    pub fn nodes(&self) -> Option<Vec<Vector3>> {
        let nodes = self.rod.as_ref()?.simulation.positions().iter();
        let in_cell = |node: &Vector3| (self.supply.chuck * nalgebra::Point3::from(*node)).coords;
        Some(nodes.map(in_cell).collect())
    }

    /// The rod in its initial state.
    pub fn rod(&self) -> &ClampedRod {
        &self.supply.rod
    }
}

/// A rod in simulation, in the frame of the chuck.
struct ChuckedRod {
    simulation: Simulation,
    /// Grip of the hand on the rod, while it holds the rod.
    grip: Option<Grip>,
    /// Angle of the chuck when the rod was clamped, rad.
    first_angle: f64,
    /// Last angle of the chuck, rad.
    last_angle: f64,
    /// Time of the simulation up to which the motion of its clamps is set, s.
    led_until: f64,
    /// Time of the hand-over, s.
    begin: f64,
}

impl ChuckedRod {
    /// Advances towards the time `now`, s, and returns whether the simulation has reached it. A
    /// difficult step takes long. The method then returns `false`, so that the server can do other
    /// work, and must be called again with the same clamps.
    fn advance(
        &mut self,
        hand: impl Fn(usize) -> Pose,
        angle: f64,
        now: f64,
    ) -> Result<bool, SimulationError> {
        let until = now - self.begin;
        if until > self.led_until {
            let from = self.simulation.time();
            if let Some(grip) = &mut self.grip {
                let motion = grip.lead(&hand(grip.holder), [from, until]);
                self.simulation.move_clamp(grip.clamp, motion);
            }
            let motion = self.turn(from, angle, until);
            self.simulation.move_clamp(CHUCK, motion);
            (self.last_angle, self.led_until) = (angle, until);
        }
        Ok(advance_for_a_while(&mut self.simulation, until)?.has_come)
    }

    /// Rotation of the clamp from the last angle of the chuck to the next.
    fn turn(&self, from: f64, angle: f64, until: f64) -> Motion {
        let knots = [(from, self.last_angle), (until, angle)];
        let knots = knots.map(|(time, angle)| (time, angle - self.first_angle));
        Motion {
            axis: Some(Vector3::x()),
            angle: knots.into(),
            ..Motion::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells;
    use rodlab_engine::mechanics::kirchhoff::{Helix, critical_distance};
    use rodlab_lab::experiment::ClampPoses;

    /// Rods for the chuck of a cell, with the wire that comes with the program.
    fn supply() -> ChuckedSupply {
        let wire = test_cells::file("scenarios/rods/nitinol_wire.toml");
        let supply = ChuckedSupply::new(&wire, &test_cells::cell("helix_gantry"));
        supply.unwrap().unwrap()
    }

    /// Mean distance of the nodes from the helix relative to the length.
    fn error(rod: &ChuckedRod, helix: &Helix, length: f64) -> f64 {
        let nodes = rod.simulation.positions();
        let edges = (nodes.len() - 1) as f64;
        let away = nodes
            .iter()
            .enumerate()
            .map(|(k, node)| (node / length - helix.position(k as f64 / edges)).norm());
        away.sum::<f64>() / nodes.len() as f64
    }

    /// Moves a straight rod along a ray in small steps, and returns its error at each of the
    /// distances.
    fn errors_along(direction: [f64; 3], distances: &[f64]) -> Vec<f64> {
        let supply = supply();
        let rod = &supply.rod;
        let unit = Helix::from(direction);
        let unit = unit.scaled(1.0 / unit.distance());
        let hand = supply.chuck * supply.end();
        let mut led = supply.handed(0, &hand, 0.0, 0.0).unwrap();
        let (mut at, mut time) = (0.0, HANDING_OVER);
        let mut errors = Vec::new();
        for distance in distances {
            while at < *distance {
                at = (at + 0.02_f64).min(*distance);
                let clamps =
                    ClampPoses::of(&unit.scaled(at), rod.length, rod.stiffness_ratio(), 0.0);
                for _ in 0..8 {
                    time += 5e-3;
                    while !led.advance(|_| clamps.hand, clamps.chuck, time).unwrap() {}
                }
            }
            errors.push(error(&led, &unit.scaled(at), rod.length));
        }
        errors
    }

    #[test]
    fn a_rod_between_chuck_and_hand_is_a_helix_up_to_the_theoretical_limit() {
        for direction in [[1.0, 1.0, -1.0], [1.0, 0.3, 0.6]] {
            let critical = critical_distance(&Helix::from(direction)).unwrap().distance;
            let errors = errors_along(direction, &[0.9, 1.05].map(|part| part * critical));
            // The weight bends the rod slightly.
            assert!(errors[0] < 0.006, "{direction:?}: {errors:?}");
            assert!(errors[1] > 0.03, "{direction:?}: {errors:?}");
        }
    }

    #[test]
    fn a_hand_that_is_not_at_the_end_of_the_straight_rod_gets_none() {
        let supply = supply();
        let hand = supply.chuck * supply.end() * Pose::translation(0.0, 0.05, 0.0);
        let mut chuck = Chuck::new(supply);
        let words = chuck.take(0, &hand, 0.0, 0.0).unwrap_err();
        assert!(words.contains("0.050 m"), "{words}");
        assert_eq!((chuck.holder(), chuck.nodes()), (None, None));
        let straight = hand * Pose::translation(0.0, -0.05, 0.0);
        chuck.take(0, &straight, 0.0, 0.0).unwrap();
        assert_eq!(chuck.holder(), Some(0));
        chuck.let_go().unwrap();
        assert_eq!(chuck.holder(), None);
    }
}
