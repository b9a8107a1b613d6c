//! Selection of the pairs of poses that agree on the mount of a camera. The first mount has the
//! least median of squares among mounts from three pairs each (Rousseeuw, J. Am. Stat. Assoc.
//! 79:871, 1984). Least squares over the agreeing pairs are then repeated until the selection is
//! stable.

use super::VisionError;
use super::hand_eye_mount::mount;
use nalgebra::{Isometry3, Vector3};

/// Smallest number of pairs for which pairs are rejected.
const LEAST: usize = 5;
/// Maximum number of trial mounts of three pairs.
const MOST_TRIALS: usize = 600;
/// Largest deviation of a pair, relative to the root mean square of the agreeing pairs.
const FAR: f64 = 3.0;
/// Errors due to rounding, as a fraction of the distance of the target.
const ROUNDING: f64 = 1e-9;
/// Maximum number of rounds until the selection is stable.
const ROUNDS: usize = 20;
/// Number of groups of pairs that the jackknife for standard deviations omits in turn.
const PARTS: usize = 20;
/// Largest error of the middle pair, as a fraction of the distance of the target. Pairs with a
/// larger error are inconsistent.
const LARGEST_ERROR: f64 = 0.05;

/// Indices of the pairs that agree; all of them if there are too few to judge.
///
/// # Errors
/// The hand was rotated about one axis only, or fewer than half of the pairs agree.
pub fn agreeing(
    hands: &[Isometry3<f64>],
    targets: &[Isometry3<f64>],
) -> Result<Vec<usize>, VisionError> {
    let count = hands.len();
    let all: Vec<usize> = (0..count).collect();
    // An error here concerns all pairs.
    let first = mount(hands, targets)?;
    if count < LEAST {
        return Ok(all);
    }
    let lever = median(
        targets
            .iter()
            .map(|target| target.translation.vector.norm())
            .collect(),
    );
    let errors = |camera: &Isometry3<f64>| errors(camera, hands, targets, lever);
    let mut best = (median(errors(&first)), first);
    for triple in triples(count) {
        let chosen = |poses: &[Isometry3<f64>]| triple.map(|index| poses[index]);
        let Ok(camera) = mount(&chosen(hands), &chosen(targets)) else {
            continue;
        };
        let middle = median(errors(&camera));
        if middle < best.0 {
            best = (middle, camera);
        }
    }
    let (middle, mut camera) = best;
    if middle > LARGEST_ERROR * lever {
        return Err(disagreeing(count));
    }
    // The median of errors with six components is close to their root mean square.
    let mut limit = FAR * middle.max(ROUNDING * lever);
    let mut kept = Vec::new();
    for _ in 0..ROUNDS {
        let errors = errors(&camera);
        let near = |index: &usize| errors[*index] <= limit;
        let next: Vec<usize> = all.iter().copied().filter(near).collect();
        if 2 * next.len() <= count {
            return Err(disagreeing(count));
        }
        if next == kept {
            break;
        }
        kept = next;
        let chosen = |poses: &[Isometry3<f64>]| -> Vec<Isometry3<f64>> {
            kept.iter().map(|index| poses[*index]).collect()
        };
        camera = mount(&chosen(hands), &chosen(targets))?;
        let errors = self::errors(&camera, &chosen(hands), &chosen(targets), lever);
        let square: f64 = errors.iter().map(|error| error * error).sum();
        limit = FAR * (square / errors.len() as f64).sqrt().max(ROUNDING * lever);
    }
    Ok(kept)
}

fn disagreeing(count: usize) -> VisionError {
    VisionError::Undetermined {
        problem: "the mount of the camera",
        reason: format!(
            "fewer than half of the {count} pairs of poses agree; check that the rows of both \
             files match, and --fixed-camera"
        ),
    }
}

/// Deviation of the target pose of each pair from the median pose, m. Rotations count as the
/// displacement at a given distance, m.
fn errors(
    camera: &Isometry3<f64>,
    hands: &[Isometry3<f64>],
    targets: &[Isometry3<f64>],
    lever: f64,
) -> Vec<f64> {
    let pairs = hands.iter().zip(targets);
    let seen: Vec<Isometry3<f64>> = pairs.map(|(hand, target)| hand * camera * target).collect();
    let along = |axis: usize| {
        median(
            seen.iter()
                .map(|pose| pose.translation.vector[axis])
                .collect(),
        )
    };
    let middle = Vector3::new(along(0), along(1), along(2));
    let away = |pose: &Isometry3<f64>| (pose.translation.vector - middle).norm();
    // Use the median of rotations relative to the pose nearest to the median position, since the
    // rotation of that pose has an error, too.
    let nearest = seen.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    let Some(reference) = nearest.map(|pose| pose.rotation) else {
        return Vec::new();
    };
    let turns = seen
        .iter()
        .map(|pose| (reference.inverse() * pose.rotation).scaled_axis());
    let turns: Vec<Vector3<f64>> = turns.collect();
    let about = |axis: usize| median(turns.iter().map(|turn| turn[axis]).collect());
    let turned = Vector3::new(about(0), about(1), about(2));
    let pairs = seen.iter().zip(&turns);
    pairs
        .map(|(pose, turn)| libm::hypot(away(pose), lever * (turn - turned).norm()))
        .collect()
}

