//! The 3-D page of a cell along a joint trajectory: links are capsules, boxes are drawn by their
//! edges.

use super::resolved::{Arm, Cell};
use nalgebra::{Point3, Vector3};
use rodlab_files::figure::{Movie, MovieCase, MovieFrame, MovieRod, View, movie_page};
use rodlab_robot::{JointTrajectory, Pose, Shape};

/// Radius of the lines that represent the edges of boxes, m.
const LINE: f64 = 2e-3;
/// Radius of the lines from joint to joint of an arm without shapes, m.
const BONE: f64 = 1e-2;

/// A line of a picture of the cell.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name of the link or the box.
    pub name: String,
    /// Radius, m.
    pub radius: f64,
    /// Points, m, in the frame of the cell.
    pub points: Vec<Vector3<f64>>,
}

/// Lines of the page.
#[derive(Default)]
struct Lines(Vec<Line>);

impl Cell {
    /// The page as HTML: the arms at home, or along a trajectory with at most the given number of
    /// frames. `lines` are drawn in all frames.
    pub fn page(
        &self,
        trajectory: Option<&JointTrajectory>,
        most_frames: usize,
        lines: &[Line],
    ) -> String {
        let frames: Vec<(f64, Lines)> = match trajectory {
            None => {
                let homes: Vec<Vec<f64>> = self.arms.iter().map(|arm| arm.home.clone()).collect();
                vec![(0.0, self.lines(&homes, lines))]
            }
            Some(trajectory) => {
                let count = trajectory.points.len().min(most_frames.max(1));
                let last = trajectory.points.len() - 1;
                (0..count)
                    .map(|k| k * last / (count - 1).max(1))
                    .map(|k| (trajectory.times[k], self.postures(trajectory, k)))
                    .map(|(time, postures)| (time, self.lines(&postures, lines)))
                    .collect()
            }
        };
        let rods = frames[0].1.0.iter().map(|line| MovieRod {
            name: line.name.clone(),
            nodes: line.points.len(),
            closed: false,
            radius: line.radius,
            radii: Vec::new(),
            held: false,
            straight: true,
            strip: None,
        });
        let case = MovieCase {
            obstacles: Vec::new(),
            name: "main".into(),
            distinction: Vec::new(),
            parameters: Vec::new(),
            rods: rods.collect(),
            planes: Vec::new(),
            view: View::oblique(),
            frames: frames
                .into_iter()
                .map(|(time, lines)| MovieFrame {
                    time,
                    positions: lines.0.into_iter().flat_map(|line| line.points).collect(),
                    contacts: Vec::new(),
                })
                .collect(),
            fields: Vec::new(),
            series: Vec::new(),
            branches: None,
        };
        movie_page(&Movie {
            title: self.title.clone(),
            subtitle: format!("cell · rodlab {}", rodlab_files::origin::VERSION),
            cases: vec![case],
            reload: None,
        })
    }

    /// Joint positions of all arms at a point of a trajectory. Arms and joints that the trajectory
    /// does not name are at home.
    fn postures(&self, trajectory: &JointTrajectory, point: usize) -> Vec<Vec<f64>> {
        let position = |arm: &Arm, joint: usize| {
            let name = &arm.chain.joints[joint].name;
            let column = trajectory
                .columns
                .iter()
                .position(|column| column.part == arm.name && column.joint.as_ref() == Some(name));
            column.map_or(arm.home[joint], |column| trajectory.points[point][column])
        };
        self.arms
            .iter()
            .map(|arm| {
                (0..arm.home.len())
                    .map(|joint| position(arm, joint))
                    .collect()
            })
            .collect()
    }

    fn lines(&self, postures: &[Vec<f64>], more: &[Line]) -> Lines {
        let arms = postures.iter().enumerate();
        let arms = arms.flat_map(|(arm, posture)| self.arm_lines(arm, posture));
        let all = arms.chain(self.box_lines());
        Lines(all.chain(more.iter().cloned()).collect())
    }

    /// The links of an arm at joint positions, rad or m.
    pub fn arm_lines(&self, arm: usize, posture: &[f64]) -> Vec<Line> {
        let mut lines = Lines::default();
        lines.arm(&self.arms[arm], posture);
        lines.0
    }

