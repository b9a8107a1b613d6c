//! Contact between rods and with planes: broad phase, distances, the implicit contact model, friction.

mod parameters;

pub use parameters::ContactParameters;
