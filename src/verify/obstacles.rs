//! Obstacles of every shape, from scenario files: ropes over round obstacles, a beam lifted by an
//! edge and by a ball, and rods that buckle in a tube.

use super::friction::{POST_RADIUS, capstan_check, leg_tensions, rope_over_post, tension_samples};
use super::rods::run_until;
use super::scenario::built;
use super::{Check, Expectation, GroupError, sleeve, tube_buckling, tube_coiling};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use std::f64::consts::PI;
use toml::{Table, Value, toml};

const LIFTED: Expectation = Expectation::new("F = 3 EI w/a³", "Euler–Bernoulli");
const SWING: Expectation = Expectation::new("T₂/T₁ = constant", "");
const FACETED: Expectation = Expectation::new("force at a ball of formula", "");

/// Bending stiffness of the rope, N m².
const BENDING: f64 = 4.41e-6;
/// Stretching stiffness of the rope, N.
const STRETCHING: f64 = 1e3;
/// Number of edges around the post.
const WRAPPED_EDGES: usize = 80;
/// Number of edges in each leg.
const LEG_EDGES: usize = 60;
/// Both of them.
const FINE: [usize; 2] = [WRAPPED_EDGES, LEG_EDGES];

/// Checks ropes over a cylinder at rest and a turning one, over a sphere and over meshes of the
/// cylinder, also as smooth curves, a beam lifted by the edge of a box and by balls, and rods in
/// tubes.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let cylinder = || {
        toml! {
            kind = "cylinder"
            point = [0, 0, 0]
            direction = [0, 0, 1]
            radius = POST_RADIUS
        }
    };
    let sphere = sphere([0.0; 3], POST_RADIUS);
    let ropes = [
        ("a cylinder", "imc", cylinder()),
        ("a cylinder", "ipc", cylinder()),
        ("a cylinder", "complementarity", cylinder()),
        ("the great circle of a sphere", "imc", sphere),
        ("a mesh of 64 faces", "imc", prism(64)),
        ("a mesh of 256 faces", "imc", prism(256)),
        ("a smooth mesh of 12 faces", "imc", smooth(prism(12))),
        ("a smooth mesh of 24 faces", "ipc", smooth(prism(24))),
        (
            "a smooth mesh of 24 faces",
            "complementarity",
            smooth(prism(24)),
        ),
    ];
    let mut checks = Vec::new();
    for (over, model, shape) in ropes {
        checks.push(capstan(over, model, shape)?);
    }
    checks.push(smooth_rope("a cylinder", "imc", cylinder())?);
    checks.push(smooth_rope("a mesh of 64 faces", "ipc", prism(64))?);
    let shape = smooth(prism(24));
    checks.push(smooth_rope("a smooth mesh of 24 faces", "imc", shape)?);
    for model in ["imc", "ipc", "complementarity"] {
        checks.push(turning_post(model, cylinder())?);
    }
    checks.push(swing(24)?);
    checks.extend(lifted_beam()?);
    checks.extend(tube_buckling::checks()?);
    checks.extend(tube_coiling::checks()?);
    checks.extend(sleeve::checks()?);
    Ok(checks)
}

/// A rope of few edges whose contact is that of a smooth curve. A polyline with these edges is off by
/// four times as much.
fn smooth_rope(over: &str, model: &str, shape: Table) -> Result<Check, GroupError> {
    const WRAPPED: usize = 20;
    const LEG: usize = 15;
    let (mut scene, nodes) = rope_scene(model, shape, [WRAPPED, LEG])?;
    scene["contact"]["geometry"] = "smooth".into();
    let tensions = leg_tensions(&mut built(scene)?, &nodes, STRETCHING, LEG)?;
    let name = format!(
        "rope of {WRAPPED} edges over {over}, μ = 0.3, half a turn, smooth geometry, {model}: T₂/T₁"
    );
    Ok(capstan_check(name, tensions, BENDING, 2e-3))
}

fn capstan(over: &str, model: &str, shape: Table) -> Result<Check, GroupError> {
    let (mut simulation, nodes) = rope_over(model, shape)?;
    let tensions = leg_tensions(&mut simulation, &nodes, STRETCHING, LEG_EDGES)?;
    let name = format!("rope over {over}, μ = 0.3, half a turn, {model}: T₂/T₁");
    Ok(capstan_check(name, tensions, BENDING, 5e-3))
}

/// The rope is held while the post turns under it: it slips as if it were pulled over a post at
/// rest.
fn turning_post(model: &str, shape: Table) -> Result<Check, GroupError> {
    let (mut scene, nodes) = rope_scene(model, shape, FINE)?;
    scene["clamps"][0]["move"] = Value::try_from([(0.0, [0.0; 3]), (1.0, [0.0; 3])])?;
    let post = &mut scene["obstacles"][0];
    if let Some(post) = post.as_table_mut() {
        post.extend(toml! { axis = [0, 0, 1] pivot = [0, 0, 0] angular_velocity = 1.0 });
    }
    let tensions = leg_tensions(&mut built(scene)?, &nodes, STRETCHING, LEG_EDGES)?;
    let name = format!("rope held over a turning cylinder, μ = 0.3, half a turn, {model}: T₂/T₁");
    Ok(capstan_check(name, tensions, BENDING, 5e-3))
}

