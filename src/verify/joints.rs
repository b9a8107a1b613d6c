//! Joints and bodies, through scenario files: frames against beam theory, pendulums and a heavy disk against their frequencies,
//! a net and a gridshell against their symmetry; slides, and bodies whose centre is off
//! their node, are files of their own.

use super::frequencies::frequencies;
use super::{Check, Expectation, GroupError, bodies, slides};
use nalgebra::{DMatrix, Matrix2};
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::{Vector3, scene::Scene};
use rodlab_lab::experiment;
use rodlab_lab::run::PreparedRun;
use std::fmt::Write;
use std::path::Path;

const PORTAL: Expectation = Expectation {
    formula: "Δ = P H³ (2+3k)/12EI(1+6k), k = H/L",
    source: "slope–deflection",
};
const HINGED_PORTAL: Expectation = Expectation {
    formula: "Δ = P H³/6EI",
    source: "Euler–Bernoulli",
};
const RIGID_STAR: Expectation = Expectation {
    formula: "w = P L³/36EI",
    source: "Euler–Bernoulli",
};
const BALL_STAR: Expectation = Expectation {
    formula: "w = P L³/9EI",
    source: "Euler–Bernoulli",
};
const CROSS: Expectation = Expectation {
    formula: "w = P b² L/2GJ + P b³/3EI",
    source: "Saint-Venant, Euler–Bernoulli",
};
const ORDER: Expectation = Expectation {
    formula: "log₂(error at N / error at 2N)",
    source: "second order",
};
const PENDULUM: Expectation = Expectation {
    formula: "det(K − ω² M) = 0 of two rigid rods",
    source: "Lagrange",
};
const DISK: Expectation = Expectation {
    formula: "det(K − ω² diag(M, I)) = 0",
    source: "Euler–Bernoulli",
};
const KEPT: Expectation = Expectation {
    formula: "E(t) = E(0)",
    source: "conservation",
};
const MIRRORED: Expectation = Expectation {
    formula: "z(x, y) = z(−x, y) = z(x, −y) = z(y, x)",
    source: "symmetry",
};

/// Rods of the frames: length (m), radius (m), EI = 1e-3 N m² and GJ = ⅔ EI with Poisson's ratio one half.
const LENGTH: f64 = 0.2;
const RADIUS: f64 = 1e-3;
const BENDING: f64 = 1e-3;
const TWISTING: f64 = 2.0 / 3.0 * BENDING;
/// Load, N: so small that beam theory is linear.
const FORCE: f64 = 1e-5;
/// Bound of all of them with 50 edges a rod.
const BOUND: f64 = 1e-3;

/// Frames under end loads, pendulums, a disk, nets, slides.
pub fn checks(full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    let stiff = LENGTH.powi(3) / BENDING;
    let portal = FORCE * stiff * 5.0 / 84.0;
    let off = |edges: usize| Ok::<_, GroupError>(portal_sway(edges, "rigid")? / portal - 1.0);
    checks.push(PORTAL.relative(
        "portal frame, rigid joints, H = L: sway",
        "m",
        portal,
        portal_sway(50, "rigid")?,
        BOUND,
    ));
    let order = libm::log2(off(10)? / off(20)?);
    checks.push(ORDER.scaled(
        "portal frame, 10 to 20 edges: order",
        "",
        2.0,
        order,
        1.0,
        0.2,
    ));
    checks.push(HINGED_PORTAL.relative(
        "portal frame, beam on two hinges: sway",
        "m",
        FORCE * stiff / 6.0,
        portal_sway(50, "hinge")?,
        BOUND,
    ));
    for (kind, expectation, parts) in [("rigid", RIGID_STAR, 36.0), ("ball", BALL_STAR, 9.0)] {
        checks.push(expectation.relative(
            format!("Y-junction of three clamped rods, {kind} joints: sag under a load"),
            "m",
            FORCE * stiff / parts,
            star_sag(50, kind)?,
            BOUND,
        ));
    }
    let arm: f64 = 0.5 * LENGTH;
    checks.push(CROSS.relative(
        "cross, rigid joint, a pair of forces at the ends of one rod twists the other: deflection",
        "m",
        FORCE * (arm * arm * LENGTH / (2.0 * TWISTING) + arm.powi(3) / (3.0 * BENDING)),
        cross_deflection(50)?,
        BOUND,
    ));
    checks.extend(double_pendulum()?);
    checks.extend(disk()?);
    checks.push(net(if full { 20 } else { 8 })?);
    checks.push(gridshell()?);
    checks.extend(bodies::checks()?);
    checks.extend(slides::checks()?);
    Ok(checks)
}

