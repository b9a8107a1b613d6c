//! The rod of a virtual cell: handed to a gripper, laid down on the table, let go.

use super::grip::{Grip, within_reach};
use crate::experiment::{self, DeploymentTables};
use crate::mechanics::dynamics::{Simulation, SimulationError};
use crate::mechanics::scene::Motion;
use crate::mechanics::system::Grasp;
use crate::mechanics::{UnitQuaternion, Vector3};
use crate::plan::deployment::{DeployedRod, OptimalGrasps, Scheme, trajectory};
use crate::plan::pattern::{Line, PatternSource};
use crate::robot::{Pose, distance_and_angle};
use crate::run::PreparedRun;
use crate::scenario::ScenarioError;
use nalgebra::Translation3;
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time in which a rod that is handed over comes into the fingers, s.
pub const HANDING_OVER: f64 = 1.0;
/// How far the hand may be from where the rod hangs by itself, in gravito-bending lengths, and how far turned, rad: a person
/// bends it by so much.
const REACH: [f64; 2] = [2.0, 0.6];
/// Least part of the hand's y axis that must be level for the rod to have a direction on the table.
const LEVEL: f64 = 0.5;
/// Speed of every node below which a rod that was let go rests, m/s.
const REST: f64 = 1e-4;
/// Longest time of simulation without a look at anything else.
const AT_A_TIME: Duration = Duration::from_millis(20);
/// Longest time for the simulation of a fall: a heap of rod is hard, and the rod along the pattern lies already.
const LONGEST_FALL: Duration = Duration::from_secs(2);
/// Height of a rod's end at which the table stops the hand that leads it, in radii.
const FLOOR: f64 = 1.05;
/// Length of the line on which a rod begins, over that of the rod.
const FIRST_LINE: f64 = 0.05;

/// Rods of one kind, one after the other, for grippers to take.
pub struct RodSupply {
    prepared: PreparedRun,
    rod: DeployedRod,
    /// Where the end hangs of a rod whose free end lies at the origin, along x.
    end: Pose,
    /// Where in the cell a person lays the free end, m; else where the rod hangs by itself.
    free_end: Option<[f64; 2]>,
}

/// Why there are no rods.
#[derive(Debug, thiserror::Error)]
pub enum RodError {
    /// The file is faulty.
    #[error(transparent)]
    File(#[from] Box<ScenarioError>),
    /// The rod cannot hang.
    #[error("the rod cannot hang from a gripper: {0}")]
    Impossible(String),
}

impl RodSupply {
    /// Rods as a file describes them in `[deployment.rod]`, on a table of some friction.
    ///
    /// # Errors
    /// The file cannot be read, or is wrong.
    pub fn new(file: &Path, friction: f64) -> Result<Self, RodError> {
        let impossible = |error: String| RodError::Impossible(error);
        let whole = std::path::absolute(file).map_err(|error| impossible(error.to_string()))?;
        let extended = toml::Value::from(whole.to_string_lossy().as_ref()).to_string();
        let text = |length: f64| {
            format!(
                "extends = {extended}\nexperiment = \"deployment\"\n\
                 [deployment]\npattern = {{ kind = \"line\", length = {length:?} }}\nlead_in = 0.0\n\
                 [contact]\nfriction = {friction:?}\ndistance_tolerance = \"50 µm\"\nslip_tolerance = \"0.01 mm/s\"\n\
                 [time]\nstep = \"5 ms\"\nend = 10.0\n"
            )
        };
        let load = |length: f64| {
            let loaded = experiment::from_text("rod", &text(length), Path::new(""), &[]);
            loaded.map_err(Box::new)
        };
        // Any short line will do; how short, the rod says.
        let first = load(1e-3)?;
        let tables: Option<&DeploymentTables> = first.scenario.experiment.tables();
        let tables = tables.expect("the tables of a deployment");
        let rod = tables.deployment.rod.deployed();
        let loaded = load(FIRST_LINE * rod.length)?;
        let prepared = experiment::prepare(&loaded.scenario);
        let prepared = prepared.map_err(|issues| Box::new(loaded.locate(issues)))?;
        let line = Line {
            length: FIRST_LINE * rod.length,
        };
        let start = PatternSource::Line(line).pattern();
        let start = start
            .map_err(|error| impossible(error.to_string()))?
            .at(0.0);
        let poses = trajectory(&[start], &rod, Scheme::Optimal, OptimalGrasps::Exact);
        let poses = poses.map_err(|error| impossible(error.to_string()))?;
        let end = Pose::from_parts(Translation3::from(poses[0].position), poses[0].rotation);
        Ok(Self {
            prepared,
            rod,
            end,
            free_end: None,
        })
    }

