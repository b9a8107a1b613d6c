//! Resolves models, time, solver and output.

use super::movement::refuse_motion;
use crate::scenario::resolved::{
    Begin, Body, Clamp, Contact, Fluid, FrictionAt, Geometry, Joint, Load, Obstacle, Output, Plane,
    Rod, Scheme, Solver, Step, Time,
};
use crate::scenario::section::Section;
use crate::scenario::tables::{OutputKeys, SolverKeys};
use crate::scenario::typed::{self, ScenarioFile};

/// The factor s of the stiffness of "imc" (m) over the radius of the thinnest rod: the thesis has
/// 1e5 m for 1 mm.
const STIFFNESS_PER_RADIUS: f64 = 1e8;
/// The default step over the end time.
const PART_OF_END: f64 = 1e-3;
/// The default of the smallest step over a fixed step: twenty halvings.
const LEAST_PART: f64 = 1e-6;
/// The default of the smallest step over the largest automatic step; the first automatic step is a
/// thousandth of the largest.
const LEAST_PART_OF_LARGEST: f64 = 1e-9;
/// Maximum number of rows that a run may write.
const MOST_OUTPUTS: f64 = 1e6;

/// Resolves the contact model; `smallest_radius` sets the defaults of the distance tolerance and of the stiffness.
pub fn contact(top: &Section<'_>, typed: Option<&typed::Contact>, smallest_radius: f64) -> Contact {
    let Some(typed) = typed else {
        return Contact::None;
    };
    let section = top.below("contact");
    let model = typed.model(&section);
    if model == typed::ContactModel::None {
        return Contact::None;
    }
    let friction = typed.friction(&section);
    let friction_at = typed.friction_at(&section);
    let geometry = typed.geometry(&section);
    if geometry == Geometry::Smooth && friction_at == FrictionAt::Surface {
        section.fault(
            "geometry",
            "\"smooth\" needs friction on the centrelines; leave out friction_at",
        );
    }
    let distance_tolerance = typed.distance_tolerance(&section, 0.01 * smallest_radius);
    if distance_tolerance > smallest_radius {
        section.out_of_range(
            "distance_tolerance",
            format_args!("{distance_tolerance:?} m"),
            format_args!("at most the smallest radius, {smallest_radius:?} m"),
        );
    }
    let slip_tolerance = typed.slip_tolerance(&section, 1e-4);
    if model == typed::ContactModel::Ipc {
        if typed.maximum_penetration.is_some() {
            section.fault(
                "maximum_penetration",
                "the model \"ipc\" allows no penetration; leave the key out",
            );
        }
        return Contact::Ipc {
            friction,
            friction_at,
            geometry,
            distance_tolerance,
            slip_tolerance,
            stiffness_factor: typed.stiffness_factor(&section, 1.0),
        };
    }
    let maximum_penetration = typed.maximum_penetration(&section);
    if model == typed::ContactModel::Complementarity {
        section.refuse(
            &[
                ("slip_tolerance", typed.slip_tolerance.is_some()),
                ("stiffness_factor", typed.stiffness_factor.is_some()),
            ],
            "the model \"complementarity\" is rigid and sticks; leave the key out",
        );
        if friction_at == FrictionAt::Surface {
            section.fault(
                "friction_at",
                "the model \"complementarity\" allows \"centreline\" only; \"surface\" needs the model \"imc\" or \"ipc\"",
            );
        }
        if geometry == Geometry::Smooth {
            section.fault(
                "geometry",
                "the model \"complementarity\" allows \"polyline\" only; \"smooth\" needs the model \"imc\" or \"ipc\"",
            );
        }
        return Contact::Complementarity {
            friction,
            distance_tolerance,
            maximum_penetration,
        };
    }
    Contact::Imc {
        friction,
        friction_at,
        geometry,
        distance_tolerance,
        slip_tolerance,
        stiffness_factor: typed.stiffness_factor(&section, STIFFNESS_PER_RADIUS * smallest_radius),
        maximum_penetration,
    }
}

/// Regularisation in radii, as in the thesis.
const REGULARIZATION: f64 = 1.02;
/// Regularisation in radii beside a wall, √e. A line of such blobs has the drag of a cylinder of
/// the rod's radius to first order in its slenderness. Beside a wall, at a height of ten radii,
/// its drag has an error of 0.2 %; with the regularisation of the thesis the error is 14 %.
const REGULARIZATION_BESIDE_A_WALL: f64 = 1.65;

