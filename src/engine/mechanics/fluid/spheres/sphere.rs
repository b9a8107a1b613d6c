//! A single sphere in Stokes flow: its own flow, and its motion in the flow of others.
//!
//! A sphere of radius a that exerts the force F and the torque T on the fluid causes the flow
//!
//! ```text
//! 8πη u(x) = G F + T × r/r³,    G = (I/r + rrᵀ/r³) + a²/3 (I/r³ − 3 rrᵀ/r⁵)
//! ```
//!
//! outside itself, with r from its centre. The motion of the sphere in a flow u∞ of others follows
//! from Faxén's laws (Kim and Karrila 1991, chapter 3)
//!
//! ```text
//! U = F/(6πηa) + (1 + a²/6 ∇²) u∞,    Ω = T/(8πηa³) + ½ ∇ × u∞
//! ```
//!
//! at its centre. For a force f at a distance r the operator 1 + a²/6 ∇² turns the Stokeslet into
//! G again: the action of a sphere on a point equals that of the point on the sphere.
//!
//! **Unknowns.** Force and torque are scaled to velocities, φ = F/(8πηa) and τ = T/(8πηa²), as are
//! U and aΩ.

use crate::mechanics::{Matrix3, Vector3};

/// A sphere that a node of a rod carries at its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sphere {
    /// Index of its centre in the positions of the scene.
    pub centre: usize,
    /// Radius a, m.
    pub radius: f64,
    /// Index of the first of three points that rotate with it. Their positions are relative to the
    /// centre, along orthogonal axes.
    pub first_tip: usize,
    /// Their distance ℓ from the centre, m.
    pub arm: f64,
}

/// Interaction of a sphere and a point at a distance, without the rotation of the point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in super::super) struct Influence {
    /// Action of the force on the velocity: symmetric.
    pub stokeslet: Matrix3,
    /// d of the velocity τ × d.
    pub rotlet: Vector3,
}

impl Influence {
    /// Adds another influence, weighted.
    pub(crate) fn add(&mut self, weight: f64, other: &Self) {
        self.stokeslet += other.stokeslet * weight;
        self.rotlet += other.rotlet * weight;
    }
}

impl Sphere {
    /// Indices of the points that rotate with it.
    pub(crate) fn tips(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.first_tip + axis)
    }

    /// Whether a point at r from its centre is inside.
    pub(crate) fn contains(&self, r: &Vector3) -> bool {
        r.norm() < self.radius
    }

    /// Angular velocity of the sphere from the velocities of the tips, rad/s: Σ p × ṗ/(2ℓ²).
    pub(crate) fn spin(&self, positions: &[Vector3], velocities: &[Vector3]) -> Vector3 {
        let moments = self
            .tips()
            .map(|tip| positions[tip].cross(&velocities[tip]));
        moments.iter().sum::<Vector3>() / (2.0 * self.arm * self.arm)
    }

    /// Force of a torque on a tip at p, N: T × p/(2ℓ²); the torques of these forces add up to T.
    pub(crate) fn force_on_tip(&self, torque: &Vector3, tip: &Vector3) -> Vector3 {
        torque.cross(tip) / (2.0 * self.arm * self.arm)
    }

    /// Resistances of the centre (6πηa) and of a tip (8πηa³ shared among them), N s/m.
    pub(crate) fn resistances(&self, viscosity: f64) -> [f64; 2] {
        use std::f64::consts::PI;
        let turning = 8.0 * PI * viscosity * self.radius.powi(3);
        [
            6.0 * PI * viscosity * self.radius,
            turning / (2.0 * self.arm * self.arm),
        ]
    }

    /// Influence at r from the centre: the fluid velocity is S φ + τ × d; inside the sphere it is
    /// that of the rigid motion.
    pub(in super::super) fn influence(&self, r: &Vector3) -> Influence {
        let a = self.radius;
        let distance = r.norm();
        if distance <= a {
            return Influence {
                stokeslet: Matrix3::identity() * (4.0 / 3.0),
                rotlet: r / a,
            };
        }
        let cubed = distance.powi(3);
        Influence {
            stokeslet: finite_size_stokeslet(r, a * a) * a,
            rotlet: r * (a * a / cubed),
        }
    }

    /// Action on the sphere of a unit force at a point, with r from the point to the centre, over
    /// 8πη: its velocity is S f and that of its surface, aΩ, is f × d.
    pub(in super::super) fn influence_of(&self, r: &Vector3) -> Influence {
        let a = self.radius;
        let Influence { stokeslet, rotlet } = self.influence(r);
        Influence {
            stokeslet: stokeslet / a,
            rotlet: rotlet / a,
        }
    }

    /// Motion (U, aΩ) of this sphere per unknowns (φ, τ) of another one, with r from the other: 6
    /// × 6 in four blocks, rows first (Rotne and Prager 1969; with rotation Wajnryb et al. 2013).
    /// Overlapping spheres count as touching.
    pub(crate) fn by(&self, other: &Self, r: &Vector3) -> [[Matrix3; 2]; 2] {
        let (a, b) = (self.radius, other.radius);
        let distance = r.norm().max(a + b);
        let r = match r.try_normalize(0.0) {
            Some(direction) => direction * distance,
            None => Vector3::x() * distance,
        };
        let cubed = distance.powi(3);
        // The matrix of w ↦ w × r/r³.
        let rotlet = -r.cross_matrix() / cubed;
        let curl =
            (r * r.transpose() * (3.0 / distance.powi(5)) - Matrix3::identity() / cubed) * 0.5;
        [
            [
                finite_size_stokeslet(&r, a * a + b * b) * b,
                rotlet * (b * b),
            ],
            [rotlet * (a * b), curl * (a * b * b)],
        ]
    }
}

