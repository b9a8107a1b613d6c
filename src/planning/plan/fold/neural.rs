//! Folds by a network trained on exact ones (thesis 4.3.4), and its force manifold (4.4.1).
//!
//! The inputs of the network are x̄ and z̄. The outputs are α, l̄_s and the inclination
//! arctan(H/|V|) of the force on the lying part, whose tangent is λ with a sign. The inclination is
//! smooth where λ has its kink, and always bounded.

use super::atlas::FoldAtlas;
use super::equilibrium::Fold;
use super::manifold::ForceManifold;
use super::workspace::Workspace;
use crate::learn::{Compared, Model, ModelError, read_model};
use rayon::prelude::*;
use rodlab_engine::mechanics::kirchhoff::elastica::Forces;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A trained network for folds.
#[derive(Clone, Debug)]
pub struct NeuralFolds {
    model: Model,
    /// Suspended lengths of its samples, L_gb.
    lengths: [f64; 2],
}

/// Output of a network for a fold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedFold {
    /// arctan(H/|V|), rad.
    pub force_inclination: f64,
    /// α, rad.
    pub angle: f64,
    /// l̄_s.
    pub suspended_length: f64,
}

impl LearnedFold {
    /// λ.
    pub fn force_ratio(&self) -> f64 {
        libm::tan(self.force_inclination).abs()
    }
}

/// Reason why a network cannot be used for folds.
#[derive(Debug, Error)]
pub enum NeuralFoldError {
    /// The file is not a model, or the model fails.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model has no range of suspended lengths, or an impossible one.
    #[error("{0} has no range of suspended lengths: train it again")]
    Lengths(PathBuf),
    /// The model was not trained for such sheets.
    #[error(
        "the network was trained for suspended lengths from {:.3} to {:.3} L_gb; needed here: from \
         {least:.3} to {longest:.3}",
        learned[0], learned[1]
    )]
    OutOfRange {
        /// Suspended lengths of its samples, L_gb.
        learned: [f64; 2],
        /// Least suspended length of the sheet.
        least: f64,
        /// Longest suspended length of the manifold.
        longest: f64,
    },
}

impl NeuralFolds {
    /// The kind of its samples.
    pub const SAMPLES: &str = "fold-samples";
    /// Input columns of the network.
    pub const INPUTS: [&str; 2] = ["x", "z"];
    /// Output columns of the network.
    pub const OUTPUTS: [&str; 3] = ["force_inclination", "alpha", "suspended_length"];
    /// Weights of the errors of the outputs. Without weights, the errors of α and l̄_s would be
    /// larger in their units.
    pub const WEIGHTS: [f64; 3] = [1.0, 1.5, 2.0];
    /// Quantities whose errors are reported.
    pub const COMPARED: [Compared; 3] = [
        Compared {
            quantity: "lambda",
            components: |_, output| [libm::tan(output[0]).abs(), 0.0, 0.0],
        },
        Compared {
            quantity: "alpha in rad",
            components: |_, output| [output[1], 0.0, 0.0],
        },
        Compared {
            quantity: "suspended length in L_gb",
            components: |_, output| [output[2], 0.0, 0.0],
        },
    ];

    /// Reads a model.
    ///
    /// # Errors
    /// See [`NeuralFoldError`].
    pub fn read(path: &Path) -> Result<Self, NeuralFoldError> {
        Self::of(path, read_model(path, Self::SAMPLES)?)
    }

