//! Rods that are handed to the grippers of a virtual cell and hang down to the table.

use super::simulated_rod::{HandedRod, Placed, SimulatedRod};
use nalgebra::{Point3, Translation3};
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::scene::{Motion, Scene};
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use rodlab_lab::experiment::{self, Deployment, DeploymentTables, Fixtures};
use rodlab_lab::run::PreparedRun;
use rodlab_lab::scenario::{Loaded, ScenarioError};
use rodlab_planning::plan::deployment::{DeployedRod, OptimalGrasps, Scheme, trajectory};
use rodlab_planning::plan::pattern::{Line, PatternSource, Point};
use rodlab_robot::{Pose, distance_and_angle};
use std::path::Path;
use toml::{Table, Value, toml};

/// Largest distance of the hand from its pose for a freely hanging rod, in gravito-bending
/// lengths, and largest rotation, rad. The user can bend the rod by these amounts.
const REACH: [f64; 2] = [2.0, 0.6];
/// Least horizontal part of the hand's y axis for which the rod has a direction on the table.
const LEVEL: f64 = 0.5;
/// Length of the initial line of a rod, relative to the length of the rod.
const FIRST_LINE: f64 = 0.05;

/// The hand-over of a rod to the gripper of an arm.
pub struct HandOver {
    /// The arm.
    pub arm: usize,
    /// Number of the supply of the rod.
    pub supply: usize,
    /// Pose of the hand in the cell.
    pub hand: Pose,
    /// Pose of the top of the table in the cell.
    pub table: Pose,
    /// Time, s.
    pub now: f64,
}

/// Supplies rods of one kind, one after another, to grippers.
pub struct RodSupply {
    pub(super) prepared: PreparedRun,
    pub(super) rod: DeployedRod,
    /// Pose of the hanging end of a rod whose free end lies at the origin, along x.
    pub(super) end: Pose,
    /// Place of the free end in the cell, m; `None` if the rod hangs freely.
    pub(super) free_end: Option<[f64; 2]>,
    /// Whether the rod may hang freely if a hand cannot reach its end with the free end at that
    /// place.
    pub(super) may_hang: bool,
    /// Whether the rod hangs in the air.
    pub(super) is_free: bool,
    /// Pegs on the table, and the pose of their frame in the cell.
    pub(super) fixtures: Option<(Fixtures, Pose)>,
}

/// Reason why rods cannot be supplied.
#[derive(Debug, thiserror::Error)]
pub enum RodError {
    /// The file is invalid.
    #[error(transparent)]
    File(#[from] Box<ScenarioError>),
    /// The rod cannot hang.
    #[error("the rod cannot hang from a gripper: {0}")]
    Impossible(String),
}

impl RodError {
    /// Error that a rod cannot hang, with its reason.
    pub(super) fn impossible(reason: impl ToString) -> Self {
        Self::Impossible(reason.to_string())
    }
}

/// Creates a scenario that extends a file.
pub(super) fn extending(file: &Path) -> Result<Table, RodError> {
    let whole = std::path::absolute(file).map_err(RodError::impossible)?;
    Ok(toml! { extends = (whole.to_string_lossy().into_owned()) })
}

/// Reads a scenario from its table.
pub(super) fn loaded(name: &str, scenario: Table) -> Result<Loaded, RodError> {
    let loaded = experiment::from_table(name, scenario, Path::new(""), &[]);
    Ok(loaded.map_err(Box::new)?)
}

/// Reads a scenario from its table and prepares its simulation.
pub(super) fn prepared(name: &str, scenario: Table) -> Result<(Loaded, PreparedRun), RodError> {
    let loaded = loaded(name, scenario)?;
    let prepared = experiment::prepare(&loaded.scenario);
    let prepared = prepared.map_err(|issues| Box::new(loaded.locate(issues)))?;
    Ok((loaded, prepared))
}

impl RodSupply {
    /// Rods as a file describes them in `[deployment.rod]`, on a table with the given friction.
    ///
    /// # Errors
    /// The file cannot be read, or is invalid.
    pub fn new(file: &Path, friction: f64) -> Result<Self, RodError> {
        Self::described(&extending(file)?, &Table::new(), friction)
    }

    /// As [`RodSupply::new`], but cut to a length, m.
    ///
    /// # Errors
    /// Errors of [`RodSupply::new`].
    pub fn cut(file: &Path, friction: f64, length: f64) -> Result<Self, RodError> {
        let rod = toml! { rod = { length = length } };
        Self::described(&extending(file)?, &rod, friction)
    }

