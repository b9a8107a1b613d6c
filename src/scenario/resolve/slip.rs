//! The default of `contact.slip_tolerance`, which follows from the scales of a scene.
//!
//! What sticks creeps with some part of the slip tolerance ν. A radius h is fallen through, or run through at the acceleration
//! a of what presses rods together, with the speed √(a h); what creeps with a five-hundredth of that creeps by much less
//! than a radius in the time that motions on this scale take. For rods of a quarter of a millimetre and more, under gravity,
//! this is more than the 0.1 mm/s that suit them.

use crate::scenario::resolved::{Clamp, Contact, Load, LoadKind};

/// The largest default, m/s.
const LARGEST: f64 = 1e-4;
/// Part of the speed √(a h).
const PART_OF_FALL: f64 = 2e-3;
/// Part of the speed of clamps that move slowly.
const PART_OF_DRIVE: f64 = 0.1;
/// Standard acceleration of free fall, m/s², for scenes without gravity.
const STANDARD_GRAVITY: f64 = 9.80665;

/// Default slip tolerance of a scene whose thinnest rod has this radius (m), m/s: the least of 0.1 mm/s, √(a h)/500, and a
/// tenth of the fastest straight motion of a clamp.
pub fn default_slip_tolerance(smallest_radius: f64, loads: &[Load], clamps: &[Clamp]) -> f64 {
    let of_fall = PART_OF_FALL * (acceleration(loads) * smallest_radius).sqrt();
    let drive = clamps.iter().map(speed).fold(0.0, f64::max);
    let of_drive = if drive > 0.0 {
        PART_OF_DRIVE * drive
    } else {
        f64::INFINITY
    };
    let least = of_fall.min(of_drive);
    // A scene that is wrong elsewhere may have no radius.
    if least > 0.0 {
        LARGEST.min(least)
    } else {
        LARGEST
    }
}

/// Size of the sum of all gravity, m/s²; the standard one without any.
fn acceleration(loads: &[Load]) -> f64 {
    let mut sum = [0.0; 3];
    for load in loads {
        if let LoadKind::Gravity { acceleration } = load.kind {
            for (sum, part) in sum.iter_mut().zip(acceleration) {
                *sum += part;
            }
        }
    }
    let size = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
    if size > 0.0 { size } else { STANDARD_GRAVITY }
}

/// Fastest straight motion of a clamp, m/s.
fn speed(clamp: &Clamp) -> f64 {
    let corners = clamp.movement.translation.windows(2);
    let speeds = corners.map(|pair| {
        let [(before, from), (after, to)] = [pair[0], pair[1]];
        let way = (0..3)
            .map(|axis| (to[axis] - from[axis]).powi(2))
            .sum::<f64>();
        way.sqrt() / (after - before)
    });
    speeds.fold(0.0, f64::max)
}

impl Contact {
    /// Sets the slip tolerance (m/s), where the model has one.
    pub(in crate::scenario) fn set_slip_tolerance(&mut self, tolerance: f64) {
        match self {
            Self::Imc { slip_tolerance, .. } | Self::Ipc { slip_tolerance, .. } => {
                *slip_tolerance = tolerance;
            }
            Self::None | Self::Complementarity { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::resolved::Movement;

    fn gravity(acceleration: f64) -> Vec<Load> {
        vec![Load {
            kind: LoadKind::Gravity {
                acceleration: [0.0, 0.0, -acceleration],
            },
            schedule: Vec::new(),
        }]
    }

    #[test]
    fn rods_of_millimetres_have_a_tenth_of_a_millimetre_per_second() {
        for radius in [3e-4, 1e-3, 5e-3] {
            assert_eq!(default_slip_tolerance(radius, &gravity(9.81), &[]), 1e-4);
            assert_eq!(default_slip_tolerance(radius, &[], &[]), 1e-4);
        }
    }

    #[test]
    fn what_is_smaller_lighter_or_slower_has_less() {
        // √(9.81 · 2.5e-7)/500.
        let micro = default_slip_tolerance(2.5e-7, &gravity(9.81), &[]);
        assert!((micro / 3.132e-6 - 1.0).abs() < 1e-3, "{micro}");
        let light = default_slip_tolerance(1e-3, &gravity(9.81e-4), &[]);
        assert!((light / 1.981e-6 - 1.0).abs() < 1e-3, "{light}");
        let slow = Clamp {
            movement: Movement {
                translation: vec![(0.0, [0.0; 3]), (10.0, [3e-5, 4e-5, 0.0])],
                ..Movement::default()
            },
            ..at_the_start()
        };
        let slow = default_slip_tolerance(1e-3, &gravity(9.81), &[slow]);
        assert!((slow / 5e-7 - 1.0).abs() < 1e-9, "{slow}");
    }

    fn at_the_start() -> Clamp {
        Clamp {
            rod: "rod".into(),
            at: crate::scenario::resolved::Place::Start,
            hold: crate::scenario::resolved::Hold::Both,
            movement: Movement::default(),
        }
    }
}