    /// Rods whose free end a person lays at a place in the cell, m.
    pub fn with_free_end(mut self, place: [f64; 2]) -> Self {
        self.free_end = Some(place);
        self
    }

    /// The rod by what matters for laying it.
    pub fn rod(&self) -> &DeployedRod {
        &self.rod
    }

    /// A rod whose end is handed to the gripper of an arm, at the time `now`, s. `hand` and the top of the `table` are poses in the cell.
    /// Its free end lies on the table, in the direction in which the gripper holds it, so that it hangs by itself, or at the place of
    /// [`RodSupply::with_free_end`].
    ///
    /// # Errors
    /// In words: no rod of this length hangs there, or it cannot be simulated.
    pub fn handed(
        &self,
        arm: usize,
        hand: &Pose,
        table: &Pose,
        now: f64,
    ) -> Result<SimulatedRod, String> {
        let frame = self.frame(hand, table)?;
        let simulation = Simulation::new(&self.prepared.scene, &self.prepared.integration);
        let simulation = simulation.map_err(|error| error.to_string())?;
        let placed = Placed {
            frame: table * frame,
            end: self.end,
            radius: self.rod.radius,
        };
        let rod = SimulatedRod::held_by(arm, simulation, placed, now);
        Ok(rod.stopped_by_table(self.rod.radius))
    }

    /// The frame, on the table, of the simulation of a rod that hangs from a hand.
    fn frame(&self, hand: &Pose, table: &Pose) -> Result<Pose, String> {
        let held = table.inverse() * hand;
        let across = held.rotation * Vector3::y();
        if libm::hypot(across.x, across.y) < LEVEL {
            return Err(
                "the y axis of the hand is not level: a rod that it held would hang in no direction"
                    .into(),
            );
        }
        let heading = libm::atan2(-across.x, across.y);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
        let end = turn * self.end.translation.vector;
        let place = match self.free_end {
            Some([x, y]) => (table.inverse() * nalgebra::Point3::new(x, y, 0.0)).coords,
            None => held.translation.vector - end,
        };
        let frame = Pose::from_parts(Translation3::new(place.x, place.y, 0.0), turn);
        let held = frame.inverse() * held;
        let (distance, angle) = distance_and_angle(&self.end, &held);
        let [most_lengths, most_angle] = REACH;
        let most = most_lengths * self.rod.gravito_bending_length;
        if !(distance <= most && angle <= most_angle) {
            return Err(format!(
                "a rod of {:.3} m hangs with its end {:.3} m above the table; the hand is {distance:.3} m and {angle:.2} rad away \
                 from there; allowed: {most:.3} m and {most_angle} rad",
                self.rod.length, self.end.translation.z
            ));
        }
        Ok(frame)
    }

