//! Forces of the fluid on nodes, from their positions and velocities.

use super::continuation::Continuation;
use super::report::FluidReport;
use super::spheres::{Sphere, Spheres};
use super::stations::nodes_of;
use super::stokeslet_drag::{StokesletDrag, StokesletMemory};
use super::{Connections, Filament, FluidError, FluidModel, Wall, resistive_force_theory};
use crate::mechanics::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Far-field errors that the expansions can guarantee. Truncating the regularised kernel and using
/// Gauss points on the segments cause a smaller error than the least of these.
const FAR_FIELD_ERRORS: RangeInclusive<f64> = 1e-6..=1e-2;

/// Overlap of two spheres that counts as rounding, relative to the sum of their radii.
const OVERLAP: f64 = 1e-9;

/// A viscous fluid around filaments.
pub struct Fluid {
    filaments: Vec<Filament>,
    method: Method,
}

enum Method {
    Stokeslets(Box<StokesletDrag>),
    Resistive {
        viscosity: f64,
        continuation: Continuation,
        spheres: Box<Spheres>,
        /// Radii of the edges of each filament, m; empty if they are that of the filament.
        radii: Vec<Vec<f64>>,
    },
}

/// The state of a [`Fluid`] that influences its later results; part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FluidMemory(Option<StokesletMemory>);

/// Influence of the motion of other nodes on the drag on a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Estimate of the largest eigenvalue of D⁻¹ R, with the resistance R of all nodes and its local part D.
    pub largest_ratio: f64,
    /// Relative error of the drag left by its iterative solution.
    pub tolerance: f64,
}

impl Fluid {
    /// Creates a fluid around unconnected filaments, no two of which share a node.
    ///
    /// # Errors
    /// [`FluidError::BadInput`] for a viscosity, regularisation or radius that is not positive and
    /// finite, for a far-field error that is neither 0 nor from 10⁻⁶ to 10⁻², for filaments of
    /// less than two nodes, and for filaments that share nodes.
    pub fn new(model: &FluidModel, filaments: &[Filament]) -> Result<Self, FluidError> {
        check(filaments)?;
        let method = match *model {
            FluidModel::RegularizedStokeslets {
                viscosity,
                regularization,
                far_field_error,
            } => {
                positive("viscosity", viscosity)?;
                positive("regularisation", regularization)?;
                if far_field_error != 0.0 && !FAR_FIELD_ERRORS.contains(&far_field_error) {
                    return Err(FluidError::BadInput(format!(
                        "the far-field error of the fluid must be 0 or from {:e} to {:e}, not {far_field_error:e}",
                        FAR_FIELD_ERRORS.start(),
                        FAR_FIELD_ERRORS.end(),
                    )));
                }
                let drag =
                    StokesletDrag::new(viscosity, regularization, far_field_error, filaments);
                Method::Stokeslets(Box::new(drag))
            }
            FluidModel::Quadratic { .. } => {
                return Err(FluidError::BadInput(
                    "quadratic drag is a force of the scene, not a viscous flow".into(),
                ));
            }
            FluidModel::Resistive { viscosity } => {
                positive("viscosity", viscosity)?;
                Method::Resistive {
                    viscosity,
                    continuation: Continuation::default(),
                    spheres: Box::default(),
                    radii: vec![Vec::new(); filaments.len()],
                }
            }
        };
        Ok(Self {
            filaments: filaments.to_vec(),
            method,
        })
    }

    /// Creates such a fluid beside a plane at which the fluid is at rest, the no-slip wall of the
    /// flow; for regularized Stokeslets only.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`FluidError::BadInput`] for another model, a normal that is not a unit vector, and for more
    /// than 5000 nodes.
    pub fn beside_wall(
        model: &FluidModel,
        filaments: &[Filament],
        wall: Wall,
    ) -> Result<Self, FluidError> {
        let mut fluid = Self::new(model, filaments)?;
        if !((wall.normal.norm() - 1.0).abs() < 1e-9 && wall.point.iter().all(|x| x.is_finite())) {
            return Err(FluidError::BadInput(
                "the wall of a fluid needs a point and a unit normal".into(),
            ));
        }
        match (&mut fluid.method, model) {
            (
                Method::Stokeslets(drag),
                FluidModel::RegularizedStokeslets { regularization, .. },
            ) => drag.set_wall(*regularization, wall)?,
            _ => {
                return Err(FluidError::BadInput(
                    "only a fluid of regularized Stokeslets has walls".into(),
                ));
            }
        }
        Ok(fluid)
    }

    /// Gives the edges of filaments their own radii, m; an empty list leaves those of a filament.
    ///
    /// # Errors
    /// [`FluidError::BadInput`] for regularized Stokeslets.
    pub(crate) fn set_edge_radii(&mut self, of_edges: Vec<Vec<f64>>) -> Result<(), FluidError> {
        match &mut self.method {
            Method::Resistive { radii, .. } => *radii = of_edges,
            Method::Stokeslets(_) => {
                return Err(FluidError::BadInput(
                    "regularized Stokeslets need rods with the same radius everywhere; use fluid.model = \"resistive\"".into(),
                ));
            }
        }
        Ok(())
    }

