//! Description of a simulation: rods, clamps, loads, planes and models, in SI units.
//!
//! A [`Scene`] is plain data. Experiments build it; [`super::dynamics::Simulation`] and
//! [`super::statics`] run it. Node indices in a scene are counted along each rod.

mod actuation;
mod free_body;
mod joint;
mod node_force;
mod section;
mod sheath;
mod tendon;
mod yielding;

pub use actuation::{ActuatedStrain, Actuation, Course, Wave};
pub use free_body::{Axle, BodyJoint, FreeBody};

pub use joint::{
    Body, CoulombFriction, HingeSpring, Joint, JointKind, RodNode, Spring, SpringForce, Strength,
    TurningStiffness,
};

pub use node_force::{NodeForce, NodeHessian};

pub use super::piecewise::piecewise_linear;
pub(crate) use super::piecewise::piecewise_turning;

pub use section::{EdgeSection, Section, edge_sections, pieces};
pub use sheath::Sheath;
pub use tendon::{Eyelet, Pull, Tendon};
pub use yielding::{Layer, PlasticBending, Yielding, YieldingMaterial};

use super::contact::{ContactParameters, DirectedFriction};
use super::fluid::{BackgroundFlow, FluidModel};
use super::rigid_body::RigidBody;
use super::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A complete mechanical scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The rods, in the order of the scenario file.
    pub rods: Vec<RodDescription>,
    /// Held or driven nodes.
    pub clamps: Vec<Clamp>,
    /// Nodes that are joined.
    pub joints: Vec<Joint>,
    /// Springs between nodes.
    pub springs: Vec<Spring>,
    /// Cables through eyelets on rods.
    pub tendons: Vec<Tendon>,
    /// Sheaths out of which rods are fed.
    pub sheaths: Vec<Sheath>,
    /// Point masses and rigid bodies on rods.
    pub bodies: Vec<Body>,
    /// Rigid bodies that no rod carries.
    pub free_bodies: Vec<FreeBody>,
    /// Forces between nodes, or on nodes, that are defined in code.
    pub forces: Vec<Arc<dyn NodeForce>>,
    /// External loads.
    pub loads: Vec<Load>,
    /// Natural strains that change over time.
    pub actuations: Vec<Actuation>,
    /// Rigid half spaces that rods may touch.
    pub planes: Vec<Plane>,
    /// Rigid bodies that rods may touch.
    pub obstacles: Vec<Obstacle>,
    /// Contact model between rods, with planes and with obstacles; `None`: bodies pass through each other.
    pub contact: Option<ContactParameters>,
    /// Surrounding fluid; `None` is a vacuum.
    pub fluid: Option<FluidModel>,
    /// Flow of the fluid without rods; `None` for a fluid at rest.
    pub flow: Option<BackgroundFlow>,
    /// Whether the fluid resists the spin of rods about their own axes.
    pub spin_drag: bool,
    /// Index of the plane at which the fluid is at rest, its no-slip wall, for regularized
    /// Stokeslets. The flow ignores all other planes, and obstacles.
    pub wall: Option<usize>,
    /// Initial positions and velocities that replace those of the descriptions.
    pub start: Option<Start>,
}

/// The final state of a scene with the same rods. Arrays are over all nodes, rod after rod.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// Positions, m.
    pub positions: Vec<Vector3>,
    /// First material director of the edge that starts at each node; zero if none starts.
    pub directors: Vec<Vector3>,
    /// Twist between the edges on either side of each node, rad, including whole turns; 0 at free
    /// ends.
    pub twist: Vec<f64>,
    /// Velocities, m/s; empty if rods start with the velocities of their descriptions.
    pub velocities: Vec<Vector3>,
    /// Rate at which the edge that starts at each node spins about itself, rad/s; of the same
    /// length as `velocities`.
    pub spins: Vec<f64>,
    /// Tangent and first director of the clamp that held the frame at each node, or of the joint or
    /// body to which the rod is clamped there.
    pub walls: Vec<Option<[Vector3; 2]>>,
    /// Angular velocity of that joint or body, rad/s; of the same length as `velocities`.
    pub turning: Vec<Option<Vector3>>,
}

