//! The sheet of a virtual cell. The sheet lies on the table; a gripper takes its edge, folds it and
//! releases it.
//!
//! A strip in the direction of the fold is simulated, as in the experiment `folding`: a rod of the
//! same gravito-bending length, which sticks and slips on the table and on itself. The simulation
//! has its own frame, in which all y are zero. There the strip stays exactly in its plane of
//! symmetry. In a turned frame, rounding errors across this plane would grow until the round strip
//! tips over, which a wide sheet does not do.

use super::rod::{RodError, extending, prepared};
use super::sheet_picture::SeenSheet;
use super::simulated_rod::{Placed, SimulatedRod};
use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::mechanics::scene::{Load, LoadKind};
use rodlab_lab::experiment::FoldingTables;
use rodlab_robot::{Pose, distance_and_angle};
use std::path::Path;
use toml::toml;

/// Largest distance of the hand from the middle of the edge that it takes, m, and largest
/// rotation, rad.
const REACH: [f64; 2] = [5e-3, 0.2];
/// Distance at which contact with layers and the table begins, m.
const TOLERANCE: f64 = 2e-5;
/// Terminal speed of a released sheet in air, m/s: that of paper that falls flat.
const TERMINAL_SPEED: f64 = 1.0;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;
/// Length of sheet next to the edge, in thicknesses, that does not count as a layer below the
/// edge.
const BESIDE: f64 = 50.0;

/// Place of a sheet on the table of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetPlace {
    /// The middle of the edge (or the corner) that the gripper takes, in the frame of the table's
    /// top, x and y, m.
    pub edge: [f64; 2],
    /// Direction from there across the sheet, measured from the table's x axis, rad.
    pub heading: f64,
}

/// Motion of a sheet while a gripper held it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldSheet {
    /// Largest slide of the free end, m.
    pub largest_sliding: f64,
    /// Final slide in the direction in which the edge is folded, m.
    pub sliding: f64,
    /// Final position of its edge: along the fold and up, m.
    pub edge: [f64; 2],
}

/// A sheet in simulation. The origin of its frame is the initial place of the middle of the edge;
/// x points across the sheet and z up.
pub struct SimulatedSheet {
    strip: SimulatedRod,
    frame: Pose,
    /// Index of the load that models the drag of the air.
    air: usize,
    /// Pose of the edge in the hand that holds it.
    held: Option<Pose>,
    last_held: Option<HeldSheet>,
    length: f64,
    width: f64,
    is_diagonal: bool,
    thickness: f64,
}

