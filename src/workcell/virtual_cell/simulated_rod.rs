//! A rod in simulation, or two that touch each other: moved by the grippers that hold it, or
//! released.

use super::grip::{Grip, within_reach};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::mechanics::system::Grasp;
use rodlab_robot::Pose;
use std::time::{Duration, Instant};

/// Duration of the hand-over of a rod into the fingers, s.
pub const HANDING_OVER: f64 = 1.0;
/// A rod rests if every node is slower than this, m/s.
const REST: f64 = 1e-4;
/// Time for which a held rod and its hands must be still before the simulation waits for the
/// hands, s.
const STILL: f64 = 1.0;
/// Longest time for which the simulation runs without a pause for the server.
const AT_A_TIME: Duration = Duration::from_millis(20);
/// Largest number of steps for the simulation of a fall. A heap of rod is difficult to simulate,
/// and the rod along the pattern already lies.
const LONGEST_FALL: usize = 4000;
/// Height of a rod's end, in radii, at which the table stops the hand.
const FLOOR: f64 = 1.05;

/// Initial state of a rod that a gripper holds by its end.
pub struct Placed {
    /// Frame of the simulation in the cell.
    pub frame: Pose,
    /// Pose of the held end in that frame; clamp 0 of the scene holds it.
    pub end: Pose,
    /// Radius of the rod, m.
    pub radius: f64,
}

/// A rod that was handed to an arm.
#[derive(Clone, Copy, Debug)]
pub struct HandedRod {
    /// The arm.
    pub arm: usize,
    /// Number of its supply.
    pub supply: usize,
    /// Number of nodes of the rod.
    pub nodes: usize,
    /// Radius of the rod, m.
    pub radius: f64,
}

/// A rod in simulation, or two that touch each other.
pub struct SimulatedRod {
    simulation: Simulation,
    /// The frame of the simulation in the cell.
    frame: Pose,
    /// The grippers that hold the rod, in the order in which they took hold.
    grips: Vec<Grip>,
    /// Time of the simulation up to which the motion of the hands is set, s.
    led_until: f64,
    /// Time at which the simulation started, s.
    begin: f64,
    /// The rods, in the order of their nodes.
    rods: Vec<HandedRod>,
    /// Time of the release, s of the simulation.
    released: f64,
    /// Number of steps of the simulation since the release.
    falling: usize,
    /// Time since which rod and hands are still, s of the simulation.
    still_since: f64,
    rests: bool,
}

impl SimulatedRod {
    /// A rod whose end is held by clamp 0 of its scene from the time `now`, s.
    pub fn held(simulation: Simulation, placed: Placed, now: f64) -> Self {
        let rod = HandedRod {
            arm: 0,
            supply: 0,
            nodes: simulation.positions().len(),
            radius: placed.radius,
        };
        Self::held_by(simulation, &placed, &[rod], now)
    }

    /// Rods on a table, z = 0 in the frame of the simulation, which stops hands. Clamp 0 of the
    /// scene holds the end of the last rod, which is handed to its arm at the time `now`, s.
    pub fn handed(simulation: Simulation, placed: Placed, rods: &[HandedRod], now: f64) -> Self {
        let floor = FLOOR * placed.radius;
        let mut handed = Self::held_by(simulation, &placed, rods, now);
        let grips = handed.grips.into_iter();
        handed.grips = grips.map(|grip| grip.stopped_at(floor)).collect();
        handed
    }

    /// Rods that hands hold, without a table.
    pub(super) fn held_by(
        simulation: Simulation,
        placed: &Placed,
        rods: &[HandedRod],
        now: f64,
    ) -> Self {
        let end = rods.iter().map(|rod| rod.nodes).sum::<usize>() - 1;
        let arm = rods[rods.len() - 1].arm;
        let grip = Grip::new(arm, end, 0, placed.end).handed_by(HANDING_OVER);
        Self {
            simulation,
            frame: placed.frame,
            grips: vec![grip],
            led_until: 0.0,
            begin: now,
            rods: rods.to_vec(),
            released: 0.0,
            falling: 0,
            still_since: 0.0,
            rests: false,
        }
    }