/// One rod as placed at time zero.
#[derive(Clone, Debug)]
pub struct RodDescription {
    /// Name in scenarios and results.
    pub name: String,
    /// Nodes of the centreline, m: N + 1 for an open rod of N edges, N for a closed one.
    pub centreline: Vec<Vector3>,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Unit tangents of the smooth curve at its two ends; clamps use them. `None` extrapolates the edges.
    pub end_tangents: [Option<Vector3>; 2],
    /// Direction of the first material director on the first edge (its part normal to the edge counts);
    /// `None` takes any normal. The other edges' frames follow by parallel transport.
    pub first_director: Option<Vector3>,
    /// Total twist put into the placed rod from first to last edge, rad, evenly spread.
    pub twist: f64,
    /// The shape without stress.
    pub natural_shape: NaturalShape,
    /// Tension T in the placed rod, N, negative for compression. Natural edge lengths are those of
    /// the natural shape divided by 1 + T/EA.
    pub pretension: f64,
    /// Elastic stiffness of the cross-section.
    pub stiffness: Stiffness,
    /// Radius of the contact and fluid surface, m; the largest one if it varies.
    pub radius: f64,
    /// Sections of the edges of a rod whose cross-section varies; empty if it is the same
    /// everywhere. They replace `stiffness`, `mass_per_length` and
    /// `rotational_inertia_per_length`, which are then means over the rod.
    pub sections: Vec<EdgeSection>,
    /// Own friction coefficient; `None`: that of the contact model, or of the bodies that it
    /// touches. `sections` replace it.
    pub friction: Option<f64>,
    /// Mass per length ρA, kg/m.
    pub mass_per_length: f64,
    /// Moment of inertia about the centreline per length, ρ(I₁ + I₂), kg m.
    pub rotational_inertia_per_length: f64,
    /// Distribution of the mass of edges among their nodes.
    pub inertia: Inertia,
    /// Retardation time T of Kelvin–Voigt damping, s: viscosity of the material over its modulus; 0 without damping.
    pub retardation_time: f64,
    /// Viscous part of its stiffness, if any.
    pub relaxation: Option<Relaxation>,
    /// Plastic law of the section; `None` for an elastic rod.
    pub yielding: Option<Yielding>,
    /// Velocity of every node at time zero, m/s.
    pub velocity: Vector3,
    /// Angular velocity about the rod's centroid at time zero, rad/s (nodes' velocities only).
    pub angular_velocity: Vector3,
    /// Whether the rod is a rigid obstacle: every node and edge stays where it was placed.
    pub held: bool,
}

/// The spring and dashpot in series that act in parallel to the spring of a standard linear solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation {
    /// Modulus of that spring relative to Young's modulus, r = E₁/E; the same for stretching,
    /// bending and twisting.
    pub ratio: f64,
    /// Relaxation time τ, s, in which the stress of spring and dashpot at constant strain falls to
    /// 1/e.
    pub time: f64,
}

impl Scene {
    /// Friction coefficients that rods, their sections and free bodies have of their own.
    pub fn own_frictions(&self) -> Vec<f64> {
        let of_rods = self.rods.iter().flat_map(RodDescription::frictions);
        let of_bodies = self.free_bodies.iter().map(|body| body.friction);
        of_rods.chain(of_bodies).flatten().collect()
    }
}

impl RodDescription {
    /// Natural lengths of edges, from their lengths under the tension of the placed rod.
    pub fn relaxed(&self, mut lengths: Vec<f64>) -> Vec<f64> {
        for (edge, length) in lengths.iter_mut().enumerate() {
            *length /= 1.0 + self.pretension / self.section(edge).stretching;
        }
        lengths
    }

    /// A rod with the same circular section everywhere, open and at rest, naturally straight and
    /// untwisted. Most rods are of this kind; use struct update syntax to vary it.
    ///
    /// `stiffness` in N and N m², `radius` in m, `mass_per_length` in kg/m. The moment of inertia about the centreline
    /// is that of a solid circular section, ρ(I₁ + I₂) = ½ ρA h² per length.
    pub fn uniform(
        name: &str,
        centreline: Vec<Vector3>,
        stiffness: Stiffness,
        radius: f64,
        mass_per_length: f64,
    ) -> Self {
        Self {
            name: name.into(),
            centreline,
            closed: false,
            end_tangents: [None; 2],
            first_director: None,
            twist: 0.0,
            natural_shape: NaturalShape::Straight,
            pretension: 0.0,
            stiffness,
            radius,
            sections: Vec::new(),
            friction: None,
            mass_per_length,
            rotational_inertia_per_length: 0.5 * mass_per_length * radius * radius,
            inertia: Inertia::Lumped,
            retardation_time: 0.0,
            relaxation: None,
            yielding: None,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            held: false,
        }
    }
}