    /// The same beside a rod, of another kind, that lies there and that nobody holds.
    ///
    /// # Errors
    /// As [`Self::handed`].
    pub fn handed_beside(
        &self,
        (lying, kind): (&SimulatedRod, &Self),
        arm: usize,
        hand: &Pose,
        table: &Pose,
        now: f64,
    ) -> Result<SimulatedRod, String> {
        let moved = lying.frame.inverse() * table * self.frame(hand, table)?;
        let mut scene = self.prepared.scene.clone();
        let mut first = kind.prepared.scene.rods[0].clone();
        first.name = "lying".into();
        first.centreline = lying.simulation.positions()[lying.pieces[0].nodes.clone()].to_vec();
        first.end_tangents = [None; 2];
        let new = &mut scene.rods[0];
        for node in &mut new.centreline {
            *node = (moved * nalgebra::Point3::from(*node)).coords;
        }
        for tangent in new.end_tangents.iter_mut().flatten() {
            *tangent = moved.rotation * *tangent;
        }
        let pieces = Piece::beside_each_other([
            (lying.pieces[0].arm, first.centreline.len(), first.radius),
            (arm, new.centreline.len(), new.radius),
        ]);
        scene.rods.insert(0, first);
        for clamp in &mut scene.clamps {
            clamp.rod += 1;
            clamp.motion = Motion::default();
        }
        let simulation = Simulation::new(&scene, &self.prepared.integration);
        let simulation = simulation.map_err(|error| error.to_string())?;
        let placed = Placed {
            frame: lying.frame,
            end: moved * self.end,
            radius: self.rod.radius,
        };
        let end = pieces[1].nodes.end - 1;
        let mut rods = SimulatedRod::held_by(arm, simulation, placed, now);
        rods.pieces = pieces;
        rods.grips = vec![Grip::new(arm, end, 0, moved * self.end).handed_by(HANDING_OVER)];
        Ok(rods.stopped_by_table(self.rod.radius))
    }
}

/// Where a rod begins that a gripper holds by its end.
pub struct Placed {
    /// The frame of its simulation in the cell.
    pub frame: Pose,
    /// Its end in that frame, which clamp 0 of the scene holds.
    pub end: Pose,
    /// Its radius, m.
    pub radius: f64,
}

/// A rod of those in a simulation.
struct Piece {
    /// The arm to which it was handed.
    arm: usize,
    nodes: Range<usize>,
    /// Its radius, m.
    radius: f64,
}

impl Piece {
    /// Rods by their arms, numbers of nodes and radii, m.
    fn beside_each_other<const N: usize>(rods: [(usize, usize, f64); N]) -> Vec<Self> {
        let mut begin = 0;
        let pieces = rods.map(|(arm, count, radius)| {
            let nodes = begin..begin + count;
            begin = nodes.end;
            Self { arm, nodes, radius }
        });
        pieces.into()
    }
}

/// A rod in simulation, or two that touch each other.
pub struct SimulatedRod {
    simulation: Simulation,
    /// The frame of the simulation in the cell.
    frame: Pose,
    /// The grippers that hold it, in the order in which they took hold.
    grips: Vec<Grip>,
    /// Until when their hands lead it, s of the simulation.
    led_until: f64,
    /// When the simulation began, s.
    begin: f64,
    /// Which of its nodes are which rod.
    pieces: Vec<Piece>,
    /// Time that its fall has taken to simulate.
    falling: Duration,
    rests: bool,
}

impl SimulatedRod {
    /// A rod whose end is held by clamp 0 of its scene, from the time `now`, s, on.
    pub fn held(simulation: Simulation, placed: Placed, now: f64) -> Self {
        Self::held_by(0, simulation, placed, now)
    }

    /// The same, where it is the gripper of an arm that holds it.
    fn held_by(arm: usize, simulation: Simulation, placed: Placed, now: f64) -> Self {
        let end = simulation.positions().len() - 1;
        let grip = Grip::new(arm, end, 0, placed.end).handed_by(HANDING_OVER);
        Self {
            simulation,
            frame: placed.frame,
            grips: vec![grip],
            led_until: 0.0,
            begin: now,
            pieces: Piece::beside_each_other([(arm, end + 1, placed.radius)]),
            falling: Duration::ZERO,
            rests: false,
        }
    }

