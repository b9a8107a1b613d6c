//! The least clearance along a motion, including the times between its points.
//!
//! Between two times no point of an arm moves farther than `m`: the rotation of each joint times
//! the reach of the links that it carries, summed over the joints. With distances `a` and `b` at
//! the two times, the distance in between is at least `(a + b − m)/2`. Where that does not exclude
//! contact, the interval is halved.

use super::resolved::Cell;
use rodlab_robot::{Interpolant, Member, Part};

/// Movement of a point between two times, m, below which the interval is not divided further.
const FINEST: f64 = 5e-4;

impl Cell {
    /// Least distance of the arms to each other, to themselves and to their surroundings during a
    /// motion, m. Arms without a motion rest at home.
    ///
    /// # Errors
    /// A contact; the message names the bodies and the time.
    pub(super) fn least_clearance(&self, parts: &[Part]) -> Result<f64, String> {
        let surroundings = self.surroundings();
        let moving: Vec<Option<Interpolant>> = self
            .arms
            .iter()
            .map(|arm| {
                let part = parts.iter().find(|part| part.name == arm.name);
                part.map(|part| part.trajectory.interpolant())
            })
            .collect();
        let homes = surroundings.homes();
        let reaches: Vec<Vec<f64>> = surroundings.members().iter().map(Member::reaches).collect();
        let postures = |time: f64| -> Vec<Vec<f64>> {
            let arms = moving.iter().zip(&homes);
            arms.map(|(path, home)| match path {
                Some(path) => path.at(time),
                None => home.clone(),
            })
            .collect()
        };
        let look = |time: f64| -> Result<Look, String> {
            let postures = postures(time);
            let mut distance = rodlab_robot::FAR;
            if let Some(approach) = surroundings.nearest(&postures, None) {
                distance = approach.distance;
                if distance <= 0.0 {
                    let [one, other] = &approach.between;
                    return Err(format!(
                        "{one} would touch {other} {time:.3} s after the start"
                    ));
                }
            }
            Ok(Look {
                time,
                postures,
                distance,
            })
        };
        let mut times: Vec<f64> = parts
            .iter()
            .flat_map(|part| part.trajectory.times.iter().copied())
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let Some((first, rest)) = times.split_first() else {
            return Ok(rodlab_robot::FAR);
        };
        let mut before = look(*first)?;
        let mut least = before.distance;
        for time in rest {
            // Times that are still to be checked; the next one is last.
            let mut ahead = vec![*time];
            while let Some(next) = ahead.pop() {
                let after = look(next)?;
                let moved = movement(&before, &after, &reaches, &moving);
                if before.distance + after.distance <= moved && moved > FINEST {
                    ahead.push(next);
                    ahead.push(0.5 * (before.time + next));
                    continue;
                }
                least = least.min(after.distance);
                before = after;
            }
        }
        Ok(least)
    }
}

/// Postures of the arms and their clearance at one time.
struct Look {
    time: f64,
    postures: Vec<Vec<f64>>,
    distance: f64,
}

/// Greatest movement of a point of an arm against anything else between two times, m.
fn movement(
    before: &Look,
    after: &Look,
    reaches: &[Vec<f64>],
    moving: &[Option<Interpolant>],
) -> f64 {
    let middle = 0.5 * (before.time + after.time);
    let arms = moving.iter().zip(reaches).enumerate();
    arms.filter_map(|(arm, (path, reaches))| {
        let middle = path.as_ref()?.at(middle);
        let joints = reaches.iter().enumerate().map(|(joint, reach)| {
            let [a, b, c] =
                [&before.postures[arm], &middle, &after.postures[arm]].map(|q| q[joint]);
            // A joint may turn back between two points.
            ((b - a).abs() + (c - b).abs()) * reach
        });
        Some(joints.sum::<f64>())
    })
    .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_that_turn_back_between_two_times_have_moved() {
        let points = [vec![0.0, 0.0], vec![0.3, -0.1], vec![0.0, -0.2]];
        let way = Interpolant::new(&[0.0, 1.0, 2.0], &points);
        let look = |time: f64, posture: &[f64]| Look {
            time,
            postures: vec![posture.to_vec(), vec![0.0]],
            distance: 0.1,
        };
        let moved = movement(
            &look(0.0, &points[0]),
            &look(2.0, &points[2]),
            &[vec![0.8, 0.5], vec![3.0]],
            &[Some(way), None],
        );
        // There and back by 0.3 rad at 0.8 m, and by 0.2 rad in all at 0.5 m.
        assert!((moved - (0.6 * 0.8 + 0.2 * 0.5)).abs() < 1e-12, "{moved}");
    }
}
