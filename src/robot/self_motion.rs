//! The null space of redundant chains: motions of the joints that do not move the hand.
//!
//! For a chain with one redundant joint, the postures that reach a pose form closed curves, at most
//! sixteen of them (Burdick 1989), which the limits cut into arcs. They are traced here from
//! postures found by [`Chain::reach`]'s steps.

use super::chain::{Chain, MOST_JOINTS};
use super::kinematics::Jacobian;
use super::pose::Pose;
use nalgebra::{Cholesky, DVector};

/// Distance between neighbouring samples, rad or m.
const SPACING: f64 = 0.1;
/// Number of postures from which curves are traced.
const STARTS: usize = 200;
/// Longest curve, samples.
const LONGEST: usize = 2000;

impl Chain {
    /// The unit joint velocity that moves the hand least, as near as possible to `like`; `None` if
    /// `like` has no component in the null space, as in chains without redundancy.
    pub fn null_direction(&self, jacobian: &Jacobian, like: &[f64]) -> Option<Vec<f64>> {
        // The projection 1 − Jᵀ (J Jᵀ)⁻¹ J.
        let columns = jacobian.columns();
        let mut squared = jacobian.squared();
        for k in 0..6 {
            squared[(k, k)] += 1e-12;
        }
        let mut image = nalgebra::Vector6::zeros();
        for (column, part) in columns.iter().zip(like) {
            image += column * *part;
        }
        let weights = Cholesky::new(squared)?.solve(&image);
        let projected: Vec<f64> = columns
            .iter()
            .zip(like)
            .map(|(column, part)| part - column.dot(&weights))
            .collect();
        let norm = projected.iter().map(|x| x * x).sum::<f64>().sqrt();
        let asked = like.iter().map(|x| x * x).sum::<f64>().sqrt();
        (norm > 1e-3 * asked).then(|| projected.iter().map(|x| x / norm).collect())
    }

    /// The null direction of the joint axis with the greatest projection onto the null space.
    fn any_null_direction(&self, jacobian: &Jacobian) -> Option<Vec<f64>> {
        let count = self.joints.len();
        let directions = (0..count).filter_map(|k| {
            let mut unit = [0.0; MOST_JOINTS];
            unit[k] = 1.0;
            let direction = self.null_direction(jacobian, &unit[..count])?;
            Some((direction[k].abs(), direction))
        });
        directions
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, direction)| direction)
    }

    /// Curves of postures that bring the hand to a pose, each sampled every 0.1 rad from end to
    /// end. Empty for chains without redundancy and for unreachable poses. For chains with several
    /// redundant joints, the curves follow the direction that moves the hand least.
    pub fn self_motions(&self, target: &Pose) -> Vec<Vec<Vec<f64>>> {
        let mut curves: Vec<Vec<Vec<f64>>> = Vec::new();
        if self.joints.len() <= 6 {
            return curves;
        }
        for k in 0..STARTS {
            let Some(mut joints) = self.follow(target, &self.start(k)) else {
                continue;
            };
            self.unwind(&mut joints);
            let known = curves
                .iter()
                .flatten()
                .any(|sample| separation(sample, &joints) < SPACING);
            if !known {
                curves.push(self.self_motion(target, joints));
            }
        }
        curves
    }

    /// The curve through a posture, from end to end; a closed one begins and ends next to the posture.
    fn self_motion(&self, target: &Pose, through: Vec<f64>) -> Vec<Vec<f64>> {
        let (forward, closed) = self.trace(target, &through, 1.0);
        if closed {
            return std::iter::once(through).chain(forward).collect();
        }
        let (mut curve, _) = self.trace(target, &through, -1.0);
        curve.reverse();
        curve.push(through);
        curve.extend(forward);
        curve
    }

    /// Samples of a curve on one side of a posture, without the posture itself, and whether the
    /// curve returns to it.
    fn trace(&self, target: &Pose, from: &[f64], sign: f64) -> (Vec<Vec<f64>>, bool) {
        let mut samples: Vec<Vec<f64>> = Vec::new();
        let mut here = from.to_vec();
        let mut ahead: Option<Vec<f64>> = None;
        while samples.len() < LONGEST {
            let (_, jacobian) = self.hand_and_jacobian(&here);
            let direction = match &ahead {
                Some(ahead) => self.null_direction(&jacobian, ahead),
                None => self
                    .any_null_direction(&jacobian)
                    .map(|direction| direction.iter().map(|x| sign * x).collect()),
            };
            let Some(direction) = direction else { break };
            let guess: Vec<f64> = here
                .iter()
                .zip(&direction)
                .map(|(q, d)| q + SPACING * d)
                .collect();
            if self.outside_limits(&guess).is_some() {
                break;
            }
            // If the steps move the sample far away, the end of the curve is reached.
            let Some(next) = self.follow(target, &guess) else {
                break;
            };
            if separation(&next, &guess) > 0.5 * SPACING {
                break;
            }
            if samples.len() > 2 && separation(&next, from) < 0.8 * SPACING {
                samples.push(next);
                return (samples, true);
            }
            ahead = Some(direction);
            here.clone_from(&next);
            samples.push(next);
        }
        (samples, false)
    }
}

/// Distance between two postures in joint space.
pub(super) fn separation(a: &[f64], b: &[f64]) -> f64 {
    (DVector::from_column_slice(a) - DVector::from_column_slice(b)).norm()
}
