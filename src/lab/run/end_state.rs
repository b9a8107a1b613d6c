//! Converts the state at the end of a run to rows of its file and back.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::Start;
use rodlab_files::results::{EndRow, RodRecord};

/// Rows of a state of the given rods.
pub(super) fn rows_of(start: &Start, rods: &[RodRecord]) -> Vec<EndRow> {
    let nodes = rods.iter().flat_map(|rod| {
        let of_node = move |node| (rod.name.clone(), node);
        (0..rod.nodes).map(of_node)
    });
    let rows = nodes.enumerate().map(|(index, (rod, node))| {
        let x = start.positions[index];
        let velocity = start.velocities[index];
        let director = start.directors[index];
        let director = (director != Vector3::zeros()).then_some(director);
        let wall = start.walls[index];
        let component =
            |vector: Option<Vector3>, axis: usize| vector.map(|vector: Vector3| vector[axis]);
        let spin = start.turning[index];
        let (tangent, across) = (wall.map(|wall| wall[0]), wall.map(|wall| wall[1]));
        EndRow {
            rod,
            node,
            x_m: x.x,
            y_m: x.y,
            z_m: x.z,
            director_x: component(director, 0),
            director_y: component(director, 1),
            director_z: component(director, 2),
            twist_rad: start.twist[index],
            velocity_x_m_per_s: velocity.x,
            velocity_y_m_per_s: velocity.y,
            velocity_z_m_per_s: velocity.z,
            spin_rad_per_s: start.spins[index],
            wall_tangent_x: component(tangent, 0),
            wall_tangent_y: component(tangent, 1),
            wall_tangent_z: component(tangent, 2),
            wall_director_x: component(across, 0),
            wall_director_y: component(across, 1),
            wall_director_z: component(across, 2),
            wall_spin_x_rad_per_s: component(spin, 0),
            wall_spin_y_rad_per_s: component(spin, 1),
            wall_spin_z_rad_per_s: component(spin, 2),
        }
    });
    rows.collect()
}

/// The state in the given rows of these rods.
///
/// # Errors
/// A mismatch: other rods, other numbers of nodes, or numbers that are not finite.
pub fn start_from(rows: &[EndRow], rods: &[RodRecord]) -> Result<Start, String> {
    refuse_other_rods(rows, rods)?;
    let vector = |x: Option<f64>, y: Option<f64>, z: Option<f64>| {
        x.zip(y).zip(z).map(|((x, y), z)| Vector3::new(x, y, z))
    };
    let mut start = Start::default();
    for row in rows {
        let position = Vector3::new(row.x_m, row.y_m, row.z_m);
        let velocity = Vector3::new(
            row.velocity_x_m_per_s,
            row.velocity_y_m_per_s,
            row.velocity_z_m_per_s,
        );
        let director = vector(row.director_x, row.director_y, row.director_z);
        let tangent = vector(row.wall_tangent_x, row.wall_tangent_y, row.wall_tangent_z);
        let across = vector(
            row.wall_director_x,
            row.wall_director_y,
            row.wall_director_z,
        );
        let wall = tangent
            .zip(across)
            .map(|(tangent, across)| [tangent, across]);
        let turning = vector(
            row.wall_spin_x_rad_per_s,
            row.wall_spin_y_rad_per_s,
            row.wall_spin_z_rad_per_s,
        );
        let vectors = [position, velocity, director.unwrap_or_default()];
        let walls = wall.into_iter().flatten().chain(turning);
        let all = vectors.into_iter().chain(walls);
        let mut numbers = all.flat_map(|vector| [vector.x, vector.y, vector.z]);
        let finite = numbers.all(f64::is_finite);
        if !(finite && row.twist_rad.is_finite() && row.spin_rad_per_s.is_finite()) {
            return Err(format!(
                "node {} of rod `{}`: a number is not finite",
                row.node, row.rod
            ));
        }
        start.positions.push(position);
        start.directors.push(director.unwrap_or_default());
        start.twist.push(row.twist_rad);
        start.velocities.push(velocity);
        start.spins.push(row.spin_rad_per_s);
        start.walls.push(wall);
        start.turning.push(turning);
    }
    Ok(start)
}

fn refuse_other_rods(rows: &[EndRow], rods: &[RodRecord]) -> Result<(), String> {
    let found: Vec<(&str, usize)> = rows
        .chunk_by(|one, other| one.rod == other.rod && one.node + 1 == other.node)
        .map(|rod| (rod[0].rod.as_str(), rod.len()))
        .collect();
    let expected: Vec<(&str, usize)> = rods
        .iter()
        .map(|rod| (rod.name.as_str(), rod.nodes))
        .collect();
    if found == expected {
        return Ok(());
    }
    let words = |rods: &[(&str, usize)]| {
        let words = rods
            .iter()
            .map(|(name, nodes)| format!("`{name}` of {nodes} nodes"));
        words.collect::<Vec<_>>().join(", ")
    };
    Err(format!(
        "it holds other rods: {}; needed: {}",
        words(&found),
        words(&expected)
    ))
}
