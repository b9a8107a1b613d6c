//! Distances of arms to each other, to themselves and to obstacles, computed with parry.
//!
//! Pairs that cannot be kept apart are ignored: links with at most one moving joint between them,
//! pairs that overlap in the posture at rest, and pairs that overlap in more than 95 % of postures
//! from the whole range of the joints.

use super::body::{Body, Shape};
use super::chain::{Chain, JointKind, Motion};
use super::pose::Pose;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose3, Rot3, Vec3};
use parry3d_f64::query;
use parry3d_f64::shape::{ConvexPolyhedron, Cuboid, Segment};

/// Largest distance that is computed, m.
pub const FAR: f64 = 0.2;
/// Number of postures for the detection of pairs that always overlap.
const SAMPLES: usize = 200;
/// Fraction of these postures in which such a pair overlaps.
const ALWAYS: f64 = 0.95;

/// One of the arms of a cell.
#[derive(Clone, Debug)]
pub struct Member {
    /// Name of the member.
    pub name: String,
    /// Chain of the member.
    pub chain: Chain,
    /// Pose of the base in the cell.
    pub base: Pose,
    /// Shapes of the member.
    pub bodies: Vec<Body>,
    /// Joint positions at rest.
    pub home: Vec<f64>,
    /// Pairs of links that may touch.
    pub may_touch: Vec<[Option<usize>; 2]>,
}

/// A fixed box.
#[derive(Clone, Debug)]
pub struct StandingBox {
    /// Name of the box.
    pub name: String,
    /// Pose of its centre in the cell.
    pub pose: Pose,
    /// Half its sides, m.
    pub half: [f64; 3],
}

/// Arms and boxes, and the pairs to check.
#[derive(Clone, Debug)]
pub struct Surroundings {
    members: Vec<Member>,
    boxes: Vec<StandingBox>,
    pairs: Vec<Pair>,
}

/// Two shapes: the first by arm and index; the second by arm and index, or an upright box if its
/// arm is `None`.
#[derive(Clone, Copy, Debug)]
struct Pair {
    first: (usize, usize),
    second: (Option<usize>, usize),
}

/// Smallest distance between two objects.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// Distance, m; 0 or less if they overlap.
    pub distance: f64,
    /// Names of the two bodies.
    pub between: [String; 2],
}

impl Surroundings {
    /// Prepares the arms and boxes of a cell.
    pub fn new(members: Vec<Member>, boxes: Vec<StandingBox>) -> Self {
        let mut pairs = Vec::new();
        let pair = |first, second| Pair { first, second };
        for (arm, member) in members.iter().enumerate() {
            for index in 0..member.bodies.len() {
                let first = (arm, index);
                for other in index + 1..member.bodies.len() {
                    if !member.never_counts(index, other) {
                        pairs.push(pair(first, (Some(arm), other)));
                    }
                }
                for (other, them) in members.iter().enumerate().skip(arm + 1) {
                    let theirs = 0..them.bodies.len();
                    pairs.extend(theirs.map(|k| pair(first, (Some(other), k))));
                }
                // The base may touch or enter the table on which it is mounted.
                if member.bodies[index].link.is_some() {
                    let all = 0..boxes.len();
                    pairs.extend(all.map(|k| pair(first, (None, k))));
                }
            }
        }
        let mut surroundings = Self {
            members,
            boxes,
            pairs,
        };
        surroundings.drop_unavoidable();
        surroundings
    }

    /// The arms.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// Joint positions of all arms at rest.
    pub fn homes(&self) -> Vec<Vec<f64>> {
        self.members
            .iter()
            .map(|member| member.home.clone())
            .collect()
    }

    fn drop_unavoidable(&mut self) {
        let homes = self.homes();
        let at_home = self.poses(&homes);
        let mut overlaps = vec![0; self.pairs.len()];
        for k in 0..SAMPLES {
            let postures: Vec<Vec<f64>> = self
                .members
                .iter()
                .map(|member| member.chain.start(k))
                .collect();
            let poses = self.poses(&postures);
            for (pair, count) in self.pairs.iter().zip(&mut overlaps) {
                *count += usize::from(self.distance(pair, &poses) <= 0.0);
            }
        }
        let kept = self.pairs.iter().zip(overlaps).filter(|(pair, count)| {
            (*count as f64) < ALWAYS * SAMPLES as f64 && self.distance(pair, &at_home) > 0.0
        });
        self.pairs = kept.map(|(pair, _)| *pair).collect();
    }