/// Resolves the fluid; `beside_wall` is true if one of the planes may be its wall, `resists_spin` is the default of the key
/// `spin`.
pub fn fluid(
    top: &Section<'_>,
    typed: Option<&typed::Fluid>,
    beside_wall: bool,
    resists_spin: bool,
) -> Fluid {
    let Some(typed) = typed else {
        return Fluid::None;
    };
    let section = top.below("fluid");
    let model = typed.model(&section);
    refuse_foreign_keys(&section, typed, model);
    let spin = typed.spin.unwrap_or(resists_spin);
    let flow = || {
        let flow = typed.flow(&section)?;
        flow.check_directions(&section);
        Some(flow)
    };
    match model {
        typed::FluidModel::None => Fluid::None,
        typed::FluidModel::Quadratic => Fluid::Quadratic {
            density: typed.density(&section),
            normal_drag: typed.normal_drag(&section),
            tangential_drag: typed.tangential_drag(&section),
            added_mass: typed.added_mass(&section),
            flow: flow(),
        },
        typed::FluidModel::Rss => Fluid::Rss {
            viscosity: typed.viscosity(&section),
            regularization: typed.regularization(
                &section,
                if beside_wall {
                    REGULARIZATION_BESIDE_A_WALL
                } else {
                    REGULARIZATION
                },
            ),
            far_field_error: typed.far_field_error(&section),
            spin,
            flow: flow(),
        },
        typed::FluidModel::Resistive => Fluid::Resistive {
            viscosity: typed.viscosity(&section),
            spin,
            flow: flow(),
        },
    }
}

/// Reports keys of other fluid models.
fn refuse_foreign_keys(section: &Section<'_>, typed: &typed::Fluid, model: typed::FluidModel) {
    let is_rss = model == typed::FluidModel::Rss;
    let is_quadratic = model == typed::FluidModel::Quadratic;
    let foreign = [
        (
            "regularization",
            typed.regularization.is_some() && !is_rss,
            "only the model \"rss\" is regularised",
        ),
        (
            "far_field_error",
            typed.far_field_error.is_some() && !is_rss,
            "only the model \"rss\" has a far field",
        ),
        (
            "viscosity",
            typed.viscosity.is_some() && is_quadratic,
            "the model \"quadratic\" has a density instead; leave the key out",
        ),
        (
            "spin",
            typed.spin.is_some() && is_quadratic,
            "the model \"quadratic\" does not resist spin; leave the key out",
        ),
    ];
    let of_quadratic = [
        ("density", typed.density.is_some()),
        ("normal_drag", typed.normal_drag.is_some()),
        ("tangential_drag", typed.tangential_drag.is_some()),
        ("added_mass", typed.added_mass.is_some()),
    ];
    let of_quadratic = of_quadratic.map(|(key, is_given)| {
        (
            key,
            is_given && !is_quadratic,
            "only the model \"quadratic\" has this key",
        )
    });
    if model == typed::FluidModel::None {
        return;
    }
    let keys = foreign.into_iter().chain(of_quadratic);
    for (key, _, message) in keys.filter(|(_, is_foreign, _)| *is_foreign) {
        section.fault(key, message);
    }
}

/// Resolves mode and time steps.
pub fn time(top: &Section<'_>, file: &ScenarioFile) -> Time {
    let nothing = typed::Time::default();
    let typed = file.time.as_ref().unwrap_or(&nothing);
    let section = top.below("time");
    let refuse_steps = |message: &str| {
        let keys = [
            ("scheme", typed.scheme.is_some()),
            ("step", typed.step.is_some()),
            ("tolerance", typed.tolerance.is_some()),
            ("maximum_step", typed.maximum_step.is_some()),
            ("end", typed.end.is_some()),
            ("begin", typed.begin.is_some()),
        ];
        section.refuse(&keys, message);
    };
    match typed.mode(&section) {
        typed::Mode::Static => {
            refuse_steps("a static run has no time steps; leave the key out");
            Time::Static
        }
        typed::Mode::Continuation => {
            refuse_steps(
                "a path has no time steps except those of [continuation]; leave the key out",
            );
            Time::Continuation
        }
        typed::Mode::Dynamic => {
            let end = typed.end(&section);
            Time::Dynamic {
                scheme: scheme(file, typed.scheme(&section)),
                step: step(&section, typed, interval(top, &file.output, end), end),
                end,
                begin: begin(&section, typed, file),
            }
        }
    }
}

/// Where the motion begins. Rejects the equilibrium if something would have to move in it.
fn begin(section: &Section<'_>, typed: &typed::Time, file: &ScenarioFile) -> Begin {
    let chosen = typed.begin(section);
    if chosen == typed::Begin::Placed {
        return Begin::Placed;
    }
    // The resolved scenario of a run has all keys, zero velocities too.
    let moves = |rod: &typed::Rod| {
        let velocity = rod.velocity.iter().flatten();
        let mut turning = rod.angular_velocity.iter().flatten();
        velocity.map(|part| part.si()).any(|part| part != Ok(0.0))
            || turning.any(|part| part.si() != Ok(0.0))
    };
    let contact = file.contact.as_ref().and_then(|contact| contact.model);
    let refusals = [
        (
            file.start.is_some(),
            "with [start] the motion begins where another run ended; leave one of the two out",
        ),
        (
            file.rods.iter().any(moves),
            "an equilibrium has no velocity; leave out the key, or velocity and angular_velocity of the rods",
        ),
        (
            contact == Some(typed::ContactModel::Complementarity),
            "equilibria need contact.model = \"imc\" or \"ipc\"",
        ),
    ];
    if let Some((_, message)) = refusals.into_iter().find(|(refused, _)| *refused) {
        section.fault("begin", message);
    }
    Begin::Equilibrium
}

