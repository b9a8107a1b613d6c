//! Joints and bodies: frames against beam theory, pendulums and a heavy disk against their
//! frequencies, a net and a gridshell against their symmetry. Slides, and bodies with their centre
//! away from their node, are in separate files.

use super::check::order;
use super::frequencies::{ascending, frequencies, frequencies_of, nearest};
use super::rods::{clamp, force_on, gravity, line, run, run_until, steady, steps_of};
use super::scenario::built;
use super::{Check, Expectation, GroupError, bodies, slides};
use nalgebra::{DMatrix, Matrix2};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{
    IntegrationParameters, Scheme, Simulation, SimulationError,
};
use rodlab_engine::mechanics::scene::{
    Body, Clamp, Inertia, Joint, JointKind, LoadKind, RodDescription, RodNode, Scene, Stiffness,
    Strength,
};
use std::f64::consts::{PI, TAU};
use toml::{Table, toml};

const PORTAL: Expectation =
    Expectation::new("Δ = P H³ (2+3k)/12EI(1+6k), k = H/L", "slope–deflection");
const HINGED_PORTAL: Expectation = Expectation::new("Δ = P H³/6EI", "Euler–Bernoulli");
const RIGID_STAR: Expectation = Expectation::new("w = P L³/36EI", "Euler–Bernoulli");
const BALL_STAR: Expectation = Expectation::new("w = P L³/9EI", "Euler–Bernoulli");
const CROSS: Expectation =
    Expectation::new("w = P b² L/2GJ + P b³/3EI", "Saint-Venant, Euler–Bernoulli");
const PENDULUM: Expectation = Expectation::new("det(K − ω² M) = 0 of two rigid rods", "Lagrange");
const DISK: Expectation = Expectation::new("det(K − ω² diag(M, I)) = 0", "Euler–Bernoulli");
const KEPT: Expectation = Expectation::new("E(t) = E(0)", "conservation");
const MIRRORED: Expectation =
    Expectation::new("z(x, y) = z(−x, y) = z(x, −y) = z(y, x)", "symmetry");

/// Length of the rods of the frames, m.
const LENGTH: f64 = 0.2;
/// Radius of the rods, m.
const RADIUS: f64 = 1e-3;
/// Bending stiffness EI, N m².
const BENDING: f64 = 1e-3;
/// Twisting stiffness GJ, N m²: ⅔ EI with Poisson's ratio one half.
const TWISTING: f64 = 2.0 / 3.0 * BENDING;
/// Load, N; small enough for linear beam theory.
const FORCE: f64 = 1e-5;
/// Bound of the relative errors with 50 edges per rod.
const BOUND: f64 = 1e-3;

/// Checks frames under end loads, pendulums, a disk, nets and slides.
pub fn checks(full: bool) -> Result<Vec<Check>, GroupError> {
    let stiff = LENGTH.powi(3) / BENDING;
    let portal = FORCE * stiff * 5.0 / 84.0;
    let off =
        |edges: usize| Ok::<_, GroupError>(portal_sway(edges, JointKind::Rigid)? / portal - 1.0);
    let hinge = JointKind::Hinge {
        axis: Vector3::y(),
        spring: None,
    };
    let mut checks = vec![
        PORTAL
            .of("portal frame, rigid joints, H = L: sway", "m")
            .relative(portal, portal_sway(50, JointKind::Rigid)?, BOUND),
        order("portal frame, 10 to 20 edges: order", off(10)? / off(20)?),
        HINGED_PORTAL
            .of("portal frame, beam on two hinges: sway", "m")
            .relative(FORCE * stiff / 6.0, portal_sway(50, hinge)?, BOUND),
    ];
    for (name, kind, expectation, parts) in [
        ("rigid", JointKind::Rigid, RIGID_STAR, 36.0),
        ("ball", JointKind::Ball, BALL_STAR, 9.0),
    ] {
        let name = format!("Y-junction of three clamped rods, {name} joints: sag under a load");
        let (expected, got) = (FORCE * stiff / parts, star_sag(50, kind)?);
        checks.push(expectation.of(name, "m").relative(expected, got, BOUND));
    }
    let arm: f64 = 0.5 * LENGTH;
    let name =
        "cross, rigid joint, a pair of forces at the ends of one rod twists the other: deflection";
    let expected = FORCE * (arm * arm * LENGTH / (2.0 * TWISTING) + arm.powi(3) / (3.0 * BENDING));
    let got = cross_deflection(50)?;
    checks.push(CROSS.of(name, "m").relative(expected, got, BOUND));
    checks.extend(double_pendulum()?);
    checks.extend(disk()?);
    checks.push(net(if full { 20 } else { 8 })?);
    checks.push(gridshell()?);
    checks.extend(bodies::checks()?);
    checks.extend(slides::checks()?);
    Ok(checks)
}

