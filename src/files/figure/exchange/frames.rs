//! Sections of a rod: their centres, and axes that do not twist along the rod.

use super::super::motion::{MovieCase, MovieRod, square_to, tangent, turned};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::ops::Range;

/// Place of a section: its centre, m, and its axes as columns: across, square to both, tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section {
    pub centre: Vector3<f64>,
    pub axes: Matrix3<f64>,
}

impl Section {
    /// A point given along the axes from the centre.
    pub fn placed(&self, local: &Vector3<f64>) -> Vector3<f64> {
        self.centre + self.axes * local
    }

    pub fn orientation(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.axes))
    }
}

/// The nodes of each rod among all.
pub(super) fn ranges(case: &MovieCase) -> impl Iterator<Item = (&MovieRod, Range<usize>)> {
    case.rods.iter().scan(0, |first, rod| {
        let range = *first..*first + rod.nodes;
        *first = range.end;
        Some((rod, range))
    })
}

/// Sections of a rod at one time: one for each node, and for a closed rod the first one again,
/// after the turn of the axes around the ring. `before`: its sections at the time before. Tubes are
/// round, so that their axes follow from the first section without twist.
pub(super) fn sections(
    rod: &MovieRod,
    points: &[Vector3<f64>],
    before: Option<&[Section]>,
) -> Vec<Section> {
    let count = points.len() + usize::from(rod.closed);
    let mut sections: Vec<Section> = Vec::with_capacity(count);
    for number in 0..count {
        let node = number % points.len();
        let along = tangent(node, points, rod.closed);
        let from = sections.last().or(before.and_then(|before| before.first()));
        let across = match (&rod.strip, from) {
            (Some(strip), _) => strip.across(node, points, rod.closed),
            (None, Some(from)) => turned(
                &from.axes.column(0).into(),
                &from.axes.column(2).into(),
                &along,
            ),
            (None, None) => square_to(&Vector3::x(), &along),
        };
        sections.push(Section {
            centre: points[node],
            axes: Matrix3::from_columns(&[across, along.cross(&across), along]),
        });
    }
    sections
}

/// Sections of a rod at each output.
pub(super) fn motion(case: &MovieCase, rod: &MovieRod, nodes: Range<usize>) -> Vec<Vec<Section>> {
    let mut motion: Vec<Vec<Section>> = Vec::with_capacity(case.frames.len());
    for frame in &case.frames {
        let points = &frame.positions[nodes.clone()];
        let before = motion.last().map(Vec::as_slice);
        motion.push(sections(rod, points, before));
    }
    motion
}

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;

    #[test]
    fn axes_are_orthonormal_right_handed_and_follow_the_rod() {
        let case = scene();
        for (rod, nodes) in ranges(&case) {
            for (frame, sections) in motion(&case, rod, nodes.clone()).iter().enumerate() {
                let points = &case.frames[frame].positions[nodes.clone()];
                assert_eq!(sections.len(), rod.nodes + usize::from(rod.closed));
                for (number, section) in sections.iter().enumerate() {
                    let axes = section.axes;
                    let error = (axes.transpose() * axes - Matrix3::identity()).norm();
                    assert!(error < 1e-12 && axes.determinant() > 0.0);
                    let along = tangent(number % rod.nodes, points, rod.closed);
                    assert!((axes.column(2) - along).norm() < 1e-12);
                    let turned = section.orientation() * Vector3::x();
                    assert!((turned - axes.column(0)).norm() < 1e-12);
                }
            }
        }
    }
}