    /// The same on a table, z = 0 in the frame of the simulation, which stops hands that lead an end of some radius, m.
    fn stopped_by_table(mut self, radius: f64) -> Self {
        let floor = FLOOR * radius;
        let grips = self.grips.into_iter();
        self.grips = grips.map(|grip| grip.stopped_at(floor)).collect();
        self
    }

    /// A gripper takes the end again where it is, at `end` in the frame of the simulation, at the time `now`, s.
    ///
    /// # Errors
    /// The simulation refuses.
    pub fn take_again(&mut self, node: usize, end: Pose, now: f64) -> Result<(), SimulationError> {
        let clamp = self.clamped(node, now)?;
        self.grips.push(Grip::new(0, node, clamp, end));
        Ok(())
    }

    /// The node that a hand in the cell reaches: the nearest within 1.5 cm seen from above, if the hand is as low as it, and nobody
    /// holds the rod there.
    pub fn within_reach(&self, hand: &Pose) -> Option<usize> {
        let hand = self.frame.inverse() * hand;
        let nodes = self.simulation.positions();
        within_reach(&hand.translation.vector, nodes, &self.grips)
    }

    /// The gripper of an arm, whose hand is somewhere in the cell, takes hold of a node at the time `now`, s. From then on the node
    /// moves with the hand, which does not press it into what lies under it.
    ///
    /// # Errors
    /// The simulation refuses.
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

    /// A new clamp of a node at the time `now`, s. A rod that lay goes on from there.
    fn clamped(&mut self, node: usize, now: f64) -> Result<usize, SimulationError> {
        let grasp = Grasp {
            position: true,
            frame: true,
        };
        let clamp = self.simulation.grasp(node, grasp)?;
        if self.grips.is_empty() {
            self.led_until = self.simulation.time();
            self.begin = now - self.simulation.time();
            self.falling = Duration::ZERO;
            self.rests = false;
        }
        Ok(clamp)
    }

    /// Moves on towards the time `now`, s, what is held of it in the hand; whether it has come there. Hard steps take long: then it
    /// must be called again, with the same hand, so that others need not wait.
    ///
    /// # Errors
    /// No step is found, or the rod is torn, while it is held. One that was let go stays as it is then.
    pub fn advance(&mut self, hand: &Pose, now: f64) -> Result<bool, SimulationError> {
        self.advance_in(|_| *hand, now)
    }

    /// The same with the hand of each arm that holds it.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_in(
        &mut self,
        hand: impl Fn(usize) -> Pose,
        now: f64,
    ) -> Result<bool, SimulationError> {
        let until = now - self.begin;
        if self.rests {
            return Ok(true);
        }
        if self.is_held() && until > self.led_until {
            let times = [self.simulation.time(), until];
            for grip in &mut self.grips {
                let hand = self.frame.inverse() * hand(grip.holder);
                let motion = grip.lead(&hand, times);
                self.simulation.move_clamp(grip.clamp, motion);
            }
            self.led_until = until;
        }
        let work = Instant::now();
        while self.simulation.time() < until {
            if work.elapsed() > AT_A_TIME {
                self.settled(work);
                return Ok(self.rests);
            }
            if let Err(error) = self.simulation.advance(until) {
                return self.given_up(error).map(|()| true);
            }
        }
        self.settled(work);
        Ok(true)
    }

    /// Notes whether a rod that was let go rests, or falls in a way that takes too long to simulate.
    fn settled(&mut self, work: Instant) {
        if self.is_held() {
            return;
        }
        let velocities = self.simulation.velocities().iter();
        let fastest = velocities.map(|v| v.norm()).fold(0.0, f64::max);
        self.falling += work.elapsed();
        self.rests = fastest < REST;
        if !self.rests && self.falling > LONGEST_FALL {
            tracing::warn!(
                "the rod that was let go takes long to simulate: it stays as it is, its fastest node at {fastest:.3} m/s"
            );
            self.rests = true;
        }
    }