/// A scene of straight rods with what follows them in the file.
fn scene_of(rods: &[(&str, [f64; 3], [f64; 3])], edges: usize, rest: &str) -> String {
    let youngs_modulus = BENDING / (std::f64::consts::PI * RADIUS.powi(4) / 4.0);
    let mut text = format!(
        "experiment = \"scene\"\n[material]\nyoungs_modulus = {youngs_modulus:?}\npoissons_ratio = 0.5\ndensity = 1000.0\n"
    );
    for (name, start, end) in rods {
        writeln!(
            text,
            "[[rods]]\nname = \"{name}\"\nradius = {RADIUS:?}\nedges = {edges}\nshape = {{ kind = \"straight\", start = {start:?}, end = {end:?} }}"
        )
        .expect("writing to a string");
    }
    text + rest
}

fn prepared(text: &str) -> Result<PreparedRun, GroupError> {
    let loaded = experiment::from_text("scene", text, Path::new(""), &[])?;
    Ok(experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?)
}

/// The equilibrium of a scene.
fn at_rest(text: &str) -> Result<Simulation, GroupError> {
    let prepared = prepared(text)?;
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
    simulation.find_equilibrium()?;
    Ok(simulation)
}

/// How far a node has moved from where it was placed.
fn moved(simulation: &Simulation, scene: &Scene, rod: usize, node: usize) -> Vector3 {
    let first: usize = scene.rods[..rod]
        .iter()
        .map(|rod| rod.centreline.len())
        .sum();
    simulation.positions()[first + node] - scene.rods[rod].centreline[node]
}

fn portal_sway(edges: usize, joint: &str) -> Result<f64, GroupError> {
    let axis = if joint == "hinge" {
        "axis = [0, 1, 0]\n"
    } else {
        ""
    };
    let rods = [
        ("left", [0.0; 3], [0.0, 0.0, LENGTH]),
        ("beam", [0.0, 0.0, LENGTH], [LENGTH, 0.0, LENGTH]),
        ("right", [LENGTH, 0.0, 0.0], [LENGTH, 0.0, LENGTH]),
    ];
    let rest = format!(
        "[[clamps]]\nrod = \"left\"\nat = \"start\"\n[[clamps]]\nrod = \"right\"\nat = \"start\"\n\
         [[joints]]\nkind = \"{joint}\"\nrods = [\"left\", \"beam\"]\nat = [\"end\", \"start\"]\n{axis}\
         [[joints]]\nkind = \"{joint}\"\nrods = [\"right\", \"beam\"]\nat = [\"end\", \"end\"]\n{axis}\
         [[loads]]\nkind = \"force\"\nrod = \"left\"\nat = \"end\"\nforce = [{FORCE:?}, 0, 0]\n[time]\nmode = \"static\"\n"
    );
    let text = scene_of(&rods, edges, &rest);
    let simulation = at_rest(&text)?;
    Ok(moved(&simulation, &prepared(&text)?.scene, 0, edges).x)
}

fn star_sag(edges: usize, joint: &str) -> Result<f64, GroupError> {
    let arm = |turn: f64| {
        let angle = std::f64::consts::TAU * turn;
        [LENGTH * libm::cos(angle), LENGTH * libm::sin(angle), 0.0]
    };
    let rods = [
        ("a", arm(0.0), [0.0; 3]),
        ("b", arm(1.0 / 3.0), [0.0; 3]),
        ("c", arm(2.0 / 3.0), [0.0; 3]),
    ];
    let mut rest = String::new();
    for rod in ["a", "b", "c"] {
        write!(rest, "[[clamps]]\nrod = \"{rod}\"\nat = \"start\"\n")?;
    }
    for rod in ["b", "c"] {
        write!(
            rest,
            "[[joints]]\nkind = \"{joint}\"\nrods = [\"a\", \"{rod}\"]\nat = [\"end\", \"end\"]\n"
        )?;
    }
    write!(
        rest,
        "[[loads]]\nkind = \"force\"\nrod = \"b\"\nat = \"end\"\nforce = [0, 0, {:?}]\n[time]\nmode = \"static\"\n",
        -FORCE
    )?;
    let text = scene_of(&rods, edges, &rest);
    let simulation = at_rest(&text)?;
    Ok(-moved(&simulation, &prepared(&text)?.scene, 0, edges).z)
}

