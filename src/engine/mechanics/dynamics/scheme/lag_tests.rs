//! The largest ratio of a resistance to its local part for which steps with lagged drag do not
//! ring.

use super::super::history::History;
use super::super::state::State;
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::test_support::SCHEMES;

/// The largest velocity of a body without springs after many steps, from a velocity of one. Its
/// mass is `inertia` hₐ D. Its drag is −D v at the end of the stage and (D − R) v₀ at the previous
/// or the predicted motion, D = 1 N s/m.
fn velocity_after(scheme: Scheme, inertia: f64, resistance: f64) -> f64 {
    let rules = scheme.rules();
    let mut state = State::new(&[0.0; STRIDE], &[1.0, 0.0, 0.0, 0.0]);
    let mut stage = Stage {
        step: 0.0,
        acceleration_step: 0.0,
        keeps_spin: false,
        start: vec![0.0; STRIDE],
        velocity: vec![0.0; STRIDE],
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        flow_torque: Vec::new(),
        positions: vec![Vector3::zeros()],
        angles: vec![0.0],
    };
    let mut prediction = Prediction {
        unknowns: vec![0.0; STRIDE],
        velocity: vec![0.0; STRIDE],
    };
    let step = 0.1;
    let mut next = vec![0.0; STRIDE];
    for _ in 0..400 {
        rules.begin(step, &state, 0.0, &mut stage, &mut prediction);
        let expected = if rules.predicts_drag() {
            prediction.velocity[0]
        } else {
            state.velocity[0]
        };
        // inertia (v − v̂) + v + (R − 1) v₀ = 0, with `inertia` and R in units of D.
        let stage_velocity =
            (inertia * stage.velocity[0] + (1.0 - resistance) * expected) / (inertia + 1.0);
        let mut end = vec![stage.start[0] + stage.step * stage_velocity, 0.0, 0.0, 0.0];
        if rules.extrapolates() {
            end[0] = 2.0 * end[0] - state.unknowns[0];
        }
        let solved = SolvedStep {
            step,
            state: &state,
            stage: &stage,
            end: &end,
            predicted_velocity: &prediction.velocity,
            held: &[false; STRIDE],
        };
        rules.finish(&solved, &mut next);
        state.advance_to(state.time + step, &end, &next);
        if state.velocity[0].abs() > 1e12 {
            break;
        }
    }
    let History { steps } = &state.history;
    steps
        .iter()
        .map(|step| step.velocity[0].abs())
        .fold(state.velocity[0].abs(), f64::max)
}

#[test]
fn lagging_drag_decays_up_to_the_largest_ratio_and_grows_beyond() {
    for scheme in SCHEMES {
        for inertia in [0.0, 0.05, 0.3, 0.5, 1.0, 3.0, 10.0] {
            let largest = scheme.rules().largest_lagged_ratio(inertia);
            for part in [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98] {
                let left = velocity_after(scheme, inertia, part * largest);
                let is_without = largest == 0.0;
                assert!(
                    is_without || left < 2.0,
                    "{scheme:?} {inertia} {part}: {left}"
                );
            }
            let beyond = velocity_after(scheme, inertia, 1.2 * largest.max(1.3));
            assert!(beyond > 1e3, "{scheme:?} {inertia}: {beyond}");
        }
    }
}

#[test]
fn lagging_drag_decays_with_an_enlarged_local_part() {
    let rules = Scheme::BackwardDifferences.rules();
    let mut enlarged = 0;
    for inertia in [0.5, 1.1, 1.5, 2.0, 4.0] {
        for ratio in [0.5, 1.5, 2.5, 3.0, 3.5, 4.5, 6.0] {
            let Some(factor) = rules.lagged_factor(ratio, inertia) else {
                continue;
            };
            enlarged += usize::from(factor > 1.0);
            for part in [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0] {
                // In units of the enlarged part.
                let [inertia, ratio] = [inertia / factor, part * ratio / factor];
                let left = velocity_after(Scheme::BackwardDifferences, inertia, ratio);
                assert!(left < 2.0, "{inertia} {ratio} {part} {factor}: {left}");
            }
        }
    }
    assert!(enlarged > 5, "{enlarged}");
    assert_eq!(rules.lagged_factor(2.5, 0.9), None);
    assert_eq!(rules.lagged_factor(0.5, 0.0), None);
    assert_eq!(rules.lagged_factor(f64::INFINITY, 2.0), None);
}

#[test]
fn without_inertia_backward_differences_ring_below_half_of_the_local_resistance() {
    let scheme = Scheme::BackwardDifferences;
    assert!(velocity_after(scheme, 0.0, 0.4) > 1e3);
    assert!(velocity_after(scheme, 0.0, 0.5) < 1.0);
    assert_eq!(scheme.rules().largest_lagged_ratio(0.0), 0.0);
}