    /// The pair with the least distance for given postures of all arms; `None` if nothing is
    /// nearer than [`FAR`]. If `moving` is given, only pairs with a part of this arm are checked.
    pub fn nearest(&self, postures: &[Vec<f64>], moving: Option<usize>) -> Option<Approach> {
        let poses = self.poses(postures);
        let mut nearest: Option<(f64, &Pair)> = None;
        let counted = self.pairs.iter().filter(|pair| {
            moving.is_none_or(|arm| pair.first.0 == arm || pair.second.0 == Some(arm))
        });
        for pair in counted {
            let distance = self.distance(pair, &poses);
            if distance < nearest.map_or(FAR, |(least, _)| least) {
                nearest = Some((distance, pair));
            }
        }
        nearest.map(|(distance, pair)| Approach {
            distance,
            between: [
                self.name(Some(pair.first.0), pair.first.1),
                self.name(pair.second.0, pair.second.1),
            ],
        })
    }

    /// Distance of the nearest approach, at most [`FAR`].
    pub fn clearance(&self, postures: &[Vec<f64>], moving: Option<usize>) -> f64 {
        self.nearest(postures, moving)
            .map_or(FAR, |approach| approach.distance)
    }

    /// Name and distance, m, of the object that is nearest to some balls, such as the points of a
    /// rod, for given postures of all arms; `None` if nothing is nearer than [`FAR`].
    pub fn nearest_to_balls(
        &self,
        postures: &[Vec<f64>],
        centres: &[Vector3<f64>],
        radius: f64,
    ) -> Option<(String, f64)> {
        let ball = Shape::Capsule {
            half_length: 0.0,
            radius,
        };
        let poses = self.poses(postures);
        let bodies = self.members.iter().zip(&poses).enumerate();
        let bodies = bodies.flat_map(|(arm, (member, poses))| {
            let all = member.bodies.iter().zip(poses).enumerate();
            all.map(move |(index, (body, pose))| (Some(arm), index, body.shape.clone(), *pose))
        });
        let boxes = self.boxes.iter().enumerate();
        let boxes =
            boxes.map(|(index, known)| (None, index, Shape::Box { half: known.half }, known.pose));
        let mut nearest: Option<(f64, Option<usize>, usize)> = None;
        for (arm, index, shape, pose) in bodies.chain(boxes) {
            for centre in centres {
                let place =
                    Pose::from_parts(Translation3::from(*centre), UnitQuaternion::identity());
                let away = distance((&shape, &pose), (&ball, &place));
                if away < nearest.map_or(FAR, |(least, ..)| least) {
                    nearest = Some((away, arm, index));
                }
            }
        }
        nearest.map(|(away, arm, index)| (self.name(arm, index), away))
    }

    fn name(&self, arm: Option<usize>, index: usize) -> String {
        let Some(arm) = arm else {
            return self.boxes[index].name.clone();
        };
        let member = &self.members[arm];
        let link = member.bodies[index]
            .link
            .map_or("base", |link| &member.chain.segments[link].link);
        format!("{}.{link}", member.name)
    }

    /// Poses in the cell of all shapes of all arms.
    fn poses(&self, postures: &[Vec<f64>]) -> Vec<Vec<Pose>> {
        let members = self.members.iter().zip(postures);
        members
            .map(|(member, posture)| {
                let links = member.chain.links(posture);
                let poses = member.bodies.iter().map(|body| {
                    let link = body.link.map_or(Pose::identity(), |link| links[link]);
                    member.base * link * body.pose
                });
                poses.collect()
            })
            .collect()
    }

    /// Distance of a pair; for pairs beyond [`FAR`], the distance of their enclosing balls.
    fn distance(&self, pair: &Pair, poses: &[Vec<Pose>]) -> f64 {
        let (arm, index) = pair.first;
        let first = (&self.members[arm].bodies[index].shape, &poses[arm][index]);
        let upright_shape;
        let second = match pair.second {
            (Some(arm), index) => (&self.members[arm].bodies[index].shape, &poses[arm][index]),
            (None, index) => {
                let upright = &self.boxes[index];
                upright_shape = Shape::Box { half: upright.half };
                (&upright_shape, &upright.pose)
            }
        };
        distance(first, second)
    }
}

