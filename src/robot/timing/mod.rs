//! Converts a joint path to a trajectory by choosing the speed of the hand along the path.
//!
//! The path is a natural cubic spline q(w) of the arc length w. The speed along it is limited by
//! the velocities of the joints, by the speed of the hand, and by the accelerations and jerks that
//! the curvature of q requires. A forward and a backward sweep limit the acceleration along the
//! path (Bobrow et al. 1985). The motion w(t) is then smoothed in time by two moving averages,
//! which bounds its jerk, and sampled at 1 kHz.
//!
//! The limits are checked on the samples: velocity, acceleration and jerk of every joint as
//! differences of neighbouring samples, 1 ms apart. Where a value is too large, the bound on the
//! speed is lowered. The procedure repeats until every limit is satisfied. The result is close to
//! the fastest motion.

mod profile;
mod spline;

use super::chain::Limits;
use profile::SpeedProfile;
use spline::Spline;

/// Time between samples, s.
pub const SAMPLE: f64 = 1e-3;
/// Largest number of rounds in which the speed is lowered.
const ROUNDS: usize = 60;
/// Fraction of each limit that is used; the rest is for the round-off of the robot's
/// interpolation.
const PART_OF_LIMIT: f64 = 0.98;

/// Reason why no motion within the limits was found.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum TimingError {
    /// A joint has no limit of its acceleration or its jerk.
    #[error("joint {joint} has no limit of {what}: a motion from rest to rest needs one")]
    NoLimit {
        /// Index of the joint.
        joint: usize,
        /// The missing limit.
        what: &'static str,
    },
    /// The speeds could not be lowered enough for the limits.
    #[error("no motion within the limits was found; the joint path is not smooth enough")]
    NotSmooth,
}

/// Samples of a joint motion.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Joint positions every [`SAMPLE`], from rest to rest.
    pub samples: Vec<Vec<f64>>,
    /// Arc length along the path at each sample, m.
    pub way: Vec<f64>,
}

/// Largest velocity, acceleration and jerk of samples as fractions of the limits, each with the
/// joint and the sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Utilisation {
    /// Of velocity.
    pub velocity: f64,
    /// Fraction for the acceleration.
    pub acceleration: f64,
    /// Of jerk.
    pub jerk: f64,
}

/// Finds a fast motion along joint positions at the given arc lengths, m, from rest to rest, in
/// which the speed of the hand is at most `speed`, m/s.
///
/// # Errors
/// A joint lacks limits, or the path has kinks.
pub fn parametrise(
    joints: &[Vec<f64>],
    way: &[f64],
    limits: &[Limits],
    speed: f64,
) -> Result<Motion, TimingError> {
    for (joint, limits) in limits.iter().enumerate() {
        let bounds = [
            ("velocity", limits.velocity),
            ("acceleration", limits.acceleration),
            ("jerk", limits.jerk),
        ];
        if let Some((what, _)) = bounds.into_iter().find(|(_, bound)| !bound.is_finite()) {
            return Err(TimingError::NoLimit { joint, what });
        }
    }
    if joints.len() < 2 {
        return Ok(Motion {
            samples: joints.to_vec(),
            way: way.to_vec(),
        });
    }
    let spline = Spline::natural(way, joints);
    let mut profile = SpeedProfile::new(&spline, limits, speed);
    for _ in 0..ROUNDS {
        let way = profile.motion();
        let samples: Vec<Vec<f64>> = way.iter().map(|way| spline.at(*way)).collect();
        let excess = excesses(&samples, &way, limits, speed);
        if excess.iter().all(|excess| *excess <= PART_OF_LIMIT) {
            return Ok(Motion { samples, way });
        }
        profile.lower(&way, &excess, PART_OF_LIMIT);
    }
    Err(TimingError::NotSmooth)
}

/// Factor by which each sample is too fast: the greatest of the used fraction of the velocity
/// limit, the square root of that of the acceleration limit and the cube root of that of the jerk
/// limit. All of these are proportional to the speed.
fn excesses(samples: &[Vec<f64>], way: &[f64], limits: &[Limits], speed: f64) -> Vec<f64> {
    let mut excess = vec![0.0_f64; samples.len()];
    for (k, pair) in way.windows(2).enumerate() {
        excess[k] = (pair[1] - pair[0]) / SAMPLE / speed;
    }
    for (joint, limits) in limits.iter().enumerate() {
        for (k, [velocity, acceleration, jerk]) in differences(samples, joint).enumerate() {
            let most = (velocity.abs() / limits.velocity)
                .max((acceleration.abs() / limits.acceleration).sqrt())
                .max(libm::cbrt(jerk.abs() / limits.jerk));
            excess[k] = excess[k].max(most);
        }
    }
    excess
}

