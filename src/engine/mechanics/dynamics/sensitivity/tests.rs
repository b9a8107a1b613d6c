//! Derivatives against extrapolated differences of whole runs.

use super::{Sensitivity, SensitivityError, Variation, sharp};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, FrictionAt};
use crate::mechanics::dynamics::{IntegrationParameters, Scheme, Simulation};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::{Clamp, Inertia, Motion, Relaxation, Scene};
use crate::mechanics::test_support::{
    SCHEMES, SOFT_MODELS, advance_to, at, cantilever, clamp, crossed, curved, drag, fixed_steps,
    pulled, sheared, spring,
};

/// A scene as a function of a factor on one of its parameters.
type OfFactor<'a> = &'a dyn Fn(f64) -> Scene;

/// Kind of run: an equilibrium, steps of a size (s), or both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    settles: bool,
    scheme: Scheme,
    step: f64,
    steps: usize,
}

pub(super) const REST: Course = Course {
    settles: true,
    scheme: Scheme::ImplicitEuler,
    step: 1e-3,
    steps: 0,
};

impl Course {
    pub(super) fn moves(scheme: Scheme, step: f64, steps: usize) -> Self {
        Self {
            settles: false,
            scheme,
            step,
            steps,
        }
    }

    fn parameters(&self) -> IntegrationParameters {
        IntegrationParameters {
            force_tolerance: 1e-13,
            displacement_tolerance: 1e-11,
            ..fixed_steps(self.scheme, self.step)
        }
    }

    fn end(&self) -> f64 {
        self.step * self.steps as f64
    }

    pub(super) fn run(&self, scene: &Scene) -> Simulation {
        let mut simulation = sharp(scene, &self.parameters()).unwrap();
        if self.settles {
            simulation.find_equilibrium().unwrap();
        }
        advance_to(&mut simulation, self.end());
        simulation
    }

    fn differentiate(&self, scene: OfFactor, step: f64) -> Sensitivity {
        let variation = Variation {
            scenes: [scene(1.0 + step), scene(1.0 - step)],
            step,
        };
        let mut found = Sensitivity::new(&scene(1.0), &self.parameters(), &[variation]).unwrap();
        if self.settles {
            found.find_equilibrium().unwrap();
        }
        while found.base().time() < self.end() {
            found.advance(self.end()).unwrap();
        }
        found
    }
}

/// Compared quantities: positions, velocities, frames, and the forces and moments of the clamp at
/// the first node.
fn observed(simulation: &Simulation) -> [Vec<Vector3>; 4] {
    [
        simulation.positions().to_vec(),
        simulation.velocities().to_vec(),
        simulation.material_directors(),
        vec![simulation.reaction(0), simulation.reaction_moment(0)],
    ]
}

/// Difference of two observations, divided by a number.
fn rate(plus: &Simulation, minus: &Simulation, over: f64) -> [Vec<Vector3>; 4] {
    let [plus, minus] = [plus, minus].map(observed);
    std::array::from_fn(|of| {
        let pairs = plus[of].iter().zip(&minus[of]);
        pairs.map(|(plus, minus)| (plus - minus) / over).collect()
    })
}

/// Fraction of the largest value of an observation below which its derivative with respect to a
/// factor counts as small.
const UNIMPORTANT: f64 = 0.01;

/// Largest error of each observation relative to its largest derivative, or to [`UNIMPORTANT`]
/// times its largest value.
fn errors(course: &Course, scene: OfFactor, bounds: &Bounds) -> [f64; 4] {
    let found = course.differentiate(scene, bounds.step);
    let [plus, minus] = found.neighbours(0);
    let mut derivatives = rate(plus, minus, 2.0 * found.step(0));
    derivatives[0] = found.positions(0);
    derivatives[1] = found.velocities(0);
    let central = |h: f64| {
        let [plus, minus] = [1.0 + h, 1.0 - h].map(|factor| course.run(&scene(factor)));
        rate(&plus, &minus, 2.0 * h)
    };
    let levels = [1.0, 2.0, 4.0].map(|times| central(times * bounds.difference));
    let extrapolated = |of: usize, k: usize| {
        let [fine, middle, coarse] = [0, 1, 2].map(|level: usize| levels[level][of][k]);
        let [first, second] = [(fine * 4.0 - middle) / 3.0, (middle * 4.0 - coarse) / 3.0];
        (first * 16.0 - second) / 15.0
    };
    std::array::from_fn(|of| {
        let values = observed(found.base())[of].clone();
        let sizes = values.iter().map(|value| UNIMPORTANT * value.norm());
        let (mut worst, mut largest) = (0.0_f64, sizes.fold(f64::MIN_POSITIVE, f64::max));
        for (k, own) in derivatives[of].iter().enumerate() {
            let expected = extrapolated(of, k);
            worst = worst.max((own - expected).norm());
            largest = largest.max(expected.norm());
        }
        worst / largest
    })
}