    /// A rod that was let go stays as it is where no step is found.
    fn given_up(&mut self, error: SimulationError) -> Result<(), SimulationError> {
        if self.is_held() {
            return Err(error);
        }
        tracing::warn!("the rod that was let go stays as it is: {error}");
        self.rests = true;
        Ok(())
    }

    /// All grippers let go.
    ///
    /// # Errors
    /// The simulation refuses.
    pub fn release(&mut self) -> Result<(), SimulationError> {
        for grip in self.grips.drain(..) {
            self.simulation.release(grip.clamp)?;
        }
        Ok(())
    }

    /// The gripper of an arm lets go, if it holds the rod.
    ///
    /// # Errors
    /// The simulation refuses.
    pub fn release_by(&mut self, arm: usize) -> Result<(), SimulationError> {
        for grip in self.grips.extract_if(.., |grip| grip.holder == arm) {
            self.simulation.release(grip.clamp)?;
        }
        Ok(())
    }

    /// Whether a gripper holds it.
    pub fn is_held(&self) -> bool {
        !self.grips.is_empty()
    }

    /// The arms whose grippers hold it, in the order in which they took hold.
    pub fn holders(&self) -> impl DoubleEndedIterator<Item = usize> {
        self.grips.iter().map(|grip| grip.holder)
    }

    /// Multiplies a load of its scene by a factor, see [`Simulation::set_load_factor`].
    ///
    /// # Errors
    /// There is no such load.
    pub fn set_load(&mut self, load: usize, factor: f64) -> Result<(), SimulationError> {
        self.simulation.set_load_factor(load, factor)
    }

    /// Its nodes in the frame of its simulation, m.
    pub fn positions(&self) -> &[Vector3] {
        self.simulation.positions()
    }

    /// Its nodes in the cell, m.
    pub fn nodes(&self) -> Vec<Vector3> {
        let nodes = self.simulation.positions().iter();
        nodes
            .map(|node| (self.frame * nalgebra::Point3::from(*node)).coords)
            .collect()
    }

    /// Nodes in the cell, m, and radius, m, of each rod.
    pub fn seen(&self) -> Vec<(Vec<Vector3>, f64)> {
        let nodes = self.nodes();
        let pieces = self.pieces.iter();
        pieces
            .map(|piece| (nodes[piece.nodes.clone()].to_vec(), piece.radius))
            .collect()
    }