/// Triples of indices below `count`: all of them, or an evenly spread selection.
fn triples(count: usize) -> impl Iterator<Item = [usize; 3]> {
    let all = count * (count - 1) * (count - 2) / 6;
    let every = all.div_ceil(MOST_TRIALS).max(1);
    let firsts = (0..count).flat_map(move |i| (0..i).map(move |j| (i, j)));
    let all = firsts.flat_map(|(i, j)| (0..j).map(move |k| [i, j, k]));
    all.step_by(every)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Standard deviations of a mount: of the position along each axis, m, and of the rotation, rad.
/// They come from the jackknife, which omits one group of pairs at a time. `None` for too few
/// pairs.
pub fn deviations(hands: &[Isometry3<f64>], targets: &[Isometry3<f64>]) -> Option<([f64; 3], f64)> {
    let count = hands.len();
    if count < LEAST {
        return None;
    }
    let parts = count.min(PARTS);
    let without = (0..parts).map(|part| {
        let kept = |poses: &[Isometry3<f64>]| -> Vec<Isometry3<f64>> {
            let poses = poses.iter().enumerate();
            let kept = poses.filter(|(index, _)| index % parts != part);
            kept.map(|(_, pose)| *pose).collect()
        };
        mount(&kept(hands), &kept(targets)).ok()
    });
    let mounts: Vec<Isometry3<f64>> = without.collect::<Option<_>>()?;
    let number = parts as f64;
    let first = mounts[0].rotation;
    let mean = mounts
        .iter()
        .map(|pose| pose.translation.vector)
        .sum::<Vector3<f64>>()
        / number;
    let turns = mounts
        .iter()
        .map(|pose| (first.inverse() * pose.rotation).scaled_axis());
    let turns: Vec<Vector3<f64>> = turns.collect();
    let mean_turn = turns.iter().sum::<Vector3<f64>>() / number;
    let scale = (number - 1.0) / number;
    let mut squares = Vector3::zeros();
    for pose in &mounts {
        let away = pose.translation.vector - mean;
        squares += scale * away.component_mul(&away);
    }
    let turned: f64 = turns
        .iter()
        .map(|turn| (turn - mean_turn).norm_squared())
        .sum();
    Some((squares.map(f64::sqrt).into(), (scale * turned).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::super::trace_tests::Dice;
    use super::*;
    use nalgebra::UnitQuaternion;

    /// Mounts from pairs with noise are as far from the true one as they state, in the mean of many.
    #[test]
    fn mounts_are_as_far_off_as_their_deviations_state() {
        let mut dice = Dice(5);
        let mut vector = |size: f64| Vector3::from_fn(|_, _| 2.0 * size * (dice.roll() - 0.5));
        let truth = Isometry3::new(
            Vector3::new(0.03, -0.01, 0.08),
            Vector3::new(0.1, -0.2, 1.5),
        );
        let target = Isometry3::new(Vector3::new(0.5, 0.1, 0.02), Vector3::new(0.0, 0.1, 0.4));
        let trials = 40;
        let (mut moved, mut turned) = (0.0, 0.0);
        for _ in 0..trials {
            let hands: Vec<Isometry3<f64>> = (0..12)
                .map(|_| Isometry3::new(vector(0.2), vector(0.6)))
                .collect();
            let targets: Vec<Isometry3<f64>> = hands
                .iter()
                .map(|hand| {
                    let shake = Isometry3::new(vector(5e-4), vector(1e-3));
                    (hand * truth).inverse() * target * shake
                })
                .collect();
            let found = mount(&hands, &targets).expect("a mount");
            let (position, turn) = deviations(&hands, &targets).expect("deviations");
            let off = found.translation.vector - truth.translation.vector;
            for axis in 0..3 {
                moved += (off[axis] / position[axis]).powi(2) / 3.0;
            }
            let angle: UnitQuaternion<f64> = truth.rotation.inverse() * found.rotation;
            turned += (angle.angle() / turn).powi(2);
        }
        let means = [moved, turned].map(|sum| sum / f64::from(trials));
        for mean in means {
            assert!((0.7..1.4).contains(&mean), "{means:?}");
        }
    }
}