/// Whether the scene has contact.
pub fn touches(file: &ScenarioFile) -> bool {
    let contact = file.contact.as_ref();
    contact.is_some_and(|contact| contact.model != Some(typed::ContactModel::None))
}

/// Whether the scene has a fluid.
pub fn flows(file: &ScenarioFile) -> bool {
    let fluid = file.fluid.as_ref();
    fluid.is_some_and(|fluid| fluid.model != Some(typed::FluidModel::None))
}

/// The requested scheme, or the best for the contents of the scene. In contact velocities jump,
/// which only implicit Euler handles without ringing. Otherwise backward differences follow the
/// swing of a heavy cantilever with a twentieth of its error, at the same cost.
fn scheme(file: &ScenarioFile, choice: typed::SchemeChoice) -> Scheme {
    let touches = touches(file);
    match choice {
        typed::SchemeChoice::Auto if touches => Scheme::ImplicitEuler,
        typed::SchemeChoice::Auto => Scheme::BackwardDifferences,
        typed::SchemeChoice::ImplicitEuler => Scheme::ImplicitEuler,
        typed::SchemeChoice::ImplicitMidpoint => Scheme::ImplicitMidpoint,
        typed::SchemeChoice::BackwardDifferences => Scheme::BackwardDifferences,
    }
}

fn step(section: &Section<'_>, typed: &typed::Time, interval: f64, end: f64) -> Step {
    if typed.step.as_ref().is_some_and(|step| step.is_word("auto")) {
        return Step::Auto {
            tolerance: typed.tolerance(section),
            maximum: typed.maximum_step(section, interval),
        };
    }
    let keys = [
        ("tolerance", typed.tolerance.is_some()),
        ("maximum_step", typed.maximum_step.is_some()),
    ];
    section.refuse(&keys, "this key is allowed only with step = \"auto\"");
    Step::Fixed(typed.step(section, PART_OF_END * end))
}

/// Rejects friction by direction with contact that does not support it.
pub fn refuse_directed_friction(top: &Section<'_>, contact: &Contact, planes: &[Plane]) {
    let reason = if matches!(contact, Contact::Complementarity { .. }) {
        "the model \"complementarity\" has one coefficient for all directions; this table needs the model \"imc\" or \"ipc\""
    } else if contact.friction_at() == FrictionAt::Surface {
        "friction by direction acts on the centrelines; leave out contact.friction_at"
    } else if contact.geometry() == Geometry::Smooth {
        "friction by direction needs contact.geometry = \"polyline\""
    } else {
        return;
    };
    for (index, plane) in planes.iter().enumerate() {
        if plane.directed_friction.is_some() {
            let section = top.below("planes").below(&index.to_string());
            section.fault("directed_friction", reason);
        }
    }
}

/// Rejects rigid contact where it is not defined: its forces are defined only for steps of
/// implicit Euler.
pub fn refuse_rigid_statics(top: &Section<'_>, contact: &Contact, time: &Time) {
    let euler = matches!(
        time,
        Time::Dynamic {
            scheme: Scheme::ImplicitEuler,
            ..
        }
    );
    if matches!(contact, Contact::Complementarity { .. }) && !euler {
        top.below("contact").fault(
            "model",
            "\"complementarity\" needs a dynamic run with the scheme \"implicit-euler\"",
        );
    }
}

/// Whether steps use the midpoint rule.
fn is_midpoint(time: &Time) -> bool {
    matches!(
        time,
        Time::Dynamic {
            scheme: Scheme::ImplicitMidpoint,
            ..
        }
    )
}

/// Rejects the midpoint rule for viscous rods: the rate of a strain is not defined in the middle
/// of a step.
pub fn refuse_viscous_midpoint(top: &Section<'_>, rods: &[Rod], time: &Time) {
    let is_damped = |rod: &Rod| rod.material.viscosity > 0.0 || rod.material.relaxing_modulus > 0.0;
    if is_midpoint(time) && rods.iter().any(is_damped) {
        top.below("time").fault(
            "scheme",
            "\"implicit-midpoint\" does not fit rods with a viscosity or a modulus that relaxes; allowed with them: \"implicit-euler\" and \"backward-differences\"",
        );
    }
}

