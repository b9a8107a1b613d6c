use super::super::closest_points::ClosestPoints;
use super::super::contacts::ContactMotion;
use super::super::edge_contact::Sliding;
use super::super::friction::{FrictionLaw, slip};
use super::super::levers::{Lever, NONE};
use super::super::nearest_points::NearestPoints;
use super::super::patch::PatchBend;
use super::super::potential::normal_response;
use super::super::test_support::*;
use super::*;

const TIME_STEP: f64 = 1e-3;

/// Two touching edges that turn, in units of the radius of the first.
struct Case {
    radius: f64,
    radii: [f64; 2],
    previous: [Vector3; 4],
    free: [bool; 2],
    law: FrictionLaw,
    swing: Vector3,
    levers: Levers,
}

/// Edges of two rods.
fn of_two_rods(radii: [f64; 2]) -> Levers {
    let lever = |edge, ends, arm| Some(Lever { edge, ends, arm });
    Levers {
        nodes: [0, 1, 2, 3],
        places: [Some(0), Some(1), Some(2), Some(3)],
        edges: [lever(0, [0, 1], radii[0]), lever(2, [2, 3], radii[1])],
    }
}

impl Case {
    fn turning(&self, unknowns: &Row) -> Turning {
        let at = |place: usize| -> Vector3 { unknowns.fixed_rows::<3>(3 * place).into() };
        let turns = self.levers.edges.map(|lever| {
            lever.map_or_else(Turn::default, |lever| {
                let [from, to] = lever.ends;
                let number =
                    usize::from(lever == self.levers.edges[1].unwrap_or(lever) && lever.edge != 0);
                Turn {
                    span: [at(to) - at(from), self.previous[to] - self.previous[from]],
                    angle: unknowns[ANGLES + number],
                }
            })
        });
        Turning {
            levers: self.levers,
            turns,
            time_step: TIME_STEP,
        }
    }

    /// Motion of the contact, response and slip.
    fn at(&self, unknowns: &Row) -> (ContactMotion, NormalResponse, Sliding, Turning, Vector3) {
        let nodes: [Vector3; 4] =
            std::array::from_fn(|place| unknowns.fixed_rows::<3>(3 * place).into());
        let closest = ClosestPoints::of(&nodes);
        assert_eq!(closest.free, self.free);
        let gap = closest.distance() - self.radii[0] - self.radii[1];
        let response = normal_response(gap, self.radius, 0.5 * self.radius, 2.5);
        let motion = NearestPoints::Edges(closest).motion(&nodes, true, &PatchBend::none());
        let sliding = Sliding {
            law: self.law,
            velocities: std::array::from_fn(|m| (nodes[m] - self.previous[m]) / TIME_STEP),
            swing: self.swing,
            time_step: TIME_STEP,
        };
        let turning = self.turning(unknowns);
        let velocity = sliding.contact_velocity(&motion.weights, &motion.normal)
            + turning.velocity(&motion.normal);
        let slip = slip(&motion.normal, &velocity);
        (motion, response, sliding, turning, slip)
    }

    fn force(&self, unknowns: &Row) -> Row {
        let (motion, response, sliding, turning, slip) = self.at(unknowns);
        let traction = sliding.law.traction_of_slip(&slip);
        turning.force(&motion.weights, &motion.normal, response.force, &traction)
    }
}

/// Contacts of every class, over decades of size, from creeping to fast sliding.
fn cases() -> Vec<(Case, Row)> {
    let mut random = Random::new(17);
    let mut cases = Vec::new();
    for radius in [1e-4, 1e-2] {
        for (index, (nodes, closest)) in CLASSES
            .iter()
            .flat_map(|&free| edge_pairs_of_class(free, radius))
            .enumerate()
        {
            let slip_tolerance = 0.1 * radius;
            let speed = slip_tolerance * [0.1, 1.0, 10.0][index % 3];
            let radii = [radius, 0.7 * radius];
            let previous = nodes.map(|node| node - random.vector() * speed * TIME_STEP);
            let mut unknowns = Row::zeros();
            for (place, node) in nodes.iter().enumerate() {
                unknowns.fixed_rows_mut::<3>(3 * place).copy_from(node);
            }
            for angle in 0..2 {
                unknowns[ANGLES + angle] = random.symmetric() * speed / radius * TIME_STEP;
            }
            let case = Case {
                radius,
                radii,
                previous,
                free: closest.free,
                law: FrictionLaw {
                    coefficient: 0.3,
                    slip_tolerance,
                    grain: None,
                },
                swing: random.vector() * speed,
                levers: of_two_rods(radii),
            };
            cases.push((case, unknowns));
        }
    }
    cases
}

#[test]
fn the_jacobian_agrees_with_differences() {
    for (case, unknowns) in cases() {
        let (motion, response, sliding, turning, slip) = case.at(&unknowns);
        let found = turning.jacobian(&motion, &response, (&sliding, slip), true);
        // Columns of angles have units of lengths, and rows of moments units of forces.
        let scale = |k: usize| if k < ANGLES { 1.0 } else { 1.0 / case.radius };
        let (mut error, mut largest) = (0.0_f64, 0.0_f64);
        for column in 0..UNKNOWNS {
            let step = 1e-8 * case.radius * scale(column);
            let mut offset = Row::zeros();
            offset[column] = step;
            let change = case.force(&(unknowns + offset)) - case.force(&(unknowns - offset));
            for row in 0..UNKNOWNS {
                let unit = scale(row) * scale(column);
                let expected = change[row] / (2.0 * step) * unit;
                let own = found.jacobian[(row, column)] * unit;
                error = error.max((own - expected).abs());
                largest = largest.max(expected.abs());
            }
        }
        assert!(
            error < 2e-5 * largest,
            "{error:e} of {largest:e} {:?}",
            case.free
        );
    }
}