    /// The only rod's arm, to which it was handed; `None` where there are two.
    pub fn only_arm(&self) -> Option<usize> {
        match self.pieces.as_slice() {
            [only] => Some(only.arm),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::short_rod;
    use super::*;

    fn table() -> Pose {
        Pose::translation(0.3, -0.1, 0.05)
    }

    /// Where a hand takes a rod whose free end lies somewhere on the table.
    fn hand(supply: &RodSupply, heading: f64) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
        table() * Pose::from_parts(Translation3::new(0.1, 0.2, 0.0), turn) * supply.end
    }

    #[test]
    fn a_rod_that_is_handed_over_hangs_where_it_was_until_it_is_moved() {
        let (_folder, file) = short_rod();
        let supply = RodSupply::new(&file, 0.4).unwrap();
        let hand = hand(&supply, 0.7);
        let mut rod = supply.handed(0, &hand, &table(), 3.0).unwrap();
        let first = rod.nodes();
        assert!((first[first.len() - 1] - hand.translation.vector).norm() < 1e-6);
        let free = table() * nalgebra::Point3::new(0.1, 0.2, supply.rod().radius);
        assert!((first[0] - free.coords).norm() < 1e-9);
        for step in 1..=60 {
            while !rod.advance(&hand, 3.0 + 5e-3 * f64::from(step)).unwrap() {}
        }
        let nodes = rod.nodes();
        let moved = nodes.iter().zip(&first).map(|(a, b)| (a - b).norm());
        assert!(moved.fold(0.0, f64::max) < 0.02 * supply.rod().gravito_bending_length);
    }

    #[test]
    fn a_free_end_lies_where_a_person_lays_it() {
        let (_folder, file) = short_rod();
        let supply = RodSupply::new(&file, 0.4).unwrap();
        let hand = hand(&supply, 0.0);
        let supply = supply.with_free_end([0.395, 0.104]);
        let rod = supply.handed(0, &hand, &table(), 0.0).unwrap();
        let expected = Vector3::new(0.395, 0.104, 0.05 + supply.rod().radius);
        assert!((rod.nodes()[0] - expected).norm() < 1e-9);
        // Too far from the hand for that.
        let far = supply
            .with_free_end([0.1, 0.1])
            .handed(0, &hand, &table(), 0.0);
        assert!(far.is_err());
    }

    #[test]
    fn a_rod_that_is_let_go_falls_on_the_table() {
        let (_folder, file) = short_rod();
        let supply = RodSupply::new(&file, 0.4).unwrap();
        let hand = hand(&supply, 0.0);
        let mut rod = supply.handed(0, &hand, &table(), 0.0).unwrap();
        rod.release().unwrap();
        for step in 1..=300 {
            while !rod.advance(&hand, 5e-3 * f64::from(step)).unwrap() {}
        }
        let top = rod.nodes().iter().map(|node| node.z).fold(0.0, f64::max);
        assert!(top - 0.05 < 0.3 * supply.rod().length, "{top}");
        assert!(!rod.is_held());
    }

    #[test]
    fn two_hands_on_one_rod_lead_what_each_holds() {
        let (_folder, file) = short_rod();
        let supply = RodSupply::new(&file, 0.4).unwrap();
        let first = hand(&supply, 0.7);
        let mut rod = supply.handed(0, &first, &table(), 0.0).unwrap();
        while !rod.advance(&first, 5e-3).unwrap() {}
        let free = rod.nodes()[0];
        // A little beside the free end, and turned in some way.
        let second = Pose::from_parts(
            Translation3::from(free + Vector3::new(4e-3, -3e-3, 2e-3)),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.4),
        );
        let node = rod.within_reach(&second).unwrap();
        assert_eq!(node, 0);
        let mut hands = [first, second];
        let lead = |rod: &mut SimulatedRod, hands: &[Pose; 2], step: i32| {
            while !rod
                .advance_in(|arm| hands[arm], 5e-3 * f64::from(step))
                .unwrap()
            {}
        };
        rod.take(1, node, &second, 5e-3).unwrap();
        assert_eq!(rod.holders().collect::<Vec<_>>(), [0, 1]);
        for step in 2..=240 {
            let part = f64::from(step) / 240.0;
            hands[0] = Translation3::new(0.0, 0.0, -0.02 * part) * first;
            hands[1] = Translation3::new(0.0, 0.01 * part, 0.03 * part) * second;
            lead(&mut rod, &hands, step);
        }
        let nodes = rod.nodes();
        let end = nodes[nodes.len() - 1];
        assert!((end - hands[0].translation.vector).norm() < 1e-6, "{end}");
        let led = nodes[0] - free;
        assert!((led - Vector3::new(0.0, 0.01, 0.03)).norm() < 1e-6, "{led}");
        // One that goes down to the table is stopped where the rod lay; one that lets go loses its end only.
        for step in 241..=340 {
            let down = f64::from(step - 240) / 100.0;
            hands[1] = Translation3::new(0.0, 0.01, 0.03 - 0.05 * down) * second;
            lead(&mut rod, &hands, step);
        }
        let height = rod.nodes()[0].z - free.z;
        assert!(height.abs() < 1e-6, "{height}");
        rod.release_by(1).unwrap();
        assert_eq!(rod.holders().collect::<Vec<_>>(), [0]);
        hands[0] = Translation3::new(0.0, 0.0, -0.03) * first;
        lead(&mut rod, &hands, 400);
        let end = rod.nodes()[nodes.len() - 1];
        assert!((end - hands[0].translation.vector).norm() < 1e-6, "{end}");
    }