    /// The edges of the table and the obstacles.
    pub fn box_lines(&self) -> Vec<Line> {
        let mut lines = Lines::default();
        for standing in self.boxes() {
            lines.edges(&standing.name, &standing.pose, standing.half);
        }
        lines.0
    }

    /// Paths of the hands of all arms that move along a trajectory, with at most `most` points
    /// each, m.
    pub fn hand_paths(&self, trajectory: &JointTrajectory, most: usize) -> Vec<Vec<[f64; 3]>> {
        let stride = trajectory.points.len().div_ceil(most.max(1)).max(1);
        let moving = self.arms.iter().enumerate();
        let moving = moving.filter(|(_, arm)| !trajectory.columns_of(&arm.name).is_empty());
        let path = |arm: usize| {
            let points = (0..trajectory.points.len()).step_by(stride);
            points
                .map(|point| self.hand_at(trajectory, point, arm).into())
                .collect()
        };
        moving.map(|(arm, _)| path(arm)).collect()
    }

    /// Position of the hand of an arm at a point of a trajectory, m.
    pub(crate) fn hand_at(
        &self,
        trajectory: &JointTrajectory,
        point: usize,
        arm: usize,
    ) -> Vector3<f64> {
        let posture = &self.postures(trajectory, point)[arm];
        self.arms[arm].hand(posture).translation.vector
    }
}

impl Lines {
    fn arm(&mut self, arm: &Arm, posture: &[f64]) {
        let links = arm.chain.links(posture);
        if arm.bodies.is_empty() {
            let joints = std::iter::once(arm.base.translation.vector)
                .chain(
                    links
                        .iter()
                        .map(|link| (arm.base * link).translation.vector),
                )
                .chain([arm.hand(posture).translation.vector]);
            self.add(&arm.name, BONE, joints);
        }
        for body in &arm.bodies {
            let link = body.link.map_or(Pose::identity(), |link| links[link]);
            let pose = arm.base * link * body.pose;
            let name = body
                .link
                .map_or("base", |link| &arm.chain.segments[link].link);
            let name = format!("{}.{name}", arm.name);
            match &body.shape {
                Shape::Capsule {
                    half_length,
                    radius,
                } => {
                    // A ball needs a short line too, so that its tube has a direction.
                    let end = half_length.max(1e-4);
                    let at = |z: f64| (pose * Point3::new(0.0, 0.0, z)).coords;
                    self.add(&name, *radius, [at(-end), at(end)]);
                }
                Shape::Box { half } => self.edges(&name, &pose, *half),
                Shape::Hull(hull) => {
                    for outline in hull.outlines() {
                        let points = outline.iter().map(|at| (pose * Point3::from(*at)).coords);
                        self.add(&name, LINE, points);
                    }
                }
            }
        }
    }

    /// The twelve edges of a box, as one line through its corners.
    fn edges(&mut self, name: &str, pose: &Pose, half: [f64; 3]) {
        // Around the bottom, up, around the top; then down and up again at the other three
        // corners.
        const CORNERS: [usize; 16] = [0, 1, 3, 2, 0, 4, 5, 1, 5, 7, 3, 7, 6, 2, 6, 4];
        let corner = |bits: usize| {
            let side = |k: usize| [-half[k], half[k]][bits >> k & 1];
            (pose * Point3::new(side(0), side(1), side(2))).coords
        };
        let points = CORNERS.iter().map(|bits| corner(*bits));
        self.add(name, LINE, points);
    }

    fn add(&mut self, name: &str, radius: f64, points: impl IntoIterator<Item = Vector3<f64>>) {
        self.0.push(Line {
            name: name.to_owned(),
            radius,
            points: points.into_iter().collect(),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_box_shows_all_of_its_edges() {
        let mut lines = Lines::default();
        lines.edges("box", &Pose::identity(), [1.0, 2.0, 3.0]);
        let edges: BTreeSet<String> = lines.0[0]
            .points
            .windows(2)
            .map(|pair| {
                assert_eq!((pair[0] - pair[1]).iter().filter(|d| **d != 0.0).count(), 1);
                let mut ends = [format!("{:?}", pair[0]), format!("{:?}", pair[1])];
                ends.sort();
                ends.join(" ")
            })
            .collect();
        assert_eq!(edges.len(), 12);
    }
}
