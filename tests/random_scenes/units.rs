//! Scenes of the other families in other units: the same numbers.

use super::judged::{Case, Failed, Run, Verdict, run};
use super::random::Random;
use rodlab::experiment;
use rodlab::mechanics::Vector3;
use rodlab::scenario::Scales;

/// Difference allowed, of the largest value: rounding grows where rods touch.
const ALLOWED: f64 = 1e-8;

/// Judges a scene by itself in units of length, time and mass that keep nothing else the same.
pub fn judge(case: &Case, seed: u64) -> Verdict {
    let mut random = Random(!seed);
    let scales = Scales {
        length: random.decades(1e-6, 1e3),
        time: random.decades(1e-4, 1e3),
        mass: random.decades(1e-12, 1e6),
    };
    let text = experiment::rescaled(&case.text, &scales).expect("a TOML file");
    let scaled = Case {
        text,
        radius: scales.length * case.radius,
        step: scales.time * case.step,
        second: Vec::new(),
        forceless: Vec::new(),
    };
    let words = format!(
        "lengths × {:e}, times × {:e}, masses × {:e}",
        scales.length, scales.time, scales.mass
    );
    match (run(case, &[]), run(&scaled, &[])) {
        (Ok(one), Ok(other)) => {
            let apart = difference(&one, &other, &scales);
            if apart <= ALLOWED {
                Verdict::Right
            } else {
                Verdict::Wrong(format!("off by {apart:.3e} with {words}"))
            }
        }
        (Err(Failed::Without(message)), _) | (_, Err(Failed::Without(message))) => {
            Verdict::Wrong(message)
        }
        (Err(one), Err(_)) => Verdict::Refused(one.message()),
        (Ok(_), Err(refused)) => {
            Verdict::Wrong(format!("refused with {words}: {}", refused.message()))
        }
        (Err(refused), Ok(_)) => {
            Verdict::Wrong(format!("accepted with {words} only: {}", refused.message()))
        }
    }
}

fn difference(one: &Run, other: &Run, scales: &Scales) -> f64 {
    let relative = |a: &[Vector3], b: &[Vector3], factor: f64| {
        let largest = a.iter().map(Vector3::norm).fold(0.0, f64::max);
        let pairs = a.iter().zip(b);
        let apart = pairs
            .map(|(a, b)| (b / factor - a).norm())
            .fold(0.0, f64::max);
        if apart == 0.0 { 0.0 } else { apart / largest }
    };
    relative(&one.positions, &other.positions, scales.length).max(relative(
        &one.velocities,
        &other.velocities,
        scales.length / scales.time,
    ))
}
