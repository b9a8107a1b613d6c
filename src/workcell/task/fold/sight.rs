//! Measures a sheet with the camera of a cell: its place, the slide of its free end, and whether
//! its edge has slipped away.

use crate::cell::Cell;
use image::RgbImage;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use rodlab_lab::experiment::{Crease, Paper};
use rodlab_robot::Pose;
use rodlab_vision::{
    Camera, ColourRule, Contrast, EdgePose, FoundEdge, Point, Sheet, VisionError, find_edge,
    find_sheet,
};

/// Tolerance of the side lengths against those in the file, relative.
const SIDES: f64 = 0.03;
/// Search radius of the free end, m: a held sheet slides less.
const REACH: f64 = 0.1;
/// The edge may hide the free end if it appears nearer to it than this, m: about two pixels.
const COVER: f64 = 1.5e-3;
/// Range of each side that is measured next to a corner, as fractions.
const BESIDE_CORNER: [f64; 2] = [0.02, 0.45];
/// Positions across a sheet, as fractions of its width, at which the absence of paper is checked.
const ACROSS: [f64; 5] = [-0.3, -0.15, 0.0, 0.15, 0.3];

/// Detector of a sheet.
pub struct Sight {
    /// The camera, locating on the upper side of the sheet.
    camera: Camera,
    /// Height of the middle of the lying sheet above the origin of the cell, m.
    height: f64,
    colour: ColourRule,
    paper: Paper,
    crease: Crease,
}

/// A visible free end.
#[derive(Clone, Debug)]
pub struct SeenEnd {
    /// Slide in the direction of the fold, m.
    pub slid: f64,
    /// Rotation about the vertical, rad: zero for a sheet that slides straight.
    pub turned: f64,
    /// Edges of the free end in the picture, pixels.
    pub edges: Vec<[Point; 2]>,
}

impl Sight {
    /// Creates the detector for a sheet on the table of a cell.
    ///
    /// # Errors
    /// A message: the cell has no camera.
    pub fn new(
        cell: &Cell,
        paper: Paper,
        crease: Crease,
        colour: &ColourRule,
    ) -> Result<Self, String> {
        let camera = cell.camera.as_ref().ok_or("the cell has no [camera]")?;
        let table = cell.table_height();
        Ok(Self {
            camera: camera.seeing(table + paper.thickness),
            height: table + 0.5 * paper.thickness,
            colour: colour.clone(),
            paper,
            crease,
        })
    }