/// Settings of the comparison of a derivative.
pub(super) struct Bounds {
    /// ε of the derivative, and the fraction of the parameter by which whole runs differ.
    pub(super) step: f64,
    pub(super) difference: f64,
    /// Largest errors of positions, velocities and frames, and of reactions.
    pub(super) motion: f64,
    pub(super) reactions: f64,
}

pub(super) const EXACT: Bounds = Bounds {
    step: 2e-5,
    difference: 2e-3,
    motion: 1e-7,
    reactions: 1e-7,
};

/// Compares with differences over a fraction of the parameter; errors may be as large as the
/// tolerance.
#[track_caller]
fn check(name: &str, course: &Course, scene: OfFactor, bounds: &Bounds) {
    let errors = errors(course, scene, bounds);
    let words = errors.map(|error| format!("{error:.1e}")).join(" ");
    println!("{name:24} {:?} {words}", course.scheme);
    let of_motion = errors[..3].iter().copied().fold(0.0, f64::max);
    assert!(of_motion < bounds.motion, "{name} {course:?}: {words}");
    assert!(errors[3] < bounds.reactions, "{name} {course:?}: {words}");
}

/// For parameters with less effect.
pub(super) const WEAK: Bounds = Bounds {
    difference: 1e-2,
    ..EXACT
};

/// For dashpots: a rounding error in the length of an edge at the start of a step is multiplied by
/// EA T/H in the force.
const DAMPED: Bounds = Bounds {
    step: 1e-4,
    reactions: 2e-5,
    ..WEAK
};

/// For quantities that switch at some distance, such as the stiffness of contacts and joints that
/// break.
pub(super) const AT_SWITCHES: Bounds = Bounds {
    difference: 5e-4,
    ..EXACT
};

/// For the flow of regularized Stokeslets, which stores its operator in single precision.
const FLOWING: Bounds = Bounds {
    step: 2e-3,
    motion: 1e-5,
    reactions: 1e-4,
    ..WEAK
};

/// Changes of single parameters by a factor.
pub(super) type Change = (&'static str, fn(&mut Scene, f64));

pub(super) const OF_RODS: [Change; 6] = [
    ("EI1", |scene, factor| {
        scene.rods[0].stiffness.bending[0] *= factor;
    }),
    ("EI2", |scene, factor| {
        scene.rods[0].stiffness.bending[1] *= factor;
    }),
    ("GJ", |scene, factor| {
        scene.rods[0].stiffness.twisting *= factor;
    }),
    ("mass", |scene, factor| {
        scene.rods[0].mass_per_length *= factor;
        scene.rods[0].rotational_inertia_per_length *= factor;
    }),
    ("natural curvature", |scene, factor| {
        scene.rods[0].natural_shape = curved([2.0 * factor, 1.0], 1.5);
    }),
    ("initial length", |scene, factor| {
        for node in &mut scene.rods[0].centreline {
            *node *= factor;
        }
    }),
];

fn changed(scene: &Scene, change: fn(&mut Scene, f64), factor: f64) -> Scene {
    let mut scene = scene.clone();
    change(&mut scene, factor);
    scene
}

#[track_caller]
pub(super) fn check_all(course: &Course, scene: &Scene, changes: &[Change], bounds: &Bounds) {
    for (name, change) in changes {
        let of = |factor: f64| changed(scene, *change, factor);
        check(name, course, &of, bounds);
    }
}

#[test]
fn equilibria_of_a_cantilever() {
    check_all(&REST, &cantilever(), &OF_RODS, &EXACT);
}

#[test]
fn swings_of_a_cantilever_by_every_scheme() {
    for scheme in SCHEMES {
        let course = Course::moves(scheme, 2e-3, 30);
        check_all(&course, &cantilever(), &OF_RODS, &EXACT);
    }
}

#[test]
fn consistent_inertia_and_a_motion_from_equilibrium() {
    let mut scene = cantilever();
    scene.rods[0].inertia = Inertia::Consistent;
    scene.clamps[0].motion.translation = vec![(0.0, Vector3::zeros()), (0.1, Vector3::y() * 0.05)];
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let course = Course {
            settles: true,
            ..Course::moves(scheme, 2e-3, 30)
        };
        check_all(&course, &scene, &OF_RODS, &EXACT);
    }
}

