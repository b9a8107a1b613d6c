//! The keys of flagella: as typed, as resolved, and the conversion between them.

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

/// Most flagella that a scenario may have; more are taken for a typing error.
const MOST_FLAGELLA: usize = 10_000;
/// Most nodes of one flagellum.
const MOST_NODES: usize = 1_000_000;

keys! {
    /// Helical flagella on the corners of a regular polygon around the origin, their axes along z.
    table TypedFlagella "flagella" {
        /// Number of flagella, at least 1.
        count: raw(i64) raw,
        /// Radius of the helices.
        helix_radius: number(Length, POSITIVE) required,
        /// Pitch of the helices.
        pitch: number(Length, POSITIVE) required,
        /// Length of the helices along their axes, without the hook.
        axial_length: number(Length, POSITIVE) required,
        /// Side of the polygon on whose corners the axes are. Not needed for a single flagellum.
        side: number(Length, POSITIVE) required,
        /// Direction of the first axis from the centre of the polygon, an angle about z (axes point from head to tip) from the
        /// direction in which every helix begins, seen from its own axis. Default: "180 deg", the first helix begins towards the
        /// centre, as in the released code of the thesis. It matters for odd numbers of flagella; multiples of 360°/count are alike.
        orientation: number(Angle, FINITE) default(PI),
        /// Rate of turning of the heads. Positive makes right-handed helices push towards their heads, as
        /// bacteria swim, and bundle: the heads then turn clockwise seen from the tips.
        angular_velocity: number(AngularVelocity, FINITE) required,
        /// Whether a straight inlet of one edge along the axis and a ramp of two edges at 45° lead to the
        /// helix.
        hook: flag() default(true),
        /// Support of the head: "node" (the default: the first node and the frame there) or "edge" (the
        /// second node too, the usual clamp of other codes).
        head: word(Head) default(Head::Node),
    }
}

/// Helical flagella on the corners of a regular polygon.
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
    /// Side of the polygon on whose corners the axes are, m.
    pub side: f64,
    /// Direction of the first axis from the centre of the polygon, from that in which the helices begin, rad.
    pub orientation: f64,
    /// Rate of turning of the heads, rad/s.
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

/// Everything that this experiment reads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlagellaTables {
    /// Material of the flagella.
    pub material: Material,
    /// Radius and nodes of each flagellum.
    pub rod: BuilderRod,
    /// Number, geometry and drive.
    pub flagella: Flagella,
}

/// Resolves the tables of this experiment; `None` if a whole number is at fault, which is reported.
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