/// A straight rod of the frames with the given density, kg/m³.
fn bar(start: Vector3, end: Vector3, edges: usize, density: f64) -> RodDescription {
    let section = PI * RADIUS * RADIUS;
    let stiffness = Stiffness::circular(4.0 * BENDING / (section * RADIUS * RADIUS), 0.5, RADIUS);
    let nodes = line(start, end, edges);
    RodDescription {
        inertia: Inertia::Consistent,
        ..RodDescription::uniform("rod", nodes, stiffness, RADIUS, density * section)
    }
}

/// A joint of two nodes, each given by its rod and number.
fn joint(kind: JointKind, nodes: [(usize, usize); 2]) -> Joint {
    Joint {
        name: "joint".into(),
        nodes: nodes.map(|(rod, node)| RodNode { rod, node }),
        kind,
        strength: Strength::default(),
    }
}

/// Holds the first node of a rod.
fn clamp_of(rod: usize) -> Clamp {
    Clamp { rod, ..clamp(0) }
}

/// Displacement of a node at rest from its placed position.
fn deflection(scene: &Scene, rod: usize, node: usize) -> Result<Vector3, SimulationError> {
    let mut simulation = Simulation::new(scene, &IntegrationParameters::default())?;
    simulation.find_equilibrium()?;
    let before = scene.rods[..rod].iter().map(|rod| rod.centreline.len());
    let place = simulation.positions()[before.sum::<usize>() + node];
    Ok(place - scene.rods[rod].centreline[node])
}

fn portal_sway(edges: usize, kind: JointKind) -> Result<f64, SimulationError> {
    let feet = [0.0, LENGTH].map(|x| Vector3::new(x, 0.0, 0.0));
    let tops = feet.map(|foot| foot + LENGTH * Vector3::z());
    let scene = Scene {
        rods: [(feet[0], tops[0]), (tops[0], tops[1]), (feet[1], tops[1])]
            .map(|(start, end)| bar(start, end, edges, 1000.0))
            .to_vec(),
        clamps: vec![clamp_of(0), clamp_of(2)],
        joints: vec![
            joint(kind, [(0, edges), (1, 0)]),
            joint(kind, [(2, edges), (1, edges)]),
        ],
        loads: vec![steady(force_on(edges, FORCE * Vector3::x()))],
        ..Scene::default()
    };
    Ok(deflection(&scene, 0, edges)?.x)
}

fn star_sag(edges: usize, kind: JointKind) -> Result<f64, SimulationError> {
    let arm = |part: u8| {
        let (sine, cosine) = libm::sincos(TAU * f64::from(part) / 3.0);
        let foot = LENGTH * Vector3::new(cosine, sine, 0.0);
        bar(foot, Vector3::zeros(), edges, 1000.0)
    };
    let scene = Scene {
        rods: (0..3).map(arm).collect(),
        clamps: (0..3).map(clamp_of).collect(),
        joints: [1, 2]
            .map(|rod| joint(kind, [(0, edges), (rod, edges)]))
            .to_vec(),
        loads: vec![steady(force_on(edges, -FORCE * Vector3::z()))],
        ..Scene::default()
    };
    Ok(-deflection(&scene, 0, edges)?.z)
}

/// Deflection of the end of a rod that is welded crosswise to the middle of a clamped rod.
fn cross_deflection(edges: usize) -> Result<f64, SimulationError> {
    let across = |half: Vector3| bar(-half, half, edges, 1000.0);
    let pull = |node: usize, force: f64| {
        steady(LoadKind::Force {
            rod: 1,
            node,
            force: force * Vector3::z(),
        })
    };
    let scene = Scene {
        rods: [Vector3::y(), Vector3::x()]
            .map(|axis| across(0.5 * LENGTH * axis))
            .to_vec(),
        clamps: vec![clamp(0), clamp(edges)],
        joints: vec![joint(JointKind::Rigid, [(0, edges / 2), (1, edges / 2)])],
        loads: vec![pull(edges, FORCE), pull(0, -FORCE)],
        ..Scene::default()
    };
    Ok(deflection(&scene, 1, edges)?.z)
}

const GRAVITY: f64 = 9.81;

