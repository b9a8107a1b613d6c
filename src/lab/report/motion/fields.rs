//! Fields by which rods can be coloured: curvature, twist, contact force, speed.

use nalgebra::Vector3;
use rodlab_files::figure::{Field, MovieRod};
use rodlab_files::results::{NodeForces, NodePositions};

/// The fields of a run. Only `node_forces.csv` has twist and contact force; without it the speed
/// is computed from the positions of consecutive outputs.
pub(super) fn fields(
    rods: &[MovieRod],
    outputs: &[NodePositions],
    forces: Option<&[NodeForces]>,
) -> Vec<Field> {
    let positions = outputs.iter().map(|output| &output.positions);
    let curvature = positions.map(|positions| curvatures(rods, positions));
    let mut fields = vec![field("Curvature", "1/m", false, curvature.collect())];
    match forces {
        Some(forces) => {
            let sizes = |vectors: &[Vector3<f64>]| vectors.iter().map(Vector3::norm).collect();
            let of = |values: &dyn Fn(&NodeForces) -> Vec<f64>| forces.iter().map(values).collect();
            let twist = of(&|output| output.twist_rates.clone());
            fields.push(field("Twist", "rad/m", true, twist));
            let contact = of(&|output| sizes(&output.contact_forces));
            fields.push(field("Contact force", "N", false, contact));
            let speed = of(&|output| sizes(&output.velocities));
            fields.push(field("Speed", "m/s", false, speed));
        }
        None => fields.push(field("Mean speed", "m/s", false, mean_speeds(outputs))),
    }
    fields
}

fn field(name: &str, unit: &str, signed: bool, values: Vec<Vec<f64>>) -> Field {
    Field {
        name: name.into(),
        unit: unit.into(),
        signed,
        values,
    }
}

/// Curvature at each node, 1/m: κ = 2 tan(φ/2)/l̄ with the angle φ between the edges that meet at
/// the node and their mean length l̄ (Bergou et al. 2008). The ends of open rods have the
/// curvature of their neighbours.
fn curvatures(rods: &[MovieRod], positions: &[Vector3<f64>]) -> Vec<f64> {
    let mut curvatures = Vec::with_capacity(positions.len());
    let mut rest = positions;
    for rod in rods {
        let (nodes, after) = rest.split_at(rod.nodes);
        rest = after;
        let count = rod.nodes;
        let at = |k: usize| {
            let (before, after) = if rod.closed {
                ((k + count - 1) % count, (k + 1) % count)
            } else {
                (k - 1, k + 1)
            };
            let (arriving, leaving) = (nodes[k] - nodes[before], nodes[after] - nodes[k]);
            let lengths = arriving.norm() * leaving.norm();
            let binormal =
                2.0 * arriving.cross(&leaving).norm() / (lengths + arriving.dot(&leaving));
            2.0 * binormal / (arriving.norm() + leaving.norm())
        };
        if rod.closed {
            curvatures.extend((0..count).map(at));
        } else if count < 3 {
            curvatures.extend(std::iter::repeat_n(0.0, count));
        } else {
            curvatures.extend((0..count).map(|k| at(k.clamp(1, count - 2))));
        }
    }
    curvatures
}

/// Mean speed of each node since the previous output, m/s; at the first output until the next.
fn mean_speeds(outputs: &[NodePositions]) -> Vec<Vec<f64>> {
    let between = |before: &NodePositions, after: &NodePositions| -> Vec<f64> {
        let span = after.time - before.time;
        let pairs = before.positions.iter().zip(&after.positions);
        pairs
            .map(|(a, b)| {
                if span > 0.0 {
                    (b - a).norm() / span
                } else {
                    0.0
                }
            })
            .collect()
    };
    let mut speeds: Vec<Vec<f64>> = outputs
        .windows(2)
        .map(|pair| between(&pair[0], &pair[1]))
        .collect();
    let first = speeds.first().cloned();
    speeds.insert(
        0,
        first.unwrap_or_else(|| vec![0.0; outputs[0].positions.len()]),
    );
    speeds
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(nodes: usize, radius: f64, part: f64) -> Vec<Vector3<f64>> {
        (0..nodes)
            .map(|k| part * std::f64::consts::TAU * k as f64 / nodes as f64)
            .map(|angle| Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0))
            .collect()
    }

    fn rod(nodes: usize, closed: bool) -> MovieRod {
        MovieRod {
            name: "rod".into(),
            nodes,
            closed,
            radius: 1e-3,
            radii: Vec::new(),
            held: false,
            straight: false,
            strip: None,
        }
    }

    #[test]
    fn circles_are_curved_by_their_radius_at_second_order() {
        for (closed, part) in [(true, 1.0), (false, 0.4)] {
            let error = |nodes: usize| {
                let values = curvatures(&[rod(nodes, closed)], &circle(nodes, 0.5, part));
                let errors = values.iter().map(|value| (value - 2.0).abs());
                errors.fold(0.0, f64::max)
            };
            let (coarse, fine) = (error(20), error(40));
            assert!(
                fine < 0.05 && (coarse / fine - 4.0).abs() < 0.1,
                "{coarse} {fine}"
            );
        }
    }

    #[test]
    fn mean_speed_is_the_distance_over_the_time() {
        let output = |time: f64| NodePositions {
            time,
            positions: vec![Vector3::new(3.0 * time, 0.0, 4.0 * time), Vector3::zeros()],
        };
        for speeds in mean_speeds(&[output(0.0), output(0.5), output(2.0)]) {
            assert!((speeds[0] - 5.0).abs() < 1e-12 && speeds[1] == 0.0);
        }
        assert_eq!(mean_speeds(&[output(1.0)]), [[0.0, 0.0]]);
    }
}
