//! The motion of a case of a results directory: the data for the 3-D page and films.

mod fields;
mod parameters;
mod series;
mod strips;

use super::branches::Branches;
use super::carried_bodies::carried_bodies;
use super::case_folders::CaseFolder;
use super::free_bodies::{free_bodies, rod_nodes};
use super::obstacles::{movie_obstacles, obstacles_of};
use super::threads::threads;
use crate::experiment::{from_text, kind_named};
use crate::scenario::Scenario;
use fields::fields;
use parameters::flattened;
use rayon::prelude::*;
use rodlab_engine::mechanics::contact::{ContactPlane, ContactSurface, touching_points};
use rodlab_engine::mechanics::scene::Obstacle;
use rodlab_engine::mechanics::system::obstacle_poses;
use rodlab_files::figure::{MovieCase, MovieFrame, MoviePlane, MovieRod, View};
use rodlab_files::results::{
    Manifest, NODES, NodeForces, NodePositions, ResultsError, read_node_forces, read_nodes,
};
use series::series;
use std::path::PathBuf;
use strips::strip_of;

/// A case as it was read.
pub(super) struct CaseMotion {
    folder: CaseFolder,
    path: PathBuf,
    manifest: Manifest,
    branches: Option<Branches>,
    /// Index of each shown output among all outputs, and its positions.
    outputs: Vec<(usize, NodePositions)>,
    forces: Option<Vec<NodeForces>>,
    /// `None` if the scenario is of an older version that cannot be read any more. The rods are
    /// still shown.
    scenario: Option<Scenario>,
    /// Whether outputs were left out.
    pub thinned: bool,
}

impl CaseMotion {
    /// Reads at most `largest_count` outputs of a case, evenly spaced; `None` if it wrote no
    /// positions.
    pub fn read(
        folder: &CaseFolder,
        root: &Manifest,
        largest_count: usize,
    ) -> Result<Option<Self>, ResultsError> {
        if !folder.path.join(NODES).exists() {
            return Ok(None);
        }
        let own = Manifest::read_checked(&folder.path)?;
        let manifest = own.unwrap_or_else(|| root.clone());
        let nodes = manifest.rods.iter().map(|rod| rod.nodes).sum();
        let outputs = read_nodes(&folder.path, nodes)?.into_iter().enumerate();
        let mut outputs: Vec<(usize, NodePositions)> = outputs.collect();
        let mut forces = read_node_forces(&folder.path, nodes)?;
        // A run in progress may be between the two files.
        if let Some(forces) = &mut forces {
            let common = outputs.len().min(forces.len());
            outputs.truncate(common);
            forces.truncate(common);
        }
        let thinned = outputs.len() > largest_count;
        if thinned {
            outputs = evenly_spread(outputs, largest_count);
            forces = forces.map(|forces| evenly_spread(forces, largest_count));
        }
        if outputs.is_empty() || nodes == 0 {
            return Ok(None);
        }
        let scenario = from_text(&manifest.name, &manifest.scenario, &folder.path, &[]);
        Ok(Some(Self {
            folder: folder.clone(),
            path: folder.path.clone(),
            branches: Branches::read(&folder.path)?,
            manifest,
            outputs,
            forces,
            scenario: scenario.ok().map(|loaded| loaded.scenario),
            thinned,
        }))
    }

    /// Rods, planes and bodies in motion.
    pub fn scene(&self) -> MovieCase {
        let scenario = self.scenario.as_ref();
        let outputs = || self.outputs.iter().map(|(_, output)| output);
        let positions = || outputs().map(|output| output.positions.as_slice());
        let placed = &self.outputs[0].1.positions;
        let obstacles = obstacles_of(scenario);
        let times: Vec<f64> = outputs().map(|output| output.time).collect();
        let mut bodies = movie_obstacles(&obstacles, &times, positions().flatten());
        let carried = carried_bodies(scenario, &self.manifest.rods, placed);
        bodies.extend(carried.iter().map(|body| body.in_motion(positions())));
        let threads = threads(scenario, &self.manifest.rods, placed);
        bodies.extend(threads.iter().map(|thread| thread.in_motion(positions())));
        let free = free_bodies(&self.manifest.rods, placed);
        bodies.extend(free.iter().map(|body| body.in_motion(positions())));
        let of_rods = rod_nodes(&self.manifest.rods);
        let branches = self.branches.as_ref();
        let mut case = MovieCase {
            name: self.folder.name.clone(),
            distinction: self.folder.parameters.clone(),
            parameters: flattened(&self.manifest.scenario),
            rods: self.rods(),
            planes: self.planes(),
            obstacles: bodies,
            view: View::oblique(),
            frames: outputs()
                .map(|output| MovieFrame {
                    time: output.time,
                    positions: output.positions[..of_rods].to_vec(),
                    contacts: Vec::new(),
                })
                .collect(),
            fields: Vec::new(),
            series: Vec::new(),
            branches: branches.map(|branches| {
                let numbers = self.outputs.iter().map(|(number, _)| *number);
                numbers.map(|number| branches.of(number)).collect()
            }),
        };
        case.view = case.fitting_view();
        case
    }