    #[test]
    fn a_hand_beyond_reach_takes_nothing() {
        let (_folder, file) = short_rod();
        let supply = RodSupply::new(&file, 0.4).unwrap();
        let hand = hand(&supply, 0.0);
        let mut rod = supply.handed(0, &hand, &table(), 0.0).unwrap();
        let free = rod.nodes()[0];
        let at = |x: f64, y: f64, z: f64| {
            Pose::from_parts(
                Translation3::from(free + Vector3::new(x, y, z)),
                UnitQuaternion::identity(),
            )
        };
        assert_eq!(rod.within_reach(&at(0.0, 0.014, 0.0)), Some(0));
        assert_eq!(rod.within_reach(&at(0.0, 0.016, 0.0)), None);
        assert_eq!(rod.within_reach(&at(0.0, 0.0, 0.016)), None);
        // A gripper holds the end already.
        assert_eq!(rod.within_reach(&hand), None);
        rod.take(1, 0, &at(0.0, 0.0, 0.0), 0.0).unwrap();
        assert_eq!(rod.within_reach(&at(0.0, 0.0, 0.0)), None);
    }

    #[test]
    fn a_second_rod_is_handed_beside_one_that_lies() {
        let (_folder, file) = short_rod();
        let supply = RodSupply::new(&file, 0.4).unwrap();
        let first = hand(&supply, 0.7);
        let mut rod = supply.handed(0, &first, &table(), 0.0).unwrap();
        rod.release().unwrap();
        for step in 1..=300 {
            while !rod.advance(&first, 5e-3 * f64::from(step)).unwrap() {}
        }
        let lay = rod.nodes();
        let second = Pose::translation(0.0, 0.2, 0.0) * hand(&supply, -0.4);
        let both = supply.handed_beside((&rod, &supply), 1, &second, &table(), 1.5);
        let mut both = both.unwrap();
        let seen = both.seen();
        assert_eq!(seen.len(), 2);
        assert!(
            seen[0]
                .0
                .iter()
                .zip(&lay)
                .all(|(a, b)| (a - b).norm() < 1e-9)
        );
        let end = seen[1].0[30];
        assert!((end - second.translation.vector).norm() < 1e-6, "{end}");
        // The one lies, and the other follows its hand.
        let lifted = Translation3::new(0.0, 0.0, 0.05) * second;
        for step in 1..=100 {
            let part = f64::from(step) / 100.0;
            let hand = Translation3::new(0.0, 0.0, 0.05 * part) * second;
            while !both
                .advance_in(|_| hand, 1.5 + 5e-3 * f64::from(step))
                .unwrap()
            {}
        }
        for step in 101..=240 {
            while !both
                .advance_in(|_| lifted, 1.5 + 5e-3 * f64::from(step))
                .unwrap()
            {}
        }
        let seen = both.seen();
        let moved = seen[0].0.iter().zip(&lay).map(|(a, b)| (a - b).norm());
        assert!(moved.fold(0.0, f64::max) < 1e-3);
        let end = seen[1].0[30];
        assert!((end - lifted.translation.vector).norm() < 1e-6, "{end}");
    }

    #[test]
    fn a_hand_that_cannot_hold_a_hanging_rod_is_told_so() {
        let (_folder, file) = short_rod();
        let supply = RodSupply::new(&file, 0.4).unwrap();
        let far = Pose::translation(0.0, 0.0, 0.3) * hand(&supply, 0.0);
        let Err(words) = supply.handed(0, &far, &table(), 0.0) else {
            panic!("it is too high");
        };
        assert!(words.contains("above the table"), "{words}");
        let tipped =
            hand(&supply, 0.0) * Pose::rotation(Vector3::z() * std::f64::consts::FRAC_PI_2);
        let Err(words) = supply.handed(0, &tipped, &table(), 0.0) else {
            panic!("its y axis points up");
        };
        assert!(words.contains("not level"), "{words}");
    }
}
