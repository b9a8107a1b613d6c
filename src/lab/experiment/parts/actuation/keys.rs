//! Typed natural strains that change over time.

use crate::scenario::quantity::Quantity;
use crate::scenario::units::{Angle, Curvature, Dimensionless, Frequency, Length, Time, Twist};
use schemars::JsonSchema;

/// Corners of a piecewise linear factor: [[time, factor], ...].
type Schedule = Vec<(Quantity<Time>, Quantity<Dimensionless>)>;

/// A natural strain that changes over time, by which the rod bends, twists or lengthens. Give
/// `values`, or a wave by its `amplitude`: amplitude · sin(2π (s/wavelength − t · frequency) +
/// phase) at the distance s from the start of the rod. Several strains of one rod are added to
/// each other and to the natural shape.
#[derive(Debug, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", deny_unknown_fields, rename = "actuation")]
pub enum ActuationKeys {
    /// Natural curvature about a material director.
    Curvature {
        /// Name of the rod.
        rod: Option<String>,
        /// Director about which the rod bends: 1 (the default) or 2.
        direction: Option<i64>,
        /// Curvature at given times, [[time, curvature], ...], linear between them and constant outside.
        values: Option<Vec<(Quantity<Time>, Quantity<Curvature>)>>,
        /// Largest curvature of a wave.
        amplitude: Option<Quantity<Curvature>>,
        /// Length of a wave along the rod. Default: all of the rod does the same.
        wavelength: Option<Quantity<Length>>,
        /// Cycles of a wave per time; it runs from the start of the rod to its end, and back where the frequency is
        /// negative. Default: 0, a standing pattern.
        frequency: Option<Quantity<Frequency>>,
        /// Phase of a wave at the start of the rod at time 0. Default: 0.
        phase: Option<Quantity<Angle>>,
        /// Factor of a wave at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
        /// Start of the strained part, from the start of the rod. Default: the start of the rod.
        from: Option<Quantity<Length>>,
        /// End of the strained part, from the start of the rod. Default: the end of the rod.
        to: Option<Quantity<Length>>,
    },
    /// Natural twist per length.
    Twist {
        /// Name of the rod.
        rod: Option<String>,
        /// Twist at given times, [[time, twist], ...], linear between them and constant outside.
        values: Option<Vec<(Quantity<Time>, Quantity<Twist>)>>,
        /// Largest twist of a wave.
        amplitude: Option<Quantity<Twist>>,
        /// Length of a wave along the rod. Default: all of the rod does the same.
        wavelength: Option<Quantity<Length>>,
        /// Cycles of a wave per time; it runs from the start of the rod to its end, and back where the frequency is
        /// negative. Default: 0, a standing pattern.
        frequency: Option<Quantity<Frequency>>,
        /// Phase of a wave at the start of the rod at time 0. Default: 0.
        phase: Option<Quantity<Angle>>,
        /// Factor of a wave at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
        /// Start of the strained part, from the start of the rod. Default: the start of the rod.
        from: Option<Quantity<Length>>,
        /// End of the strained part, from the start of the rod. Default: the end of the rod.
        to: Option<Quantity<Length>>,
    },
    /// Relative change of the natural length: 0.1 is 10 % longer.
    ///
    /// Mass, stiffnesses of the section, and natural curvature and twist per length do not change.
    Length {
        /// Name of the rod.
        rod: Option<String>,
        /// Relative change at given times, [[time, change], ...], linear between them and constant outside.
        values: Option<Vec<(Quantity<Time>, Quantity<Dimensionless>)>>,
        /// Largest relative change of a wave.
        amplitude: Option<Quantity<Dimensionless>>,
        /// Length of a wave along the rod. Default: all of the rod does the same.
        wavelength: Option<Quantity<Length>>,
        /// Cycles of a wave per time; it runs from the start of the rod to its end, and back where the frequency is
        /// negative. Default: 0, a standing pattern.
        frequency: Option<Quantity<Frequency>>,
        /// Phase of a wave at the start of the rod at time 0. Default: 0.
        phase: Option<Quantity<Angle>>,
        /// Factor of a wave at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
        /// Start of the strained part, from the start of the rod. Default: the start of the rod.
        from: Option<Quantity<Length>>,
        /// End of the strained part, from the start of the rod. Default: the end of the rod.
        to: Option<Quantity<Length>>,
    },
}
