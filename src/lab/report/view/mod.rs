//! The interactive page of a results directory: a run, or the cases of a sweep.

mod fields;
mod parameters;
mod series;

use crate::experiment::{Page, from_text, kind_named};
use crate::report::branches::Branches;
use crate::report::carried_bodies::carried_bodies;
use crate::report::case_folders::{CaseFolder, case_folders};
use crate::report::drawn_springs::drawn_springs;
use crate::report::obstacles::{movie_obstacles, obstacles_of};
use crate::scenario::Scenario;
use fields::fields;
use parameters::flattened;
use rayon::prelude::*;
use rodlab_engine::mechanics::contact::{ContactPlane, ContactSurface, touching_points};
use rodlab_engine::mechanics::scene::Obstacle;
use rodlab_engine::mechanics::system::obstacle_poses;
use rodlab_files::figure::{
    Movie, MovieCase, MovieFrame, MoviePlane, MovieRod, View, is_page, movie_page,
};
use rodlab_files::results::{
    Manifest, NODES, NodePositions, ResultsError, read_node_forces, read_nodes, replace_own,
};
use series::series;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The directory holds no results.
    #[error("`{}` is no results directory: it has no manifest.json; give the directory that `rodlab run` names", .0.display())]
    NotResults(PathBuf),
    /// The runs wrote no positions.
    #[error(
        "`{}` has no nodes.csv with a whole output, so there is nothing to show; set `nodes = true` under [output] and run again",
        .0.display()
    )]
    NoNodes(PathBuf),
    /// The experiment has a page of its own, but not of these results.
    #[error("`{}` has {reason}", directory.display())]
    NoPage {
        /// The directory.
        directory: PathBuf,
        /// What there is, and why it makes no page.
        reason: &'static str,
    },
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

/// What became of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenPage {
    /// Cases that it shows.
    pub cases: usize,
    /// Size of the file.
    pub bytes: usize,
    /// Whether outputs were left out to keep it small.
    pub thinned: bool,
}

