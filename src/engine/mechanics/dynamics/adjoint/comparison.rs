//! Comparison of derivatives with respect to fields with extrapolated differences of whole runs in
//! which one value of a rod differs, for tests.

use super::{Gradient, LARGEST_TRACE, Recording, Trace};
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::state::State;
use crate::mechanics::dynamics::{IntegrationParameters, Scheme, Simulation};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::Scene;
use crate::mechanics::system::Assembly;
use crate::mechanics::test_support::{advance_to, fixed_steps};

const STEPS: usize = 30;
const STEP: f64 = 2e-3;
pub(super) const SCHEMES: [Scheme; 2] = [Scheme::ImplicitEuler, Scheme::BackwardDifferences];

/// Kind of run: steps, after an equilibrium or not, or the equilibrium alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    pub(super) settles: bool,
    pub(super) steps: usize,
    pub(super) scheme: Scheme,
}

impl Course {
    pub(super) fn parameters(&self) -> IntegrationParameters {
        IntegrationParameters {
            force_tolerance: 1e-13,
            displacement_tolerance: 1e-11,
            ..fixed_steps(self.scheme, STEP)
        }
    }

    pub(super) fn end(&self) -> f64 {
        STEP * self.steps as f64
    }

    /// The results of a run with one value changed by an amount.
    pub(super) fn run(&self, scene: &Scene, change: Change, node: usize, amount: f64) -> Vec<f64> {
        let mut simulation = Simulation::new(scene, &self.parameters()).unwrap();
        change(&mut simulation, node, amount);
        let rods = &simulation.system.assembly.rods;
        simulation.system.geometry.take_natural_strains(rods);
        if self.settles {
            simulation.find_equilibrium().unwrap();
        }
        advance_to(&mut simulation, self.end());
        results(&simulation)
    }

    pub(super) fn gradients(&self, scene: &Scene, largest: usize) -> Vec<Gradient> {
        let mut recording = Recording::new(scene, &self.parameters()).unwrap();
        recording.trace = Trace::new(&recording.simulation, largest);
        if self.settles {
            recording.find_equilibrium().unwrap();
        }
        while recording.simulation().time() < self.end() {
            recording.advance(self.end()).unwrap();
        }
        recording.gradients(&results).unwrap()
    }
}

/// Position and velocity of two nodes, a director, and the kinetic energy of bodies with inertia.
pub(super) fn results(simulation: &Simulation) -> Vec<f64> {
    let last = simulation.positions().len() - 1;
    let vectors = [
        simulation.positions()[last.min(10)] * 10.0,
        simulation.positions()[6] * 10.0,
        simulation.velocities()[5],
        simulation.material_directors()[5],
    ];
    let numbers = vectors
        .iter()
        .flat_map(|vector| [vector.x, vector.y, vector.z]);
    let frames = &simulation.system.assembly.joints.frames;
    let rotates = frames.iter().any(|frame| frame.body.is_some());
    let kinetic = rotates.then(|| 100.0 * simulation.energies().kinetic);
    numbers.chain(kinetic).collect()
}

/// Adds an amount to a value of a node.
pub(super) type Change = fn(&mut Simulation, usize, f64);

/// Indices of the vertices at a node.
fn vertices_at(assembly: &Assembly, node: usize) -> Vec<usize> {
    let vertices = assembly.rods.vertices.iter().enumerate();
    let at = vertices.filter(|(_, vertex)| assembly.node_of(vertex) == node);
    at.map(|(index, _)| index).collect()
}

/// Adds to the natural strains of the vertices at a node: to κ about m₁, κ about m₂, or the twist.
fn strain(simulation: &mut Simulation, node: usize, [first, second, twist]: [f64; 3]) {
    let assembly = &mut simulation.system.assembly;
    let edges = assembly.rods.edges.clone();
    let length = |start: usize| {
        let edge = edges.iter().find(|edge| edge.start == start);
        edge.map_or(0.0, |edge| edge.natural_length)
    };
    for index in vertices_at(assembly, node) {
        let vertex = &mut assembly.rods.vertices[index];
        let voronoi = 0.5 * (length(vertex.before) + length(vertex.after));
        for frame in 0..2 {
            vertex.natural.curvature[2 * frame] += second * voronoi;
            vertex.natural.curvature[2 * frame + 1] -= first * voronoi;
        }
        vertex.natural.twist += twist * voronoi;
    }
}

/// Multiplies stiffnesses of the vertices at a node.
fn stiffen(simulation: &mut Simulation, node: usize, [first, second, twisting]: [f64; 3]) {
    let assembly = &mut simulation.system.assembly;
    for index in vertices_at(assembly, node) {
        let vertex = &mut assembly.rods.vertices[index];
        vertex.stiffness.bending[1] *= 1.0 + first;
        vertex.stiffness.bending[0] *= 1.0 + second;
        vertex.stiffness.twisting *= 1.0 + twisting;
    }
}

