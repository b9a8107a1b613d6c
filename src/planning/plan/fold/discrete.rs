//! Equilibrium of a fold with a discrete elastic rod.

use super::FoldError;
use super::equilibrium::{Condition, Fold};
use nalgebra::Vector3;
use rodlab_engine::mechanics::kirchhoff::elastica::{Forces, Place, State};

/// A number and its derivatives with respect to H, V and l̄_s.
#[derive(Clone, Copy)]
struct Dual {
    value: f64,
    by: Vector3<f64>,
}

impl Dual {
    fn map(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            by: slope * self.by,
        }
    }
}

impl Fold {
    /// The fold at the same gripper position for a discrete elastic rod of N edges; second-order
    /// accurate in their length.
    ///
    /// # Errors
    /// Newton's method does not converge.
    pub fn discrete(&self, edges: usize) -> Result<Self, FoldError> {
        let [x, z] = self.gripper;
        let conditions = [Condition::NoMoment, Condition::Along(x), Condition::Up(z)];
        let end = |forces, length| end(forces, length, edges);
        let found = Self::solved(self.forces, self.suspended_length, conditions, end);
        found.ok_or(FoldError::NoConvergence {
            gripper: self.gripper,
            edges,
        })
    }
}

/// The end of a planar discrete elastic rod of N equal edges of length l = l̄_s/N. At node j the edges turn by φ_j and the moment
/// is M_j = 2 tan(φ_j/2)/l (thesis Eq. 1.5); the moments of edge j balance:
///
/// > M_{j+1} − M_j = l (H sin θ_j − (V + (j + ½) l/2) cos θ_j),  θ_j = θ_{j−1} + φ_j
///
/// The first edge lies on the table, without a moment before it. The returned angle is that of the
/// last edge. The derivatives with respect to the length are returned beside the end.
fn end(forces: Forces, length: f64, edges: usize) -> (Place, State) {
    let part = 1.0 / edges as f64;
    let edge = part * length;
    let nought = Dual {
        value: 0.0,
        by: Vector3::zeros(),
    };
    let [mut x, mut z, mut angle, mut moment] = [nought; 4];
    for j in 0..edges {
        if j > 0 {
            let half = 0.5 * edge * moment.value;
            let half_by = 0.5 * (edge * moment.by + moment.value * part * Vector3::z());
            angle.value += 2.0 * libm::atan(half);
            angle.by += 2.0 / (1.0 + half * half) * half_by;
        }
        let (sine, cosine) = libm::sincos(angle.value);
        let [sine, cosine] = [angle.map(sine, cosine), angle.map(cosine, -sine)];
        let middle = (j as f64 + 0.5) * part;
        let load = forces.vertical + 0.5 * middle * length;
        let torque = forces.horizontal * sine.value - load * cosine.value;
        let torque_by = forces.horizontal * sine.by + sine.value * Vector3::x()
            - load * cosine.by
            - cosine.value * Vector3::new(0.0, 1.0, 0.5 * middle);
        moment.value += edge * torque;
        moment.by += edge * torque_by + part * torque * Vector3::z();
        for (sum, slope) in [(&mut x, cosine), (&mut z, sine)] {
            sum.value += edge * slope.value;
            sum.by += edge * slope.by + part * slope.value * Vector3::z();
        }
    }
    let state = |part: &dyn Fn(&Dual) -> f64| State {
        x: part(&x),
        z: part(&z),
        angle: part(&angle),
        curvature: part(&moment),
    };
    let place = Place {
        arc_length: length,
        state: state(&|dual| dual.value),
        by_horizontal: state(&|dual| dual.by.x),
        by_vertical: state(&|dual| dual.by.y),
    };
    (place, state(&|dual| dual.by.z))
}

#[cfg(test)]
mod tests {
    use super::super::FoldAtlas;

    #[test]
    fn the_discrete_rod_is_second_order_and_within_a_twentieth_of_a_per_cent() {
        let atlas = FoldAtlas::new();
        for gripper in [[0.68, 0.77], [3.4, 1.7], [2.0, 3.2], [6.6, 1.9]] {
            let exact = atlas.solve(gripper).unwrap();
            let error = |edges| {
                let found = exact.discrete(edges).unwrap();
                let ratio = found.force_ratio() - exact.force_ratio();
                [
                    found.suspended_length - exact.suspended_length,
                    found.angle - exact.angle,
                    ratio,
                ]
            };
            let (coarse, fine) = (error(100), error(200));
            for k in 0..3 {
                let order = (coarse[k] / fine[k]).log2();
                assert!((order - 2.0).abs() < 0.1, "{gripper:?} {k}: {order}");
            }
            assert!(coarse[0].abs() < 5e-4 * exact.suspended_length);
            assert!(coarse[1].abs() < 0.05f64.to_radians());
            assert!(coarse[2].abs() < 5e-4, "{coarse:?}");
        }
    }
}