/// A rod with both ends clamped, one of which turns about two axes while it moves.
fn twisted() -> Scene {
    let mut scene = cantilever();
    scene.rods[0].twist = 0.4;
    scene.clamps.push(driven(1.0));
    scene
}

fn driven(factor: f64) -> Clamp {
    let axis = Vector3::new(1.0, 0.5, 0.2).normalize();
    let way = Vector3::new(-0.08, 0.03, 0.05);
    Clamp {
        motion: Motion {
            translation: vec![(0.0, Vector3::zeros()), (0.1, way * factor)],
            axis: Some(axis),
            angle: vec![(0.0, 0.0), (0.1, 4.0 * factor)],
            ..Motion::default()
        },
        ..clamp(0, 10)
    }
}

#[test]
fn frames_of_a_twisted_rod_with_a_moving_clamp() {
    let motions: [Change; 2] = [
        ("motion of a clamp", |scene, factor| {
            scene.clamps[1] = driven(factor);
        }),
        ("turning of a clamp", |scene, factor| {
            scene.clamps[1].motion.angular_velocity = 20.0 * factor;
        }),
    ];
    for scheme in SCHEMES {
        let course = Course::moves(scheme, 2e-3, 30);
        check_all(&course, &twisted(), &motions, &EXACT);
        check_all(&course, &twisted(), &OF_RODS[..5], &EXACT);
    }
}

#[test]
fn drag_viscosity_and_relaxation() {
    let mut scene = cantilever();
    scene.loads.push(drag(None, 0.05, 1e-5));
    scene.rods[0].retardation_time = 0.02;
    scene.rods[0].relaxation = Some(Relaxation {
        ratio: 0.5,
        time: 0.03,
    });
    let changes: [Change; 4] = [
        ("drag", |scene, factor| {
            scene.loads[2] = drag(None, 0.05 * factor, 1e-5 * factor);
        }),
        ("retardation", |scene, factor| {
            scene.rods[0].retardation_time = 0.02 * factor;
        }),
        ("relaxation", |scene, factor| {
            let relaxation = scene.rods[0].relaxation.as_mut().unwrap();
            relaxation.time *= factor;
            relaxation.ratio *= factor;
        }),
        ("EI", |scene, factor| {
            scene.rods[0].stiffness.bending = [1e-3 * factor, 2.5e-3 * factor];
        }),
    ];
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let course = Course::moves(scheme, 2e-3, 30);
        check_all(&course, &scene, &changes, &DAMPED);
    }
}

#[test]
fn springs_and_local_drag_of_a_fluid() {
    let mut scene = cantilever();
    scene.fluid = Some(FluidModel::Resistive { viscosity: 0.05 });
    scene.springs = vec![spring("spring", [at(0, 3), at(0, 9)], 20.0)];
    let changes: [Change; 2] = [
        ("viscosity", |scene, factor| {
            scene.fluid = Some(FluidModel::Resistive {
                viscosity: 0.05 * factor,
            });
        }),
        ("stiffness of a spring", |scene, factor| {
            scene.springs[0].stiffness *= factor;
        }),
    ];
    for scheme in SCHEMES {
        let course = Course::moves(scheme, 2e-3, 30);
        check_all(&course, &scene, &changes, &WEAK);
    }
}

#[test]
fn flow_of_two_rods() {
    let mut scene = cantilever();
    let mut other = scene.rods[0].clone();
    other.name = "other".into();
    for node in &mut other.centreline {
        *node += Vector3::new(0.02, 0.05, 0.01);
    }
    scene.rods.push(other);
    scene.clamps.push(clamp(1, 0));
    scene.clamps[0].motion.translation = vec![(0.0, Vector3::zeros()), (1.0, Vector3::y() * 0.5)];
    let fluid = |viscosity: f64| {
        Some(FluidModel::RegularizedStokeslets {
            viscosity,
            regularization: 1.02,
            far_field_error: 0.0,
        })
    };
    scene.fluid = fluid(0.05);
    let change: OfFactor = &|factor| {
        let mut scene = scene.clone();
        scene.fluid = fluid(0.05 * factor);
        scene
    };
    for scheme in SCHEMES {
        let course = Course::moves(scheme, 2e-3, 30);
        check("viscosity of a flow", &course, change, &FLOWING);
        check_all(&course, &scene, &OF_RODS[..2], &FLOWING);
    }
}