impl SimulatedSheet {
    /// A sheet as a file describes it in `[folding.paper]`, on a table with the given friction.
    /// For a fold along its diagonal, its corner points in the direction of the fold. Without a
    /// place it lies in the middle of the table. `table` is the pose of the top of the table.
    ///
    /// # Errors
    /// The file cannot be read, or is invalid.
    pub fn new(
        file: &Path,
        friction: f64,
        is_diagonal: bool,
        place: Option<SheetPlace>,
        table: &Pose,
    ) -> Result<Self, RodError> {
        let mut scenario = extending(file)?;
        let crease = if is_diagonal {
            "diagonal-strip"
        } else {
            "half"
        };
        // The gripper determines the fold, so that any path will do here, such as a circle.
        scenario.extend(toml! {
            experiment = "folding"
            folding = { crease = crease, algorithm = "circle" }
            contact = { friction = friction, distance_tolerance = TOLERANCE, slip_tolerance = "0.02 mm/s" }
            time = { step = "5 ms", end = 10.0 }
        });
        let (loaded, mut prepared) = prepared("sheet", scenario)?;
        let tables: Option<&FoldingTables> = loaded.scenario.experiment.tables();
        let folding = &tables.expect("the tables of a fold").folding;
        let length = folding.sheet().length;
        let paper = folding.paper;
        let loads = &mut prepared.scene.loads;
        let air = loads.len();
        loads.push(Load {
            kind: LoadKind::Drag {
                rod: None,
                translation: prepared.scene.rods[0].mass_per_length * GRAVITY / TERMINAL_SPEED,
                rotation: 0.0,
            },
            schedule: Vec::new(),
        });
        let simulation = Simulation::new(&prepared.scene, &prepared.integration);
        let simulation = simulation.map_err(RodError::impossible)?;
        let place = place.unwrap_or(SheetPlace {
            edge: [-0.5 * length, 0.0],
            heading: 0.0,
        });
        let [x, y] = place.edge;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), place.heading);
        let frame = table * Pose::from_parts(Translation3::new(x, y, 0.0), turn);
        let placed = Placed {
            frame: Pose::identity(),
            end: edge_pose(simulation.positions()),
            radius: 0.5 * paper.thickness,
        };
        let mut strip = SimulatedRod::held(simulation, placed, 0.0);
        strip.release().map_err(RodError::impossible)?;
        Ok(Self {
            strip,
            frame,
            air,
            held: None,
            last_held: None,
            length,
            width: paper.width,
            is_diagonal,
            thickness: paper.thickness,
        })
    }

    /// The gripper takes the edge at the time `now`, s; `hand` is its pose.
    ///
    /// # Errors
    /// A message: the hand is not at the edge.
    pub fn take(&mut self, hand: &Pose, now: f64) -> Result<(), String> {
        let edge = edge_pose(self.strip.positions());
        let (distance, angle) = distance_and_angle(&(self.frame * edge), hand);
        let [farthest, most] = REACH;
        if !(distance <= farthest && angle <= most) {
            return Err(format!(
                "the hand is {:.1} mm and {angle:.2} rad away from the edge of the sheet; allowed: {:.0} mm and {most} rad",
                1e3 * distance,
                1e3 * farthest
            ));
        }
        let last = self.strip.positions().len() - 1;
        let taken = self.strip.take_again(last, edge, now);
        // During slow folding the drag of the air is negligible.
        let taken = taken.and_then(|()| self.strip.set_load(self.air, 0.0));
        taken.map_err(|error| error.to_string())?;
        self.held = Some(hand.inverse() * self.frame * edge);
        Ok(())
    }

    /// Releases the edge; the drag of the air slows the sheet that springs open.
    ///
    /// # Errors
    /// The simulation rejects the release.
    pub fn release(&mut self) -> Result<(), SimulationError> {
        self.held = None;
        self.strip.set_load(self.air, 1.0)?;
        self.strip.release()
    }

    /// Advances towards the time `now`, s, with the edge in the hand if it is held. Returns
    /// whether the simulation has reached that time.
    ///
    /// # Errors
    /// No step is found while the sheet is held.
    pub fn advance(&mut self, hand: &Pose, now: f64) -> Result<bool, SimulationError> {
        let Some(held) = &self.held else {
            return self.strip.advance(hand, now);
        };
        let edge = self.frame.inverse() * hand * held;
        let (mut place, mut outwards) = (edge.translation.vector, edge.rotation * Vector3::x());
        // A sheet is not bent across, so that its strip stays in the plane of the fold.
        (place.y, outwards.y) = (0.0, 0.0);
        // A layer or the table under the edge stops it, since fingers are compliant.
        place.z = place.z.max(self.lowest(place.x));
        let has_come = self.strip.advance(&edge_along(place, outwards), now);
        self.note();
        has_come
    }

    fn note(&mut self) {
        let nodes = self.strip.positions();
        let sliding = nodes[0].x - self.length;
        let edge = nodes[nodes.len() - 1];
        let before = self.last_held.map_or(0.0, |held| held.largest_sliding);
        self.last_held = Some(HeldSheet {
            largest_sliding: before.max(sliding.abs()),
            sliding,
            edge: [edge.x, edge.z],
        });
    }

    /// Whether a gripper holds the sheet.
    pub fn is_held(&self) -> bool {
        self.held.is_some()
    }

    /// Thickness of the sheet, m.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// The sheet as the camera sees it.
    pub fn seen(&self) -> SeenSheet {
        SeenSheet {
            frame: self.frame,
            nodes: self.strip.positions().to_vec(),
            width: self.width,
            is_diagonal: self.is_diagonal,
        }
    }

    /// Motion of the sheet while it was last held, if it was.
    pub fn last_held(&self) -> Option<HeldSheet> {
        self.last_held
    }

    /// Least height of the edge at x, m, on the table or on the layer of sheet below.
    fn lowest(&self, x: f64) -> f64 {
        let nodes = self.strip.positions();
        let top = nodes[nodes.len() - 1].z;
        let spacing = (nodes[1] - nodes[0]).norm();
        let beside = (BESIDE * self.thickness / spacing).ceil() as usize + 1;
        let below = nodes[..nodes.len() - beside].windows(2).filter_map(|pair| {
            let part = (x - pair[0].x) / (pair[1].x - pair[0].x);
            let height = pair[0].z + part * (pair[1].z - pair[0].z);
            ((0.0..=1.0).contains(&part) && height < top).then_some(height)
        });
        let layer = self.thickness + 2.0 * TOLERANCE;
        let table = 0.5 * self.thickness + TOLERANCE;
        below.fold(table, |lowest, height| lowest.max(height + layer))
    }
}

/// Pose of the edge of a strip, as the pose of a hand that holds it.
fn edge_pose(nodes: &[Vector3]) -> Pose {
    let last = nodes.len() - 1;
    edge_along(nodes[last], nodes[last] - nodes[last - 1])
}

