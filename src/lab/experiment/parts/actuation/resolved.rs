//! Resolved natural strains that change over time.

use serde::Serialize;

/// A natural strain that changes over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Actuation {
    /// Kind of strain.
    #[serde(flatten)]
    pub kind: ActuationKind,
    /// Name of the rod.
    pub rod: String,
    /// Size of the strain.
    #[serde(flatten)]
    pub course: Course,
    /// Start of the strained part along the rod, m.
    pub from: f64,
    /// End of the strained part along the rod, m; `None` is the end of the rod.
    pub to: Option<f64>,
}

/// Natural strains that may change over time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ActuationKind {
    /// Curvature, 1/m.
    Curvature {
        /// Material director about which the rod bends, 1 or 2.
        direction: usize,
    },
    /// Twist, rad/m.
    Twist,
    /// Relative change of length.
    Length,
}

/// The magnitude of a natural strain.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Course {
    /// The same all along.
    Uniform {
        /// Strain at given times in s, piecewise linear.
        values: Vec<(f64, f64)>,
    },
    /// A wave.
    Wave {
        /// Largest strain.
        amplitude: f64,
        /// Wavelength, m; `None` if the strain is the same along the rod.
        wavelength: Option<f64>,
        /// Cycles per time, 1/s.
        frequency: f64,
        /// Phase at the start of the rod at time 0, rad.
        phase: f64,
        /// Factor at given times in s, piecewise linear; empty for a factor of 1.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        schedule: Vec<(f64, f64)>,
    },
}

impl Course {
    /// Largest and smallest value at any time and place.
    pub fn extremes(&self) -> [f64; 2] {
        let bounds = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::NEG_INFINITY, f64::INFINITY], |[high, low], value| {
                [high.max(value), low.min(value)]
            })
        };
        match self {
            Self::Uniform { values } => bounds(&mut values.iter().map(|corner| corner.1)),
            Self::Wave {
                amplitude,
                schedule,
                ..
            } => {
                let factors = schedule.iter().map(|corner| corner.1.abs());
                let largest = factors.reduce(f64::max).unwrap_or(1.0) * amplitude.abs();
                [largest, -largest]
            }
        }
    }

    /// Whether it changes over time.
    pub fn changes(&self) -> bool {
        match self {
            Self::Uniform { values } => values.len() > 1,
            Self::Wave {
                frequency,
                schedule,
                ..
            } => *frequency != 0.0 || !schedule.is_empty(),
        }
    }
}