    /// Rods, planes and bodies in motion, with colour fields, columns to plot, and places of
    /// contact.
    pub fn with_numbers(&self) -> Result<MovieCase, ResultsError> {
        let mut case = self.scene();
        let of_rods = rod_nodes(&self.manifest.rods);
        let outputs = self.outputs.iter().map(|(_, output)| NodePositions {
            time: output.time,
            positions: output.positions[..of_rods].to_vec(),
        });
        let outputs: Vec<NodePositions> = outputs.collect();
        case.series = series(&self.path, &self.outputs, case.branches.is_some())?;
        case.fields = fields(&case.rods, &outputs, self.forces.as_deref());
        if case.branches.is_some() {
            // Equilibria do not move.
            case.fields.retain(|field| field.unit != "m/s");
        }
        let scenario = self.scenario.as_ref();
        let contacts = contacts(&case.rods, &outputs, scenario, &obstacles_of(scenario));
        for (frame, contacts) in case.frames.iter_mut().zip(contacts) {
            frame.contacts = contacts;
        }
        Ok(case)
    }

    /// The planes of the scenario, and the table of an experiment that has one.
    fn planes(&self) -> Vec<MoviePlane> {
        let described = self.scenario.iter().flat_map(|scenario| &scenario.planes);
        let described = described.map(|plane| MoviePlane {
            point: plane.point,
            normal: plane.normal,
        });
        let kind = kind_named(&self.manifest.experiment);
        let table = kind
            .is_some_and(|kind| kind.has_table())
            .then_some(MoviePlane {
                point: [0.0; 3],
                normal: [0.0, 0.0, 1.0],
            });
        described.chain(table).collect()
    }

    fn rods(&self) -> Vec<MovieRod> {
        let mut first = 0;
        let rods = self.manifest.rods.iter().filter(|record| !record.rigid);
        let rods = rods.map(|record| {
            let placed = &self.outputs[0].1.positions[first..first + record.nodes];
            first += record.nodes;
            let mut described = self.scenario.iter().flat_map(|scenario| &scenario.rods);
            let described = described.find(|rod| rod.name == record.name);
            MovieRod {
                name: record.name.clone(),
                nodes: record.nodes,
                closed: record.closed,
                radius: record.radius,
                radii: record.radii.clone(),
                held: described.is_some_and(|rod| rod.held),
                straight: false,
                strip: strip_of(record, described, self.scenario.as_ref(), placed),
            }
        });
        rods.collect()
    }
}

/// Selects `count` of the items, with the first and the last.
fn evenly_spread<T>(items: Vec<T>, count: usize) -> Vec<T> {
    let last = items.len() - 1;
    let mut wanted = (0..count).map(|k| k * last / (count - 1).max(1)).peekable();
    let spread = items.into_iter().enumerate().filter_map(|(index, item)| {
        wanted.next_if_eq(&index)?;
        Some(item)
    });
    spread.collect()
}

/// Places where the gap between surfaces is below the distance tolerance of the contact model, at
/// each output.
fn contacts(
    rods: &[MovieRod],
    outputs: &[NodePositions],
    scenario: Option<&Scenario>,
    obstacles: &[Obstacle],
) -> Vec<Vec<nalgebra::Vector3<f64>>> {
    let none = vec![Vec::new(); outputs.len()];
    let Some(scenario) = scenario else {
        return none;
    };
    let Some(clearance) = scenario.contact.distance_tolerance() else {
        return none;
    };
    let mut surface = ContactSurface::new();
    let mut first = 0;
    for rod in rods {
        let placed = &outputs[0].positions[first..first + rod.nodes];
        surface.add_rod(first, placed, rod.closed, rod.radius, rod.held);
        if !rod.radii.is_empty() {
            let edges = rod.nodes - usize::from(!rod.closed);
            let ends = (0..edges).map(|edge| [edge, (edge + 1) % rod.nodes]);
            let mean = ends.map(|ends| 0.5 * (rod.radii[ends[0]] + rod.radii[ends[1]]));
            surface.set_radii(&mean.collect::<Vec<f64>>(), &rod.radii);
        }
        first += rod.nodes;
    }
    for obstacle in obstacles {
        surface.add_obstacle(obstacle.body.clone(), None);
    }
    let planes: Vec<ContactPlane> = scenario
        .planes
        .iter()
        .map(|plane| ContactPlane {
            point: plane.point.into(),
            normal: plane.normal.into(),
            friction: None,
            directed_friction: None,
        })
        .collect();
    outputs
        .par_iter()
        .map(|output| {
            let poses = obstacle_poses(obstacles, output.time);
            touching_points(&surface, &planes, &poses, &output.positions, clearance)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_items_hold_both_ends() {
        assert_eq!(evenly_spread((0..=30).collect(), 4), [0, 10, 20, 30]);
        assert_eq!(evenly_spread((0..5).collect(), 5), [0, 1, 2, 3, 4]);
        assert_eq!(evenly_spread((0..5).collect(), 1), [0]);
    }
}
