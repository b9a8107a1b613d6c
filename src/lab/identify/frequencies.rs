//! Natural frequencies of small vibrations about an equilibrium: the columns `frequency_1_hz`, `frequency_2_hz`, ...

use crate::run::{LiveRun, Mode, PreparedRun};
use nalgebra::SymmetricEigen;
use std::f64::consts::TAU;

/// Maximum number of natural frequencies that are compared.
const MOST_FREQUENCIES: usize = 20;
/// Maximum number of free unknowns for natural frequencies, which use dense matrices.
const MOST_UNKNOWNS: usize = 1500;

/// Returns the index of a natural frequency, from 0, if a column names one.
pub(super) fn frequency_of(name: &str) -> Option<usize> {
    let number = name.strip_prefix("frequency_")?.strip_suffix("_hz")?;
    number
        .parse()
        .ok()
        .and_then(|number: usize| number.checked_sub(1))
}

/// Checks that a scene has the natural frequency of an index, from 0.
pub(super) fn frequency(prepared: &PreparedRun, number: usize) -> Result<usize, String> {
    if prepared.mode != Mode::Static {
        return Err("natural frequencies need an equilibrium: time.mode = \"static\"".to_owned());
    }
    let nodes: usize = prepared
        .scene
        .rods
        .iter()
        .map(|rod| rod.centreline.len())
        .sum();
    if 4 * nodes > MOST_UNKNOWNS {
        return Err(format!(
            "natural frequencies of {nodes} nodes take too long; allowed: at most {}",
            MOST_UNKNOWNS / 4
        ));
    }
    match number < MOST_FREQUENCIES {
        true => Ok(number),
        false => Err(format!(
            "natural frequencies are counted from 1; allowed: 1 to {MOST_FREQUENCIES}"
        )),
    }
}

/// Natural frequencies of small vibrations, Hz, from the lowest; none if the equilibrium is
/// unstable.
pub(super) fn natural_frequencies(run: &mut LiveRun) -> Vec<f64> {
    let mass = run.simulation.mass_matrix();
    let stiffness = run.simulation.stiffness_matrix();
    let Some(root) = mass.cholesky() else {
        return Vec::new();
    };
    let Some(half) = root.l().solve_lower_triangular(&stiffness) else {
        return Vec::new();
    };
    let Some(reduced) = root.l().solve_lower_triangular(&half.transpose()) else {
        return Vec::new();
    };
    let symmetric = 0.5 * (&reduced + reduced.transpose());
    let mut squares: Vec<f64> = SymmetricEigen::new(symmetric)
        .eigenvalues
        .iter()
        .copied()
        .collect();
    squares.sort_by(f64::total_cmp);
    if squares.first().is_none_or(|lowest| *lowest < 0.0) {
        return Vec::new();
    }
    squares.iter().map(|square| square.sqrt() / TAU).collect()
}
