//! Nodes of filaments, counted one filament after the other.

use super::{Filament, FluidError};
use crate::mechanics::{Matrix3, Vector3};

/// Whether all components are numbers.
pub(super) fn are_finite(vectors: &[Vector3]) -> bool {
    vectors.iter().flatten().all(|x| x.is_finite())
}

/// The nodes of filaments among those of the scene.
pub(super) fn nodes_of(filaments: &[Filament]) -> impl Iterator<Item = usize> {
    filaments.iter().flat_map(Filament::range)
}

/// The symmetric part of the inverse.
pub(super) fn symmetric_inverse(block: &Matrix3) -> Result<Matrix3, FluidError> {
    let inverse = block.try_inverse().ok_or(FluidError::Singular)?;
    Ok((inverse + inverse.transpose()) * 0.5)
}

/// Half of the lengths of the edges of its filament that meet at each station, m. An edge without length is an error: its
/// two nodes have the same row in the operator.
pub(super) fn voronoi_lengths(
    filaments: &[Filament],
    positions: &[Vector3],
    lengths: &mut [f64],
) -> Result<(), FluidError> {
    lengths.fill(0.0);
    let mut first = 0;
    for filament in filaments {
        for edge in 0..filament.edges() {
            let ends = [first + edge, first + (edge + 1) % filament.nodes];
            let half = 0.5 * (positions[ends[1]] - positions[ends[0]]).norm();
            if half == 0.0 {
                return Err(FluidError::Singular);
            }
            for node in ends {
                lengths[node] += half;
            }
        }
        first += filament.nodes;
    }
    Ok(())
}
