//! Settings of the engine for contact, fluid and time.

use crate::scenario::{self, Contact, Fluid, FrictionAt, Geometry, Scenario, Scheme, Step, Time};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::{self, ContactModel, ContactParameters};
use rodlab_engine::mechanics::dynamics::{self, IntegrationParameters, StepSize};
use rodlab_engine::mechanics::fluid::{BackgroundFlow, FlowKind, FluidModel};

pub(super) fn contact_parameters(contact: &Contact) -> Option<ContactParameters> {
    match *contact {
        Contact::None => None,
        Contact::Imc {
            friction,
            friction_at,
            geometry,
            distance_tolerance,
            slip_tolerance,
            stiffness_factor,
            maximum_penetration,
        } => Some(ContactParameters {
            model: ContactModel::ImplicitContact,
            distance_tolerance,
            friction,
            friction_at: place_of(friction_at),
            geometry: geometry_of(geometry),
            slip_tolerance,
            stiffness_factor,
            maximum_penetration,
        }),
        Contact::Ipc {
            friction,
            friction_at,
            geometry,
            distance_tolerance,
            slip_tolerance,
            stiffness_factor,
        } => Some(ContactParameters {
            model: ContactModel::IncrementalPotential,
            distance_tolerance,
            friction,
            friction_at: place_of(friction_at),
            geometry: geometry_of(geometry),
            slip_tolerance,
            stiffness_factor,
            maximum_penetration: 0.0,
        }),
        Contact::Complementarity {
            friction,
            distance_tolerance,
            maximum_penetration,
        } => Some(ContactParameters {
            model: ContactModel::Complementarity,
            distance_tolerance,
            friction,
            maximum_penetration,
            ..ContactParameters::default()
        }),
    }
}

fn geometry_of(geometry: Geometry) -> contact::Geometry {
    match geometry {
        Geometry::Polyline => contact::Geometry::Polyline,
        Geometry::Smooth => contact::Geometry::Smooth,
    }
}

fn place_of(friction: FrictionAt) -> contact::FrictionAt {
    match friction {
        FrictionAt::Centreline => contact::FrictionAt::Centreline,
        FrictionAt::Surface => contact::FrictionAt::Surface,
    }
}

pub(super) fn fluid_model(fluid: &Fluid) -> Option<FluidModel> {
    match *fluid {
        Fluid::None => None,
        Fluid::Rss {
            viscosity,
            regularization,
            far_field_error,
            ..
        } => Some(FluidModel::RegularizedStokeslets {
            viscosity,
            regularization,
            far_field_error,
        }),
        Fluid::Resistive { viscosity, .. } => Some(FluidModel::Resistive { viscosity }),
        Fluid::Quadratic {
            density,
            normal_drag,
            tangential_drag,
            added_mass,
            ..
        } => Some(FluidModel::Quadratic {
            density,
            normal: normal_drag,
            tangential: tangential_drag,
            added_mass,
        }),
    }
}

/// The flow of the fluid without rods.
pub(super) fn background_flow(fluid: &Fluid) -> Option<BackgroundFlow> {
    let flow = fluid.flow()?;
    let kind = match &flow.kind {
        scenario::FlowKind::Uniform { velocity } => FlowKind::Uniform {
            velocity: Vector3::from(*velocity),
        },
        scenario::FlowKind::Shear {
            direction,
            gradient,
            rate,
            point,
        } => FlowKind::Shear {
            point: Vector3::from(*point),
            direction: Vector3::from(*direction),
            gradient: Vector3::from(*gradient),
            rate: *rate,
        },
        scenario::FlowKind::Rotation {
            axis,
            angular_velocity,
            point,
        } => FlowKind::Rotation {
            point: Vector3::from(*point),
            angular_velocity: Vector3::from(*axis) * *angular_velocity,
        },
        scenario::FlowKind::Extension {
            rate,
            stretched,
            compressed,
            point,
        } => FlowKind::extension(
            Vector3::from(*point),
            *rate,
            Vector3::from(*stretched),
            compressed.map(Vector3::from),
        ),
        scenario::FlowKind::Profile {
            direction,
            along,
            velocities,
        } => FlowKind::Profile {
            direction: Vector3::from(*direction),
            along: Vector3::from(*along),
            speeds: velocities.clone(),
        },
    };
    Some(BackgroundFlow {
        kind,
        schedule: flow.schedule.clone(),
    })
}

/// Whether the fluid resists rotation of rods about their own axes.
pub(super) fn resists_spin(fluid: &Fluid) -> bool {
    matches!(
        fluid,
        Fluid::Rss { spin: true, .. } | Fluid::Resistive { spin: true, .. }
    )
}

pub(super) fn integration_parameters(scenario: &Scenario) -> IntegrationParameters {
    let defaults = IntegrationParameters::default();
    let (scheme, step) = match scenario.time {
        Time::Static | Time::Continuation => (defaults.scheme, defaults.step),
        Time::Dynamic { scheme, step, .. } => (
            match scheme {
                Scheme::ImplicitEuler => dynamics::Scheme::ImplicitEuler,
                Scheme::ImplicitMidpoint => dynamics::Scheme::ImplicitMidpoint,
                Scheme::BackwardDifferences => dynamics::Scheme::BackwardDifferences,
            },
            match step {
                Step::Fixed(step) => StepSize::Fixed(step),
                Step::Auto { tolerance, maximum } => StepSize::Auto { tolerance, maximum },
            },
        ),
    };
    IntegrationParameters {
        scheme,
        step,
        force_tolerance: scenario.solver.force_tolerance,
        displacement_tolerance: scenario.solver.displacement_tolerance,
        maximum_iterations: scenario.solver.maximum_iterations,
        minimum_step: (scenario.solver.minimum_step).unwrap_or(defaults.minimum_step),
    }
}
