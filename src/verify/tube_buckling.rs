//! Rods that are pushed into a horizontal tube: onset of snaking, from continuation and from a
//! slow push, and the push at which a helix has the energy of the straight rod.

use super::continuation::critical_on_path;
use super::scenario::{prepared, simulation};
use super::theory::tube::{EVEN_HELIX, SNAKE, uneven_helix};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_lab::run::{Mode, PreparedRun};
use std::f64::consts::TAU;

const SNAKING: Expectation = Expectation::new("F = 2 √(EI w/r)", "Dawson and Paslay 1984");
const COILING: Expectation = Expectation::new("F = 2√2 √(EI w/r)", "Chen, Lin and Cheatham 1990");
const UNEVEN: Expectation = Expectation::new(
    "½ k⁴ − ½ f k² + 1 = 1/(28 k⁴ − 4 f k²)",
    "energy of θ = kx + a sin kx",
);

/// Amplitude of the snake relative to the clearance at which the rod counts as snaking: fifty
/// times the tilt of the tube.
const SEEN: f64 = 0.05;
/// Allowed relative error: the push grows by 2 % while the snake grows from the tilt of the tube,
/// and by less if the rod is pushed more slowly.
const LATE: f64 = 5e-2;
/// Allowed relative error: a uniform helix needs a push that is 1.3 % larger than that of a helix
/// which turns faster near the top.
const EVEN: f64 = 2e-2;

/// Checks the pushes in three files.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = vec![snake_on_path()?, snake_in_time()?];
    checks.extend(helix()?);
    Ok(checks)
}

/// A rod from a file and its tube.
struct RodInTube {
    /// EI, N m².
    bending: f64,
    /// EA, N.
    stretching: f64,
    /// w, N/m.
    weight: f64,
    /// r, m.
    clearance: f64,
}

impl RodInTube {
    fn of(prepared: &PreparedRun) -> Self {
        let rod = &prepared.scene.rods[0];
        Self {
            bending: rod.stiffness.bending[0],
            stretching: rod.stiffness.stretching,
            weight: 9.81 * rod.mass_per_length,
            clearance: prepared.scene.obstacles[0].body.radius - rod.radius,
        }
    }

    /// Unit of push √(EI w/r), N.
    fn push(&self) -> f64 {
        (self.bending * self.weight / self.clearance).sqrt()
    }

    /// Unit of length (EI r/w)^¼, m.
    fn length(&self) -> f64 {
        (self.bending * self.clearance / self.weight).sqrt().sqrt()
    }
}

/// Bifurcation of the path of the straight rod.
fn snake_on_path() -> Result<Check, GroupError> {
    let prepared = prepared(include_str!("scenes/tube.toml"), &[])?;
    let rod = RodInTube::of(&prepared);
    // At the end of the path, at parameter 1, the rod of a metre is shortened by a millimetre.
    let shortening = 1e-3 * critical_on_path(&prepared.scene, 1.0)?;
    let name =
        "rod pushed into a horizontal tube: push at which it begins to snake, by continuation";
    let expected = SNAKE * rod.push();
    let got = rod.stretching * shortening;
    Ok(SNAKING.of(name, "N").relative(expected, got, 5e-3))
}

/// The largest push of a rod before snaking is detected.
fn snake_in_time() -> Result<Check, GroupError> {
    let text = include_str!("scenes/snake_in_tube.toml");
    let rod = RodInTube::of(&prepared(text, &[])?);
    let mut simulation = simulation(text, &[])?;
    let swing = |simulation: &Simulation| {
        let sideways = simulation.positions().iter().map(|x| x.y.abs());
        sideways.fold(0.0, f64::max) / rod.clearance
    };
    let mut largest = 0.0;
    while simulation.time() < 4.0 && swing(&simulation) < SEEN {
        simulation.advance(4.0)?;
        largest = f64::max(largest, simulation.reaction(0).x);
    }
    let seen = swing(&simulation) >= SEEN;
    let name = "rod pushed slowly into a horizontal tube: largest push before snaking is detected";
    let expected = SNAKE * rod.push();
    let got = if seen { largest } else { f64::NAN };
    Ok(SNAKING.of(name, "N").relative(expected, got, LATE))
}