/// For added mass: the reactions contain accelerations over the small first steps of backward
/// differences.
const ACCELERATED: Bounds = Bounds {
    reactions: 1e-6,
    ..EXACT
};

/// A shear for every fluid, and quadratic drag, whose derivatives are exact in any flow.
#[test]
fn background_flows() {
    let quadratic = FluidModel::Quadratic {
        density: 50.0,
        normal: 1.2,
        tangential: 0.3,
        added_mass: 1.0,
    };
    let stokeslets = FluidModel::RegularizedStokeslets {
        viscosity: 0.05,
        regularization: 1.02,
        far_field_error: 0.0,
    };
    let changes: [Change; 2] = [
        ("shear rate", |scene, factor| {
            scene.flow = Some(sheared(4.0 * factor));
        }),
        ("EI", |scene, factor| {
            scene.rods[0].stiffness.bending = [1e-3 * factor, 2.5e-3 * factor];
        }),
    ];
    for (model, bounds) in [
        (FluidModel::Resistive { viscosity: 0.05 }, [&WEAK, &EXACT]),
        (stokeslets, [&FLOWING; 2]),
        (quadratic, [&ACCELERATED; 2]),
    ] {
        let mut scene = cantilever();
        (scene.fluid, scene.flow) = (Some(model), Some(sheared(4.0)));
        scene.spin_drag = true;
        for scheme in SCHEMES {
            let course = Course::moves(scheme, 2e-3, 30);
            check_all(&course, &scene, &changes[..1], bounds[0]);
            check_all(&course, &scene, &changes[1..], bounds[1]);
        }
    }
}

#[test]
fn friction_on_the_ground() {
    let changes: [Change; 2] = [
        ("friction", |scene, factor| {
            scene.contact.as_mut().unwrap().friction *= factor;
        }),
        ("EI", |scene, factor| {
            scene.rods[0].stiffness.bending = [1e-3 * factor, 2.5e-3 * factor];
        }),
    ];
    for model in SOFT_MODELS {
        let course = Course::moves(Scheme::ImplicitEuler, 2e-3, 30);
        let mut scene = pulled(model);
        check_all(&course, &scene, &changes, &AT_SWITCHES);
        scene.contact.as_mut().unwrap().friction_at = FrictionAt::Surface;
        check_all(&course, &scene, &changes, &AT_SWITCHES);
    }
}

#[test]
fn sticking_and_sliding_by_complementarity() {
    let changes: [Change; 2] = [
        ("friction", |scene, factor| {
            scene.contact.as_mut().unwrap().friction *= factor;
        }),
        ("EI", |scene, factor| {
            scene.rods[0].stiffness.bending = [1e-3 * factor, 2.5e-3 * factor];
        }),
    ];
    let radius: Change = ("radius", |scene, factor| scene.rods[0].radius *= factor);
    let rigid = Bounds {
        motion: 1e-5,
        reactions: 1e-5,
        ..AT_SWITCHES
    };
    // With another radius, contact begins in another step.
    let near = Bounds {
        difference: 2e-5,
        reactions: 1e-3,
        ..rigid
    };
    let course = Course::moves(Scheme::ImplicitEuler, 2e-3, 30);
    for scene in [pulled, crossed] {
        let scene = scene(ContactModel::Complementarity);
        check_all(&course, &scene, &changes, &rigid);
        check_all(&course, &scene, &[radius], &near);
    }
}

#[test]
fn what_has_no_derivatives_is_refused() {
    let course = Course::moves(Scheme::ImplicitEuler, 2e-3, 1);
    let mut longer = cantilever();
    longer.clamps.push(clamp(0, 10));
    let variation = Variation {
        scenes: [longer.clone(), longer],
        step: 1e-5,
    };
    let refused = Sensitivity::new(&cantilever(), &course.parameters(), &[variation]);
    assert!(matches!(refused, Err(SensitivityError::Unsuitable(_))));
}