#[test]
fn moments_balance_about_the_contact_points() {
    for (case, unknowns) in cases() {
        let (motion, response, sliding, turning, slip) = case.at(&unknowns);
        let traction = sliding.law.traction_of_slip(&slip);
        let force = turning.force(&motion.weights, &motion.normal, response.force, &traction);
        let at = |k: usize, all: &Row| -> Vector3 { all.fixed_rows::<3>(3 * k).into() };
        let mut torque = Vector3::zeros();
        let mut sum = Vector3::zeros();
        for place in 0..4 {
            torque += at(place, &unknowns).cross(&at(place, &force));
            sum += at(place, &force);
        }
        for (k, turn) in turning.turns.iter().enumerate() {
            torque += turn.span[0].normalize() * force[ANGLES + k];
        }
        // Moment left by the gap between the contact points: two arms end at points that are a gap
        // apart.
        let friction = traction * response.force;
        let gap = motion.normal * (case.at_gap(&unknowns));
        torque -= gap.cross(&friction);
        let unit = response.force * case.radius;
        assert!(sum.norm() < 1e-13 * response.force);
        assert!(torque.norm() < 1e-12 * unit, "{:e}", torque.norm() / unit);
    }
}

impl Case {
    /// Gap of the surfaces, m.
    fn at_gap(&self, unknowns: &Row) -> f64 {
        let nodes: [Vector3; 4] =
            std::array::from_fn(|place| unknowns.fixed_rows::<3>(3 * place).into());
        ClosestPoints::of(&nodes).distance() - self.radii[0] - self.radii[1]
    }
}

#[test]
fn friction_takes_the_power_of_the_slip() {
    for (case, unknowns) in cases() {
        let (motion, response, sliding, turning, slip) = case.at(&unknowns);
        let traction = sliding.law.traction_of_slip(&slip);
        let friction = traction * response.force;
        let none = Vector3::zeros();
        let all = turning.force(&motion.weights, &motion.normal, response.force, &traction)
            - turning.force(&motion.weights, &motion.normal, response.force, &none);
        // The first-order rate of change of the unknowns: tangents that turn by a step are those
        // at its end.
        let mut power = friction.dot(&sliding.velocity_of_swing(&motion.normal));
        for place in 0..4 {
            let own: Vector3 = all.fixed_rows::<3>(3 * place).into();
            power += own.dot(&sliding.velocities[place]);
        }
        for (k, turn) in turning.turns.iter().enumerate() {
            power += all[ANGLES + k] * turn.angle / TIME_STEP;
        }
        let expected = friction.dot(&slip);
        assert!(expected <= 0.0);
        let scale = friction.norm() * (slip.norm() + case.law.slip_tolerance);
        assert!(
            (power - expected).abs() < 1e-3 * scale,
            "{power:e} {expected:e}"
        );
    }
}

#[test]
fn a_motion_as_one_rigid_body_slides_no_more_than_the_gap() {
    let mut random = Random::new(23);
    for (mut case, unknowns) in cases() {
        case.swing = Vector3::zeros();
        let rate = random.vector();
        let turned = |node: Vector3| node - rate.cross(&node) * TIME_STEP;
        case.previous =
            std::array::from_fn(|place| turned(unknowns.fixed_rows::<3>(3 * place).into()));
        let mut unknowns = unknowns;
        for (k, ends) in [[0, 1], [2, 3]].into_iter().enumerate() {
            let [from, to]: [Vector3; 2] = ends.map(|end| unknowns.fixed_rows::<3>(3 * end).into());
            unknowns[ANGLES + k] = rate.dot(&(to - from).normalize()) * TIME_STEP;
        }
        let (_, _, sliding, _, slip) = case.at(&unknowns);
        let of_gap = rate.norm() * case.at_gap(&unknowns).abs();
        let of_step = rate.norm_squared() * TIME_STEP * case.radius;
        assert!(
            slip.norm() < of_gap + 10.0 * of_step,
            "{:e}",
            slip.norm() / case.radius
        );
        assert!(sliding.time_step == TIME_STEP);
    }
}

#[test]
fn a_node_over_a_plane_rolls_without_slip() {
    let (radius, spin) = (2e-3, 5.0);
    let levers = Levers {
        nodes: [1, 0, 2, NONE],
        places: [Some(0), None, None, None],
        edges: [
            Some(Lever {
                edge: 0,
                ends: [1, 0],
                arm: 0.5 * radius,
            }),
            Some(Lever {
                edge: 1,
                ends: [0, 2],
                arm: 0.5 * radius,
            }),
        ],
    };
    let turn = Turn {
        span: [Vector3::x() * 0.01; 2],
        angle: spin * TIME_STEP,
    };
    let turning = Turning {
        levers,
        turns: [turn; 2],
        time_step: TIME_STEP,
    };
    // A spin about x > 0 moves the lowest point along +y: the rod rolls towards −y.
    let velocity = Vector3::y() * (-spin * radius);
    let slip = velocity + turning.velocity(&Vector3::z());
    assert!(slip.norm() < 1e-15, "{slip}");
    let moments = turning.moments(&Vector3::z(), &Vector3::y());
    assert!((moments[ANGLES] - 0.5 * radius).abs() < 1e-18);
    assert!((moments[ANGLES + 1] - 0.5 * radius).abs() < 1e-18);
}
