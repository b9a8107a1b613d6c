//! Scenes of the other families in other units, which must give the same numbers.
//!
//! The units are powers of four of the original ones. Rounding is then identical in both runs,
//! including square roots, and a difference shows a number with a unit in the code. With other
//! factors, rounding would differ. Such differences can grow to any size if rods are stiff or
//! touch, or if a velocity has decayed to rounding errors. Only if forces and moments occur in one
//! equation, as in a rigid joint, do the pivots of its elimination, and thus rounding, depend on
//! the unit of length.

use super::judged::{Case, Failed, Run, Verdict, run};
use super::random::Random;
use rodlab::experiment;
use rodlab::mechanics::Vector3;
use rodlab::scenario::Scales;

/// Allowed difference, relative to the largest value.
const ALLOWED: f64 = 1e-9;
/// Allowed difference of a velocity, in last digits of positions per step; a decayed velocity
/// consists only of these.
const ROUNDINGS: f64 = 1e3;

/// A power of four.
fn factor(random: &mut Random, exponents: [i32; 2]) -> f64 {
    let [least, most] = exponents.map(f64::from);
    4f64.powi(random.between(least, most).round() as i32)
}

/// Judges a scene by the same scene in other units of length, time and mass.
pub fn judge(case: &Case, seed: u64) -> Verdict {
    let mut random = Random(!seed);
    let scales = Scales {
        length: factor(&mut random, [-10, 5]),
        time: factor(&mut random, [-7, 5]),
        mass: factor(&mut random, [-20, 10]),
    };
    let text = experiment::rescaled(&case.text, &scales).expect("a TOML file");
    let scaled = Case {
        text,
        radius: scales.length * case.radius,
        step: scales.time * case.step,
        second: Vec::new(),
        resolved_by: None,
        forceless: Vec::new(),
    };
    let words = format!(
        "lengths × {:e}, times × {:e}, masses × {:e}",
        scales.length, scales.time, scales.mass
    );
    match (run(case, &[]), run(&scaled, &[])) {
        (Ok(one), Ok(other)) => {
            let apart = difference(&one, &other, &scales, case.step);
            if apart <= ALLOWED {
                Verdict::Right
            } else {
                Verdict::Wrong(format!("off by {apart:.3e} with {words}"))
            }
        }
        (Err(Failed::Without(message)), _) | (_, Err(Failed::Without(message))) => {
            Verdict::Wrong(message)
        }
        (Err(one), Err(_)) => Verdict::Refused(one.message().into()),
        (Ok(_), Err(refused)) => {
            Verdict::Wrong(format!("refused with {words}: {}", refused.message()))
        }
        (Err(refused), Ok(_)) => {
            Verdict::Wrong(format!("accepted with {words} only: {}", refused.message()))
        }
    }
}

fn difference(one: &Run, other: &Run, scales: &Scales, step: f64) -> f64 {
    let largest = |a: &[Vector3]| a.iter().map(Vector3::norm).fold(0.0, f64::max);
    let rounding = ROUNDINGS * f64::EPSILON * largest(&one.positions) / step;
    let relative = |a: &[Vector3], b: &[Vector3], factor: f64, rounding: f64| {
        let pairs = a.iter().zip(b);
        let apart = pairs
            .map(|(a, b)| (b / factor - a).norm())
            .fold(0.0, f64::max);
        if apart <= rounding {
            0.0
        } else {
            apart / largest(a)
        }
    };
    let positions = relative(&one.positions, &other.positions, scales.length, 0.0);
    let speed = scales.length / scales.time;
    positions.max(relative(
        &one.velocities,
        &other.velocities,
        speed,
        rounding,
    ))
}