    /// A gripper takes the end again at its current place at the time `now`, s. `end` is the pose
    /// in the frame of the simulation.
    ///
    /// # Errors
    /// The simulation rejects the grip.
    pub fn take_again(&mut self, node: usize, end: Pose, now: f64) -> Result<(), SimulationError> {
        let clamp = self.clamped(node, now)?;
        self.grips.push(Grip::new(0, node, clamp, end));
        Ok(())
    }

    /// The node that a hand in the cell reaches: the nearest one in plan view within 1.5 cm, if
    /// the hand is at its height and no gripper holds the rod there.
    pub fn within_reach(&self, hand: &Pose) -> Option<usize> {
        let hand = self.frame.inverse() * hand;
        within_reach(&hand.translation.vector, self.positions(), &self.grips)
    }

    /// The gripper of an arm takes hold of a node at the time `now`, s. From then on the node
    /// moves with the hand, but is not pressed into the table.
    ///
    /// # Errors
    /// The simulation rejects the clamp.
    pub fn take(
        &mut self,
        arm: usize,
        node: usize,
        hand: &Pose,
        now: f64,
    ) -> Result<(), SimulationError> {
        let clamp = self.clamped(node, now)?;
        let hand = self.frame.inverse() * hand;
        let lowest = hand.translation.z;
        self.grips
            .push(Grip::new(arm, node, clamp, hand).stopped_at(lowest));
        Ok(())
    }

    /// A new clamp of a node at the time `now`, s. The simulation of a lying rod resumes there.
    fn clamped(&mut self, node: usize, now: f64) -> Result<usize, SimulationError> {
        let grasp = Grasp {
            position: true,
            frame: true,
        };
        let clamp = self.simulation.grasp(node, grasp)?;
        if self.grips.is_empty() {
            self.led_until = self.simulation.time();
            self.begin = now - self.simulation.time();
            self.falling = 0;
        }
        self.wake();
        Ok(clamp)
    }

    /// Advances towards the time `now`, s, with the held part in the hand. Returns whether the
    /// simulation has reached that time. A difficult step takes long. The method then returns
    /// `false`, so that the server can do other work, and must be called again with the same hand.
    ///
    /// While a held rod and its hands are still, the simulation waits. Sticking contacts of the
    /// engine creep below the slip tolerance (0.2 µm/s for a folded sheet), and a cell at a high
    /// rate passes hundreds of seconds while its client looks and plans.
    ///
    /// # Errors
    /// No step is found, or the rod tears, while it is held. A released rod is frozen instead.
    pub fn advance(&mut self, hand: &Pose, now: f64) -> Result<bool, SimulationError> {
        self.advance_in(|_| *hand, now)
    }

    /// As [`Self::advance`], with the hand of each arm that holds the rod.
    ///
    /// # Errors
    /// Errors of [`Self::advance`].
    pub fn advance_in(
        &mut self,
        hand: impl Fn(usize) -> Pose,
        now: f64,
    ) -> Result<bool, SimulationError> {
        let until = now - self.begin;
        let inwards = self.frame.inverse();
        if self.rests {
            let mut grips = self.grips.iter_mut();
            if !grips.any(|grip| grip.moves(&(inwards * hand(grip.holder)), until)) {
                self.begin = now - self.simulation.time();
                return Ok(true);
            }
            self.wake();
        }
        if self.is_held() && until > self.led_until {
            let times = [self.simulation.time(), until];
            for grip in &mut self.grips {
                let hand = inwards * hand(grip.holder);
                if grip.moves(&hand, until) {
                    self.still_since = until;
                }
                let motion = grip.lead(&hand, times);
                self.simulation.move_clamp(grip.clamp, motion);
            }
            self.led_until = until;
        }
        match advance_for_a_while(&mut self.simulation, until) {
            Ok(advanced) => {
                self.settled(advanced.steps);
                Ok(advanced.has_come || self.rests)
            }
            Err(error) => self.given_up(error).map(|()| true),
        }
    }

    /// Continues the simulation.
    fn wake(&mut self) {
        self.still_since = self.simulation.time();
        self.rests = false;
    }

