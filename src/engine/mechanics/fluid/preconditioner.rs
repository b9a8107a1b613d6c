//! An approximate inverse of the flow operator, kept while the filaments move on.

use super::Filament;
use super::FluidError;
use super::chain::Link;
use super::coarse_space::CoarseSpace;
use super::flow::Flow;
use super::neighbourhoods::Neighbourhoods;
use super::spheres::Spheres;
use crate::mechanics::Vector3;

/// Initial number of nodes of a neighbourhood. Iterations with neighbourhoods alone, in a bundle
/// of ten helices (pairs 3 mm apart, 680 nodes), for 16, 24, 32, 48, 64 nodes: 27, 21, 17, 13, 11.
/// The cost of building grows with the cube.
pub(super) const NEIGHBOURHOOD: usize = 32;

/// Cost of an operation of an elimination, in operations of a product, as timed for 136 and 680
/// nodes.
const PRICE_OF_ELIMINATION: f64 = 2.5;

/// A two-level Schwarz method (Smith, Bjørstad and Gropp 1996): the coarse level solves for the
/// total forces on all aggregates of filaments together. Then neighbourhoods solve for the forces
/// of nodes from the remaining flow.
///
/// ```text
/// A⁻¹ ≈ Q + S (1 − A Q)
/// ```
///
/// with the [`CoarseSpace`] Q and the [`Neighbourhoods`] S. In the bundle of ten flagella Q
/// reduces the iterations from 11.6 to 7.7 a solve. With clusters of nodes there is no Q: building
/// it would take hundreds of products.
pub(super) struct Preconditioner {
    neighbourhoods: Neighbourhoods,
    coarse: Option<CoarseSpace>,
    /// x − A Q x.
    rest: Vec<f64>,
    /// Points without force.
    forceless: Vec<usize>,
}

impl Preconditioner {
    /// Creates a preconditioner for these filaments, with neighbourhoods of the given size.
    pub(crate) fn new(filaments: &[Filament], operator: &Flow, neighbourhood: usize) -> Self {
        let nodes = operator.nodes();
        Self {
            neighbourhoods: Neighbourhoods::new(nodes, neighbourhood),
            coarse: (operator.exact()).map(|_| CoarseSpace::new(filaments, operator.points())),
            rest: vec![0.0; 3 * nodes],
            forceless: Vec::new(),
        }
    }

    /// Nodes of a neighbourhood.
    pub(crate) fn neighbourhood(&self) -> usize {
        self.neighbourhoods.size()
    }

    /// Cost of [`build`](Self::build) in units of one iteration, from operation counts.
    pub(crate) fn price(&self, operator: &Flow) -> f64 {
        PRICE_OF_ELIMINATION * self.operations(operator) / operator.operations()
    }

    /// Floating-point operations of [`build`](Self::build), nearly all of them for the neighbourhoods.
    pub(crate) fn operations(&self, operator: &Flow) -> f64 {
        self.neighbourhoods.operations(operator.nodes())
    }

    /// Builds the parts for stations at these positions, for which `operator` has been assembled.
    ///
    /// # Errors
    /// [`FluidError::Singular`] if one of them has no inverse.
    pub(crate) fn build(
        &mut self,
        links: &[Link],
        positions: &[Vector3],
        operator: &Flow,
    ) -> Result<(), FluidError> {
        self.forceless.clear();
        (self.forceless).extend_from_slice(operator.spheres().points_inside());
        if let (Some(coarse), Some(exact)) = (&mut self.coarse, operator.exact()) {
            coarse.build(exact, operator.points())?;
        }
        let walled = operator.exact().filter(|exact| exact.has_wall());
        self.neighbourhoods
            .build(links, positions, operator.points(), walled)
    }

    /// Computes `y` ≈ A⁻¹ `x`; each sphere is treated as if it were alone.
    pub(crate) fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        let of_points = self.rest.len();
        let (x, w) = x.split_at(of_points);
        let (y, s) = y.split_at_mut(of_points);
        Spheres::precondition(w, s);
        self.apply_to_points(x, y);
        for &point in &self.forceless {
            let own = 3 * point..3 * point + 3;
            y[own.clone()].copy_from_slice(&x[own]);
        }
    }

    fn apply_to_points(&mut self, x: &[f64], y: &mut [f64]) {
        match &mut self.coarse {
            Some(coarse) => {
                coarse.solve(x, &mut self.rest);
                self.neighbourhoods.apply(&self.rest, y);
                coarse.add_forces(y);
            }
            None => self.neighbourhoods.apply(x, y),
        }
    }
}
