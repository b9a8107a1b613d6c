//! Rods in viscous flow.

use super::benchmark::{Benchmark, Measure, Quantity};
use super::filament::RigidHelix;
use super::measured::series;

pub(super) static HELIX_IN_FLOW: Benchmark = Benchmark {
    name: "validation/helix-in-flow",
    title: "Thrust, torque and drag of a rigid helix",
    about: "A rigid helix of three turns, of the radius 1, the pitch 4 and the filament radius 1/16, is turned about its axis at the \
            rate 1 in a fluid of unit viscosity without boundaries, and then moved along its axis at the speed 1. \
            A clamp at its end measures force and torque about the axis. The filament is a line of regularised point \
            forces with ε = 1.65 of its radius, which has the drag of a long cylinder of that radius; the torque of \
            the filament about its own centreline is left out. Thrust of a turning helix and torque of a moving one \
            are equal in theory, by reciprocity.",
    source: "after the helices of Rodenborn, Chen, Swinney, Liu and Zhang 2013, Proc. Natl. Acad. Sci. 110, E338, of the \
             same filament radius over helix radius",
    means: "point forces on the smooth helix, half a regularisation length apart, by a dense solution; at a third of that \
            length the values change by at most 0.05 %",
    scene: include_str!("scenes/helix-in-flow.toml"),
    edges: [60, 120, 240],
    quantities: &[
        resistance("thrust when turned"),
        resistance("torque when turned"),
        resistance("drag when moved"),
        resistance("torque when moved"),
    ],
    exact: || {
        let helix = RigidHelix {
            radius: 1.0,
            pitch: 4.0,
            turns: 3.0,
            regularization: 1.65 / 16.0,
        };
        let [along, coupling, around] = helix.resistances();
        vec![coupling, around, along, coupling]
    },
    measure: Measure::Run(|case| {
        let columns = [
            "time_s",
            "place_x_m",
            "place_y_m",
            "root_force_x_n",
            "root_force_y_n",
            "root_force_z_n",
            "root_moment_z_n_m",
        ];
        let rows = series(case, columns)?;
        // Force along the axis and torque about it, at the end of each half of the run.
        let at = |end: f64| {
            let row = rows.iter().rfind(|row| row[0] < end + 1e-6);
            row.map_or([f64::NAN; 2], |[_, x, y, across, beside, along, moment]| {
                [*along, moment + x * beside - y * across]
            })
        };
        Ok([at(1.0), at(2.0)].concat())
    }),
};

/// A resistance without a published value.
const fn resistance(name: &'static str) -> Quantity {
    Quantity {
        name,
        published: None,
        scale: None,
    }
}