/// Rejects slides with friction in runs that find equilibria.
pub fn refuse_resting_friction(top: &Section<'_>, joints: &[Joint], time: &Time) {
    let rubbing = joints
        .iter()
        .enumerate()
        .filter(|(_, joint)| joint.kind.rubs());
    for (index, _) in rubbing.filter(|_| time.finds_equilibria()) {
        let section = top.below("joints").below(&index.to_string());
        section.fault("friction", Time::RESTING_FRICTION);
    }
}

/// Rejects frames that turn in schemes that extrapolate from the middle of each step: a rotation
/// there is not a rotation at the end of the step.
pub fn refuse_turning_midpoint(top: &Section<'_>, joints: &[Joint], bodies: &[Body], time: &Time) {
    let turns = joints.iter().any(|joint| joint.kind.turns())
        || bodies
            .iter()
            .any(|body| body.moments_of_inertia().is_some());
    if is_midpoint(time) && turns {
        top.below("time").fault(
            "scheme",
            "\"implicit-midpoint\" does not fit rigid joints, hinges, springs that turn rods, and bodies with inertia; allowed with them: \"implicit-euler\" and \"backward-differences\"",
        );
    }
}

/// Rejects changes over time in a run without time: a static run would use the value at time 0
/// only.
pub fn refuse_static_motion(
    top: &Section<'_>,
    time: &Time,
    clamps: &[Clamp],
    loads: &[Load],
    obstacles: &[Obstacle],
) {
    if *time != Time::Static {
        return;
    }
    let refuse = |table: &str, index: usize, key: &str| {
        top.below(table).below(&index.to_string()).fault_with_help(
            key,
            "a static run has no time, so nothing moves or changes in it",
            Some(
                "leave the key out, and place rods and loads in their final state; or follow the equilibria with time.mode = \"continuation\", whose parameter replaces the time; or run dynamically"
                    .into(),
            ),
        );
    };
    for (index, clamp) in clamps.iter().enumerate() {
        refuse_motion(&clamp.movement, |key| refuse("clamps", index, key));
    }
    for (index, obstacle) in obstacles.iter().enumerate() {
        refuse_motion(&obstacle.movement, |key| refuse("obstacles", index, key));
    }
    for (index, load) in loads.iter().enumerate() {
        if !load.schedule.is_empty() {
            refuse("loads", index, "schedule");
        }
    }
}

/// Rejects time steps below the smallest step of the solver.
pub fn refuse_small_steps(top: &Section<'_>, time: &Time, solver: &Solver) {
    let Time::Dynamic { step, .. } = time else {
        return;
    };
    let (key, step) = match *step {
        Step::Fixed(step) => ("step", step),
        Step::Auto { maximum, .. } => ("maximum_step", maximum),
    };
    if let Some(least) = solver.minimum_step.filter(|least| step < *least) {
        top.below("time").out_of_range(
            key,
            format_args!("{step:?} s"),
            format_args!("at least solver.minimum_step = {least:?} s"),
        );
    }
}

/// Resolves the solver; the step size sets the default of the smallest step.
pub fn solver(top: &Section<'_>, typed: &SolverKeys, time: &Time) -> Solver {
    let section = top.below("solver");
    let least = match *time {
        Time::Static | Time::Continuation => None,
        Time::Dynamic { step, .. } => Some(match step {
            Step::Fixed(step) => LEAST_PART * step,
            Step::Auto { maximum, .. } => LEAST_PART_OF_LARGEST * maximum,
        }),
    };
    let solver = typed.resolve(&section);
    Solver {
        minimum_step: solver.minimum_step.or(least),
        ..solver
    }
}

/// Time between outputs of a run that ends at `end`.
fn interval(top: &Section<'_>, typed: &OutputKeys, end: f64) -> f64 {
    let section = top.below("output");
    let interval = typed.resolve(&section).interval.unwrap_or(end / 100.0);
    if interval * MOST_OUTPUTS < end {
        section.out_of_range(
            "interval",
            format_args!("{interval:?} s"),
            format_args!("at least a millionth of time.end = {end:?} s"),
        );
    }
    interval
}

/// Resolves the output.
pub fn output(top: &Section<'_>, typed: &OutputKeys, time: &Time) -> Output {
    let refuse_interval = |why: &str| {
        let section = top.below("output");
        section.refuse(&[("interval", typed.interval.is_some())], why);
        None
    };
    let interval = match time {
        Time::Static => refuse_interval("a static run writes once; leave the key out"),
        Time::Continuation => {
            refuse_interval("a path is written point by point; leave the key out")
        }
        Time::Dynamic { end, .. } => Some(interval(top, typed, *end)),
    };
    Output {
        interval,
        ..typed.resolve(&top.below("output"))
    }
}