    /// Adds spheres to the filaments, before these are connected. `positions` (m) has an entry for
    /// each node and each point that rotates with a sphere; nodes that are inside a sphere now are
    /// part of it.
    ///
    /// # Errors
    /// [`FluidError::BadInput`] for a radius that is not positive and finite, for spheres that overlap, and beside a wall.
    pub(crate) fn set_spheres(
        &mut self,
        spheres: &[Sphere],
        positions: &[Vector3],
    ) -> Result<(), FluidError> {
        for (number, sphere) in spheres.iter().enumerate() {
            positive("sphere radius", sphere.radius)?;
            for other in &spheres[..number] {
                let distance = (positions[sphere.centre] - positions[other.centre]).norm();
                if distance < (1.0 - OVERLAP) * (sphere.radius + other.radius) {
                    return Err(FluidError::BadInput(format!(
                        "two spheres in the flow overlap: their centres are {distance:.3e} m apart, less than the sum of their \
                         radii, {:.3e} m; place them apart, or make them one body",
                        sphere.radius + other.radius
                    )));
                }
            }
        }
        let stations: Vec<Vector3> = nodes_of(&self.filaments)
            .map(|node| positions[node])
            .collect();
        let spheres = Spheres::new(spheres, &stations, positions);
        match &mut self.method {
            Method::Stokeslets(drag) => drag.set_spheres(spheres)?,
            Method::Resistive { spheres: own, .. } => **own = spheres,
        }
        Ok(())
    }

    /// The first node that is at or behind the wall although it may not be: its index in the
    /// scene, and its height, m.
    pub(crate) fn behind_wall(&self, positions: &[Vector3]) -> Option<(usize, f64)> {
        match &self.method {
            Method::Stokeslets(drag) => drag.wall()?.behind(positions),
            Method::Resistive { .. } => None,
        }
    }

    /// Sets the connections of filaments at `positions` (m, of all nodes of the scene). Nodes at
    /// the same point are one point of the flow, joined or not, until they separate.
    pub(crate) fn connect(&mut self, connections: &Connections, positions: &[Vector3]) {
        match &mut self.method {
            Method::Stokeslets(drag) => drag.connect(connections, positions),
            Method::Resistive { continuation, .. } => {
                *continuation = Continuation::new(&self.filaments, connections);
            }
        }
    }

    /// Pairs of unjoined nodes that were at the same point when the filaments were placed; empty
    /// if nodes do not interact through the fluid.
    pub(crate) fn met_by_chance(&self) -> Vec<[usize; 2]> {
        match &self.method {
            Method::Stokeslets(drag) => drag.met_by_chance(),
            Method::Resistive { .. } => Vec::new(),
        }
    }

    /// The two nodes closest to each other, and their distance over the smaller regularisation
    /// length; neighbours along a filament and nodes of one point are excluded. `None` if nodes do
    /// not interact through the fluid.
    pub(crate) fn nearest_nodes(&self, positions: &[Vector3]) -> Option<([usize; 2], f64)> {
        match &self.method {
            Method::Stokeslets(drag) => drag.nearest_nodes(positions),
            Method::Resistive { .. } => None,
        }
    }

    /// Computes the force of the fluid on every node (N) and its local resistance D (N s/m,
    /// symmetric positive definite): a change δv of the node's own velocity changes the force on
    /// it by about −D δv, exactly so for resistive force theory.
    ///
    /// All slices have one entry per node of the scene and, with spheres, one per point that
    /// rotates with a sphere; positions in m and velocities in m/s. `spins` (rad/s) are those of
    /// the edges that start at the nodes, about their tangents; empty if their flow is ignored, as
    /// in resistive force theory. Nodes outside all filaments get zero. The centre of a sphere
    /// gets the force on it; the points that rotate with it get forces whose torques add up to the
    /// torque on it.
    ///
    /// # Errors
    /// See [`FluidError`]; `forces` and `resistance` are then unspecified, while the memory stays valid
    /// for another attempt.
    pub fn drag(
        &mut self,
        positions: &[Vector3],
        velocities: &[Vector3],
        spins: &[f64],
        forces: &mut [Vector3],
        resistance: &mut [Matrix3],
    ) -> Result<FluidReport, FluidError> {
        forces.fill(Vector3::zeros());
        resistance.fill(Matrix3::zeros());
        match &mut self.method {
            Method::Stokeslets(drag) => drag.drag(positions, velocities, spins, forces, resistance),
            Method::Resistive {
                viscosity,
                continuation,
                spheres,
                radii,
            } => {
                resistive_force_theory::drag(
                    *viscosity,
                    (&self.filaments, radii),
                    continuation.lengths(&self.filaments, positions),
                    positions,
                    velocities,
                    forces,
                    resistance,
                )?;
                let stations = nodes_of(&self.filaments).enumerate();
                for (_, node) in stations.filter(|&(station, _)| spheres.hold(station)) {
                    forces[node] = Vector3::zeros();
                    resistance[node] = Matrix3::zeros();
                }
                spheres.add_own_drag(*viscosity, velocities, forces, resistance);
                Ok(FluidReport::default())
            }
        }
    }