/// Deflection of the end of a rod that is welded across the middle of a clamped one.
fn cross_deflection(edges: usize) -> Result<f64, GroupError> {
    let half = 0.5 * LENGTH;
    let rods = [
        ("axle", [0.0, -half, 0.0], [0.0, half, 0.0]),
        ("lever", [-half, 0.0, 0.0], [half, 0.0, 0.0]),
    ];
    let rest = format!(
        "[[clamps]]\nrod = \"axle\"\nat = \"start\"\n[[clamps]]\nrod = \"axle\"\nat = \"end\"\n\
         [[joints]]\nkind = \"rigid\"\nrods = [\"axle\", \"lever\"]\nat = [{0}, {0}]\n\
         [[loads]]\nkind = \"force\"\nrod = \"lever\"\nat = \"end\"\nforce = [0, 0, {FORCE:?}]\n\
         [[loads]]\nkind = \"force\"\nrod = \"lever\"\nat = \"start\"\nforce = [0, 0, {1:?}]\n[time]\nmode = \"static\"\n",
        edges / 2,
        -FORCE
    );
    let text = scene_of(&rods, edges, &rest);
    let simulation = at_rest(&text)?;
    Ok(moved(&simulation, &prepared(&text)?.scene, 1, edges).z)
}

/// Two stiff rods that hang from a hinge and from each other: frequencies, and energy in a wide swing.
fn double_pendulum() -> Result<Vec<Check>, GroupError> {
    let gravity = 9.81;
    let rest = |time: &str| {
        format!(
            "[[clamps]]\nrod = \"upper\"\nat = \"start\"\nhold = \"position\"\n\
             [[joints]]\nkind = \"ball\"\nrods = [\"upper\", \"lower\"]\nat = [\"end\", \"start\"]\n\
             [[loads]]\nkind = \"gravity\"\nacceleration = [0, 0, {:?}]\n[time]\n{time}\n",
            -gravity
        )
    };
    let hanging = [
        ("upper", [0.0; 3], [0.0, 0.0, -LENGTH]),
        ("lower", [0.0, 0.0, -LENGTH], [0.0, 0.0, -2.0 * LENGTH]),
    ];
    // Spin about their own axes costs no energy: what is soft there is left out by a little drag of the static state.
    let text = scene_of(&hanging, 20, &rest("mode = \"static\""))
        .replace("density = 1000.0", "density = 10.0");
    let mut simulation = at_rest(&text)?;
    let found = swinging(&mut simulation)?;
    // With λ = ω² l/g of two uniform rods: (3/2 − 4λ/3)(1/2 − λ/3) = λ²/4.
    let (a, b, c): (f64, f64, f64) = (7.0 / 36.0, -7.0 / 6.0, 0.75);
    let root = (b * b - 4.0 * a * c).sqrt();
    let mut checks = Vec::new();
    for (mode, sign) in [(1, -1.0), (2, 1.0)] {
        let square = (-b + sign * root) / (2.0 * a);
        checks.push(PENDULUM.relative(
            format!("double pendulum of stiff rods in a ball joint, mode {mode}: ω"),
            "rad/s",
            (square * gravity / LENGTH).sqrt(),
            found[2 * mode - 2],
            BOUND,
        ));
    }
    let raised = [
        ("upper", [0.0; 3], [LENGTH, 0.0, 0.0]),
        ("lower", [LENGTH, 0.0, 0.0], [LENGTH, LENGTH, 0.0]),
    ];
    let time = "scheme = \"implicit-midpoint\"\nstep = 2e-4\nend = 1.0";
    let prepared = prepared(&scene_of(&raised, 10, &rest(time)))?;
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
    let total = |simulation: &Simulation| {
        let energies = simulation.energies();
        energies.total()
    };
    let (start, mut kinetic, mut worst) = (total(&simulation), 0.0_f64, 0.0_f64);
    while simulation.time() < 1.0 {
        simulation.advance(1.0)?;
        kinetic = kinetic.max(simulation.energies().kinetic);
        worst = worst.max((total(&simulation) - start).abs());
    }
    checks.push(KEPT.scaled(
        "double pendulum, wide swing for 1 s, midpoint rule: energy gained or lost, of the largest kinetic energy",
        "J",
        0.0,
        worst,
        kinetic,
        1e-3,
    ));
    Ok(checks)
}