/// Two rods that hang from a hinge and from each other, with the given positions of hinge, joint
/// and end.
fn two_hanging(places: [Vector3; 3], edges: usize, density: f64) -> Scene {
    let [hinge, middle, end] = places;
    Scene {
        rods: vec![
            bar(hinge, middle, edges, density),
            bar(middle, end, edges, density),
        ],
        clamps: vec![Clamp {
            holds_frame: false,
            ..clamp(0)
        }],
        joints: vec![joint(JointKind::Ball, [(0, edges), (1, 0)])],
        loads: vec![gravity(GRAVITY)],
        ..Scene::default()
    }
}

/// Two stiff rods that hang from a hinge and from each other: frequencies, and energy in a wide swing.
fn double_pendulum() -> Result<Vec<Check>, GroupError> {
    // The spin of the rods about their own axes has no stiffness. A small drag in the static
    // solution suppresses these soft modes.
    let hanging = [0.0, -LENGTH, -2.0 * LENGTH].map(|z| Vector3::new(0.0, 0.0, z));
    let scene = two_hanging(hanging, 20, 10.0);
    let mut simulation = Simulation::new(&scene, &IntegrationParameters::default())?;
    simulation.find_equilibrium()?;
    let found = swinging(&mut simulation)?;
    // With λ = ω² l/g of two uniform rods: (3/2 − 4λ/3)(1/2 − λ/3) = λ²/4.
    let (a, b, c): (f64, f64, f64) = (7.0 / 36.0, -7.0 / 6.0, 0.75);
    let root = (b * b - 4.0 * a * c).sqrt();
    let mut checks = Vec::new();
    for (mode, sign) in [(1, -1.0), (2, 1.0)] {
        let square = (-b + sign * root) / (2.0 * a);
        let name = format!("double pendulum of stiff rods in a ball joint, mode {mode}: ω");
        let (expected, got) = ((square * GRAVITY / LENGTH).sqrt(), found[2 * mode - 2]);
        checks.push(PENDULUM.of(name, "rad/s").relative(expected, got, BOUND));
    }
    let raised = [[0.0, 0.0], [LENGTH, 0.0], [LENGTH, LENGTH]];
    let scene = two_hanging(raised.map(|[x, y]| Vector3::new(x, y, 0.0)), 10, 1000.0);
    let parameters = IntegrationParameters {
        scheme: Scheme::ImplicitMidpoint,
        ..steps_of(2e-4)
    };
    let mut simulation = Simulation::new(&scene, &parameters)?;
    let start = simulation.energies().total();
    let (mut kinetic, mut worst) = (0.0_f64, 0.0_f64);
    while simulation.time() < 1.0 {
        simulation.advance(1.0)?;
        let energies = simulation.energies();
        kinetic = kinetic.max(energies.kinetic);
        worst = worst.max((energies.total() - start).abs());
    }
    let name = "double pendulum, wide swing for 1 s, midpoint rule: energy error over the largest kinetic energy";
    checks.push(KEPT.of(name, "J").scaled(0.0, worst, kinetic, 1e-3));
    Ok(checks)
}

/// Frequencies of the modes in which the rods swing, in pairs of equal ones, without the modes of
/// spin.
fn swinging(simulation: &mut Simulation) -> Result<Vec<f64>, GroupError> {
    let stiffness = simulation.stiffness_matrix();
    let scale = stiffness.amax();
    let unknowns = simulation.free_unknowns();
    // A weak spring holds the free twist of the rods, with frequencies far above those of the
    // pendulum.
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
    frequencies_of(held, &simulation.mass_matrix())
}