/// Writes the page of a results directory to the file `to`, which holds everything it needs.
///
/// Of each case at most `largest_count` outputs are shown, evenly spread. Cases without positions are left
/// out. `done`: called after each case with the number done and the number of all.
///
/// # Errors
/// [`ViewError`]; the file is whole or untouched.
pub fn write_page(
    directory: &Path,
    to: &Path,
    largest_count: usize,
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<WrittenPage, ViewError> {
    let Some(manifest) = Manifest::read_checked(directory)? else {
        return Err(ViewError::NotResults(directory.to_owned()));
    };
    let kind = kind_named(&manifest.experiment);
    let page = kind.map_or(Ok(Page::RodsInMotion), |kind| kind.page(directory))?;
    match page {
        Page::RodsInMotion => {}
        Page::Nothing(reason) => {
            return Err(ViewError::NoPage {
                directory: directory.to_owned(),
                reason,
            });
        }
        Page::Own(page) => {
            replace_own(to, page.as_bytes(), is_page)?;
            return Ok(WrittenPage {
                cases: 1,
                bytes: page.len(),
                thinned: false,
            });
        }
    }
    let folders = case_folders(directory)?;
    let count = AtomicUsize::new(0);
    let read: Result<Vec<_>, ViewError> = folders
        .par_iter()
        .map(|folder| {
            let case = movie_case(folder, &manifest, largest_count);
            done(1 + count.fetch_add(1, Ordering::Relaxed), folders.len());
            case
        })
        .collect();
    let cases: Vec<(MovieCase, bool)> = read?.into_iter().flatten().collect();
    if cases.is_empty() {
        return Err(ViewError::NoNodes(directory.to_owned()));
    }
    let thinned = cases.iter().any(|(_, thinned)| *thinned);
    let cases: Vec<MovieCase> = cases.into_iter().map(|(case, _)| case).collect();
    let movie = Movie {
        title: if manifest.title.is_empty() {
            manifest.name.clone()
        } else {
            manifest.title.clone()
        },
        subtitle: format!("{} · rodlab {}", manifest.experiment, manifest.version),
        cases,
    };
    let page = movie_page(&movie);
    replace_own(to, page.as_bytes(), is_page)?;
    Ok(WrittenPage {
        cases: movie.cases.len(),
        bytes: page.len(),
        thinned,
    })
}

/// A case in motion, and whether outputs were left out; `None` where it wrote no positions.
fn movie_case(
    folder: &CaseFolder,
    root: &Manifest,
    largest_count: usize,
) -> Result<Option<(MovieCase, bool)>, ViewError> {
    if !folder.path.join(NODES).exists() {
        return Ok(None);
    }
    let own = Manifest::read_checked(&folder.path)?;
    let manifest = own.as_ref().unwrap_or(root);
    let nodes = manifest.rods.iter().map(|rod| rod.nodes).sum();
    let branches = Branches::read(&folder.path)?;
    let mut outputs: Vec<(usize, NodePositions)> = read_nodes(&folder.path, nodes)?
        .into_iter()
        .enumerate()
        .collect();
    let mut forces = read_node_forces(&folder.path, nodes)?;
    // A run at work may be between the two files.
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
    // Results of an older version may not be understood as a scenario any more; the rods still are.
    let scenario = from_text(&manifest.name, &manifest.scenario, &folder.path, &[]);
    let scenario = scenario.ok().map(|loaded| loaded.scenario);
    let held = |name: &str| {
        let mut rods = scenario.iter().flat_map(|scenario| &scenario.rods);
        rods.any(|rod| rod.held && rod.name == name)
    };
    let rods: Vec<MovieRod> = manifest
        .rods
        .iter()
        .map(|rod| MovieRod {
            name: rod.name.clone(),
            nodes: rod.nodes,
            closed: rod.closed,
            radius: rod.radius,
            held: held(&rod.name),
        })
        .collect();
    let series = series(&folder.path, &outputs, branches.is_some())?;
    let numbers = outputs.iter().map(|(number, _)| *number);
    let branches = branches.map(|branches| numbers.map(|number| branches.of(number)).collect());
    let outputs: Vec<NodePositions> = outputs.into_iter().map(|(_, output)| output).collect();
    let mut fields = fields(&rods, &outputs, forces.as_deref());
    if branches.is_some() {
        // Equilibria do not move.
        fields.retain(|field| field.unit != "m/s");
    }
    let obstacles = obstacles_of(scenario.as_ref());
    let contacts = contacts(&rods, &outputs, scenario.as_ref(), &obstacles);
    let carried = carried_bodies(scenario.as_ref(), &manifest.rods, &outputs[0].positions);
    let mut bodies = movie_obstacles(
        &obstacles,
        &outputs.iter().map(|output| output.time).collect::<Vec<_>>(),
        outputs.iter().flat_map(|output| &output.positions),
    );
    let positions = || outputs.iter().map(|output| output.positions.as_slice());
    bodies.extend(carried.iter().map(|body| body.in_motion(positions())));
    let springs = drawn_springs(scenario.as_ref(), &manifest.rods);
    bodies.extend(springs.iter().map(|spring| spring.in_motion(positions())));
    let planes = scenario.iter().flat_map(|scenario| &scenario.planes);
    let case = MovieCase {
        name: folder.name.clone(),
        distinction: folder.parameters.clone(),
        parameters: flattened(&manifest.scenario),
        planes: planes
            .map(|plane| MoviePlane {
                point: plane.point,
                normal: plane.normal,
            })
            .collect(),
        obstacles: bodies,
        view: View::fitting(outputs.iter().flat_map(|output| &output.positions)),
        frames: outputs
            .into_iter()
            .zip(contacts)
            .map(|(output, contacts)| MovieFrame {
                time: output.time,
                positions: output.positions,
                contacts,
            })
            .collect(),
        rods,
        fields,
        series,
        branches,
    };
    Ok(Some((case, thinned)))
}

/// `count` of the items, the first and the last among them.
fn evenly_spread<T>(items: Vec<T>, count: usize) -> Vec<T> {
    let last = items.len() - 1;
    let mut wanted = (0..count).map(|k| k * last / (count - 1).max(1)).peekable();
    let spread = items.into_iter().enumerate().filter_map(|(index, item)| {
        wanted.next_if_eq(&index)?;
        Some(item)
    });
    spread.collect()
}

/// Where surfaces are within the distance tolerance of the contact model of each other, at each output.
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
        first += rod.nodes;
    }
    for obstacle in obstacles {
        surface.add_obstacle(obstacle.body.clone(), 0.0);
    }
    let planes: Vec<ContactPlane> = scenario
        .planes
        .iter()
        .map(|plane| ContactPlane {
            point: plane.point.into(),
            normal: plane.normal.into(),
            friction: 0.0,
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

    #[test]
    fn a_directory_without_results_is_refused_by_name() {
        let directory = tempfile::tempdir().unwrap();
        let to = directory.path().join("view.html");
        let error = write_page(directory.path(), &to, 10, &|_, _| ()).unwrap_err();
        assert!(matches!(error, ViewError::NotResults(_)), "{error}");
        assert!(error.to_string().contains("manifest.json"), "{error}");
        assert!(!to.exists());
    }
}