    /// Sets whether the rod is at rest after a number of steps. A fall that takes too long to
    /// simulate is ended.
    fn settled(&mut self, steps: usize) {
        let velocities = self.simulation.velocities().iter();
        let fastest = velocities.map(|v| v.norm()).fold(0.0, f64::max);
        let time = self.simulation.time();
        if self.is_held() {
            if fastest >= REST {
                self.still_since = time;
            }
            self.rests = time - self.still_since >= STILL;
            return;
        }
        // A rod that was held still has no velocity until its first step.
        if time <= self.released {
            return;
        }
        self.falling += steps;
        self.rests = fastest < REST;
        if !self.rests && self.falling > LONGEST_FALL {
            tracing::warn!(
                "the released rod takes long to simulate and is frozen; its fastest node moves at {fastest:.3} m/s"
            );
            self.rests = true;
        }
    }

    /// Freezes a released rod after its simulation failed.
    fn given_up(&mut self, error: SimulationError) -> Result<(), SimulationError> {
        if self.is_held() {
            return Err(error);
        }
        tracing::warn!("the released rod is frozen: {error}");
        self.rests = true;
        Ok(())
    }

    /// Opens all grippers.
    ///
    /// # Errors
    /// The simulation rejects the release.
    pub fn release(&mut self) -> Result<(), SimulationError> {
        self.open(|_| true)
    }

    /// Opens the gripper of an arm, if it holds the rod.
    ///
    /// # Errors
    /// The simulation rejects the release.
    pub fn release_by(&mut self, arm: usize) -> Result<(), SimulationError> {
        self.open(|grip| grip.holder == arm)
    }

    fn open(&mut self, opens: impl Fn(&Grip) -> bool) -> Result<(), SimulationError> {
        let opened: Vec<Grip> = self.grips.extract_if(.., |grip| opens(grip)).collect();
        for grip in opened {
            self.released = self.simulation.time();
            self.wake();
            self.simulation.release(grip.clamp)?;
        }
        Ok(())
    }

    /// Whether a gripper holds the rod.
    pub fn is_held(&self) -> bool {
        !self.grips.is_empty()
    }

    /// Whether the gripper of an arm holds the rod.
    pub fn is_held_by(&self, arm: usize) -> bool {
        self.grips.iter().any(|grip| grip.holder == arm)
    }

    /// The arms whose grippers hold the rod, in the order in which they took hold.
    pub fn holders(&self) -> impl DoubleEndedIterator<Item = usize> {
        self.grips.iter().map(|grip| grip.holder)
    }

    /// Multiplies a load of the scene by a factor, see [`Simulation::set_load_factor`].
    ///
    /// # Errors
    /// The load does not exist.
    pub fn set_load(&mut self, load: usize, factor: f64) -> Result<(), SimulationError> {
        self.simulation.set_load_factor(load, factor)
    }

    /// Nodes of the rods in the frame of the simulation, m, without those of pegs.
    pub fn positions(&self) -> &[Vector3] {
        let nodes = self.rods.iter().map(|rod| rod.nodes).sum();
        &self.simulation.positions()[..nodes]
    }

    /// Nodes of the rods in the cell, m.
    pub fn nodes(&self) -> Vec<Vector3> {
        let nodes = self.positions().iter();
        nodes
            .map(|node| (self.frame * nalgebra::Point3::from(*node)).coords)
            .collect()
    }

    /// Nodes in the cell, m, and radius, m, of each rod.
    pub fn seen(&self) -> Vec<(Vec<Vector3>, f64)> {
        let mut nodes = self.nodes();
        let rods = self.rods.iter();
        rods.map(|rod| (nodes.drain(..rod.nodes).collect(), rod.radius))
            .collect()
    }

    /// The rods, in the order of their nodes.
    pub fn rods(&self) -> &[HandedRod] {
        &self.rods
    }

    /// The frame of the simulation in the cell.
    pub fn frame(&self) -> Pose {
        self.frame
    }
}

/// Progress of a simulation towards a time.
pub(super) struct Advanced {
    /// Whether it has reached that time.
    pub has_come: bool,
    /// Number of steps.
    pub steps: usize,
}

/// Advances a simulation towards a time, s, for at most `AT_A_TIME`.
pub(super) fn advance_for_a_while(
    simulation: &mut Simulation,
    until: f64,
) -> Result<Advanced, SimulationError> {
    let work = Instant::now();
    let mut steps = 0;
    while simulation.time() < until && work.elapsed() <= AT_A_TIME {
        simulation.advance(until)?;
        steps += 1;
    }
    Ok(Advanced {
        has_come: simulation.time() >= until,
        steps,
    })
}
