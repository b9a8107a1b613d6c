//! The default of `contact.slip_tolerance`, derived from the scales of a scene.
//!
//! Sticking contacts creep at a fraction of the slip tolerance ν. The speed scale is √(a h): a
//! body with the acceleration a (of gravity, or of the motion that presses rods together) reaches
//! this speed over a radius h. Creep at a thousandth of this speed covers much less than a radius
//! during such a motion. For a radius of a millimetre on Earth the tolerance is 0.1 mm/s. Scenes
//! without gravity use the gravity of Earth and at most 0.1 mm/s, because there even thicker rods
//! are driven at millimetres per second.

use crate::scenario::resolved::{Clamp, Contact, Load, LoadKind};

/// The largest default without gravity, m/s.
const LARGEST: f64 = 1e-4;
/// Part of the speed √(a h).
const PART_OF_FALL: f64 = 1e-3;
/// Fraction of the speed of slowly moving clamps.
const PART_OF_DRIVE: f64 = 0.1;
/// Acceleration of free fall on Earth, m/s², for scenes without gravity.
const ON_EARTH: f64 = 10.0;

/// Default slip tolerance of a scene whose thinnest rod has this radius (m), in m/s: the smaller
/// of √(a h)/1000 and a tenth of the largest translational speed of a clamp. Without gravity a is
/// 10 m/s², and the tolerance is at most 0.1 mm/s.
pub fn default_slip_tolerance(smallest_radius: f64, loads: &[Load], clamps: &[Clamp]) -> f64 {
    let gravity = gravity(loads);
    let (acceleration, largest) = if gravity > 0.0 {
        (gravity, f64::INFINITY)
    } else {
        (ON_EARTH, LARGEST)
    };
    let of_fall = PART_OF_FALL * (acceleration * smallest_radius).sqrt();
    let drive = clamps.iter().map(speed).fold(0.0, f64::max);
    let of_drive = if drive > 0.0 {
        PART_OF_DRIVE * drive
    } else {
        f64::INFINITY
    };
    let least = of_fall.min(of_drive).min(largest);
    // The scene may have another fault and no radius.
    if least > 0.0 && least.is_finite() {
        least
    } else {
        LARGEST
    }
}

/// Magnitude of the total gravity, m/s²; 0 without any.
fn gravity(loads: &[Load]) -> f64 {
    let mut sum = [0.0; 3];
    for load in loads {
        if let LoadKind::Gravity { acceleration } = load.kind {
            for (sum, part) in sum.iter_mut().zip(acceleration) {
                *sum += part;
            }
        }
    }
    sum.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Largest translational speed of a clamp, m/s.
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
    /// Sets the slip tolerance (m/s), if the model has one.
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

    fn weight(acceleration: f64) -> Vec<Load> {
        vec![Load {
            kind: LoadKind::Gravity {
                acceleration: [0.0, 0.0, -acceleration],
            },
            schedule: Vec::new(),
        }]
    }

    #[test]
    fn rods_of_a_millimetre_have_a_tenth_of_a_millimetre_per_second() {
        let of = |radius: f64| default_slip_tolerance(radius, &weight(10.0), &[]);
        assert!((of(1e-3) / 1e-4 - 1.0).abs() < 1e-12);
        // It scales with √h, in any unit of length.
        for radius in [1e-7, 3e-4, 5e-3, 2.0] {
            assert!((of(radius) / (1e-4 * (radius / 1e-3).sqrt()) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn without_gravity_thicker_rods_have_no_more() {
        for radius in [1e-3, 5e-3] {
            assert_eq!(default_slip_tolerance(radius, &[], &[]), 1e-4);
        }
        assert!((default_slip_tolerance(1e-5, &[], &[]) / 1e-5 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_lighter_or_slower_has_less() {
        let light = default_slip_tolerance(1e-3, &weight(1e-3), &[]);
        assert!((light / 1e-6 - 1.0).abs() < 1e-12, "{light}");
        let slow = Clamp {
            movement: Movement {
                translation: vec![(0.0, [0.0; 3]), (10.0, [3e-5, 4e-5, 0.0])],
                ..Movement::default()
            },
            ..at_the_start()
        };
        let slow = default_slip_tolerance(1e-3, &weight(9.81), &[slow]);
        assert!((slow / 5e-7 - 1.0).abs() < 1e-9, "{slow}");
    }

    fn at_the_start() -> Clamp {
        Clamp {
            rod: "rod".into(),
            at: crate::scenario::resolved::Place::Start,
            hold: crate::scenario::resolved::Hold::Both,
            offset: [0.0; 3],
            rotation: [0.0; 3],
            movement: Movement::default(),
        }
    }
}