/// (I/r + rrᵀ/r³) + s/3 (I/r³ − 3 rrᵀ/r⁵) for the sum s of the squared radii.
fn finite_size_stokeslet(r: &Vector3, squares: f64) -> Matrix3 {
    let square = r.norm_squared();
    let distance = square.sqrt();
    let outer = r * r.transpose() / square;
    let part = squares / (3.0 * square);
    (Matrix3::identity() * (1.0 + part) + outer * (1.0 - 3.0 * part)) / distance
}

#[cfg(test)]
mod tests {
    use super::*;

    const BALL: Sphere = Sphere {
        centre: 0,
        radius: 0.3,
        first_tip: 1,
        arm: 0.2,
    };

    /// Flow of the sphere for given unknowns.
    fn flow(r: &Vector3, force: &Vector3, torque: &Vector3) -> Vector3 {
        let Influence { stokeslet, rotlet } = BALL.influence(r);
        stokeslet * force + torque.cross(&rotlet)
    }

    #[test]
    fn the_flow_of_a_sphere_is_its_motion_at_the_surface() {
        let [force, torque] = [Vector3::new(0.3, -0.2, 0.7), Vector3::new(-0.1, 0.4, 0.5)];
        for direction in [Vector3::x(), Vector3::new(0.6, 0.0, 0.8), -Vector3::z()] {
            for just_outside in [1.0, 1.0 + 1e-12] {
                let r = direction * (0.3 * just_outside);
                // U = F/(6πηa) = 4/3 φ, and aΩ = τ.
                let rigid = force * (4.0 / 3.0) + torque.cross(&direction);
                assert!((flow(&r, &force, &torque) - rigid).norm() < 1e-11);
            }
        }
    }

    #[test]
    fn the_flow_of_a_sphere_has_no_sources() {
        let [force, torque] = [Vector3::new(0.3, -0.2, 0.7), Vector3::new(-0.1, 0.4, 0.5)];
        let (x, h) = (Vector3::new(0.4, -0.2, 0.3), 1e-5);
        let slope = |axis: usize| {
            let ends = [h, -h].map(|by| {
                let mut moved = x;
                moved[axis] += by;
                flow(&moved, &force, &torque)[axis]
            });
            (ends[0] - ends[1]) / (2.0 * h)
        };
        let divergence: f64 = (0..3).map(slope).sum();
        assert!(divergence.abs() < 1e-8, "{divergence:e}");
    }

    #[test]
    fn a_torque_on_tips_is_that_of_a_turning_sphere() {
        let turn = nalgebra::Rotation3::new(Vector3::new(0.3, 1.1, -0.4));
        let tips = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| turn * axis * BALL.arm);
        let mut positions = vec![Vector3::new(5.0, 6.0, 7.0)];
        positions.extend(tips);
        let spin = Vector3::new(0.2, -3.0, 1.0);
        let velocities: Vec<Vector3> = positions.iter().map(|p| spin.cross(p)).collect();
        assert!((BALL.spin(&positions, &velocities) - spin).norm() < 1e-14);
        let torque = Vector3::new(0.5, 0.1, -0.7);
        let sum: Vector3 = tips
            .iter()
            .map(|tip| tip.cross(&BALL.force_on_tip(&torque, tip)))
            .sum();
        assert!((sum - torque).norm() < 1e-14);
        // Each tip alone has its share of 8πηa³.
        let [_, of_tip] = BALL.resistances(0.7);
        let braking: Vector3 = tips
            .iter()
            .map(|tip| tip.cross(&(spin.cross(tip) * -of_tip)))
            .sum();
        let expected = spin * (-8.0 * std::f64::consts::PI * 0.7 * 0.3f64.powi(3));
        assert!((braking - expected).norm() < 1e-13);
    }

    #[test]
    fn two_spheres_act_on_each_other_alike() {
        let other = Sphere {
            radius: 0.5,
            ..BALL
        };
        let r = Vector3::new(0.7, -0.9, 0.4);
        let whole = |rows: [[Matrix3; 2]; 2], a: f64, b: f64| {
            // After conversion of φ, τ to F, T and of aΩ to Ω, the matrix is symmetric.
            let [[tt, tr], [rt, rr]] = rows;
            [[tt / b, tr / (b * b)], [rt / (a * b), rr / (a * b * b)]]
        };
        let to = whole(BALL.by(&other, &r), 0.3, 0.5);
        let back = whole(other.by(&BALL, &-r), 0.5, 0.3);
        for i in 0..2 {
            for j in 0..2 {
                let difference = to[i][j] - back[j][i].transpose();
                assert!(difference.norm() < 1e-14, "{i} {j}: {difference}");
            }
        }
    }
}