    /// Finds the sheet and its frame in the cell. The origin is in the middle of an edge; x points
    /// across the sheet, in the direction of a side that is nearest to `heading`, rad.
    ///
    /// # Errors
    /// No sheet is found, or its size differs from the file.
    pub fn find(&self, picture: &RgbImage, heading: f64) -> Result<(Pose, Sheet), VisionError> {
        self.camera.check_size(picture.width(), picture.height())?;
        let locate = |pixel: Point| self.camera.on_table(pixel);
        let sheet = find_sheet(picture, &self.colour, locate)?;
        let edges = [0, 1, 2, 3].map(|edge| sheet.edge(edge));
        let length = self.paper.sheet(self.crease).length;
        let is_diagonal = self.crease == Crease::Diagonal;
        let axis = |start: usize| {
            if is_diagonal {
                (sheet.corners[start], sheet.corners[(start + 2) % 4])
            } else {
                (edges[start].middle, edges[(start + 2) % 4].middle)
            }
        };
        let fits = |start: usize| {
            let (from, to) = axis(start);
            let sides = [
                ((to - from).norm(), length),
                (
                    edges[start].length,
                    if is_diagonal {
                        self.paper.length
                    } else {
                        self.paper.width
                    },
                ),
            ];
            sides
                .iter()
                .all(|(seen, known)| (seen - known).abs() < SIDES * length)
        };
        let turn = |start: usize| {
            let way = axis(start).1 - axis(start).0;
            let turn = libm::atan2(way.y, way.x) - heading;
            libm::cos(turn)
        };
        let fitting = (0..4).filter(|start| fits(*start));
        let start = fitting.max_by(|one, other| turn(*one).total_cmp(&turn(*other)));
        let start = start.ok_or_else(|| self.of_other_size(&edges))?;
        let (from, to) = axis(start);
        let heading = libm::atan2((to - from).y, (to - from).x);
        let frame = Pose::from_parts(
            Translation3::new(from.x, from.y, self.height),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading),
        );
        Ok((frame, sheet))
    }

    fn of_other_size(&self, edges: &[EdgePose; 4]) -> VisionError {
        VisionError::NotFound {
            what: "the sheet",
            reason: format!(
                "sides of {:.1} and {:.1} mm are seen; those of its file are {:.1} and {:.1} mm",
                1e3 * edges[0].length,
                1e3 * edges[1].length,
                1e3 * self.paper.length,
                1e3 * self.paper.width
            ),
        }
    }

    /// Measures the slide of the free end of a sheet with a known frame in the direction of the
    /// fold. `near`, m, is its expected value.
    ///
    /// # Errors
    /// The free end is not found.
    pub fn end(&self, picture: &RgbImage, frame: &Pose, near: f64) -> Result<SeenEnd, VisionError> {
        let back = frame.inverse();
        let locate = |pixel: Point| {
            let place = self.camera.on_table(pixel)?;
            let place = back * Point3::new(place.x, place.y, self.height);
            Ok(Point::new(place.x, place.y))
        };
        let expected = self.free_end();
        let mut found: Vec<(FoundEdge, [Point; 2])> = Vec::new();
        for ends in expected {
            let ends = ends.map(|end| end + Point::new(near, 0.0));
            let pixels = self.in_picture(frame, ends)?;
            let scale = (pixels[1] - pixels[0]).norm() / (ends[1] - ends[0]).norm();
            let edge = find_edge(picture, &self.colour, pixels, scale * REACH, locate)?;
            found.push((edge, ends));
        }
        // An edge n·x = d that moves by Δ along x moves by Δ n_x along its normal.
        let slid = |(edge, [from, to]): &(FoundEdge, [Point; 2])| {
            let middle = (from + to) * 0.5;
            near + (edge.offset - edge.normal.dot(&middle)) / edge.normal.x
        };
        let turned = |(edge, [from, to]): &(FoundEdge, [Point; 2])| {
            let along = to - from;
            let across = Point::new(along.y, -along.x) * along.y.signum();
            libm::atan2(across.perp(&edge.normal), across.dot(&edge.normal))
        };
        let count = found.len() as f64;
        Ok(SeenEnd {
            slid: found.iter().map(slid).sum::<f64>() / count,
            turned: found.iter().map(turned).sum::<f64>() / count,
            edges: found.iter().map(|(edge, _)| edge.pixels).collect(),
        })
    }

    /// Whether the edge may hide the measured part of a free end that has slid by `slid`, m. The
    /// place of the edge is in the frame of the sheet, m.
    pub fn is_end_hidden(&self, frame: &Pose, edge: Vector3<f64>, slid: f64) -> bool {
        let eye = frame.inverse() * Point3::from(self.camera.pose.translation.vector);
        // Place on the table at which the camera sees the edge.
        let seen = edge.x + (edge.x - eye.x) * edge.z / (eye.z - edge.z);
        let length = self.paper.sheet(self.crease).length;
        let beside = match self.crease {
            Crease::Diagonal => 0.5 * BESIDE_CORNER[1] * length,
            _ => 0.0,
        };
        seen > length + slid - beside - COVER
    }

    /// The edges at the free end of a sheet that has not slid, in the frame of the sheet.
    fn free_end(&self) -> Vec<[Point; 2]> {
        let length = self.paper.sheet(self.crease).length;
        if self.crease == Crease::Diagonal {
            let side = |sign: f64| {
                BESIDE_CORNER.map(|part| {
                    let away = 0.5 * part * length;
                    Point::new(length - away, sign * away)
                })
            };
            return vec![side(1.0), side(-1.0)];
        }
        let half = 0.5 * self.paper.width;
        vec![[-half, half].map(|y| Point::new(length, y))]
    }

    /// An edge in the picture, from one end to the other with the sheet on its right.
    fn in_picture(&self, frame: &Pose, ends: [Point; 2]) -> Result<[Point; 2], VisionError> {
        let pixel = |place: Point| {
            let place = frame * Point3::new(place.x, place.y, 0.0);
            let seen = self.camera.project(place.coords);
            seen.ok_or(VisionError::NotFound {
                what: "the free end of the sheet",
                reason: "it is behind the camera".into(),
            })
        };
        let [from, to] = [pixel(ends[0])?, pixel(ends[1])?];
        let inside = pixel((ends[0] + ends[1]) * 0.5 - Point::new(0.02, 0.0))?;
        let is_right = (to - from).perp(&(inside - from)) > 0.0;
        Ok(if is_right { [from, to] } else { [to, from] })
    }

    /// Whether the picture shows paper at x in the frame of a sheet, m. The edge lay there before
    /// it was lifted.
    ///
    /// # Errors
    /// The colour cannot be applied, or the place is outside the picture.
    pub fn is_paper_at(
        &self,
        picture: &RgbImage,
        frame: &Pose,
        x: f64,
    ) -> Result<bool, VisionError> {
        let contrast = Contrast::new(picture, &self.colour)?;
        let is_paper = |part: &&f64| {
            let extent = match self.crease {
                // The corner is narrow near its tip.
                Crease::Diagonal => 2.0 * x,
                _ => self.paper.width,
            };
            let place = frame * Point3::new(x, **part * extent, 0.0);
            let pixel = self.camera.project(place.coords);
            pixel
                .is_some_and(|pixel| contrast.at(pixel.x, pixel.y) >= f64::from(contrast.threshold))
        };
        Ok(2 * ACROSS.iter().filter(is_paper).count() > ACROSS.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;
    use rodlab_vision::{RenderOptions, render};

    const PAPER: Paper = Paper {
        length: 0.2,
        width: 0.2,
        gravito_bending_length: 0.05,
        thickness: 1e-4,
        density: 800.0,
        least_suspended_length: 0.958,
        friction: None,
        edges: 80,
    };

    fn sight(crease: Crease) -> Sight {
        Sight::new(&gantry(), PAPER, crease, &ColourRule::Background).unwrap()
    }

    /// A picture of a flat sheet of 0.2 m by `length` whose frame is moved by `slid` along its x
    /// axis.
    fn picture(sight: &Sight, frame: &Pose, length: f64, slid: f64) -> RgbImage {
        let back = frame.inverse();
        let is_diagonal = sight.crease == Crease::Diagonal;
        let ground = |point: Point| {
            let place = back * Point3::new(point.x, point.y, sight.height);
            let (x, y) = (place.x - slid, place.y);
            let is_on = if is_diagonal {
                let far = 0.1 * std::f64::consts::SQRT_2;
                (x - far).abs() + y.abs() < far
            } else {
                (0.0..length).contains(&x) && y.abs() < 0.1
            };
            if is_on {
                [230.0; 3]
            } else {
                [40.0, 44.0, 48.0]
            }
        };
        render(&sight.camera, &[], ground, &RenderOptions::default())
    }

    fn frame(turn: f64) -> Pose {
        Pose::from_parts(
            Translation3::new(-0.1, 0.02, 5e-5),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn),
        )
    }

    #[test]
    fn a_sheet_is_found_with_its_frame_and_its_sliding_to_a_fraction_of_a_pixel() {
        for crease in [Crease::Half, Crease::Diagonal] {
            let sight = sight(crease);
            let known = frame(0.2);
            let (found, _) = sight.find(&picture(&sight, &known, 0.2, 0.0), 0.0).unwrap();
            let away = known.inverse() * found;
            assert!(away.translation.vector.norm() < 2e-4, "{crease:?} {away}");
            assert!(away.rotation.angle() < 2e-3, "{crease:?} {away}");
            for slid in [-4e-3, 0.0, 6e-3] {
                let moved = picture(&sight, &known, 0.2, slid);
                let seen = sight.end(&moved, &known, 0.0).unwrap();
                assert!(
                    (seen.slid - slid).abs() < 2e-4 && seen.turned.abs() < 2e-3,
                    "{crease:?} {slid}: {seen:?}"
                );
            }
            let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.04);
            let askew = picture(&sight, &(known * turned), 0.2, 0.0);
            let seen = sight.end(&askew, &known, 0.0).unwrap();
            assert!((seen.turned - 0.04).abs() < 2e-3, "{crease:?} {seen:?}");
            // From the opposite side the same square is found with its frame turned by π.
            let turned = sight.find(&picture(&sight, &known, 0.2, 0.0), std::f64::consts::PI);
            let turned = known.inverse() * turned.unwrap().0;
            assert!((turned.rotation.angle() - std::f64::consts::PI).abs() < 2e-3);
        }
    }

    #[test]
    fn an_edge_over_the_free_end_hides_it() {
        let known = frame(0.2);
        let hidden = |crease: Crease, x: f64, z: f64| {
            sight(crease).is_end_hidden(&known, Vector3::new(x, 0.0, z), -0.01)
        };
        assert!(hidden(Crease::Half, 0.19, 2e-4) && !hidden(Crease::Half, 0.185, 2e-4));
        // The camera is 1.6 m above the middle of the table and 0.1 m from the initial place of
        // the edge: a point at a height of 10 cm appears 5 mm farther away.
        assert!(hidden(Crease::Half, 0.185, 0.1) && !hidden(Crease::Half, 0.18, 0.1));
        // For a diagonal fold, the sides next to the corner are measured up to 45 % of half the
        // diagonal.
        let corner = 0.2 * std::f64::consts::SQRT_2 - 0.01;
        assert!(hidden(Crease::Diagonal, corner - 0.06, 2e-4));
        assert!(!hidden(Crease::Diagonal, corner - 0.07, 2e-4));
    }

    #[test]
    fn a_sheet_of_another_size_is_rejected_and_a_lifted_edge_leaves_the_table_bare() {
        let sight = sight(Crease::Half);
        let known = frame(0.0);
        let small = picture(&sight, &known, 0.17, 0.0);
        let error = sight.find(&small, 0.0).unwrap_err().to_string();
        assert!(error.contains("those of its file"), "{error}");
        let flat = picture(&sight, &known, 0.2, 0.0);
        assert!(sight.is_paper_at(&flat, &known, 0.03).unwrap());
        let gone = picture(&sight, &known, 0.14, 0.06);
        assert!(!sight.is_paper_at(&gone, &known, 0.03).unwrap());
        // The end is found at its place, unless it is far from its expected place.
        for near in [0.0, 0.05] {
            let seen = sight.end(&gone, &known, near).unwrap();
            assert!(seen.slid.abs() < 2e-4, "{seen:?}");
        }
        let far = picture(&sight, &known, 0.2, -0.15);
        assert!(sight.end(&far, &known, 0.0).is_err());
    }
}
