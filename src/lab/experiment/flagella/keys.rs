//! The keys of flagella: typed, resolved, and the conversion between them.

use crate::scenario::keys::{
    Angle, AngularVelocity, FINITE, Length, NON_NEGATIVE, OwnTable, POSITIVE, Request, keys,
};
use crate::scenario::{BuilderRod, Material};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The table of this experiment.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<TypedFlagella>(
    "flagella",
    "Number, geometry and drive of the flagella of the experiment \"flagella\".",
)];

/// Maximum number of flagella; larger numbers are taken for typing errors.
const MOST_FLAGELLA: usize = 10_000;
/// Maximum number of nodes of a flagellum.
const MOST_NODES: usize = 1_000_000;

keys! {
    /// Helical flagella at the corners of a regular polygon around the origin, with their axes
    /// along z.
    table TypedFlagella "flagella" {
        /// Number of flagella, at least 1.
        count: raw(i64) raw,
        /// Radius of the helices.
        helix_radius: number(Length, POSITIVE) required,
        /// Pitch of the helices.
        pitch: number(Length, POSITIVE) required,
        /// Length of the helices along their axes, without the hook.
        axial_length: number(Length, POSITIVE) required,
        /// Side of the polygon with the axes at its corners. Not needed for a single flagellum.
        side: number(Length, POSITIVE) required,
        /// Direction from the centre of the polygon to the first axis, as an angle about z (axes
        /// point from head to tip). The angle is measured from the direction in which every helix
        /// begins, seen from its own axis. Default: "180 deg", the first helix begins towards the
        /// centre, as in the released code of the thesis. The angle matters for odd numbers of
        /// flagella; angles that differ by multiples of 360°/count are equivalent.
        orientation: number(Angle, FINITE) default(PI),
        /// Angular velocity of the heads. Positive makes right-handed helices push towards their
        /// heads, as in swimming bacteria, and bundle: the heads then turn clockwise as seen from
        /// the tips.
        angular_velocity: number(AngularVelocity, FINITE) required,
        /// Whether the helix is preceded by a straight inlet of one edge along the axis and a ramp
        /// of two edges at 45°.
        hook: flag() default(true),
        /// Support of the head: "node" (the default: the first node and the frame there) or "edge"
        /// (the second node too, the usual clamp in other codes).
        head: word(Head) default(Head::Node),
    }
}

/// Helical flagella at the corners of a regular polygon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flagella {
    /// Number of flagella M.
    pub count: usize,
    /// Radius of the helices, m.
    pub helix_radius: f64,
    /// Pitch of the helices, m.
    pub pitch: f64,
    /// Length of the helices along their axes, m.
    pub axial_length: f64,
    /// Side of the polygon with the axes at its corners, m.
    pub side: f64,
    /// Direction from the centre to the first axis, measured from the direction in which the
    /// helices begin, rad.
    pub orientation: f64,
    /// Angular velocity of the heads, rad/s.
    pub angular_velocity: f64,
    /// Whether a straight inlet and a ramp lead from the axis to the helix.
    pub hook: bool,
    /// Support of the head.
    pub head: Head,
}

/// Support of the head of a flagellum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Head {
    /// The first node and the material frame there.
    Node,
    /// Both nodes of the first edge and its frame: the usual clamp of other codes.
    Edge,
}

/// Keys that this experiment reads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlagellaTables {
    /// Material of the flagella.
    pub material: Material,
    /// Radius and nodes of each flagellum.
    pub rod: BuilderRod,
    /// Number, geometry and drive.
    pub flagella: Flagella,
}

/// Resolves the tables of this experiment; `None` after a faulty whole number, which is reported.
pub fn resolve(request: &Request<'_>) -> Option<FlagellaTables> {
    let built = request.needs_rod();
    let typed: Option<&TypedFlagella> = request.table("flagella");
    let typed = typed.filter(|_| built)?;
    let section = request.top.below("flagella");
    let count = section.count("count", typed.count, 1..=MOST_FLAGELLA);
    let hook = typed.hook(&section);
    let fewest_nodes = if hook { 8 } else { 5 };
    let built = request.rod(fewest_nodes..=MOST_NODES)?;
    let side = if count == Some(1) {
        section.with_default("side", &typed.side, NON_NEGATIVE, 0.0)
    } else {
        typed.side(&section)
    };
    let helix_radius = typed.helix_radius(&section);
    let pitch = typed.pitch(&section);
    let axial_length = typed.axial_length(&section);
    let orientation = typed.orientation(&section);
    let angular_velocity = typed.angular_velocity(&section);
    Some(FlagellaTables {
        material: built.material,
        rod: built.rod()?,
        flagella: Flagella {
            count: count?,
            helix_radius,
            pitch,
            axial_length,
            side,
            orientation,
            angular_velocity,
            hook,
            head: typed.head(&section),
        },
    })
}