/// Pose of an edge at a place: x along the sheet, out of it, and y level.
fn edge_along(place: Vector3, outwards: Vector3) -> Pose {
    let outwards = outwards.normalize();
    let level = -Vector3::y();
    let normal = outwards.cross(&level).normalize();
    let axes = Matrix3::from_columns(&[outwards, normal.cross(&outwards), normal]);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    Pose::from_parts(Translation3::from(place), turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet() -> SimulatedSheet {
        let file = crate::test_cells::file("scenarios/papers/a4.toml");
        let place = SheetPlace {
            edge: [0.1, -0.2],
            heading: 0.5,
        };
        let table = Pose::translation(0.0, 0.0, 0.05);
        SimulatedSheet::new(&file, 0.12, false, Some(place), &table).unwrap()
    }

    /// The edge of a sheet in the cell.
    fn edge_of(sheet: &SimulatedSheet) -> Pose {
        sheet.frame * edge_pose(sheet.strip.positions())
    }

    fn highest(sheet: &SimulatedSheet) -> f64 {
        let nodes = sheet.strip.positions().iter();
        nodes.map(|node| node.z).fold(0.0, f64::max)
    }

    /// Advances a sheet in a number of steps from a time on, s, with the hand of each step.
    fn lead(sheet: &mut SimulatedSheet, begin: f64, steps: i32, hand: impl Fn(f64) -> Pose) {
        for step in 1..=steps {
            let (hand, now) = (hand(f64::from(step)), begin + 5e-3 * f64::from(step));
            while !sheet.advance(&hand, now).unwrap() {}
        }
    }

    fn raised(height: f64) -> Translation3<f64> {
        Translation3::new(0.0, 0.0, height)
    }

    #[test]
    fn a_sheet_is_taken_by_its_edge_lifted_and_let_go() {
        let mut sheet = sheet();
        let edge = edge_of(&sheet);
        let far = Translation3::new(0.0, 0.01, 0.0) * edge;
        let words = sheet.take(&far, 0.0).unwrap_err();
        assert!(words.contains("10.0 mm"), "{words}");
        // The hand is not exactly at the edge; the edge keeps its offset from the hand.
        let hand = Translation3::new(1e-3, -2e-3, 5e-4) * edge;
        sheet.take(&hand, 1.0).unwrap();
        let first = sheet.strip.positions()[sheet.strip.positions().len() - 1];
        lead(&mut sheet, 1.0, 200, |step| raised(5e-5 * step) * hand);
        let nodes = sheet.strip.positions();
        let last = nodes[nodes.len() - 1];
        let lifted = last - first;
        assert!(
            (lifted - Vector3::new(0.0, 0.0, 0.01)).norm() < 1e-6,
            "{last}"
        );
        // The risen part is longer than its projection, so that the sheet is pulled along.
        let held = sheet.last_held().unwrap();
        assert!((-1.5e-3..-1e-4).contains(&held.sliding), "{held:?}");
        assert!(sheet.take(&hand, 2.0).is_err(), "it has moved away");
        sheet.release().unwrap();
        lead(&mut sheet, 2.0, 600, |_| hand);
        assert!(highest(&sheet) < 2e-3);
        // The gripper takes the sheet again at its new place.
        let edge = edge_of(&sheet);
        sheet.take(&edge, 6.0).unwrap();
        assert!(sheet.is_held());
    }

    #[test]
    fn a_sheet_stays_in_the_plane_of_its_fold_however_long_it_rests() {
        let mut sheet = sheet();
        let edge = edge_of(&sheet);
        sheet.take(&edge, 0.0).unwrap();
        // The edge is lifted and turned over along a circle until the loop would tip over by
        // itself.
        let (steps, radius) = (600, 0.07);
        let frame = sheet.frame;
        let first = frame.inverse() * edge;
        let turned = |step: f64| {
            let angle = 0.8 * std::f64::consts::PI * step / f64::from(steps);
            let (sine, cosine) = libm::sincos(angle);
            let moved = Translation3::new(radius * (1.0 - cosine), 0.0, radius * sine);
            let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
            frame * Pose::from_parts(moved * first.translation, turn * first.rotation)
        };
        lead(&mut sheet, 0.0, steps, turned);
        assert!(highest(&sheet) > 0.04);
        let hand = turned(f64::from(steps));
        lead(&mut sheet, 3.0, 2000, |_| hand);
        assert!(sheet.strip.positions().iter().all(|node| node.y == 0.0));
        sheet.release().unwrap();
        lead(&mut sheet, 13.0, 2000, |_| hand);
        assert!(sheet.strip.positions().iter().all(|node| node.y == 0.0));
    }

    #[test]
    fn a_layer_under_the_edge_stops_it() {
        let mut sheet = sheet();
        let edge = edge_of(&sheet);
        sheet.take(&edge, 0.0).unwrap();
        lead(&mut sheet, 0.0, 40, |step| raised(-5e-5 * step) * edge);
        let [_, height] = sheet.last_held().unwrap().edge;
        assert!((height - 7e-5).abs() < 1e-6, "{height}");
        // Above the middle of the sheet the edge is stopped by the layer there.
        let lowest = sheet.lowest(0.15);
        assert!((lowest - 1.9e-4).abs() < 3e-5, "{lowest}");
    }
}