/// Velocity, acceleration and jerk of a joint at each sample from differences, with rest before
/// the first and after the last.
fn differences(samples: &[Vec<f64>], joint: usize) -> impl Iterator<Item = [f64; 3]> + '_ {
    let last = samples.len() - 1;
    let at = move |k: isize| samples[k.clamp(0, last as isize) as usize][joint];
    (0..samples.len() as isize).map(move |k| {
        let [a, b, c, d] = [at(k - 1), at(k), at(k + 1), at(k + 2)];
        [
            (c - b) / SAMPLE,
            (c - 2.0 * b + a) / SAMPLE.powi(2),
            (d - 3.0 * c + 3.0 * b - a) / SAMPLE.powi(3),
        ]
    })
}

/// Fraction of the limits that samples use, with rest before and after them.
pub fn utilisation(samples: &[Vec<f64>], limits: &[Limits]) -> Utilisation {
    let mut used = Utilisation::default();
    for (joint, limits) in limits.iter().enumerate() {
        for [velocity, acceleration, jerk] in differences(samples, joint) {
            used.velocity = used.velocity.max(velocity.abs() / limits.velocity);
            used.acceleration = used
                .acceleration
                .max(acceleration.abs() / limits.acceleration);
            used.jerk = used.jerk.max(jerk.abs() / limits.jerk);
        }
    }
    used
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(velocity: f64, acceleration: f64, jerk: f64) -> Limits {
        Limits {
            lower: -10.0,
            upper: 10.0,
            velocity,
            acceleration,
            jerk,
        }
    }

    fn line(length: f64, ratio: f64) -> (Vec<Vec<f64>>, Vec<f64>) {
        let way: Vec<f64> = (0..=100).map(|k| length * f64::from(k) / 100.0).collect();
        (
            way.iter()
                .map(|w| vec![ratio * w, -0.5 * ratio * w])
                .collect(),
            way,
        )
    }

    /// At the part of the speed that is used, accelerations are its square and jerks its cube of their limits.
    fn assert_within(motion: &Motion, bounds: &[Limits]) {
        let used = utilisation(&motion.samples, bounds);
        let most = [1, 2, 3].map(|power| 0.98_f64.powi(power) * (1.0 + 1e-9));
        assert!(
            used.velocity <= most[0] && used.acceleration <= most[1] && used.jerk <= most[2],
            "{used:?}"
        );
    }

    #[test]
    fn a_straight_motion_is_nearly_as_fast_as_jerk_limits_allow() {
        let (joints, way) = line(2.0, 1.0);
        let bounds = [limits(1.0, 4.0, 40.0), limits(9.0, 99.0, 999.0)];
        let motion = parametrise(&joints, &way, &bounds, 9.0).unwrap();
        assert_within(&motion, &bounds);
        // Duration of the fastest motion: l/v + v/a + a/j.
        let fastest = 2.0 / 1.0 + 1.0 / 4.0 + 4.0 / 40.0;
        let time = motion.samples.len() as f64 * SAMPLE;
        assert!(time > fastest && time < 1.25 * fastest, "{time} {fastest}");
        assert_eq!(motion.samples[0], joints[0]);
        let end = &motion.samples[motion.samples.len() - 1];
        assert!((end[0] - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_speed_of_the_hand_is_held() {
        let (joints, way) = line(0.5, 1.0);
        let bounds = [limits(5.0, 20.0, 400.0); 2];
        let motion = parametrise(&joints, &way, &bounds, 0.1).unwrap();
        let fastest = motion
            .way
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(0.0, f64::max);
        assert!(
            fastest / SAMPLE <= 0.1 && fastest / SAMPLE > 0.09,
            "{}",
            fastest / SAMPLE
        );
    }

    #[test]
    fn limits_hold_around_a_corner() {
        // A right-angled path: one joint stops, then the other starts.
        let way: Vec<f64> = (0..=400).map(|k| 1e-3 * f64::from(k)).collect();
        let joints: Vec<Vec<f64>> = way
            .iter()
            .map(|w| vec![3.0 * w.min(0.2), 3.0 * (w - 0.2).max(0.0)])
            .collect();
        let bounds = [limits(1.5, 5.0, 50.0); 2];
        let motion = parametrise(&joints, &way, &bounds, 1.0).unwrap();
        assert_within(&motion, &bounds);
        assert!(motion.samples.len() < 6000, "{}", motion.samples.len());
        // Compute the differences independently, since `utilisation` was used to generate the
        // motion.
        for joint in 0..2 {
            let jerk = motion.samples.windows(4).map(|four| {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| four[k][joint]);
                ((d - c) - 2.0 * (c - b) + (b - a)).abs() / SAMPLE.powi(3)
            });
            let strongest = jerk.fold(0.0, f64::max);
            assert!(strongest > 25.0 && strongest <= 50.0, "{strongest}");
        }
    }

    #[test]
    fn a_joint_without_a_limit_of_jerk_is_named() {
        let (joints, way) = line(1.0, 1.0);
        let bounds = [limits(1.0, 1.0, 1.0), limits(1.0, 1.0, f64::INFINITY)];
        let error = parametrise(&joints, &way, &bounds, 1.0).unwrap_err();
        assert_eq!(
            error,
            TimingError::NoLimit {
                joint: 1,
                what: "jerk"
            }
        );
    }
}
