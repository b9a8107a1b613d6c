use super::super::friction::FrictionLaw;
use super::super::test_support::{Random, relative_error};
use super::*;

const OWN: DirectedFriction = DirectedFriction {
    forwards: 0.1,
    backwards: 0.7,
    sideways: 0.4,
};

/// The law on the plane z = 0 for a rod along the tangent `tangent` of any length.
fn law(own: DirectedFriction, tangent: Vector3) -> FrictionLaw {
    FrictionLaw {
        coefficient: own.sideways,
        slip_tolerance: 1e-4,
        grain: Some(own.grain(&Vector3::z(), &tangent)),
    }
}

/// A random vector in the plane.
fn in_plane(random: &mut Random) -> Vector3 {
    let mut vector = random.vector();
    vector.z = 0.0;
    vector
}

#[test]
fn each_direction_has_its_coefficient() {
    let tangent = Vector3::new(0.6, 0.8, 0.0);
    let across = Vector3::new(-0.8, 0.6, 0.0);
    let law = law(OWN, tangent * 0.02);
    for (direction, coefficient) in [
        (tangent, OWN.forwards),
        (-tangent, OWN.backwards),
        (across, OWN.sideways),
        (-across, OWN.sideways),
    ] {
        let found = law.traction_of_slip(&(direction * 0.1));
        assert!((found + direction * coefficient).norm() < 1e-15);
    }
    // Between them, the law as printed by Hu et al.
    let mut random = Random::new(7);
    for _ in 0..100 {
        let direction = in_plane(&mut random).normalize();
        let along = direction.dot(&tangent);
        let own = if along > 0.0 {
            OWN.forwards
        } else {
            OWN.backwards
        };
        let expected = tangent * (-own * along) - across * (OWN.sideways * direction.dot(&across));
        let found = law.traction_of_slip(&(direction * 0.1));
        assert!((found - expected).norm() < 1e-15);
    }
}

#[test]
fn a_rod_that_stands_on_the_plane_slides_sideways_in_all_directions() {
    let upright = law(OWN, Vector3::z());
    let slip = Vector3::new(0.03, -0.04, 0.0);
    let found = upright.traction_of_slip(&slip);
    assert!((found + slip * (OWN.sideways / slip.norm())).norm() < 1e-15);
    // At 60° a quarter of the difference is left.
    let steep = law(OWN, Vector3::new(0.5, 0.0, 0.75f64.sqrt()));
    let found = steep.traction_of_slip(&(Vector3::x() * 0.1));
    assert!((found.x + 0.75 * OWN.sideways + 0.25 * OWN.forwards).abs() < 1e-15);
}

#[test]
fn equal_coefficients_are_the_law_without_directions() {
    let own = DirectedFriction {
        forwards: 0.3,
        backwards: 0.3,
        sideways: 0.3,
    };
    let mut random = Random::new(9);
    for decade in -3..=3 {
        let directed = law(own, random.vector());
        let plain = FrictionLaw {
            grain: None,
            ..directed
        };
        let slip = in_plane(&mut random) * (1e-4 * 10f64.powi(decade));
        let sum = in_plane(&mut random) * 10f64.powi(decade);
        let close = |a: Vector3, b: Vector3| assert!((a - b).norm() < 1e-12 * a.norm());
        close(
            plain.traction_of_slip(&slip),
            directed.traction_of_slip(&slip),
        );
        close(plain.resolved(&sum, 2.0), directed.resolved(&sum, 2.0));
        close(plain.limited(sum), directed.limited(sum));
        let (one, other) = (plain.slope(&slip), directed.slope(&slip));
        assert!(relative_error(other.as_slice(), one.as_slice()) < 1e-12);
    }
}

#[test]
fn the_slope_agrees_with_differences_over_decades() {
    let mut random = Random::new(15);
    for decade in -3..=3 {
        let scale = 1e-4 * 10f64.powi(decade);
        for _ in 0..50 {
            let law = law(OWN, random.vector());
            let slip = in_plane(&mut random) * scale;
            let step = 1e-6 * scale;
            let mut expected = Matrix3::zeros();
            for axis in 0..2 {
                let mut offset = Vector3::zeros();
                offset[axis] = step;
                let change =
                    law.traction_of_slip(&(slip + offset)) - law.traction_of_slip(&(slip - offset));
                expected.set_column(axis, &(change / (2.0 * step)));
            }
            let mut found = law.slope(&slip);
            found.set_column(2, &Vector3::zeros()); // slips lie in the plane
            let error = relative_error(found.as_slice(), expected.as_slice());
            assert!(error < 1e-7, "10^{decade}: {error:e}");
        }
    }
}

/// The derivative jumps where the sliding turns from backwards to forwards, the force does not; at
/// rest it vanishes.
#[test]
fn the_force_is_continuous_where_the_coefficient_jumps() {
    let law = law(OWN, Vector3::x());
    for across in [0.0, 1e-6, 1e-4, 1e-2] {
        let at = |along: f64| law.traction_of_slip(&Vector3::new(along, across, 0.0));
        assert!((at(1e-16) - at(-1e-16)).norm() < 1e-10);
    }
    assert_eq!(law.traction_of_slip(&Vector3::zeros()), Vector3::zeros());
}

#[test]
fn friction_does_no_positive_work() {
    let mut random = Random::new(21);
    for _ in 0..1000 {
        let law = law(OWN, random.vector());
        let slip = in_plane(&mut random) * 3e-4;
        let traction = law.traction_of_slip(&slip);
        assert!(traction.dot(&slip) <= 0.0);
        // It lies within the curve to which tractions are shortened.
        assert!((law.limited(traction) - traction).norm() < 1e-15);
        let shortened = law.limited(traction * 100.0);
        assert!(shortened.norm() <= OWN.largest() * (1.0 + 1e-15));
    }
}

#[test]
fn a_slip_is_found_from_its_friction_and_resistance() {
    let mut random = Random::new(23);
    for coefficient in [0.0, 0.1, 3.0] {
        let own = DirectedFriction {
            forwards: coefficient,
            ..OWN
        };
        for decade in -4..=6 {
            for _ in 0..50 {
                let law = law(own, random.vector());
                let resistance = 10f64.powi(decade);
                let sum = in_plane(&mut random);
                let slip = law.resolved(&sum, resistance);
                let error = law.traction_of_slip(&slip) - slip * resistance - sum;
                assert!(error.norm() < 1e-9, "10^{decade}: {:e}", error.norm());
            }
        }
    }
}
