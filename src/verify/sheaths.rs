//! Rods that are fed out of sheaths, pushed and turned in them.

use super::scenario::moved;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::SpatialCantilever;

const TIP: Expectation = Expectation::new("EI θ″ = −P cos θ", "Kirchhoff rod, multiple shooting");
const PUSHED_OUT: Expectation = Expectation::new(
    "F = −P sin θ",
    "M²/2EI + T along a rod; Bigoni, Dal Corso, Bosi and Misseroni 2015",
);
const PUSHED: Expectation = Expectation::new(
    "work of load and push",
    "energies of stretching, bending and motion",
);
const TORQUE: Expectation = Expectation::new("GJ φ/ℓ", "constant twist");

/// EI and GJ, N m²; load across the end, N; length outside, m.
const BENDING: f64 = 0.01;
const TWISTING: f64 = 0.008;
const LOAD: f64 = 0.5;
const OUTSIDE: f64 = 0.297;
/// Number of steps of the theory.
const STEPS: usize = 400;
/// Place of the mouth, m.
const MOUTH: f64 = 0.4;

/// Checks a rod that bends outside, one that bends itself out, and one that twists.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let simulation = moved(include_str!("scenes/fed_rod.toml"), &[], 6.0)?;
    let tip = *simulation.positions().last().ok_or("the rod has nodes")?;
    let [force, _] = simulation.sheath_force(0);
    let [x, y, sine] = end_outside().ok_or("the rod of the theory has no equilibrium")?;
    let mut checks = vec![
        TIP.of(
            "rod fed out under a load across its end: its end along the sheath",
            "m",
        )
        .scaled(x, tip.x - MOUTH, OUTSIDE, 1e-3),
        TIP.of("the same, across the sheath", "m")
            .scaled(y, tip.y, OUTSIDE, 1e-3),
        PUSHED_OUT
            .of("force of the sheath that holds it back", "N")
            .relative(-LOAD * sine, force, 2e-3),
    ];
    let simulation = moved(include_str!("scenes/pushed_rod.toml"), &[], 0.2)?;
    let tip = *simulation.positions().last().ok_or("the rod has nodes")?;
    let fed = simulation.length_outside(0) - 0.3;
    let work = 0.3 * tip.y - 0.02 * fed;
    checks.push(
        PUSHED
            .of(
                "rod that leaves its sheath by bending, against a push of 0.02 N: energy",
                "J",
            )
            .relative(work, simulation.energies().total(), 2e-3),
    );
    let simulation = moved(include_str!("scenes/turned_rod.toml"), &[], 4.0)?;
    let [_, moment] = simulation.sheath_force(0);
    checks.push(
        TORQUE
            .of("rod drawn in and turned by 8 rad: torque", "N m")
            .relative(TWISTING * 8.0 / (0.3 - 0.043), moment, 1e-6),
    );
    Ok(checks)
}

/// End of the part outside along and across the sheath, m, and the sine of its angle there.
fn end_outside() -> Option<[f64; 3]> {
    let outside = SpatialCantilever {
        length: OUTSIDE,
        stiffness: [BENDING, BENDING, TWISTING],
        stretching: 1e6,
        natural: |_| [0.0; 3],
        director: Vector3::y(),
        tangent: Vector3::x(),
        load_per_length: Vector3::zeros(),
        end_force: Vector3::y() * LOAD,
        end_moment: Vector3::zeros(),
    };
    let points = outside.points(STEPS)?;
    let [.., before, end] = points[..] else {
        return None;
    };
    Some([end.x, end.y, (end - before).normalize().y])
}