impl Member {
    /// For each joint, the largest displacement of a point of the arm per motion of the joint: the
    /// reach of the links beyond a revolute joint, m, and 1 for a prismatic one.
    pub fn reaches(&self) -> Vec<f64> {
        let segments = &self.chain.segments;
        // How far the arm extends from the origin of each link, m: the shapes of the link, and all links beyond it.
        let mut extents = vec![0.0_f64; segments.len() + 1];
        for index in (0..segments.len()).rev() {
            let own = self.bodies.iter().filter(|body| body.link == Some(index));
            let own =
                own.map(|body| body.pose.translation.vector.norm() + body.shape.enclosing_radius());
            let next = segments.get(index + 1).map_or(0.0, |next| {
                next.origin.translation.vector.norm() + next.farthest_slide(&self.chain.joints)
            });
            extents[index] = own.fold(next + extents[index + 1], f64::max);
        }
        let mut reaches = vec![0.0; self.chain.joints.len()];
        for (segment, extent) in segments.iter().zip(&extents) {
            if let Motion::Driven {
                kind, joint, ratio, ..
            } = segment.motion
            {
                reaches[joint] += ratio.abs()
                    * match kind {
                        JointKind::Revolute => *extent,
                        JointKind::Prismatic => 1.0,
                    };
            }
        }
        reaches
    }

    /// Whether two shapes are so close along the chain that they always touch.
    fn never_counts(&self, first: usize, second: usize) -> bool {
        let links = [self.bodies[first].link, self.bodies[second].link];
        let [low, high] = [links[0].min(links[1]), links[0].max(links[1])];
        let begin = low.map_or(0, |link| link + 1);
        let end = high.map_or(0, |link| link + 1);
        let joints = self.chain.segments[begin..end].iter();
        let moving = joints.filter(|segment| segment.moves()).count();
        moving <= 1
            || self
                .may_touch
                .iter()
                .any(|pair| *pair == [links[0], links[1]] || *pair == [links[1], links[0]])
    }
}

impl Shape {
    /// Radius of a ball about the origin that holds the shape.
    fn enclosing_radius(&self) -> f64 {
        match self {
            Self::Capsule {
                half_length,
                radius,
            } => half_length + radius,
            Self::Box { half: [x, y, z] } => (x * x + y * y + z * z).sqrt(),
            Self::Hull(hull) => hull.radius(),
        }
    }
}

fn distance(first: (&Shape, &Pose), second: (&Shape, &Pose)) -> f64 {
    let centres = first.1.translation.vector - second.1.translation.vector;
    let apart = centres.norm() - first.0.enclosing_radius() - second.0.enclosing_radius();
    if apart > FAR {
        return apart;
    }
    let [pose_1, pose_2] = [first.1, second.1].map(glam_pose);
    let (core_1, core_2) = (Core::new(first.0), Core::new(second.0));
    let measured = query::distance(&pose_1, core_1.shape(), &pose_2, core_2.shape());
    // Parry supports all pairs of shapes; otherwise the distance of the enclosing balls is
    // conservative.
    measured.map_or(apart, |core| {
        core.distance - core_1.radius() - core_2.radius()
    })
}

/// A shape for parry: of a capsule only the line, without its radius.
enum Core<'a> {
    Line(Segment, f64),
    Box(Cuboid),
    Hull(&'a ConvexPolyhedron),
}

impl<'a> Core<'a> {
    fn new(shape: &'a Shape) -> Self {
        match shape {
            Shape::Capsule {
                half_length,
                radius,
            } => {
                let end = Vec3::new(0.0, 0.0, half_length.max(1e-9));
                Self::Line(Segment::new(-end, end), *radius)
            }
            Shape::Box { half } => Self::Box(Cuboid::new(Vec3::from_array(*half))),
            Shape::Hull(hull) => Self::Hull(&hull.polyhedron),
        }
    }

    fn shape(&self) -> &dyn parry3d_f64::shape::Shape {
        match self {
            Self::Line(line, _) => line,
            Self::Box(cuboid) => cuboid,
            Self::Hull(hull) => *hull,
        }
    }

    fn radius(&self) -> f64 {
        match self {
            Self::Line(_, radius) => *radius,
            Self::Box(_) | Self::Hull(_) => 0.0,
        }
    }
}