    /// Adds the derivatives of the power Σ λ·D v of the local resistance with respect to the
    /// positions of the nodes, for `velocities` v and a `motion` λ of all nodes; nothing for a flow.
    ///
    /// # Errors
    /// As [`Self::drag`].
    pub(crate) fn add_power_gradient(
        &mut self,
        positions: &[Vector3],
        velocities_and_motion: [&[Vector3]; 2],
        gradient: &mut [Vector3],
    ) -> Result<(), FluidError> {
        let Method::Resistive {
            viscosity,
            continuation,
            spheres,
            radii,
        } = &mut self.method
        else {
            return Ok(());
        };
        let stations = nodes_of(&self.filaments).enumerate();
        let inside = stations.filter(|&(station, _)| spheres.hold(station));
        let inside: Vec<usize> = inside.map(|(_, node)| node).collect();
        let lengths = continuation.lengths(&self.filaments, positions).to_vec();
        resistive_force_theory::add_power_gradient(
            *viscosity,
            (&self.filaments, radii),
            (&lengths, continuation.chains()),
            &|node| !inside.contains(&node),
            positions,
            velocities_and_motion,
            gradient,
        )
    }

    /// Computes the force of the fluid on every node (N) for other velocities, m/s and rad/s. The
    /// nodes stay where they were in the last [`Self::drag`], which determined the local
    /// `resistance`. The force is linear in the velocities, as for any flow without inertia.
    ///
    /// # Errors
    /// The errors of [`Self::drag`].
    ///
    /// # Panics
    /// If the fluid does not couple nodes ([`Self::coupling`]).
    pub(crate) fn drag_of(
        &mut self,
        velocities: &[Vector3],
        spins: &[f64],
        resistance: &[Matrix3],
        forces: &mut [Vector3],
    ) -> Result<FluidReport, FluidError> {
        match &mut self.method {
            Method::Stokeslets(drag) => drag.drag_of(velocities, spins, resistance, forces),
            Method::Resistive { .. } => panic!("local drag does not depend on a flow"),
        }
    }

    /// Solves for the drag to a smaller relative residual from now on; returns whether the flow
    /// operator is accurate enough for that.
    pub(crate) fn sharpen(&mut self, tolerance: f64) -> bool {
        match &mut self.method {
            Method::Stokeslets(drag) => drag.sharpen(tolerance),
            Method::Resistive { .. } => true,
        }
    }

    /// Influence of the motion of other nodes; `None` if there is none, so that the local
    /// resistance D is the whole resistance.
    pub(crate) fn coupling(&self) -> Option<Coupling> {
        match &self.method {
            Method::Stokeslets(drag) => Some(Coupling {
                largest_ratio: drag.largest_ratio(),
                tolerance: drag.tolerance(),
            }),
            Method::Resistive { .. } => None,
        }
    }

    /// Power that the last drag takes from the motion of the nodes, W; `None` if nodes do not
    /// interact. In a fluid at rest it is positive for every motion.
    pub(crate) fn dissipation(&self) -> Option<f64> {
        match &self.method {
            Method::Stokeslets(drag) => Some(drag.dissipation()),
            Method::Resistive { .. } => None,
        }
    }

    /// Data of a checkpoint.
    pub(crate) fn memory(&self) -> FluidMemory {
        FluidMemory(match &self.method {
            Method::Stokeslets(drag) => Some(drag.memory()),
            Method::Resistive { .. } => None,
        })
    }

    /// Continues from the memory of a fluid around the same filaments, bit for bit as without an
    /// interruption.
    ///
    /// # Errors
    /// [`FluidError::ForeignMemory`] if the memory does not fit the filaments and the model.
    pub(crate) fn restore(&mut self, memory: FluidMemory) -> Result<(), FluidError> {
        match (&mut self.method, memory.0) {
            (Method::Stokeslets(drag), Some(memory)) => drag.restore(memory),
            (Method::Resistive { .. }, None) => Ok(()),
            _ => Err(FluidError::ForeignMemory),
        }
    }
}

fn positive(quantity: &str, value: f64) -> Result<(), FluidError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(FluidError::BadInput(format!(
        "the {quantity} of the fluid must be positive and finite, not {value}"
    )))
}

fn check(filaments: &[Filament]) -> Result<(), FluidError> {
    let mut ranges = Vec::with_capacity(filaments.len());
    for filament in filaments {
        if filament.nodes < 2 {
            return Err(FluidError::BadInput(
                "a filament in a fluid needs at least two nodes".into(),
            ));
        }
        positive("filament radius", filament.radius)?;
        ranges.push(filament.range());
    }
    ranges.sort_by_key(|range| range.start);
    if ranges.windows(2).any(|pair| pair[1].start < pair[0].end) {
        return Err(FluidError::BadInput(
            "two filaments in a fluid share a node".into(),
        ));
    }
    Ok(())
}