    /// Rods of a deployment, on its table with its pegs; `frame` is the pose of its pattern in the
    /// cell. The free end lies at the start of the pattern if the hand can then reach the other
    /// end.
    ///
    /// # Errors
    /// The rod cannot hang.
    pub fn of(deployment: &Deployment, friction: f64, frame: Pose) -> Result<Self, RodError> {
        let rod = Value::try_from(deployment.rod).map_err(RodError::impossible)?;
        let rod = toml! { rod = rod };
        let fixtures = Fixtures::of(deployment).map_err(RodError::impossible)?;
        let pattern = deployment.whole_pattern();
        let start = pattern.map_err(RodError::impossible)?.at(0.0);
        let start = frame * nalgebra::Point3::new(start.position.x, start.position.y, 0.0);
        let supply = Self::described(&Table::new(), &rod, friction)?;
        Ok(Self {
            fixtures: Some((fixtures, frame)),
            free_end: Some([start.x, start.y]),
            may_hang: true,
            ..supply
        })
    }

    /// Rods from keys at the top of a scenario, or in its `[deployment]`.
    fn described(top: &Table, in_deployment: &Table, friction: f64) -> Result<Self, RodError> {
        let scenario = |length: f64| {
            let mut deployment = toml! {
                pattern = { kind = "line", length = length }
                lead_in = 0.0
            };
            deployment.extend(in_deployment.clone());
            let mut scenario = top.clone();
            scenario.extend(toml! {
                experiment = "deployment"
                deployment = deployment
                contact = { friction = friction, distance_tolerance = "50 µm", slip_tolerance = "0.01 mm/s" }
                time = { step = "5 ms", end = 10.0 }
            });
            scenario
        };
        // Any short line is sufficient; the rod determines its length.
        let first = loaded("rod", scenario(1e-3))?;
        let tables: Option<&DeploymentTables> = first.scenario.experiment.tables();
        let tables = tables.expect("the tables of a deployment");
        let rod = tables.deployment.rod.deployed();
        let length = FIRST_LINE * rod.length;
        let (_, prepared) = prepared("rod", scenario(length))?;
        let line = PatternSource::Line(Line { length }).pattern();
        let start = line.map_err(RodError::impossible)?.at(0.0);
        let poses = trajectory(&[start], &rod, Scheme::Optimal, OptimalGrasps::Exact);
        let poses = poses.map_err(RodError::impossible)?;
        let end = Pose::from_parts(Translation3::from(poses[0].position), poses[0].rotation);
        Ok(Self {
            prepared,
            rod,
            end,
            free_end: None,
            may_hang: false,
            is_free: false,
            fixtures: None,
        })
    }

    /// Rods whose free end the user places at a point of the cell, m.
    pub fn with_free_end(mut self, place: [f64; 2]) -> Self {
        self.free_end = Some(place);
        self
    }

    /// Rods whose free end the user places at the start of a pattern; `frame` is the pose of the
    /// pattern in the cell.
    pub fn beginning_at(self, frame: &Pose, start: Point) -> Self {
        let start = frame * Point3::new(start.x, start.y, 0.0);
        self.with_free_end([start.x, start.y])
    }

    /// Whether the rods hang in the air.
    pub fn is_free(&self) -> bool {
        self.is_free
    }

    /// The pegs on the table: start of the axis and centre of the round top in the cell, m, and
    /// radius, m.
    pub fn pegs(&self) -> Vec<([Vector3; 2], f64)> {
        let standing = self.fixtures.iter().flat_map(|(fixtures, frame)| {
            fixtures.pegs().iter().map(move |peg| {
                let [x, y] = peg.position;
                let axis = [0.0, peg.height - peg.radius];
                let axis = axis.map(|z| (frame * nalgebra::Point3::new(x, y, z)).coords);
                (axis, peg.radius)
            })
        });
        standing.collect()
    }

    /// Properties of the rod that matter for laying it.
    pub fn rod(&self) -> &DeployedRod {
        &self.rod
    }

    /// Hands the end of a rod to a gripper. The free end lies on the table in the direction of the
    /// gripper, so that the rod hangs freely, or at the place of [`RodSupply::with_free_end`].
    ///
    /// # Errors
    /// A message: a rod of this length cannot hang there, or the rod cannot be simulated.
    pub fn handed(&self, to: &HandOver) -> Result<SimulatedRod, String> {
        let frame = self.frame(&to.hand, &to.table)?;
        let placed = Placed {
            frame: to.table * frame,
            end: self.end,
            radius: self.rod.radius,
        };
        self.simulated(&self.prepared.scene, placed, &[], to)
    }