/// Largest deviation of T₂/T₁ from its mean while a rope slides over a smooth mesh of a cylinder,
/// relative to the mean.
fn swing(faces: usize) -> Result<Check, GroupError> {
    let (mut simulation, nodes) = rope_over("imc", smooth(prism(faces)))?;
    let samples = tension_samples(&mut simulation, &nodes, STRETCHING, LEG_EDGES)?;
    let ratios: Vec<f64> = samples.iter().map(|[less, more]| more / less).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let farthest = |most: f64, ratio: &f64| most.max((ratio / mean - 1.0).abs());
    let name = format!("rope over a smooth mesh of {faces} faces, imc: swing of T₂/T₁");
    Ok(SWING
        .of(name, "")
        .zero(ratios.iter().fold(0.0, farthest), 1e-3))
}

/// A rope over an obstacle, and its nodes as placed.
fn rope_over(model: &str, shape: Table) -> Result<(Simulation, Vec<Vector3>), GroupError> {
    let (scene, nodes) = rope_scene(model, shape, FINE)?;
    Ok((built(scene)?, nodes))
}

/// The scenario of a rope over an obstacle, with numbers of edges around it and in each leg, and its
/// nodes as placed.
fn rope_scene(
    model: &str,
    shape: Table,
    [wrapped, leg]: [usize; 2],
) -> Result<(Table, Vec<Vector3>), GroupError> {
    let nodes = rope_over_post(wrapped, leg, 3e-3);
    let points: Vec<[f64; 3]> = nodes.iter().map(|x| (*x).into()).collect();
    let mut scene: Table = include_str!("scenes/rope.toml").parse()?;
    scene["rods"][0]["shape"]["points"] = Value::try_from(points)?;
    scene["obstacles"][0]["shape"] = shape.into();
    scene["contact"]["model"] = model.into();
    Ok((scene, nodes))
}

/// The cylinder as a mesh with the given number of faces around it and with its corners on the
/// cylinder.
fn prism(faces: usize) -> Table {
    let corner = |k: usize, z: f64| {
        let (sine, cosine) = libm::sincos(2.0 * PI * k as f64 / faces as f64);
        [POST_RADIUS * cosine, POST_RADIUS * sine, z]
    };
    let ring = |z: f64| (0..faces).map(move |k| corner(k, z));
    let mut vertices: Vec<[f64; 3]> = ring(-0.01).chain(ring(0.01)).collect();
    vertices.extend([[0.0, 0.0, -0.01], [0.0, 0.0, 0.01]]);
    let mut triangles = Vec::new();
    for k in 0..faces {
        let next = (k + 1) % faces;
        triangles.extend([
            [k, next, faces + next],
            [k, faces + next, faces + k],
            [2 * faces, next, k],
            [2 * faces + 1, faces + k, faces + next],
        ]);
    }
    mesh(&vertices, &triangles)
}

/// A ball as a mesh: an octahedron whose faces are divided into four, `cuts` times, with its
/// corners on the ball.
fn ball(centre: [f64; 3], radius: f64, cuts: usize) -> Table {
    let directions = [
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
    ];
    let mut corners: Vec<Vector3> = directions
        .map(|direction| Vector3::from(direction.map(f64::from)))
        .to_vec();
    let mut triangles = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    for _ in 0..cuts {
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                corners.push((corners[a] + corners[b]).normalize());
                corners.len() - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let vertices: Vec<[f64; 3]> = (corners.iter())
        .map(|corner| std::array::from_fn(|k| centre[k] + radius * corner[k]))
        .collect();
    mesh(&vertices, &triangles)
}

/// A mesh that stands for a smooth surface.
fn smooth(mut mesh: Table) -> Table {
    mesh.insert("smooth".to_owned(), true.into());
    mesh
}

fn mesh(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Table {
    toml! {
        kind = "mesh"
        vertices = (Value::try_from(vertices).expect("numbers are TOML"))
        triangles = (Value::try_from(triangles).expect("numbers are TOML"))
    }
}

fn sphere(centre: [f64; 3], radius: f64) -> Table {
    let [x, y, z] = centre;
    toml! { kind = "sphere" centre = [x, y, z] radius = radius }
}

/// Radius of the balls that lift the beam, m.
const BALL: f64 = 0.02;

fn lifted_beam() -> Result<[Check; 3], GroupError> {
    let force = |shape: Option<Table>| -> Result<f64, GroupError> {
        let mut scene: Table = include_str!("scenes/pushed_beam.toml").parse()?;
        if let Some(shape) = shape {
            scene["obstacles"][0]["shape"] = shape.into();
        }
        let mut simulation = built(scene)?;
        run_until(&mut simulation, 1.5)?;
        let forces = simulation.contact_forces();
        Ok(forces.iter().map(|force| force.z).sum())
    };
    // The lift of the centreline is the lift of the edge after first contact, which occurs at 1
    // mm.
    let (lift, arm, radius): (f64, f64, f64) = (0.005, 0.5, 2e-3);
    let bending = 1e9 * PI * radius.powi(4) / 4.0;
    let expected = 3.0 * bending * lift / arm.powi(3);
    // The initial position is a millimetre below the beam, like that of the edge of the box.
    let centre = [arm, 0.0, -radius - 1e-3 - BALL];
    let of_formula = force(Some(sphere(centre, BALL)))?;
    let of_mesh = force(Some(ball(centre, BALL, 4)))?;
    let of_smooth = force(Some(smooth(ball(centre, BALL, 2))))?;
    Ok([
        LIFTED
            .of("beam lifted by the edge of a box: force", "N")
            .relative(expected, force(None)?, 1e-2),
        FACETED
            .of("beam lifted by a ball of 2048 triangles: force", "N")
            .relative(of_formula, of_mesh, 1e-2),
        FACETED
            .of("beam lifted by a smooth ball of 128 triangles: force", "N")
            .relative(of_formula, of_smooth, 2e-3),
    ])
}
