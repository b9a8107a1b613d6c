//! The fluid around the rods.

/// A fluid model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FluidModel {
    /// Regularized Stokeslet segments (thesis 2.4.1): every edge acts on every node.
    RegularizedStokeslets {
        /// Dynamic viscosity η, Pa s.
        viscosity: f64,
        /// Regularisation ε as a multiple of the rod radius h; the thesis uses 1.02.
        regularization: f64,
        /// Relative error allowed in the drag by approximating the flow of distant nodes, which is
        /// done only for scenes of a thousand nodes or more; 10⁻⁶ to 10⁻², or 0 for no
        /// approximation.
        far_field_error: f64,
    },
    /// Resistive force theory: drag by local coefficients along and across the rod.
    Resistive {
        /// Dynamic viscosity η, Pa s.
        viscosity: f64,
    },
    /// Drag of large Reynolds numbers, quadratic in the velocity (Morison et al. 1950; the
    /// cross-flow principle of Hoerner 1965): local, normal and tangential to the rod.
    Quadratic {
        /// Density ρ of the fluid, kg/m³.
        density: f64,
        /// Coefficient Cₙ of the drag per length normal to the rod, ½ ρ 2h Cₙ vₙ².
        normal: f64,
        /// Coefficient Cₜ of the drag per surface along the rod, ½ ρ 2πh Cₜ vₜ² per length.
        tangential: f64,
        /// Coefficient Cₐ of the added mass per length normal to the rod, Cₐ ρ π h².
        added_mass: f64,
    },
}
