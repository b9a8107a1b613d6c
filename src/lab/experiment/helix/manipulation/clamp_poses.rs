//! Poses of the clamps of a rod that should form a helix (thesis Eqs. 6.2 and 6.3).

use nalgebra::{Isometry3, Translation3, Unit};
use rodlab_engine::mechanics::kirchhoff::Helix;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};

/// The clamps of a rod that starts at the origin in the direction of x.
///
/// With Λ = √(κ² + τ²) and the axis a = (τ, κ, 0)/Λ the end of a helix of length 1 lies at
/// (τ²/Λ² + κ² sin Λ/Λ³, κτ (1 − sin Λ/Λ)/Λ², κ (cos Λ − 1)/Λ²). This is Eq. 6.2 without its
/// misprints, with the axes in another order. The Frenet frame at the end is that of the start,
/// rotated by Λ about a. The hand holds the untwisted frame, which is the Frenet frame rotated
/// back by τ about the tangent (Eq. 6.3). The chuck applies the twist ω/c, with the opposite
/// sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampPoses {
    /// Angle of the chuck about x, rad.
    pub chuck: f64,
    /// Pose of the hand, m; its x axis is the tangent at the end.
    pub hand: Isometry3<f64>,
}

impl ClampPoses {
    /// Clamp poses of a helix given in units of the rod's `length`, m, and its bending stiffness;
    /// `stiffness_ratio` is c = GJ/EI. The whole helix is rotated by `roll`, rad, about x. This
    /// does not change the clamps of the straight rod.
    pub fn of(helix: &Helix, length: f64, stiffness_ratio: f64, roll: f64) -> Self {
        let (axis, rate) = helix.axis();
        let frenet = UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), rate);
        let tangent = Unit::new_normalize(frenet * Vector3::x());
        let untwisted = UnitQuaternion::from_axis_angle(&tangent, -helix.torsion) * frenet;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll);
        Self {
            chuck: -helix.twisting_moment / stiffness_ratio,
            hand: Isometry3::from_parts(
                Translation3::from(turn * (length * helix.position(1.0))),
                turn * untwisted * turn.inverse(),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::helix::stability::DiscreteRod;
    use rodlab_engine::mechanics::rod::transport::rotated;

    /// The chain of edges rotates its end by the twist of its polygon, which approaches that of
    /// the helix with the square of the edge length.
    #[test]
    fn a_fine_chain_of_edges_has_the_same_clamps() {
        let helix = Helix::from([5.0, 3.0, 2.0]);
        let c = 0.75;
        let clamps = ClampPoses::of(&helix, 1.0, c, 0.0);
        let away = |edges: usize| {
            let rod = DiscreteRod {
                edges,
                stiffness_ratio: c,
                bending_stiffness: 1.0,
            };
            let end = rod.end_on_helix(&helix);
            let place = Vector3::x() + end.translation[0].1;
            let turned = end.orientation[0].1 * Vector3::y();
            let tangent = clamps.hand.rotation * Vector3::x();
            // In the chain of edges the end carries the whole twist.
            let carried = rotated(
                &(clamps.hand.rotation * Vector3::y()),
                &tangent,
                -clamps.chuck,
            );
            let off = (place - clamps.hand.translation.vector).norm();
            off.max((turned - carried).norm())
        };
        let [coarse, fine] = [away(100), away(200)];
        assert!((coarse / fine - 4.0).abs() < 0.2, "{coarse} {fine}");
        assert!(fine < 1e-3, "{fine}");
    }

    #[test]
    fn the_straight_rod_is_the_same_for_every_roll() {
        let straight = ClampPoses::of(&Helix::from([0.0, 0.0, 0.0]), 0.5, 0.75, 0.7);
        assert_eq!(straight.chuck, 0.0);
        assert!((straight.hand.translation.vector - 0.5 * Vector3::x()).norm() < 1e-15);
        assert!(straight.hand.rotation.angle() < 1e-12);
    }

    #[test]
    fn a_roll_turns_the_helix_about_its_first_tangent() {
        let helix = Helix::from([4.0, 1.0, -2.0]);
        let [flat, rolled] = [0.0, 0.5].map(|roll| ClampPoses::of(&helix, 0.5, 0.75, roll));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.5);
        let tangent = |clamps: &ClampPoses| clamps.hand.rotation * Vector3::x();
        assert!((turn * tangent(&flat) - tangent(&rolled)).norm() < 1e-12);
        let places = [flat, rolled].map(|clamps| clamps.hand.translation.vector);
        assert!((turn * places[0] - places[1]).norm() < 1e-12);
        assert_eq!(flat.chuck, rolled.chuck);
    }
}