/// A heavy disk at the end of a massless cantilever: frequencies, and its motion after an impulse.
fn disk() -> Result<Vec<Check>, GroupError> {
    let (mass, radius): (f64, f64) = (0.1, 0.03);
    let inertia = 0.25 * mass * radius * radius;
    let mut scene = Scene {
        rods: vec![bar(Vector3::zeros(), LENGTH * Vector3::x(), 40, 0.1)],
        clamps: vec![clamp(0)],
        bodies: vec![Body {
            inertia: Some([inertia, inertia, 2.0 * inertia]),
            ball: None,
            ..Body::uniform_ball(RodNode { rod: 0, node: 40 }, mass, radius)
        }],
        ..Scene::default()
    };
    let mut simulation = Simulation::new(&scene, &IntegrationParameters::default())?;
    simulation.find_equilibrium()?;
    let found = frequencies(&mut simulation)?;
    let stiffness = Matrix2::new(12.0, -6.0 * LENGTH, -6.0 * LENGTH, 4.0 * LENGTH * LENGTH)
        * (BENDING / LENGTH.powi(3));
    let scales = [1.0 / mass.sqrt(), 1.0 / inertia.sqrt()];
    let scaled = Matrix2::from_fn(|i, j| stiffness[(i, j)] * scales[i] * scales[j]);
    let eigen = scaled.symmetric_eigen();
    let theory = ascending(eigen.eigenvalues.iter().map(|square| square.sqrt()));
    let mut checks = Vec::new();
    for (mode, &expected) in theory.iter().enumerate() {
        let name = format!("heavy disk on a cantilever, bending mode {}: ω", mode + 1);
        let got = nearest(&found, expected);
        checks.push(DISK.of(name, "rad/s").relative(expected, got, BOUND));
    }
    // With a small sideways velocity the disk moves in the sum of both modes.
    let (speed, end) = (1e-3, TAU / theory[0] * 3.2);
    scene.rods[0].velocity = Vector3::new(0.0, speed, 0.0);
    let simulation = run(&scene, Scheme::BackwardDifferences, end / 4000.0, end)?;
    let parts = (0..2).map(|k| {
        let frequency = eigen.eigenvalues[k].sqrt();
        let part = eigen.eigenvectors[(0, k)];
        speed * part * part * libm::sin(frequency * end) / frequency
    });
    let (expected, amplitude) = (parts.sum(), speed / theory[0]);
    let name =
        "heavy disk, thrown sideways: deflection after 3.2 periods, error over its amplitude";
    let got = simulation.positions()[40].y;
    checks.push(DISK.of(name, "m").scaled(expected, got, amplitude, 3e-3));
    Ok(checks)
}

/// A square lattice with the given numbers of rods in each direction and of edges per piece.
fn lattice(rods: usize, edges: usize, boundary: Table) -> Table {
    let corner = -0.5 * LENGTH;
    toml! {
        name = "net"
        rod = { radius = RADIUS, edges = edges }
        boundary = boundary
        [shape]
        kind = "grid"
        corner = [corner, corner, 0]
        sides = [[LENGTH, 0, 0], [0, LENGTH, 0]]
        rods = [rods, rods]
    }
}

/// A flat lattice whose corners are pushed towards each other: asymmetry of the dome relative to
/// its height.
fn gridshell() -> Result<Check, GroupError> {
    let rods = 5;
    let boundary = toml! { ends = "corners" scale = [[0.2, 1], [1, 0.9]] };
    let mut simulation = built(toml! {
        experiment = "scene"
        material = { youngs_modulus = "1 GPa", poissons_ratio = 0.3, density = 1000.0 }
        networks = [(lattice(rods, 3, boundary))]
        time = { step = 2e-3, end = 1.0 }
        [[loads]]
        kind = "distributed"
        force_per_length = [0, 0, 0.05]
        [[loads]]
        kind = "drag"
        translation = 0.1
    })?;
    run_until(&mut simulation, 1.0)?;
    simulation.find_equilibrium()?;
    let (worst, height) = asymmetry(&simulation, rods, 3 * (rods - 1) + 1);
    if height < 0.1 * LENGTH {
        return Err(format!("the lattice rose by {height} m only").into());
    }
    let name = "gridshell of 5 × 5 laths from a flat lattice, corners pushed in by 10 %: asymmetry over its height";
    Ok(MIRRORED.of(name, "m").scaled(0.0, worst, height, 1e-9))
}

/// A square net of balls under its weight, held at its corners: asymmetry relative to its sag.
fn net(rods: usize) -> Result<Check, GroupError> {
    let boundary = toml! { ends = "corners" };
    let mut simulation = built(toml! {
        experiment = "scene"
        material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
        networks = [(lattice(rods, 2, boundary))]
        loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
        time = { mode = "static" }
    })?;
    simulation.find_equilibrium()?;
    let (worst, sag) = asymmetry(&simulation, rods, 2 * (rods - 1) + 1);
    let name = format!(
        "net of {rods} × {rods} rods in ball joints under its weight: asymmetry over its sag"
    );
    Ok(MIRRORED.of(name, "m").scaled(0.0, worst, sag, 1e-9))
}

/// Largest difference of heights (m) at equivalent places of a square grid under its symmetries,
/// and the largest height.
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
                // The equivalent place in the other family of rods, mirrored at the diagonal.
                height(rods + rod, node),
            ];
            for other in others {
                worst = worst.max((own - other).abs());
            }
        }
    }
    (worst, largest)
}
