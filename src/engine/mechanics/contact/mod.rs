//! Contact between rods, with planes and with obstacles: broad phase, distances, three contact models, friction.
//!
//! [`ContactSystem`] holds all contacts of a scene; the other files follow the steps from geometry
//! to force:
//!
//! | file | contents |
//! |---|---|
//! | `surface`, `plane` | edges as capsules, planes, obstacles, which pairs are neighbours |
//! | `placed_obstacles`, `foot` | rigid obstacles: positions, parts near a rod, and the foot of a node on a face |
//! | `box_tree` | boxes around the parts of an obstacle, and which of them are near |
//! | `body_faces` | faces of free bodies, which move |
//! | `body_turns`, `spun_contacts` | friction at the surfaces of free bodies |
//! | `broad_phase`, `candidates` | pairs of edges that may touch, kept over many steps |
//! | `closest_points`, `distance` | centreline distance Δ of two edges and its derivatives (thesis Eqs. 2.3–2.6) |
//! | `inside` | points inside a closed obstacle |
//! | `prescribed` | contacts of prescribed points, which carry no force |
//! | `root`, `roots` | clamped nodes at which a rod leaves a body that it is set in |
//! | `rim` | the rims of tubes |
//! | `reflex_edge` | edges in valleys of a mesh, which have no contact |
//! | `smooth_faces`, `patch` | meshes that stand for smooth surfaces, and their faces as curved patches |
//! | `patch_search` | the foot of a node on them |
//! | `jet` | numbers with first and second derivatives |
//! | `nearest_points` | the same of two edges, or of a node and a face |
//! | `parameters` | the contact model and its numbers |
//! | `normal_law`, `normal_response`, `potential`, `barrier` | contact energy of a gap: Eqs. 2.15, 2.16 or the barrier of Eq. 2.1 |
//! | `continuous_collision`, `step_bound` | bound on a step that does not cross the barrier |
//! | `certificate` | check that no bodies passed through each other in a step |
//! | `curve_points`, `nodes_and_points` | contact points on smooth curves through the nodes |
//! | `coupled_pairs` | pairs for which the Newton system has room |
//! | `constraints` | contacts as constraints, whose forces are found by complementarity (thesis 3.3) |
//! | `constraint_turns` | rotations of free bodies at them |
//! | `active_law`, `active_set` | the same near a solution, as laws for its derivatives |
//! | `friction` | Coulomb friction, smoothed near zero slip (Eqs. 2.7–2.14) |
//! | `directed_friction` | the same with coefficients along and across a rod, on planes |
//! | `edge_contact`, `plane_contact` | force and Jacobian of one contact |
//! | `turning`, `levers` | the same with friction at surfaces that turn with the edges of rods |
//! | `surface_turns`, `turned_contacts` | angles of edges in a step, and the contacts that turn them |
//! | `multipliers`, `tractions`, `slots`, `iterate` | normal forces and friction that Newton's method carries along |
//! | `stored_energy` | contact energy at other configurations than the last evaluation |
//! | `dampers` | contact forces as functions of the start of a step and of the contact stiffness |
//! | `stiffness` | the adaptive contact stiffness (Eqs. 2.18, 2.19) |
//! | `contacts` | data of a single contact |
//! | `contact_system`, `evaluation`, `plane_evaluation` | all contacts of a scene |
//! | `proximity` | least distance, penetration, overlaps of a new scene |
//! | `rest_gap` | gap of surfaces at rest |
//! | `touching` | points of contact, for pictures |
//! | `memory` | data for a restart |

mod active_law;
mod active_set;
mod barrier;
mod body_faces;
mod body_turns;
mod box_tree;
mod broad_phase;
mod candidates;
mod certificate;
mod closest_points;
mod constraint_turns;
mod constraints;
mod contact_system;
mod contacts;
mod continuous_collision;
mod coupled_pairs;
mod curve_points;
mod dampers;
mod directed_friction;
mod distance;
mod edge_contact;
mod edge_turn;
mod evaluated;
mod evaluation;
mod foot;
mod friction;
mod inside;
mod iterate;
mod jet;
mod levers;
mod memory;
mod multipliers;
mod nearest_in_step;
mod nearest_points;
mod nodes_and_points;
mod normal_law;
mod normal_response;
#[cfg(test)]
mod obstacle_tests;
mod own_friction;
mod pair_evaluation;
mod parameters;
mod patch;
mod patch_search;
mod placed_obstacles;
mod plane;
mod plane_contact;

mod plane_evaluation;
mod potential;
mod prescribed;
mod proximity;
mod reflex_edge;
mod rest_gap;
mod rim;
#[cfg(test)]
mod rim_tests;
mod root;
mod roots;
mod slots;
mod smooth_faces;
mod spun_contacts;
mod step_bound;
mod stiffness;
mod stored_energy;
mod surface;
mod surface_turns;
#[cfg(test)]
mod test_support;
#[cfg(test)]
mod tests;
mod touching;
mod tractions;
mod turned_contacts;
mod turning;

pub(crate) use active_law::ActiveLaw;
pub(crate) use body_turns::{SPUN, SpunContact, SpunJacobian};
pub(crate) use closest_points::edge_distance;
pub(crate) use constraint_turns::ConstraintTurns;
pub use contact_system::ContactSystem;
pub use contacts::{
    ActiveContact, CandidatePair, ConstraintPlace, ContactConstraint, ContactPair, EdgeJacobian,
    ForceCorrections, PlaneContact, PlaneJacobian, Proximity,
};
pub(crate) use curve_points::{CurvePoints, PER_EDGE, RowOfNodes, WINDOW, Window};
pub(crate) use dampers::FromStart;
pub use directed_friction::DirectedFriction;
pub(super) use friction::cut;
pub(crate) use levers::{Levers, NONE};
pub(crate) use memory::{ContactMemory, MismatchedMemory};
pub use parameters::{ContactModel, ContactParameters, FrictionAt, Geometry};
pub use plane::ContactPlane;
pub(crate) use root::{Root, RootBody};
pub(crate) use stiffness::Adaption;
pub(crate) use stored_energy::Stored;
pub use surface::{ContactEdge, ContactSurface};
pub(crate) use surface_turns::{TurnedBodies, TurnedContact};
pub(crate) use touching::overlapping_edges;
pub use touching::touching_points;
pub(crate) use turned_contacts::TurningEdges;
pub(crate) use turning::Row;