/// The push at which a helix, unloaded along equilibria, has the energy of the straight rod.
fn helix() -> Result<[Check; 2], GroupError> {
    let prepared = prepared(include_str!("scenes/helix_in_tube.toml"), &[])?;
    let rod = RodInTube::of(&prepared);
    let Mode::Continuation(plan) = prepared.mode else {
        return Err("the file has no path of equilibria".into());
    };
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
    let mut tracer = simulation.path(plan)?;
    let mut found = [f64::NAN; 2];
    let mut before: Option<[f64; 3]> = None;
    while let Some(point) = simulation.next_point(&mut tracer)? {
        let middle = MiddleTurns::of(&simulation, &prepared, &rod);
        let here = [middle.energy, middle.push, middle.wave_number];
        if let Some([energy, push, wave_number]) = before
            && energy * middle.energy <= 0.0
            && point.negative == 0
        {
            let part = energy / (energy - middle.energy);
            found = [(push, middle.push), (wave_number, middle.wave_number)]
                .map(|(from, to)| from + part * (to - from));
            break;
        }
        before = Some(here);
    }
    let [push, wave_number] = found;
    let uneven = if wave_number.is_finite() {
        uneven_helix(wave_number * rod.length())
    } else {
        f64::NAN
    };
    let name = "rod coiled in a horizontal tube: push at which it has the energy of a straight one, by continuation";
    let coiling = EVEN_HELIX * rod.push();
    let ratio = push / (uneven * rod.push());
    Ok([
        COILING.of(name, "N").relative(coiling, push, EVEN),
        UNEVEN
            .of(
                "the same push over that of an uneven helix of its wave number",
                "",
            )
            .relative(1.0, ratio, 3e-3),
    ])
}

/// One turn on each side of the middle of a helix, where its ends have no effect.
struct MiddleTurns {
    /// Push along the tube, N.
    push: f64,
    /// Energy in excess of that of the straight rod under the same push, J.
    energy: f64,
    /// k, 1/m.
    wave_number: f64,
}

impl MiddleTurns {
    fn of(simulation: &Simulation, prepared: &PreparedRun, rod: &RodInTube) -> Self {
        let nodes = simulation.positions();
        let description = &prepared.scene.rods[0];
        let placed = description.centreline.windows(2);
        let lengths = description.relaxed(placed.map(|x| (x[1] - x[0]).norm()).collect());
        let push = simulation.reaction(0).x;
        let curvature = |node: usize| {
            let [before, after] = [node - 1, node].map(|k| (nodes[k + 1] - nodes[k]).normalize());
            let turned = (after - before).norm() / (0.5 * (after + before).norm());
            turned / (0.5 * (lengths[node - 1] + lengths[node]))
        };
        // Angle about the axis of the tube from one node to the next.
        let turn = |from: &Vector3, to: &Vector3| {
            libm::atan2(from.y * to.z - from.z * to.y, from.y * to.y + from.z * to.z)
        };
        let strain = -push / rod.stretching;
        let straight = 0.5 * rod.stretching * strain * strain + push * strain;
        let middle = nodes.len() / 2;
        let mut sums = [0.0; 2];
        let either_side: [Vec<usize>; 2] = [
            (middle..nodes.len() - 2).collect(),
            (1..middle).rev().collect(),
        ];
        for edges in either_side {
            let mut angle = 0.0;
            for edge in edges {
                let [start, end] = [nodes[edge], nodes[edge + 1]];
                let length = lengths[edge];
                let stretch = (end - start).norm() / length - 1.0;
                let bent = curvature(edge).powi(2) + curvature(edge + 1).powi(2);
                let lifted = 0.5 * (start.z + end.z) + rod.clearance;
                let advance = end.x - start.x;
                let energy = length
                    * (0.5 * rod.stretching * stretch * stretch
                        + 0.25 * rod.bending * bent
                        + rod.weight * lifted
                        - straight)
                    + push * (advance - length);
                let turned = turn(&start, &end).abs();
                // Weight of the edge: zero beyond the turn, and a fraction at its end.
                let part = ((TAU - angle) / turned).clamp(0.0, 1.0);
                sums[0] += part * energy;
                sums[1] += part * advance;
                angle += turned;
            }
        }
        Self {
            push,
            energy: sums[0],
            wave_number: 2.0 * TAU / sums[1],
        }
    }
}
