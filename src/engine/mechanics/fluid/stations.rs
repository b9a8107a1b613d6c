//! Nodes of filaments, counted one filament after the other.

use super::{Filament, FluidError};
use crate::mechanics::{Matrix3, Vector3};

/// Whether all components are numbers.
pub(super) fn are_finite(vectors: &[Vector3]) -> bool {
    vectors.iter().flatten().all(|x| x.is_finite())
}

/// Indices in the scene of the nodes of filaments.
pub(super) fn nodes_of(filaments: &[Filament]) -> impl Iterator<Item = usize> {
    filaments.iter().flat_map(Filament::range)
}

/// The edges of filaments: the filament, the index of the edge along it, and the stations at its
/// ends.
pub(super) fn edges_of(
    filaments: &[Filament],
) -> impl Iterator<Item = (&Filament, usize, [usize; 2])> {
    let firsts = filaments.iter().scan(0, |next, filament| {
        let first = *next;
        *next += filament.nodes;
        Some((filament, first))
    });
    firsts.flat_map(|(filament, first)| {
        (0..filament.edges()).map(move |edge| {
            let ends = [edge, (edge + 1) % filament.nodes].map(|node| first + node);
            (filament, edge, ends)
        })
    })
}

/// The symmetric part of the inverse.
pub(super) fn symmetric_inverse(block: &Matrix3) -> Result<Matrix3, FluidError> {
    let inverse = block.try_inverse().ok_or(FluidError::Singular)?;
    Ok((inverse + inverse.transpose()) * 0.5)
}

/// Half of the lengths of the edges that meet at each station, m. An edge without length is an
/// error: its two nodes have the same row in the operator.
pub(super) fn voronoi_lengths(
    filaments: &[Filament],
    positions: &[Vector3],
    lengths: &mut [f64],
) -> Result<(), FluidError> {
    lengths.fill(0.0);
    for (_, _, ends) in edges_of(filaments) {
        let half = 0.5 * (positions[ends[1]] - positions[ends[0]]).norm();
        if half == 0.0 {
            return Err(FluidError::Singular);
        }
        for station in ends {
            lengths[station] += half;
        }
    }
    Ok(())
}