/// Frequencies of the modes in which rods swing, in pairs of equal ones; they spin about themselves without any stiffness.
fn swinging(simulation: &mut Simulation) -> Result<Vec<f64>, GroupError> {
    let stiffness = simulation.stiffness_matrix();
    let scale = stiffness.amax();
    let unknowns = simulation.free_unknowns();
    // What twists the rods against nothing is held by a weak spring, far above the pendulum's frequencies.
    let spring = |k: usize| {
        if unknowns[k] % 4 == 3 {
            1e-6 * scale
        } else {
            0.0
        }
    };
    let held = DMatrix::from_fn(unknowns.len(), unknowns.len(), |i, j| {
        stiffness[(i, j)] + if i == j { spring(i) } else { 0.0 }
    });
    let factor = held.cholesky().ok_or("not stable")?.unpack();
    let half = factor
        .solve_lower_triangular(&simulation.mass_matrix())
        .ok_or("not stable")?;
    let matrix = factor
        .solve_lower_triangular(&half.transpose())
        .ok_or("not stable")?;
    let eigenvalues = matrix.symmetric_eigenvalues();
    let mut all: Vec<f64> = eigenvalues
        .iter()
        .map(|inverse| 1.0 / inverse.max(0.0).sqrt())
        .collect();
    all.sort_by(f64::total_cmp);
    Ok(all)
}

/// A heavy disk at the end of a cantilever without mass of its own: frequencies, and its motion after an impulse.
fn disk() -> Result<Vec<Check>, GroupError> {
    let (mass, radius): (f64, f64) = (0.1, 0.03);
    let inertia = 0.25 * mass * radius * radius;
    let rods = [("rod", [0.0; 3], [LENGTH, 0.0, 0.0])];
    let rest = |time: &str| {
        format!(
            "[[clamps]]\nrod = \"rod\"\nat = \"start\"\n\
             [[bodies]]\nrod = \"rod\"\nat = \"end\"\nmass = {mass:?}\nshape = {{ kind = \"disk\", radius = {radius:?} }}\n\
             [time]\n{time}\n"
        )
    };
    let light = |text: String| text.replace("density = 1000.0", "density = 0.1");
    let mut simulation = at_rest(&light(scene_of(&rods, 40, &rest("mode = \"static\""))))?;
    let found = frequencies(&mut simulation)?;
    let stiffness = Matrix2::new(12.0, -6.0 * LENGTH, -6.0 * LENGTH, 4.0 * LENGTH * LENGTH)
        * (BENDING / LENGTH.powi(3));
    let scales = [1.0 / mass.sqrt(), 1.0 / inertia.sqrt()];
    let scaled = Matrix2::from_fn(|i, j| stiffness[(i, j)] * scales[i] * scales[j]);
    let eigen = scaled.symmetric_eigen();
    let mut theory: Vec<f64> = eigen
        .eigenvalues
        .iter()
        .map(|square| square.sqrt())
        .collect();
    theory.sort_by(f64::total_cmp);
    let near = |expected: f64| {
        let differences = found.iter().copied();
        differences.min_by(|a, b| (a - expected).abs().total_cmp(&(b - expected).abs()))
    };
    let mut checks = Vec::new();
    for (mode, expected) in theory.iter().enumerate() {
        checks.push(DISK.relative(
            format!("heavy disk on a cantilever, bending mode {}: ω", mode + 1),
            "rad/s",
            *expected,
            near(*expected).unwrap_or(f64::NAN),
            BOUND,
        ));
    }
    // Thrown sideways with a small velocity it moves as the sum of both modes.
    let (speed, end) = (1e-3, std::f64::consts::TAU / theory[0] * 3.2);
    let time = format!(
        "scheme = \"backward-differences\"\nstep = {:?}\nend = {end:?}",
        end / 4000.0
    );
    let text = light(scene_of(&rods, 40, &rest(&time)));
    let mut prepared = prepared(&text)?;
    prepared.scene.rods[0].velocity = Vector3::new(0.0, speed, 0.0);
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
    while simulation.time() < end {
        simulation.advance(end)?;
    }
    let expected: f64 = (0..2)
        .map(|k| {
            let frequency = eigen.eigenvalues[k].sqrt();
            let part = eigen.eigenvectors[(0, k)];
            speed * part * part * libm::sin(frequency * end) / frequency
        })
        .sum();
    checks.push(DISK.scaled(
        "heavy disk, thrown sideways: deflection after 3.2 periods, of its amplitude",
        "m",
        expected,
        moved(&simulation, &prepared.scene, 0, 40).y,
        speed / theory[0],
        3e-3,
    ));
    Ok(checks)
}