/// Distribution of the mass of edges among nodes, and of the weights of vertices next to clamps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Inertia {
    /// Half of the mass of an edge at either node. Vibrations are of second order in the edge
    /// length.
    #[default]
    Lumped,
    /// Mass that is consistent with edges moving linearly from node to node, with Gregory's
    /// weights next to clamps. Vibrations of straight rods are of fourth order.
    Consistent,
}

/// The stress-free shape of a rod.
#[derive(Clone, Debug, PartialEq)]
pub enum NaturalShape {
    /// Curvature, twist and lengths as placed.
    AsPlaced,
    /// Straight and untwisted, edge lengths as placed.
    Straight,
    /// Constant material curvatures (1/m) and twist (rad/m), edge lengths as placed.
    Curved {
        /// Natural curvatures about the two material directors, 1/m: the components κb·m₁ and κb·m₂ of the curvature
        /// binormal.
        curvature: [f64; 2],
        /// Natural twist, rad/m.
        twist: f64,
    },
    /// Curvature, twist and lengths of another polyline with the same number of nodes.
    Centreline(Vec<Vector3>),
    /// Individual lengths, curvatures and twists of each edge and each node.
    Strains(NaturalStrains),
}

/// Natural strains node by node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NaturalStrains {
    /// Natural lengths of the edges, m.
    pub lengths: Vec<f64>,
    /// Natural curvatures about the two material directors at the nodes, 1/m; at the ends, those
    /// of the half vertices at clamps.
    pub curvature: Vec<[f64; 2]>,
    /// Natural twist at the nodes, rad/m.
    pub twist: Vec<f64>,
}

/// Stiffness of a cross-section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// Stretching stiffness EA, N.
    pub stretching: f64,
    /// Bending stiffnesses EI₁ and EI₂ about the first and the second material director, N m².
    pub bending: [f64; 2],
    /// Twisting stiffness GJ, N m².
    pub twisting: f64,
}

impl Stiffness {
    /// Stiffness of a round rod of a radius (m): E π r², E π r⁴/4 and G π r⁴/2 with Young's
    /// modulus E (Pa) and G = E/(2 + 2 ν).
    pub fn circular(youngs_modulus: f64, poissons_ratio: f64, radius: f64) -> Self {
        let stretching = youngs_modulus * std::f64::consts::PI * radius * radius;
        let bending = 0.25 * stretching * radius * radius;
        Self {
            stretching,
            bending: [bending; 2],
            twisting: bending / (1.0 + poissons_ratio),
        }
    }
}

/// A held or driven node.
///
/// Holding the frame adds a ghost half edge at the node: an edge of prescribed direction and
/// material frame. Its Voronoi length is half an edge, so that the wall is at the node itself. At
/// an inner node there is one on either side. If another clamp holds the position, but not the
/// frame, of the node at the other end of an edge, the edge itself is the wall: its material frame
/// is held, without a ghost edge.
#[derive(Clone, Debug)]
pub struct Clamp {
    /// Index of the rod.
    pub rod: usize,
    /// Index of the node along the rod.
    pub node: usize,
    /// Whether the position of the node is held.
    pub holds_position: bool,
    /// Whether tangent and material frame at the node are held.
    pub holds_frame: bool,
    /// Motion of the clamp.
    pub motion: Motion,
}

/// Prescribed motion: x(t) = pivot + R(t)(x(0) − pivot) + translation(t), frame(t) = R(t)
/// frame(0). R(t) rotates first by `angle(t) + angular_velocity · t` about `axis` and then to
/// `orientation(t)`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Motion {
    /// Displacement in m at given times in s.
    pub translation: Vec<(f64, Vector3)>,
    /// Unit vector about which the clamp rotates; `None` is the tangent of the clamp at time zero.
    pub axis: Option<Vector3>,
    /// Angle in rad at given times in s.
    pub angle: Vec<(f64, f64)>,
    /// Constant angular velocity, rad/s.
    pub angular_velocity: f64,
    /// Orientation, relative to that at time zero, at given times in s; in between, the shorter
    /// rotation at constant speed.
    pub orientation: Vec<(f64, UnitQuaternion)>,
    /// Fixed point of the rotation; `None` is the node.
    pub pivot: Option<Vector3>,
}

