//! Forces that are defined in code instead of by numbers.

use super::RodNode;
use crate::mechanics::{Matrix3, Vector3};
use std::fmt::Debug;

/// ∂²E/∂xᵢ∂xⱼ of up to four nodes i and j, N/m.
pub type NodeHessian = [[Matrix3; 4]; 4];

/// A force on one to four nodes that has a potential E(x₁, …, xₖ) of their positions: F = −∂E/∂x.
///
/// A scene may have any number and any kinds of them ([`Scene::forces`](super::Scene::forces)),
/// without a change of this crate. E must be twice differentiable wherever nodes may move, and
/// must not depend on time. Here, a spring to a fixed point of the ground, E = ½ k ‖x − x₀‖²:
///
/// ```
/// use rodlab_engine::mechanics::scene::{NodeForce, NodeHessian, RodNode};
/// use rodlab_engine::mechanics::{Matrix3, Vector3};
///
/// #[derive(Debug)]
/// struct GroundSpring {
///     node: RodNode,
///     anchor: Vector3,
///     stiffness: f64,
/// }
///
/// impl NodeForce for GroundSpring {
///     fn name(&self) -> &str {
///         "ground"
///     }
///
///     fn nodes(&self) -> Vec<RodNode> {
///         vec![self.node]
///     }
///
///     fn energy(&self, positions: &[Vector3]) -> f64 {
///         0.5 * self.stiffness * (positions[0] - self.anchor).norm_squared()
///     }
///
///     fn add_gradient(&self, positions: &[Vector3], gradient: &mut [Vector3]) {
///         gradient[0] += self.stiffness * (positions[0] - self.anchor);
///     }
///
///     fn add_hessian(&self, _: &[Vector3], hessian: &mut NodeHessian) {
///         hessian[0][0] += self.stiffness * Matrix3::identity();
///     }
/// }
/// ```
pub trait NodeForce: Debug + Send + Sync {
    /// Name in scenarios and results.
    fn name(&self) -> &str;

    /// The nodes, one to four.
    fn nodes(&self) -> Vec<RodNode>;

    /// E at the positions of the nodes (m), J.
    fn energy(&self, positions: &[Vector3]) -> f64;

    /// Adds ∂E/∂x of each node, N.
    fn add_gradient(&self, positions: &[Vector3], gradient: &mut [Vector3]);

    /// Adds ∂²E/∂x² of each pair of nodes, N/m.
    fn add_hessian(&self, positions: &[Vector3], hessian: &mut NodeHessian);
}
