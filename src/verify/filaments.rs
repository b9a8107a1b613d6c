//! Single filaments in a fluid, simulated by the engine.

use rodlab_engine::mechanics::fluid::{Filament, Fluid, FluidError};
use rodlab_engine::mechanics::{Matrix3, Vector3};

/// A filament with all nodes.
pub fn open_filament(nodes: usize, radius: f64) -> Filament {
    Filament {
        first_node: 0,
        nodes,
        closed: false,
        radius,
    }
}

/// Forces on the fluid, N per node.
pub fn forces_on(
    fluid: &mut Fluid,
    nodes: &[Vector3],
    velocities: &[Vector3],
) -> Result<Vec<Vector3>, FluidError> {
    let mut forces = vec![Vector3::zeros(); nodes.len()];
    let mut resistance = vec![Matrix3::zeros(); nodes.len()];
    fluid.drag(nodes, velocities, &[], &mut forces, &mut resistance)?;
    // The engine reports the forces of the fluid on the rod.
    Ok(forces.into_iter().map(|force| -force).collect())
}
