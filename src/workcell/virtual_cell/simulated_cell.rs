//! Arms, axes, grippers and the rod or the sheet of a virtual cell, on a common clock.

use super::arm::{Ended, Refusal, SimulatedArm};
use super::axis::moving_parts;
use super::camera::Scenery;
use super::chuck::Chuck;
use super::fault::{Fault, FaultKind};
use super::rod::{HandOver, RodSupply};
use super::settings::Settings;
use super::sheet::SimulatedSheet;
use super::simulated_rod::{HANDING_OVER, SimulatedRod};
use crate::cell::Cell;
use nalgebra::Translation3;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_engine::mechanics::rotation;
use rodlab_lab::experiment::Jitter;
use rodlab_robot::{PartTrajectory, Pose};

/// Time step of the simulated cell, s.
pub const STEP: f64 = 5e-3;
/// Time that a gripper takes to open, s.
const OPENING: f64 = 0.2;
/// Time shift between the noise of one arm and that of the next, s. Both use the same noise; the
/// shift is much longer than a task.
const APART: f64 = 1e5;

/// Event in a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The motion of an arm has ended.
    Arm(usize, Ended),
    /// The gripper of an arm has reached its setpoint.
    Gripper(usize),
    /// A fault that does not concern arms and rods is due.
    Fault(FaultKind),
}

/// A gripper.
#[derive(Clone, Copy, Debug)]
struct Gripper {
    /// Opening at and above which the gripper releases its object, m: half open counts as open.
    opened: f64,
    /// The last commanded opening, m.
    told: f64,
    /// Time at which a command is completed, s.
    done: Option<f64>,
}

/// A cell in simulation.
pub struct SimulatedCell {
    time: f64,
    arms: Vec<SimulatedArm>,
    grippers: Vec<Option<Gripper>>,
    table: Pose,
    /// Rods for the grippers, in the order in which they are handed over.
    supplies: Vec<RodSupply>,
    /// Whether laid rods stay when the next one is handed over.
    rods_stay: bool,
    /// Number of rods handed over.
    handed: usize,
    /// Rods of another kind, for the arms after the first.
    second_supply: Option<RodSupply>,
    /// Noise of the gripper poses, which the joints do not report.
    jitter: Option<Jitter>,
    /// The rod.
    rod: Option<SimulatedRod>,
    /// The sheet, and the arm that took it last.
    sheet: Option<(SimulatedSheet, usize)>,
    /// The chuck with its rod.
    chuck: Option<Chuck>,
    /// Pending faults.
    faults: Vec<Fault>,
    /// Time for which arms have moved since the first command, s.
    moved: Option<f64>,
}

