//! The list of all forces of a scene.

use super::actuation::Actuators;
use super::bearings::Bearings;
use super::build::Assembly;
use super::contact::Contact;
use super::cross_flow::CrossFlow;
use super::damping::Damping;
use super::demand::Demand;
use super::elasticity::Elasticity;
use super::inertia::Inertia;
use super::linear_drag::LinearDrag;
use super::loads::Loads;
use super::local_drag::LocalDrag;
use super::node_forces::NodeForces;
use super::plasticity::Plasticity;
use super::sheaths::Sheaths;
use super::springs::Springs;
use super::tendons::Tendons;
use super::term::Term;
use crate::linalg::Element;
use crate::mechanics::SceneError;
use crate::mechanics::scene::Scene;

/// Declares the list, in the order in which residuals and Jacobians are added up.
macro_rules! terms {
    ($($(#[$documentation:meta])* $name:ident: $kind:ty,)*) => {
        /// All terms of a scene.
        pub(crate) struct Terms {
            $($(#[$documentation])* pub $name: $kind,)*
        }

        impl Terms {
            /// Creates the terms of a scene with numbered unknowns.
            ///
            /// # Errors
            /// [`SceneError`] for an invalid scene.
            pub(crate) fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
                Ok(Self { $($name: Term::new(scene, assembly)?,)* })
            }

            /// All of them.
            pub(crate) fn all(&self) -> [&dyn Term; Self::COUNT] {
                [$(&self.$name,)*]
            }

            /// All terms, mutable.
            pub(crate) fn all_mut(&mut self) -> [&mut dyn Term; Self::COUNT] {
                [$(&mut self.$name,)*]
            }

            const COUNT: usize = [$(stringify!($name),)*].len();
        }
    };
}

terms! {
    /// Natural strains as functions of time.
    actuators: Actuators,
    /// Sheaths that hold parts of rods, and change their stiffness at the mouth.
    sheaths: Sheaths,
    /// Stretching, bending and twisting of the rods.
    elasticity: Elasticity,
    /// Plastic strains of the rods, which change their natural strains at each evaluation.
    plasticity: Plasticity,
    /// Springs between nodes, between frames and about hinges.
    springs: Springs,
    /// Cables through eyelets.
    tendons: Tendons,
    /// Moments about axles.
    bearings: Bearings,
    /// Forces that the scene defines by code.
    node_forces: NodeForces,
    /// Dashpots of the material, which change the natural strains and the stiffness of rods in a stage.
    damping: Damping,
    /// External forces and moments.
    loads: Loads,
    inertia: Inertia,
    /// Drag with coefficients given by the scene.
    drag: LinearDrag,
    /// Drag of a fluid near the motion of a stage.
    fluid: LocalDrag,
    /// Quadratic drag of air or water.
    cross_flow: CrossFlow,
    contact: Contact,
}

impl Terms {
    /// The unknowns that each term couples.
    pub(crate) fn elements(&self, assembly: &Assembly) -> [Vec<Element>; Self::COUNT] {
        self.all().map(|term| term.elements(assembly))
    }

    /// Whether a term couples nodes of different rods, or distant nodes of one rod.
    pub(crate) fn couple_nodes(&self) -> bool {
        self.all().iter().any(|term| term.couples_nodes())
    }

    /// Checks whether a scene with these terms meets a demand.
    ///
    /// # Errors
    /// The reason of the last term that does not support it.
    pub(crate) fn admit(&self, demand: Demand) -> Result<(), SceneError> {
        let terms = self.all().into_iter().rev();
        let refusal = terms.filter_map(|term| term.refuses(demand)).next();
        refusal.map_or(Ok(()), Err)
    }

    /// Data of all terms for a checkpoint.
    pub(crate) fn memory(&self) -> Vec<Vec<f64>> {
        self.all().iter().flat_map(|term| term.memory()).collect()
    }

    /// Restores the data of a checkpoint.
    ///
    /// # Errors
    /// The difference if the checkpoint belongs to another scene.
    pub(crate) fn restore(
        &mut self,
        mut memory: impl Iterator<Item = Vec<f64>>,
    ) -> Result<(), &'static str> {
        for term in self.all_mut() {
            term.restore(&mut memory)?;
        }
        // Only dashpots and rods that yield have data whose size depends on the scene.
        memory
            .next()
            .map_or(Ok(()), |_| Err("damping or plastic strains"))
    }
}