fn throw(simulation: &mut Simulation, node: usize, velocity: Vector3) {
    let State {
        unknowns,
        velocity: own,
        ..
    } = &simulation.state;
    let mut own = own.clone();
    for axis in 0..3 {
        own[STRIDE * node + axis] += velocity[axis];
    }
    simulation.system.assembly.joints.spread_points(&mut own);
    simulation.state = State::new(&unknowns.clone(), &own);
}

/// A field with the rule to change it at a node, a small amount, and its derivative there.
type Field = (&'static str, Change, f64, fn(&Gradient, usize) -> f64);

const FIELDS: [Field; 9] = [
    (
        "curvature about m1",
        |s, k, by| strain(s, k, [by, 0.0, 0.0]),
        0.01,
        |g, k| g.natural_curvature[k][0],
    ),
    (
        "curvature about m2",
        |s, k, by| strain(s, k, [0.0, by, 0.0]),
        0.01,
        |g, k| g.natural_curvature[k][1],
    ),
    (
        "twist",
        |s, k, by| strain(s, k, [0.0, 0.0, by]),
        0.01,
        |g, k| g.natural_twist[k],
    ),
    (
        "EI1",
        |s, k, by| stiffen(s, k, [by, 0.0, 0.0]),
        0.01,
        |g, k| g.bending[k][0],
    ),
    (
        "EI2",
        |s, k, by| stiffen(s, k, [0.0, by, 0.0]),
        0.01,
        |g, k| g.bending[k][1],
    ),
    (
        "GJ",
        |s, k, by| stiffen(s, k, [0.0, 0.0, by]),
        0.01,
        |g, k| g.twisting[k],
    ),
    (
        "EA",
        |s, k, by| {
            let mut edges = s.system.assembly.rods.edges.iter_mut();
            let edge = edges.find(|edge| edge.start == k);
            edge.into_iter()
                .for_each(|edge| edge.stretching *= 1.0 + by);
        },
        0.01,
        |g, k| g.stretching[k],
    ),
    (
        "velocity",
        |s, k, by| throw(s, k, Vector3::y() * by),
        0.01,
        |g, k| g.velocity[k].y,
    ),
    (
        "force",
        |s, k, by| s.system.terms.loads.external_mut()[STRIDE * k + 2] += by,
        1e-5,
        |g, k| g.force[k].z,
    ),
];

/// Derivatives of all results with respect to one value.
fn differences(
    course: &Course,
    scene: &Scene,
    change: Change,
    node: usize,
    amount: f64,
) -> Vec<f64> {
    let central = |amount: f64| -> Vec<f64> {
        let [plus, minus] = [amount, -amount].map(|by| course.run(scene, change, node, by));
        let pairs = plus.iter().zip(&minus);
        pairs
            .map(|(plus, minus)| (plus - minus) / (2.0 * amount))
            .collect()
    };
    let [fine, middle, coarse] = [1.0, 2.0, 4.0].map(|times| central(times * amount));
    (0..fine.len())
        .map(|of| {
            let first = (4.0 * fine[of] - middle[of]) / 3.0;
            let second = (4.0 * middle[of] - coarse[of]) / 3.0;
            (16.0 * first - second) / 15.0
        })
        .collect()
}

/// Threshold below which derivatives count as small, for results of the size 1.
const UNIMPORTANT: f64 = 1e-3;

/// Compares at given nodes, with a given largest error.
#[track_caller]
pub(super) fn check_at<const N: usize>(
    nodes: [usize; N],
    exactness: f64,
    name: &str,
    course: &Course,
    scene: &Scene,
    share: f64,
) {
    check_shares(nodes, exactness, name, course, scene, |_| share);
}

/// Compares with changes by a share of each field.
#[track_caller]
pub(super) fn check_shares<const N: usize>(
    nodes: [usize; N],
    exactness: f64,
    name: &str,
    course: &Course,
    scene: &Scene,
    share: impl Fn(&str) -> f64,
) {
    let gradients = course.gradients(scene, LARGEST_TRACE);
    let fields = FIELDS
        .iter()
        .filter(|field| !(course.settles && field.0 == "velocity"));
    for (field, change, amount, of) in fields {
        let (mut worst, mut largest) = (0.0_f64, UNIMPORTANT);
        for node in nodes {
            let expected = differences(course, scene, *change, node, share(field) * amount);
            for (gradient, expected) in gradients.iter().zip(expected) {
                if *field == "velocity" && scene.clamps.iter().any(|clamp| clamp.node == node) {
                    assert_eq!(of(gradient, node), 0.0);
                    continue;
                }
                worst = worst.max((of(gradient, node) - expected).abs());
                largest = largest.max(expected.abs());
            }
        }
        println!(
            "{name:12} {field:20} {:?} {:.1e} of {largest:.1e}",
            course.scheme,
            worst / largest
        );
        assert!(
            worst / largest < exactness,
            "{name} {field} {course:?}: {:e}",
            worst / largest
        );
    }
}

pub(super) fn course(scheme: Scheme) -> Course {
    Course {
        settles: false,
        steps: STEPS,
        scheme,
    }
}