impl SimulatedCell {
    /// The arms of a cell at home, with rods for their grippers or a sheet on the table, if the
    /// settings include them.
    pub fn new(cell: &Cell, settings: Settings) -> Self {
        let parts = moving_parts(cell);
        let grippers = parts.iter().map(|arm| {
            let known = arm.gripper.as_ref()?;
            Some(Gripper {
                opened: 0.5 * (known.open + known.closed),
                told: known.open,
                done: None,
            })
        });
        let arms = parts.iter();
        Self {
            time: 0.0,
            arms: arms
                .map(|arm| SimulatedArm::new(arm, settings.response))
                .collect(),
            grippers: grippers.collect(),
            table: cell.table.map_or_else(Pose::identity, |table| table.top),
            supplies: settings
                .supply
                .into_iter()
                .chain(settings.further)
                .collect(),
            rods_stay: settings.rods_stay,
            handed: 0,
            second_supply: settings.second_supply,
            jitter: settings.jitter,
            rod: None,
            sheet: settings.sheet.map(|sheet| (sheet, 0)),
            chuck: settings.chucked.map(Chuck::new),
            faults: settings.faults,
            moved: None,
        }
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The arms, then the axes.
    pub fn arms(&self) -> &[SimulatedArm] {
        &self.arms
    }

    /// Objects that a camera sees.
    pub fn scenery(&self) -> Scenery {
        let sheet = self.sheet.as_ref().map(|(sheet, _)| sheet.seen());
        if let Some(chuck) = &self.chuck {
            let rod = chuck.nodes().map(|nodes| (nodes, chuck.rod().radius, 0));
            return Scenery {
                rods: rod.into_iter().collect(),
                markers: chuck.rod().marker_places(),
                sheet,
                pegs: Vec::new(),
            };
        }
        let rods = self.rod.iter().flat_map(|rod| {
            let kinds = rod.rods().iter();
            let kinds = kinds.map(|rod| usize::from(rod.supply >= self.supplies.len()));
            let seen = rod.seen().into_iter().zip(kinds);
            seen.map(|((nodes, radius), kind)| (nodes, radius, kind))
        });
        Scenery {
            rods: rods.collect(),
            markers: Vec::new(),
            sheet,
            pegs: self.supplies.first().map_or(Vec::new(), RodSupply::pegs),
        }
    }

    /// Opening of the fingers of an arm, m: the thickness of the held object, or the setpoint; `None` without a gripper.
    pub fn fingers(&self, arm: usize) -> Option<f64> {
        let told = self.grippers[arm]?.told;
        let rod = self.rod.as_ref();
        let is_among = rod.is_some_and(|rod| rod.is_held_by(arm));
        if !is_among && self.holder() != Some(arm) {
            return Some(told);
        }
        let chucked = self.chuck.as_ref().map(|chuck| 2.0 * chuck.rod().radius);
        let sheet = self.sheet.as_ref().map(|(sheet, _)| sheet.thickness());
        let thinnest = |rod: &SimulatedRod| {
            let radii = rod.rods().iter().map(|rod| rod.radius);
            2.0 * radii.fold(f64::INFINITY, f64::min)
        };
        let rod = rod.map(thinnest);
        Some(told.max(chucked.or(sheet).or(rod).unwrap_or(0.0)))
    }

    /// The sheet.
    pub fn sheet(&self) -> Option<&SimulatedSheet> {
        self.sheet.as_ref().map(|(sheet, _)| sheet)
    }

    /// Commands an arm to follow a trajectory.
    ///
    /// # Errors
    /// See [`SimulatedArm::take`].
    pub fn follow(&mut self, arm: usize, trajectory: PartTrajectory) -> Result<(), Refusal> {
        self.arms[arm].take(trajectory, self.time)?;
        self.moved.get_or_insert(0.0);
        Ok(())
    }

    /// Stops an arm.
    pub fn stop(&mut self, arm: usize) {
        self.arms[arm].stop();
    }

    /// Opens or closes the gripper of an arm. A closing gripper takes the edge of the sheet or a
    /// rod within its reach. Otherwise the end of a rod is handed to it: of a new rod if one
    /// already lies elsewhere.
    ///
    /// # Errors
    /// A message: the gripper cannot take anything, or the simulation rejects it.
    pub fn grip(&mut self, arm: usize, opening: f64) -> Result<(), String> {
        let gripper = self.grippers[arm].ok_or("this arm has no gripper")?;
        let takes = match (self.sheet.is_some(), opening >= gripper.opened) {
            (true, opens) => self.grip_sheet(arm, opens).map(|()| OPENING),
            (false, true) => self.open(arm).map(|()| OPENING),
            (false, false) if self.chuck.is_some() => self.clamp(arm),
            (false, false) => self.close(arm),
        };
        self.grippers[arm] = Some(Gripper {
            told: opening,
            done: Some(self.time + takes?),
            ..gripper
        });
        Ok(())
    }

    /// Opens a gripper, which releases its object.
    fn open(&mut self, arm: usize) -> Result<(), String> {
        // The user takes away a rod that would fall.
        if (self.supply(self.supply_number(arm))).is_some_and(RodSupply::is_free) {
            self.rod = None;
        }
        let opened = match (&mut self.chuck, &mut self.rod) {
            (Some(chuck), _) if chuck.holder() == Some(arm) => chuck.let_go(),
            (None, Some(rod)) => rod.release_by(arm),
            _ => Ok(()),
        };
        opened.map_err(|error| error.to_string())
    }

    /// Closes a gripper on a rod, or hands one over; returns the duration, s.
    fn close(&mut self, arm: usize) -> Result<f64, String> {
        let hand = self.hand(arm);
        let number = self.supply_number(arm);
        if self.supply(number).is_none() {
            return Ok(OPENING);
        }
        if let Some(rod) = &self.rod {
            if rod.is_held_by(arm) {
                return Ok(OPENING);
            }
            if let Some(node) = rod.within_reach(&hand) {
                self.arms[arm].must_stand()?;
                return self.take(arm, node, &hand);
            }
            if let Some(holder) = rod.holders().next() {
                return Err(format!(
                    "{} holds the rod, and {} does not reach it: none of it is within 1.5 cm of the hand",
                    self.arms[holder].name, self.arms[arm].name
                ));
            }
        }
        self.arms[arm].must_stand()?;
        let Some(supply) = self.supply(number) else {
            return Ok(OPENING);
        };
        let to = HandOver {
            arm,
            supply: number,
            hand,
            table: self.table,
            now: self.time,
        };
        let stays = |rod: &&SimulatedRod| {
            // A single rod of another kind stays on the table.
            let is_other = match rod.rods() {
                [only] => only.supply != number && self.second_supply.is_some(),
                _ => false,
            };
            self.rods_stay || is_other
        };
        let handed = match self.rod.as_ref().filter(stays) {
            Some(lying) => {
                let kinds = lying.rods().iter();
                let kinds = kinds.filter_map(|rod| self.supply(rod.supply));
                supply.handed_beside(lying, &kinds.collect::<Vec<_>>(), &to)
            }
            None => supply.handed(&to),
        };
        self.rod = Some(handed?);
        self.handed += 1;
        Ok(HANDING_OVER)
    }

    /// Takes hold of a node of the rod; returns the duration, s.
    fn take(&mut self, arm: usize, node: usize, hand: &Pose) -> Result<f64, String> {
        if let Some(rod) = &mut self.rod {
            let taken = rod.take(arm, node, hand, self.time);
            taken.map_err(|error| error.to_string())?;
        }
        Ok(OPENING)
    }

    /// Number of the supply from which an arm gets its next rod. That of the second arm follows
    /// those of the first one.
    fn supply_number(&self, arm: usize) -> usize {
        let count = self.supplies.len();
        match self.second_supply.is_some() && arm > 0 {
            true => count,
            false => self.handed.min(count.saturating_sub(1)),
        }
    }

    /// The supply with a number.
    fn supply(&self, number: usize) -> Option<&RodSupply> {
        let second = self.second_supply.as_ref();
        let second = second.filter(|_| number == self.supplies.len());
        self.supplies.get(number).or(second)
    }

    /// Takes the edge of the sheet, or releases it.
    fn grip_sheet(&mut self, arm: usize, opens: bool) -> Result<(), String> {
        let holder = self.holder();
        match (opens, holder) {
            (true, Some(holder)) if holder == arm => {
                self.let_go().map_err(|error| error.to_string())
            }
            (false, Some(holder)) if holder != arm => {
                Err(format!("{} holds the sheet", self.arms[holder].name))
            }
            (true, _) | (false, Some(_)) => Ok(()),
            (false, None) => {
                self.arms[arm].must_stand()?;
                let (hand, now) = (self.hand(arm), self.time);
                let Some((sheet, holder)) = &mut self.sheet else {
                    return Ok(());
                };
                sheet.take(&hand, now)?;
                *holder = arm;
                Ok(())
            }
        }
    }

    /// The arm whose gripper holds the rod or the sheet.
    fn holder(&self) -> Option<usize> {
        if let Some(chuck) = &self.chuck {
            return chuck.holder();
        }
        let sheet = self.sheet.as_ref().filter(|(sheet, _)| sheet.is_held());
        let rod = self.rod.as_ref().and_then(|rod| rod.holders().next());
        sheet.map(|(_, holder)| *holder).or(rod)
    }

    /// Clamps a rod between the chuck and the hand of an arm; returns the duration, s.
    fn clamp(&mut self, arm: usize) -> Result<f64, String> {
        let Some(chuck) = &mut self.chuck else {
            return Ok(OPENING);
        };
        match chuck.holder() {
            Some(holder) if holder != arm => {
                return Err(format!("{} holds the rod", self.arms[holder].name));
            }
            Some(_) => return Ok(OPENING),
            None => {}
        }
        self.arms[arm].must_stand()?;
        let angle = self.arms[chuck.part()].joints()[0];
        let taken = chuck.take(arm, &self.arms[arm].hand(), angle, self.time);
        taken.map(|()| HANDING_OVER)
    }

    /// Releases the held object; if several grippers hold one rod, the one that took it last.
    fn let_go(&mut self) -> Result<(), SimulationError> {
        if let Some(chuck) = &mut self.chuck {
            chuck.let_go()?;
        }
        if let Some((sheet, _)) = &mut self.sheet {
            sheet.release()?;
        }
        let Some(rod) = &mut self.rod else {
            return Ok(());
        };
        let last = rod.holders().next_back();
        last.map_or(Ok(()), |arm| rod.release_by(arm))
    }

    /// Advances by one step, or continues the last step if the simulation of the rod has not
    /// finished it.
    ///
    /// # Errors
    /// The simulation of the rod finds no step.
    pub fn advance(&mut self) -> Result<Vec<Event>, SimulationError> {
        if !self.lead()? {
            return Ok(Vec::new());
        }
        let mut events = self.suffer()?;
        self.time += STEP;
        if self.arms.iter().any(SimulatedArm::is_moving) {
            self.moved = self.moved.map(|moved| moved + STEP);
        }
        for (index, arm) in self.arms.iter_mut().enumerate() {
            if let Some(ended) = arm.advance(self.time, STEP) {
                events.push(Event::Arm(index, ended));
            }
        }
        self.lead()?;
        for (index, gripper) in self.grippers.iter_mut().enumerate() {
            let command = gripper.as_mut().map(|gripper| &mut gripper.done);
            if command.is_some_and(|done| done.take_if(|done| *done <= self.time).is_some()) {
                events.push(Event::Gripper(index));
            }
        }
        Ok(events)
    }

    /// Pose of the hand of an arm, with noise.
    fn hand(&self, arm: usize) -> Pose {
        let hand = self.arms[arm].hand();
        match &self.jitter {
            Some(jitter) => {
                let (way, turn) = jitter.at(self.time + APART * arm as f64);
                let place = Translation3::from(hand.translation.vector + way);
                Pose::from_parts(place, rotation::from_vector(turn) * hand.rotation)
            }
            None => hand,
        }
    }

    /// Advances the held objects to the current time; returns whether they have reached it.
    fn lead(&mut self) -> Result<bool, SimulationError> {
        if let Some(chuck) = &mut self.chuck {
            let angle = self.arms[chuck.part()].joints()[0];
            return chuck.lead(|arm| self.arms[arm].hand(), angle, self.time);
        }
        if let Some(holder) = self.sheet.as_ref().map(|(_, holder)| *holder) {
            let hand = self.hand(holder);
            if let Some((sheet, _)) = &mut self.sheet {
                return sheet.advance(&hand, self.time);
            }
        }
        // The arms have finished their step: only the rod advances.
        let Some(mut rod) = self.rod.take() else {
            return Ok(true);
        };
        let has_come = rod.advance_in(|arm| self.hand(arm), self.time);
        self.rod = Some(rod);
        has_come
    }

    /// Injects the faults that are due.
    fn suffer(&mut self) -> Result<Vec<Event>, SimulationError> {
        let Some(moved) = self.moved else {
            return Ok(Vec::new());
        };
        let moving = self.arms.iter().position(SimulatedArm::is_moving);
        let holds = self.holder().is_some();
        // A joint can freeze only during a motion, and only a held object can slip.
        let has_come = |fault: &Fault| {
            fault.time <= moved
                && match fault.kind {
                    FaultKind::FreezeJoint => moving.is_some(),
                    FaultKind::SlipGrasp => holds,
                    FaultKind::DropLink | FaultKind::LoseCamera => true,
                }
        };
        let (come, rest): (Vec<Fault>, Vec<Fault>) =
            self.faults.iter().copied().partition(has_come);
        self.faults = rest;
        let mut events = Vec::new();
        for fault in come {
            match (fault.kind, moving) {
                (FaultKind::FreezeJoint, Some(arm)) => {
                    self.arms[arm].freeze();
                }
                (FaultKind::SlipGrasp, _) => self.let_go()?,
                _ => {}
            }
            events.push(Event::Fault(fault.kind));
        }
        Ok(events)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::{cell, settings, short_rods};

    /// Moves an arm to joint positions within a number of seconds.
    fn go(cell: &mut SimulatedCell, arm: usize, joints: [f64; 6], seconds: f64) {
        let names = cell.arms()[arm].names().into_iter();
        let trajectory = PartTrajectory {
            joints: names.map(str::to_owned).collect(),
            times: vec![0.0, seconds],
            points: vec![cell.arms()[arm].joints().to_vec(), joints.to_vec()],
        };
        cell.follow(arm, trajectory).unwrap();
        while cell.arms()[arm].is_moving() {
            cell.advance().unwrap();
        }
    }

    fn wait(cell: &mut SimulatedCell, seconds: f64) {
        let until = cell.time() + seconds;
        while cell.time() < until {
            cell.advance().unwrap();
        }
    }

    #[test]
    fn a_gripper_takes_hold_of_a_rod_that_another_one_holds_where_it_reaches_it() {
        let settings = Settings {
            supply: Some(short_rods()),
            ..settings()
        };
        let mut cell = SimulatedCell::new(&cell("two_gantries"), settings);
        go(&mut cell, 0, [-0.4, 0.0, 0.27, 0.0, 0.0, 0.0], 2.0);
        cell.grip(0, 0.0).unwrap();
        wait(&mut cell, 1.5);
        let words = cell.grip(1, 0.0).unwrap_err();
        assert!(words.contains("right does not reach it"), "{words}");
        let free = cell.scenery().rods.remove(0).0[0];
        let [x, y, z] = [free.x, free.y, free.z + 5e-3];
        go(&mut cell, 1, [x, y, z, 0.0, 0.0, 0.0], 4.0);
        cell.grip(1, 0.0).unwrap();
        wait(&mut cell, 0.3);
        go(&mut cell, 1, [x, y, z + 0.03, 0.0, 0.0, 0.0], 1.0);
        let nodes = cell.scenery().rods.remove(0).0;
        assert!((nodes[0].z - free.z - 0.03).abs() < 3e-3);
        assert!((nodes[30].z - 0.27).abs() < 1e-3);
        // The object slips from the gripper that took it last; the other gripper still holds it.
        cell.let_go().unwrap();
        wait(&mut cell, 0.5);
        let nodes = cell.scenery().rods.remove(0).0;
        assert!((nodes[30].z - 0.27).abs() < 1e-3);
        assert!(nodes[0].z < free.z + 0.02, "{}", nodes[0]);
        cell.grip(0, 0.04).unwrap();
        assert_eq!(cell.holder(), None);
    }
}