fn glam_pose(pose: &Pose) -> Pose3 {
    let q = pose.rotation.quaternion();
    let t = &pose.translation.vector;
    Pose3::from_parts(
        Vec3::new(t.x, t.y, t.z),
        Rot3::from_xyzw(q.i, q.j, q.k, q.w),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_of_angles;
    use proptest::prelude::*;

    fn ball(at: [f64; 3], radius: f64) -> (Shape, Pose) {
        let shape = Shape::Capsule {
            half_length: 0.0,
            radius,
        };
        (shape, pose_of_angles(at, [0.0; 3]))
    }

    fn between(a: &(Shape, Pose), b: &(Shape, Pose)) -> f64 {
        distance((&a.0, &a.1), (&b.0, &b.1))
    }

    #[test]
    fn crossed_capsules_are_as_far_apart_as_their_lines_less_their_radii() {
        let capsule = |at, angles| {
            let shape = Shape::Capsule {
                half_length: 0.2,
                radius: 0.03,
            };
            (shape, pose_of_angles(at, angles))
        };
        let (a, b) = (
            capsule([0.0; 3], [0.0; 3]),
            capsule([0.1, 0.0, 0.05], [1.2, 0.0, 0.0]),
        );
        assert!((between(&a, &b) - 0.04).abs() < 1e-12);
        let close = capsule([0.05, 0.0, 0.0], [1.2, 0.0, 0.0]);
        assert!((between(&a, &close) + 0.01).abs() < 1e-12);
    }

    /// No point of an arm is farther from the axis of a joint than its reach, and one gets there.
    #[test]
    fn a_joint_reaches_as_far_as_what_slides_beyond_it() {
        use crate::chain::{JointKind, Motion};
        use crate::tests::{chain, revolute};
        let mut arm = chain(
            vec![
                revolute(Pose::identity(), (-3.0, 3.0)),
                revolute(Pose::translation(0.3, 0.0, 0.0), (-0.1, 0.4)),
            ],
            Pose::identity(),
        );
        arm.joints[1].kind = JointKind::Prismatic;
        if let Motion::Driven { kind, axis, .. } = &mut arm.segments[1].motion {
            (*kind, *axis) = (JointKind::Prismatic, Vector3::x_axis());
        }
        let member = Member {
            name: "arm".into(),
            chain: arm,
            base: Pose::identity(),
            bodies: vec![Body {
                link: Some(1),
                pose: Pose::translation(0.05, 0.0, 0.0),
                shape: ball([0.0; 3], 0.02).0,
            }],
            home: vec![0.0; 2],
            may_touch: Vec::new(),
        };
        // 0.3 m to the slide, 0.4 m along it, 0.05 m to the middle of the ball, and its radius.
        let [turning, sliding] = member.reaches()[..] else {
            panic!("two joints");
        };
        assert!((turning - 0.77).abs() < 1e-12, "{turning}");
        assert_eq!(sliding, 1.0);
    }

    #[test]
    fn the_nearest_thing_to_some_balls_is_named() {
        let boxes = [("near", 0.15), ("far", 0.5)].map(|(name, x)| StandingBox {
            name: name.into(),
            pose: pose_of_angles([x, 0.0, 0.0], [0.0; 3]),
            half: [0.05; 3],
        });
        let surroundings = Surroundings::new(Vec::new(), boxes.into());
        let balls = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.3]].map(Vector3::from);
        let (name, away) = surroundings.nearest_to_balls(&[], &balls, 0.02).unwrap();
        assert_eq!(name, "near");
        assert!((away - 0.08).abs() < 1e-12, "{away}");
        let far = [Vector3::new(0.0, 2.0, 0.0)];
        assert_eq!(surroundings.nearest_to_balls(&[], &far, 0.02), None);
    }

    proptest! {
        #[test]
        fn a_box_is_as_far_from_a_ball_as_its_nearest_point(
            half in prop::array::uniform3(0.01..0.3_f64),
            place in prop::array::uniform3(-0.3..0.3_f64),
            angles in prop::array::uniform3(-3.0..3.0_f64),
            centre in prop::array::uniform3(-0.5..0.5_f64),
        ) {
            let pose = pose_of_angles(place, angles);
            let shape = (Shape::Box { half }, pose);
            let local = pose.inverse() * nalgebra::Point3::from(centre);
            let outside: f64 = (0..3).map(|k| (local[k].abs() - half[k]).max(0.0).powi(2)).sum();
            let exact = outside.sqrt() - 0.02;
            let found = between(&shape, &ball(centre, 0.02));
            prop_assert!((found.min(FAR) - exact.min(FAR)).abs() < 1e-6 || exact > FAR, "{found} {exact}");
        }
    }
}
