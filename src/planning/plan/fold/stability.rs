//! The second variation of the energy of a folded sheet.

use super::equilibrium::Fold;
use rodlab_engine::mechanics::kirchhoff::elastica::Elastica;

/// Parts into which the sheet is divided.
const PARTS: usize = 200;

impl Fold {
    /// Number of directions of decreasing energy with the gripper at a fixed position, free to
    /// turn.
    pub fn unstable_modes(&self) -> usize {
        unstable_modes(self, PARTS)
    }

    /// Number of directions of decreasing energy with the gripper at a fixed pose.
    pub fn unstable_modes_held(&self) -> usize {
        unstable_modes(self, PARTS - 1)
    }
}

/// Number of directions in which the energy of a fold decreases while the gripper stays at its
/// position. If `nodes` includes the last node, the gripper turns freely; otherwise it does not
/// turn.
///
/// > δ²E = ∫ η'² + (H cos θ + (V + s/2) sin θ) η² ds,  η(0) = 0,  ∫ η cos θ ds = ∫ η sin θ ds = 0
///
/// With piecewise linear η the second variation is a tridiagonal matrix, bordered by the two
/// conditions; its negative pivots are counted. The sheet leaves the table without curvature, so a
/// small change of the lifted length has no second-order effect.
fn unstable_modes(fold: &Fold, nodes: usize) -> usize {
    let places = Elastica::heavy(fold.forces).places(fold.suspended_length, PARTS);
    let ds = fold.suspended_length / PARTS as f64;
    let mut negative = 0;
    // Pivot, and the two borders after elimination, of the last node.
    let mut last: Option<(f64, [f64; 2])> = None;
    let mut schur = [[0.0; 2]; 2];
    for (node, place) in places.iter().enumerate().take(nodes + 1).skip(1) {
        let (sine, cosine) = libm::sincos(place.state.angle);
        let load = fold.forces.vertical + 0.5 * place.arc_length;
        let stiffness = fold.forces.horizontal * cosine + load * sine;
        let share = if node == PARTS { 0.5 } else { 1.0 };
        let mut pivot = 2.0 * share / ds + share * ds * stiffness;
        let mut border = [share * ds * cosine, share * ds * sine];
        if let Some((before, borders)) = last {
            let factor = -1.0 / (ds * before);
            pivot += factor / ds;
            for k in 0..2 {
                border[k] -= factor * borders[k];
            }
        }
        for i in 0..2 {
            for j in 0..2 {
                schur[i][j] -= border[i] * border[j] / pivot;
            }
        }
        negative += usize::from(pivot < 0.0);
        last = Some((pivot, border));
    }
    let determinant = schur[0][0] * schur[1][1] - schur[0][1] * schur[1][0];
    negative += if determinant < 0.0 {
        1
    } else if schur[0][0] < 0.0 {
        2
    } else {
        0
    };
    negative.saturating_sub(2)
}

#[cfg(test)]
mod tests {
    use super::super::FoldAtlas;
    use super::*;
    use nalgebra::DMatrix;

    /// Compares all folds at a gripper with the eigenvalues of the second variation, projected
    /// onto the two conditions, for a sheet of rigid edges.
    #[test]
    fn modes_are_those_of_the_eigenvalues() {
        const EDGES: usize = 80;
        let folds = FoldAtlas::new().solve_all([0.347_207_809_1, 0.577_905_550_1]);
        let counts = folds.unwrap().into_iter().map(|fold| {
            let ds = fold.suspended_length / EDGES as f64;
            let places = Elastica::heavy(fold.forces).places(fold.suspended_length, 2 * EDGES);
            let mut matrix = DMatrix::<f64>::zeros(EDGES, EDGES);
            let mut borders = DMatrix::<f64>::zeros(EDGES, 2);
            for edge in 0..EDGES {
                let middle = &places[2 * edge + 1];
                let (sine, cosine) = middle.state.angle.sin_cos();
                let load = fold.forces.vertical + 0.5 * middle.arc_length;
                matrix[(edge, edge)] += ds * (fold.forces.horizontal * cosine + load * sine);
                // The rotation of the first edge relative to the table acts over half an edge.
                matrix[(edge, edge)] += if edge == 0 { 2.0 / ds } else { 1.0 / ds };
                if edge > 0 {
                    matrix[(edge - 1, edge - 1)] += 1.0 / ds;
                    matrix[(edge, edge - 1)] -= 1.0 / ds;
                    matrix[(edge - 1, edge)] -= 1.0 / ds;
                }
                borders[(edge, 0)] = cosine;
                borders[(edge, 1)] = sine;
            }
            let basis = borders.qr().q();
            let projector = DMatrix::identity(EDGES, EDGES) - &basis * basis.transpose();
            let values = (&projector * matrix * &projector).symmetric_eigenvalues();
            let negative = values.iter().filter(|value| **value < -1e-9).count();
            assert_eq!(fold.unstable_modes(), negative, "{fold:?} {values}");
            negative
        });
        let counts: Vec<usize> = counts.collect();
        assert!(counts.contains(&0) && counts.contains(&1) && counts.contains(&2));
    }

    #[test]
    fn gentle_folds_are_stable() {
        let folds = FoldAtlas::new();
        for fold in folds.folds().iter().step_by(17) {
            assert_eq!(fold.unstable_modes(), 0, "{fold:?}");
        }
    }
}
