//! External loads.

use crate::scenario::declaration::keys;
use crate::scenario::section::{NON_NEGATIVE, Section};
use crate::scenario::units::{
    Acceleration, Dimensionless, Force, ForcePerLength, LinearDrag, Moment, SpinDrag,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

keys! {
    /// An external load.
    kinds LoadKeys "load", "kebab-case" => Load()
    before {}
    also {}
    LoadKind {
        /// Weight of every rod.
        Gravity {
            /// Acceleration of free fall, for example [0, 0, -9.81].
            acceleration: vector(Acceleration) required,
        },
        /// A force on a node, or on the centre of mass of a free body.
        Force {
            /// Name of the rod or free body.
            rod: text("the name of a rod") required,
            /// "start", "end", or the number of a node; 0 for the centre of a free body.
            at: place() required,
            /// The force.
            force: vector(Force) required,
            /// "space" (the default: a fixed direction), or "material": components along the two
            /// material directors and the tangent of the rod, so that the load turns with the rod.
            #[serde(skip_serializing_if = "LoadFrame::is_space")]
            frame: word(LoadFrame) default(LoadFrame::Space),
        },
        /// A moment on an edge.
        Moment {
            /// Name of the rod.
            rod: text("the name of a rod") required,
            /// "start", "end", or the number of an edge.
            at: place() required,
            /// The moment.
            moment: vector(Moment) required,
            /// "space" (the default: a fixed direction), or "material": components along the two
            /// material directors and the tangent of the rod, so that the load turns with the rod.
            #[serde(skip_serializing_if = "LoadFrame::is_space")]
            frame: word(LoadFrame) default(LoadFrame::Space),
        },
        /// A force per natural length.
        Distributed {
            /// Name of the rod. Default: all rods.
            rod: text() optional,
            /// Force per length.
            force_per_length: vector(ForcePerLength) required,
            /// "space" (the default: a fixed direction), or "material": components along the two
            /// material directors and the tangent of the rod, so that the load turns with the rod.
            #[serde(skip_serializing_if = "LoadFrame::is_space")]
            frame: word(LoadFrame) default(LoadFrame::Space),
        },
        /// Drag that opposes velocity, spin, or both.
        Drag {
            /// Name of the rod. Default: all rods.
            rod: text() optional,
            /// Coefficient of the velocity per length.
            translation: number(LinearDrag, NON_NEGATIVE) default(0.0),
            /// Coefficient of the spin per length.
            rotation: number(SpinDrag, NON_NEGATIVE) default(0.0),
        },
    }
    after {
        /// Factor at given times, [[time, factor], ...], linear between them. Default: 1 always.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        schedule: corners(Dimensionless) derived(Vec::new()),
    }
}

/// Frame in which the components of a load are constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum LoadFrame {
    /// The frame of the scene: a fixed direction.
    #[default]
    Space,
    /// The material frame of the rod: the load turns with it.
    Material,
}

impl LoadFrame {
    fn is_space(&self) -> bool {
        *self == Self::Space
    }
}

/// Resolves all loads.
pub fn loads(top: &Section<'_>, typed: &[LoadKeys]) -> Vec<Load> {
    let load = |(section, typed): (Section<'_>, &LoadKeys)| {
        if let LoadKeys::Drag {
            translation: None,
            rotation: None,
            ..
        } = typed
        {
            let help = "a drag coefficient of `translation` or `rotation`";
            section.missing("translation", help);
        }
        typed.resolve(&section)
    };
    top.elements("loads", typed).map(load).collect()
}