/// An external load, multiplied by `schedule`: factors at given times, piecewise linear; 1 if
/// empty.
#[derive(Clone, Debug)]
pub struct Load {
    /// The kind of load.
    pub kind: LoadKind,
    /// Factor at given times in s.
    pub schedule: Vec<(f64, f64)>,
}

/// Kinds of external load.
#[derive(Clone, Debug)]
pub enum LoadKind {
    /// Weight of every rod, acceleration in m/s².
    Gravity {
        /// Acceleration of free fall.
        acceleration: Vector3,
    },
    /// A dead force on a node, N.
    Force {
        /// Index of the rod.
        rod: usize,
        /// Index of the node along the rod.
        node: usize,
        /// The force.
        force: Vector3,
    },
    /// A moment of fixed direction on an edge, N m.
    Moment {
        /// Index of the rod.
        rod: usize,
        /// Index of the edge along the rod.
        edge: usize,
        /// The moment.
        moment: Vector3,
    },
    /// A dead force per natural length, N/m, on one rod or on all.
    Distributed {
        /// Index of the rod; `None` means all rods.
        rod: Option<usize>,
        /// Force per length.
        force_per_length: Vector3,
    },
    /// A force on a node that rotates with the rod, N.
    FollowerForce {
        /// Index of the rod.
        rod: usize,
        /// Index of the node along the rod.
        node: usize,
        /// Components along the two material directors and the tangent at the node; at an inner
        /// node, the mean over the two edges.
        force: Vector3,
    },
    /// A moment on an edge that rotates with it, N m.
    FollowerMoment {
        /// Index of the rod.
        rod: usize,
        /// Index of the edge along the rod.
        edge: usize,
        /// Components along the two material directors and the tangent of the edge.
        moment: Vector3,
    },
    /// A force per natural length that rotates with the rod, N/m, on one rod or on all.
    FollowerDistributed {
        /// Index of the rod; `None` means all rods.
        rod: Option<usize>,
        /// Components along the two material directors and the tangent of each edge.
        force_per_length: Vector3,
    },
    /// Linear drag −c v per length, with c in N s/m², on nodes, and −c_θ θ̇ per length on edges.
    Drag {
        /// Index of the rod; `None` means all rods.
        rod: Option<usize>,
        /// Coefficient of the velocity per length, N s/m².
        translation: f64,
        /// Coefficient of the spin per length, N s.
        rotation: f64,
    },
}

/// A rigid half space: the side that `normal` points to is free.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Any point of the surface.
    pub point: Vector3,
    /// Unit normal.
    pub normal: Vector3,
    /// Friction coefficient between plane and rods; overrides that of the contact model.
    pub friction: Option<f64>,
    /// Friction coefficients by the direction of sliding relative to a rod; override `friction`.
    pub directed_friction: Option<DirectedFriction>,
}

impl Plane {
    /// Own friction coefficient, the largest if it depends on the direction; `None` if it has none.
    pub fn own_friction(&self) -> Option<f64> {
        let directed = self.directed_friction.map(|own| own.largest());
        directed.or(self.friction)
    }
}

/// A rigid body that rods may touch.
#[derive(Clone, Debug, Default)]
pub struct Obstacle {
    /// Name in scenarios and results.
    pub name: String,
    /// Shape of the obstacle and its place at time zero.
    pub body: RigidBody,
    /// Friction coefficient between obstacle and rods; overrides that of the contact model.
    pub friction: Option<f64>,
    /// Motion of the body, by default about the centre of its vertices and the z axis.
    pub motion: Motion,
}

impl Motion {
    /// Whether anything moves.
    pub fn moves(&self) -> bool {
        self.angular_velocity != 0.0
            || !self.translation.is_empty()
            || !self.angle.is_empty()
            || !self.orientation.is_empty()
    }
}