    /// Starts the simulation of a scene whose last rod, of this kind, is handed over; `others` are
    /// on the table.
    fn simulated(
        &self,
        scene: &Scene,
        placed: Placed,
        others: &[HandedRod],
        to: &HandOver,
    ) -> Result<SimulatedRod, String> {
        let mut scene = scene.clone();
        if let Some((fixtures, pegs)) = &self.fixtures {
            let pegs = placed.frame.inverse() * pegs;
            scene.rods.extend(fixtures.posts(|[x, y]| {
                let place = pegs * nalgebra::Point3::new(x, y, 0.0);
                [place.x, place.y]
            }));
        }
        let simulation = Simulation::new(&scene, &self.prepared.integration);
        let simulation = simulation.map_err(|error| error.to_string())?;
        let handed = HandedRod {
            arm: to.arm,
            supply: to.supply,
            nodes: self.prepared.scene.rods[0].centreline.len(),
            radius: self.rod.radius,
        };
        let rods = [others, &[handed]].concat();
        Ok(match self.is_free {
            true => SimulatedRod::held_by(simulation, &placed, &rods, to.now),
            false => SimulatedRod::handed(simulation, placed, &rods, to.now),
        })
    }

    /// The frame of the simulation, on the table, of a rod that hangs from a hand.
    fn frame(&self, hand: &Pose, table: &Pose) -> Result<Pose, String> {
        match self.frame_with(self.free_end, hand, table) {
            Err(_) if self.may_hang => self.frame_with(None, hand, table),
            frame => frame,
        }
    }

    /// The frame of the simulation for a free end at a place in the cell, m, or (`None`) for a
    /// freely hanging rod.
    fn frame_with(
        &self,
        free_end: Option<[f64; 2]>,
        hand: &Pose,
        table: &Pose,
    ) -> Result<Pose, String> {
        let held = table.inverse() * hand;
        let across = held.rotation * Vector3::y();
        if libm::hypot(across.x, across.y) < LEVEL {
            return Err(
                "the y axis of the hand is not level: the direction of a hanging rod is undefined"
                    .into(),
            );
        }
        let heading = libm::atan2(-across.x, across.y);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
        let end = turn * self.end.translation.vector;
        let place = match free_end {
            Some([x, y]) => (table.inverse() * nalgebra::Point3::new(x, y, 0.0)).coords,
            None => held.translation.vector - end,
        };
        let height = if self.is_free { place.z } else { 0.0 };
        let frame = Pose::from_parts(Translation3::new(place.x, place.y, height), turn);
        let held = frame.inverse() * held;
        let (distance, angle) = distance_and_angle(&self.end, &held);
        let [most_lengths, most_angle] = REACH;
        let most = most_lengths * self.rod.gravito_bending_length;
        if !(distance <= most && angle <= most_angle) {
            return Err(format!(
                "the hand is {distance:.3} m and {angle:.2} rad from the place where a rod of {:.3} m is supplied, {:.3} m above the \
                 table; allowed: {most:.3} m and {most_angle} rad",
                self.rod.length, self.end.translation.z
            ));
        }
        Ok(frame)
    }

    /// Hands over a rod beside others, of the given kinds, which lie on the table and which no
    /// gripper holds.
    ///
    /// # Errors
    /// Errors of [`Self::handed`].
    pub fn handed_beside(
        &self,
        lying: &SimulatedRod,
        kinds: &[&Self],
        to: &HandOver,
    ) -> Result<SimulatedRod, String> {
        let frame = lying.frame();
        let moved = frame.inverse() * to.table * self.frame(&to.hand, &to.table)?;
        let mut scene = self.prepared.scene.clone();
        let handed = &mut scene.rods[0];
        for node in &mut handed.centreline {
            *node = (moved * nalgebra::Point3::from(*node)).coords;
        }
        for tangent in handed.end_tangents.iter_mut().flatten() {
            *tangent = moved.rotation * *tangent;
        }
        // Lying rods start again from rest, without their twist.
        let mut nodes = lying.positions();
        for (index, (rod, kind)) in lying.rods().iter().zip(kinds).enumerate() {
            let mut other = kind.prepared.scene.rods[0].clone();
            let (own, rest) = nodes.split_at(rod.nodes);
            nodes = rest;
            other.name = format!("lying {}", index + 1);
            other.centreline = own.to_vec();
            other.end_tangents = [None; 2];
            scene.rods.insert(index, other);
        }
        for clamp in &mut scene.clamps {
            clamp.rod += kinds.len();
            clamp.motion = Motion::default();
        }
        let placed = Placed {
            frame,
            end: moved * self.end,
            radius: self.rod.radius,
        };
        self.simulated(&scene, placed, lying.rods(), to)
    }
}