/// A flat lattice whose corners are pushed towards each other: how far the dome is from symmetric, of its height.
fn gridshell() -> Result<Check, GroupError> {
    let (rods, half) = (5, 0.5 * LENGTH);
    let text = format!(
        "experiment = \"scene\"\n[material]\nyoungs_modulus = \"1 GPa\"\npoissons_ratio = 0.3\ndensity = 1000.0\n\
         [[networks]]\nname = \"shell\"\nrod = {{ radius = {RADIUS:?}, edges = 3 }}\n\
         shape = {{ kind = \"grid\", corner = [{0:?}, {0:?}, 0], sides = [[{LENGTH:?}, 0, 0], [0, {LENGTH:?}, 0]], rods = [{rods}, {rods}] }}\n\
         boundary = {{ ends = \"corners\", scale = [[0.2, 1], [1, 0.9]] }}\n\
         [[loads]]\nkind = \"distributed\"\nforce_per_length = [0, 0, 0.05]\n\
         [[loads]]\nkind = \"drag\"\ntranslation = 0.1\n[time]\nstep = 2e-3\nend = 1.0\n",
        -half
    );
    let prepared = prepared(&text)?;
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
    while simulation.time() < 1.0 {
        simulation.advance(1.0)?;
    }
    simulation.find_equilibrium()?;
    let (worst, height) = asymmetry(&simulation, rods, 3 * (rods - 1) + 1);
    if height < 0.1 * LENGTH {
        return Err(format!("the lattice rose by {height} m only").into());
    }
    Ok(MIRRORED.scaled(
        "gridshell of 5 × 5 laths from a flat lattice, corners pushed in by 10 %: asymmetry, of its height",
        "m",
        0.0,
        worst,
        height,
        1e-9,
    ))
}

/// Largest difference of heights (m) at places of a square grid that its symmetry makes the same, and the largest height.
fn asymmetry(simulation: &Simulation, rods: usize, nodes: usize) -> (f64, f64) {
    let height = |rod: usize, node: usize| simulation.positions()[rod * nodes + node].z;
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for rod in 0..rods {
        for node in 0..nodes {
            let own = height(rod, node);
            largest = largest.max(own.abs());
            let others = [
                height(rod, nodes - 1 - node),
                height(rods - 1 - rod, node),
                // The same place of the other family, mirrored in the diagonal.
                height(rods + rod, node),
            ];
            for other in others {
                worst = worst.max((own - other).abs());
            }
        }
    }
    (worst, largest)
}

/// A square net of balls under its weight, held at its corners: how far it is from symmetric, of its sag.
fn net(rods: usize) -> Result<Check, GroupError> {
    let half = 0.5 * LENGTH;
    let text = format!(
        "experiment = \"scene\"\n[material]\nyoungs_modulus = \"1 MPa\"\npoissons_ratio = 0.5\ndensity = 1000.0\n\
         [[networks]]\nname = \"net\"\nrod = {{ radius = {RADIUS:?}, edges = 2 }}\n\
         shape = {{ kind = \"grid\", corner = [{0:?}, {0:?}, 0], sides = [[{LENGTH:?}, 0, 0], [0, {LENGTH:?}, 0]], rods = [{rods}, {rods}] }}\n\
         boundary = {{ ends = \"corners\" }}\n\
         [[loads]]\nkind = \"gravity\"\nacceleration = [0, 0, -9.81]\n[time]\nmode = \"static\"\n",
        -half
    );
    let simulation = at_rest(&text)?;
    let (worst, sag) = asymmetry(&simulation, rods, 2 * (rods - 1) + 1);
    Ok(MIRRORED.scaled(
        format!(
            "net of {rods} × {rods} rods in ball joints under its weight: asymmetry, of its sag"
        ),
        "m",
        0.0,
        worst,
        sag,
        1e-9,
    ))
}