    fn of(path: &Path, model: Model) -> Result<Self, NeuralFoldError> {
        let model = model.with_columns(path, &Self::INPUTS, &Self::OUTPUTS)?;
        let lengths = model.about.output_range.get(2).copied();
        let lengths = lengths.ok_or_else(|| NeuralFoldError::Lengths(path.to_owned()))?;
        Ok(Self { model, lengths })
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// A fold for each position within the range of the samples, `None` for the others.
    ///
    /// # Errors
    /// [`ModelError::Tensors`].
    pub fn predict(&self, places: &[[f64; 2]]) -> Result<Vec<Option<LearnedFold>>, ModelError> {
        let fold = |output: Vec<f64>| LearnedFold {
            force_inclination: output[0],
            angle: output[1],
            suspended_length: output[2],
        };
        let outputs = self.model.predict_covered(places)?.into_iter();
        Ok(outputs.map(|output| output.map(fold)).collect())
    }

    /// Compares every fifth fold of a manifold of this network with the exact fold, and checks
    /// that all folds are finite.
    pub fn check(atlas: &FoldAtlas, manifold: &ForceManifold) -> NetworkCheck {
        let folds: Vec<&Fold> = manifold.folds().collect();
        let not_finite = folds.iter().filter(|fold| !is_finite(fold)).count();
        let compared: Vec<bool> = folds
            .par_iter()
            .step_by(COMPARED_STEP)
            .filter_map(|fold| Some(is_near(fold, &atlas.solve(fold.gripper).ok()?)))
            .collect();
        NetworkCheck {
            compared: compared.len(),
            wrong: compared.iter().filter(|is_near| !**is_near).count(),
            not_finite,
        }
    }

    /// The manifold of the network (thesis sec. 4.4.1) for a sheet with suspended lengths between
    /// `least` and `longest`, at every cell of the grid within the training workspace. The manifold
    /// has λ of the network, but V of the nearest fold of the atlas, so it can be used only for
    /// [`Objective::Sum`](super::Objective::Sum).
    ///
    /// # Errors
    /// [`NeuralFoldError::OutOfRange`]; [`ModelError::Tensors`].
    pub fn manifold(
        &self,
        atlas: &FoldAtlas,
        spacing: f64,
        [least, longest]: [f64; 2],
    ) -> Result<ForceManifold, NeuralFoldError> {
        let [from, to] = self.lengths;
        let out_of_range = || NeuralFoldError::OutOfRange {
            learned: self.lengths,
            least,
            longest,
        };
        let longest_learned = longest.min(to);
        // Samples are not on the border of their workspace.
        if least < from || longest > MARGIN * to {
            return Err(out_of_range());
        }
        let from = from.max(Workspace::LENGTHS[0]);
        let workspace = Workspace::new([from, longest_learned]).ok_or_else(out_of_range)?;
        let size = workspace
            .reach()
            .map(|reach| (reach / spacing).ceil() as usize);
        let places: Vec<[f64; 2]> = ForceManifold::without_folds(spacing, size)
            .places()
            .collect();
        let learned = self.predict(&places)?;
        let folds = places.par_iter().zip(&learned).map(|(place, learned)| {
            let learned = learned.filter(|_| workspace.contains(*place))?;
            Some(fold(*place, &learned, atlas))
        });
        Ok(ForceManifold::of(spacing, size, folds.collect()))
    }
}

/// Largest ratio of the requested suspended length to the longest of the samples.
const MARGIN: f64 = 1.01;

/// Interval of the folds of a manifold that are compared with exact ones.
const COMPARED_STEP: usize = 5;
/// Allowed errors: of the inclination of the force and of α, rad, and of l̄_s. The mean error of
/// the networks in the guide is 0.003.
const TOLERANCE: f64 = 0.2;
/// Fraction of the compared folds that may have larger errors. Near x̄ = 0, where λ rises from 0
/// to 2 within 0.05 L_gb, every network has them.
const MOST_WRONG: f64 = 0.05;

/// Comparison of a network's manifold with exact folds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NetworkCheck {
    /// Number of compared folds.
    pub compared: usize,
    /// Number of compared folds with too large errors.
    pub wrong: usize,
    /// Number of folds with numbers that are not finite, among all folds.
    pub not_finite: usize,
}

impl NetworkCheck {
    /// Whether the manifold can be used for a search.
    pub fn is_passed(&self) -> bool {
        self.not_finite == 0 && self.wrong as f64 <= MOST_WRONG * self.compared as f64
    }
}

fn is_finite(fold: &Fold) -> bool {
    let numbers = [
        fold.angle,
        fold.suspended_length,
        fold.forces.horizontal,
        fold.forces.vertical,
    ];
    numbers.iter().all(|number| number.is_finite())
}

fn is_near(fold: &Fold, exact: &Fold) -> bool {
    let off = [
        fold.force_inclination() - exact.force_inclination(),
        fold.angle - exact.angle,
        fold.suspended_length - exact.suspended_length,
    ];
    off.iter().all(|off| off.abs() <= TOLERANCE)
}

/// Output of the network at a position, with V of the nearest exact fold. Distances are relative
/// to the distance from the initial edge.
fn fold(gripper: [f64; 2], learned: &LearnedFold, atlas: &FoldAtlas) -> Fold {
    let distance = |fold: &Fold| {
        let [x, z] = fold.gripper;
        libm::hypot(gripper[0] - x, gripper[1] - z) / libm::hypot(x, z)
    };
    let nearest = atlas
        .folds()
        .iter()
        .min_by(|one, other| distance(one).total_cmp(&distance(other)));
    let vertical = nearest.map_or(-1.0, |fold| fold.forces.vertical);
    Fold {
        gripper,
        angle: learned.angle,
        suspended_length: learned.suspended_length,
        forces: Forces {
            horizontal: vertical.abs() * libm::tan(learned.force_inclination),
            vertical,
        },
        moment: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifold_of_wrong_folds_does_not_pass() {
        let atlas = FoldAtlas::new();
        let exact = ForceManifold::new(&atlas, 0.3, 5.0);
        let check = NeuralFolds::check(&atlas, &exact);
        assert!(check.compared > 20 && check.is_passed(), "{check:?}");
        let changed = |change: &dyn Fn(&mut Fold)| {
            let mut manifold = exact.clone();
            for fold in exact.folds() {
                let mut moved = *fold;
                change(&mut moved);
                manifold.set(exact.cell(fold.gripper), moved);
            }
            NeuralFolds::check(&atlas, &manifold)
        };
        let slightly = changed(&|fold| fold.angle += 0.02);
        assert!(slightly.is_passed(), "{slightly:?}");
        let off = changed(&|fold| fold.suspended_length += 0.5);
        assert!(off.wrong == off.compared && !off.is_passed(), "{off:?}");
        let forces = changed(&|fold| fold.forces.horizontal -= 5.0);
        assert!(!forces.is_passed(), "{forces:?}");
        // One non-finite number is enough, even in a fold that is not compared.
        let second = exact.folds().nth(1).unwrap();
        let one = changed(&|fold| {
            if fold.gripper == second.gripper {
                fold.angle = f64::NAN;
            }
        });
        assert!(one.not_finite == 1 && !one.is_passed(), "{one:?}");
    }
}
