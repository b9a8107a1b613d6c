//! Derivatives with respect to fields in motions of joined rods and bodies, compared with
//! differences of whole runs.

use super::LARGEST_TRACE;
use super::comparison::{Course, SCHEMES, check_at, check_shares, course};
use super::contact_tests::against_forward;
use crate::mechanics::dynamics::Scheme;
use crate::mechanics::dynamics::sensitivity::joint_tests::{
    arms, breakable, breaking, pulled_pieces, sliding, sprung, tumbling,
};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::{JointKind, Relaxation, Scene};
use crate::mechanics::test_support::at;

const EXACT: f64 = 1e-7;

/// Compares in the first rod, at the joint, and in the second rod.
#[track_caller]
fn check(name: &str, course: &Course, scene: &Scene, share: f64) {
    check_at([1, 4, 6], EXACT, name, course, scene, share);
}

#[test]
fn equilibria_of_joined_rods() {
    let rest = Course {
        settles: true,
        steps: 0,
        ..course(Scheme::ImplicitEuler)
    };
    for kind in [JointKind::Rigid, sprung()] {
        check("rest", &rest, &arms(kind), 0.3);
    }
}

#[test]
fn swings_of_joined_rods_with_a_body() {
    for kind in [JointKind::Ball, JointKind::Rigid, sprung()] {
        for scheme in SCHEMES {
            check("arms", &course(scheme), &arms(kind), 1.0);
            let error = against_forward(&course(scheme), &arms(kind), at(1, 2), 1e-6);
            println!("arms {kind:?} {scheme:?} against the forward mode: {error:.1e}");
            assert!(error < 1e-7, "{kind:?} {scheme:?}: {error:e}");
        }
    }
}

#[test]
fn viscous_rods_in_a_fluid() {
    let mut scene = arms(sprung());
    for rod in &mut scene.rods {
        rod.retardation_time = 0.02;
        rod.relaxation = Some(Relaxation {
            ratio: 0.5,
            time: 0.03,
        });
    }
    scene.fluid = Some(FluidModel::Resistive { viscosity: 0.05 });
    for scheme in SCHEMES {
        let from_rest = Course {
            settles: true,
            ..course(scheme)
        };
        // Rounding errors in the lengths of edges, times EA T/H, limit the differences.
        check_at([1, 4, 6], 1e-6, "viscous", &course(scheme), &scene, 1.0);
        check("viscous", &from_rest, &scene, 0.3);
    }
}

#[test]
fn a_joint_of_the_midpoint_rule() {
    let midpoint = course(Scheme::ImplicitMidpoint);
    let mut scene = arms(JointKind::Ball);
    scene.bodies.remove(0);
    scene.fluid = Some(FluidModel::Resistive { viscosity: 0.05 });
    check("midpoint", &midpoint, &scene, 0.3);
}

#[test]
fn motions_in_which_a_joint_breaks() {
    for kind in breakable() {
        let scene = breaking(kind);
        for scheme in SCHEMES {
            // By backward differences the results hardly depend on GJ and EA: only large changes stand
            // out from rounding errors, 2e-10 in the derivatives of results of the size 1. Large changes
            // of the others make the joint break in another step.
            let (exact, stiffer) = match scheme {
                Scheme::BackwardDifferences => (2e-7, 3.0),
                _ => (EXACT, 0.2),
            };
            let share = |field: &str| match field {
                "GJ" | "EA" => stiffer,
                "velocity" => 0.05,
                _ => 0.2,
            };
            check_shares([1, 4, 6], exact, "breaking", &course(scheme), &scene, share);
            let error = against_forward(&course(scheme), &scene, at(1, 2), 1e-6);
            println!("breaking {kind:?} {scheme:?} against the forward mode: {error:.1e}");
            assert!(error < 1e-7, "{kind:?} {scheme:?}: {error:e}");
        }
        let course = course(Scheme::BackwardDifferences);
        let whole = course.gradients(&scene, LARGEST_TRACE);
        assert_eq!(whole, course.gradients(&scene, 20_000));
    }
}

#[test]
fn a_body_that_tumbles_and_resets_its_rotation() {
    for scheme in SCHEMES {
        check("tumbling", &course(scheme), &tumbling(), 2.0);
    }
}

#[test]
fn a_bead_that_slides_along_a_rod() {
    for scheme in SCHEMES {
        // The velocity of a bead on a straight wire hardly depends on its stiffness: only large changes
        // stand out from rounding errors.
        let share = |field: &str| match field {
            "EI1" | "EI2" | "GJ" | "EA" => 1.0,
            _ => 0.3,
        };
        check_shares(
            [3, 6, 10],
            EXACT,
            "bead",
            &course(scheme),
            &sliding(),
            share,
        );
    }
}

/// Contacts that stick and slide; the active set of a step is that of the run.
#[test]
fn joined_rods_pulled_over_the_ground_by_complementarity() {
    for kind in [JointKind::Ball, JointKind::Rigid] {
        let scene = pulled_pieces(kind);
        let course = course(Scheme::ImplicitEuler);
        let error = against_forward(&course, &scene, at(1, 2), 1e-7);
        println!("pulled {kind:?} against the forward mode: {error:.1e}");
        assert!(error < 1e-5, "{kind:?}: {error:e}");
        check_at([7], 1e-5, "pulled", &course, &scene, 0.02);
    }
}
