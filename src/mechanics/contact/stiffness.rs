//! The adaptive contact stiffness (thesis Eqs. 2.18, 2.19).
//!
//! k = s max‖F‖ over the nodes in contact, where F is the total force on a node without contact and
//! friction: at this stiffness a contact that must bear F does so within δ of touching. The barrier of
//! incremental potential contact follows the same rule with the factor that makes it bear F at δ/2.
//!
//! The forces change from step to step, and the stiffness should not follow every flicker: the contact
//! force grows exponentially with the gap, so that a stiffness that is off by a factor of two moves the gap
//! of a contact that does not penetrate by less than δ/20. So k rises to its new value where that is
//! more than [`BAND`] times as large, and falls, by at most this factor at a time, where it is that much
//! smaller: a peak of one step leaves the contacts of the next ones stiff.

/// Factor of change that is not followed.
const BAND: f64 = 2.0;

/// The stiffness after `present`, given the largest force `force` (N), the factor s = `factor`
/// (J/N) and the least stiffness allowed.
pub(super) fn adapted_stiffness(present: f64, force: f64, factor: f64, least: f64) -> f64 {
    let target = (factor * force).max(least);
    if target > BAND * present {
        target
    } else if target < present / BAND {
        target.max(present / BAND)
    } else {
        present
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_rises_at_once_and_ignores_flicker() {
        assert_eq!(adapted_stiffness(1.0, 5e-3, 1e5, 0.1), 500.0);
        assert_eq!(adapted_stiffness(500.0, 3e-3, 1e5, 0.1), 500.0);
        assert_eq!(adapted_stiffness(500.0, 9e-3, 1e5, 0.1), 500.0);
    }

    #[test]
    fn it_falls_by_steps_to_the_least_value() {
        let mut stiffness = 1000.0;
        for expected in [500.0, 250.0, 125.0, 62.5, 31.25, 31.25] {
            stiffness = adapted_stiffness(stiffness, 0.0, 1e5, 20.0);
            assert_eq!(stiffness, expected);
        }
    }
}
