//! Files of a planned deployment.

use super::deployed_rod::RodFile;
use super::failure::Failure;
use crate::mechanics::Vector3;
use crate::plan::deployment::{DeployedRod, GripperPose};
use crate::plan::pattern::PatternPoint;
use serde::Serialize;
use std::fmt::Write;

/// Edges per gravito-bending length of a simulated rod, and how many there are at least and at most.
const EDGES_PER_LENGTH: f64 = 4.0;
const EDGES: [f64; 2] = [80.0, 400.0];
/// Friction of the simulated table where none is given.
const FRICTION: f64 = 0.4;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;

#[derive(Serialize)]
struct TrajectoryFile<'a> {
    pattern: &'a str,
    rod: &'a str,
    gravito_bending_length_m: f64,
    poses: Vec<PoseEntry>,
}

#[derive(Serialize)]
struct PoseEntry {
    time_s: f64,
    position_m: [f64; 3],
    quaternion: [f64; 4],
}

/// Columns time_s, x_m, y_m, z_m, qw, qx, qy, qz; the contact node moves at `speed`, m/s.
pub fn trajectory_csv(poses: &[GripperPose], speed: f64) -> String {
    let mut text = String::from("time_s,x_m,y_m,z_m,qw,qx,qy,qz\n");
    for pose in poses {
        let ([x, y, z], [w, i, j, k]) = parts(pose);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{:.9},{x:.9},{y:.9},{z:.9},{w:.12},{i:.12},{j:.12},{k:.12}",
            pose.s / speed
        );
    }
    text
}

/// The same as JSON, with what it belongs to.
pub fn trajectory_json(
    poses: &[GripperPose],
    speed: f64,
    pattern: &str,
    file: &RodFile,
) -> Result<String, Failure> {
    let poses = poses.iter().map(|pose| {
        let (position_m, quaternion) = parts(pose);
        PoseEntry {
            time_s: pose.s / speed,
            position_m,
            quaternion,
        }
    });
    let whole = TrajectoryFile {
        pattern,
        rod: &file.title,
        gravito_bending_length_m: file.rod.gravito_bending_length,
        poses: poses.collect(),
    };
    let text =
        serde_json::to_string_pretty(&whole).map_err(|error| Failure::System(error.to_string()))?;
    Ok(text + "\n")
}

/// Columns s_m, x_m, y_m, curvature_per_m, friction_demand.
pub fn pattern_csv(points: &[PatternPoint], demands: &[f64]) -> String {
    let mut text = String::from("s_m,x_m,y_m,curvature_per_m,friction_demand\n");
    for (point, demand) in points.iter().zip(demands) {
        let _ = writeln!(
            text,
            "{:.9},{:.9},{:.9},{:.9},{demand:.9}",
            point.s, point.position.x, point.position.y, point.curvature
        );
    }
    text
}

/// Columns x_m, y_m, z_m.
pub fn nodes_csv(nodes: &[Vector3]) -> String {
    let mut text = String::from("x_m,y_m,z_m\n");
    for node in nodes {
        let _ = writeln!(text, "{:.12},{:.12},{:.12}", node.x, node.y, node.z);
    }
    text
}

/// Edges of the simulated rod.
pub fn edges(rod: &DeployedRod) -> usize {
    let [fewest, most] = EDGES;
    let edges = EDGES_PER_LENGTH * rod.length / rod.gravito_bending_length;
    edges.round().clamp(fewest, most) as usize
}

/// A scenario in which the rod is laid down along the trajectory.
pub fn landing(file: &RodFile, pattern: &str, friction: Option<f64>, duration: f64) -> String {
    let rod = &file.rod;
    let RodFile { title, density, .. } = file;
    let title = toml::Value::from(format!("{title} is laid along {pattern}"));
    // L_gb³ = E h²/(8 ρ g).
    let youngs_modulus =
        8.0 * density * GRAVITY * rod.gravito_bending_length.powi(3) / rod.radius.powi(2);
    format!(
        "# The gripper follows trajectory.csv; rod.csv is the rod as it hangs from its first pose.\n\
         experiment = \"scene\"\n\
         title = {title}\n\n\
         [material]\n\
         youngs_modulus = {youngs_modulus:?}   # from the gravito-bending length\n\
         poissons_ratio = 0.5\n\
         density = {density:?}\n\n\
         [[rods]]\n\
         name = \"rod\"\n\
         radius = {radius:?}\n\
         edges = {edges}\n\
         shape = {{ kind = \"points\", file = \"rod.csv\" }}\n\
         natural_shape = {{ kind = \"straight\", start = [0, 0, 0], end = [{length:?}, 0, 0] }}\n\n\
         [[clamps]]\n\
         rod = \"rod\"\n\
         at = \"end\"\n\
         follow = \"trajectory.csv\"\n\n\
         [[planes]]\n\n\
         [[loads]]\n\
         kind = \"gravity\"\n\
         acceleration = [0, 0, -{GRAVITY}]\n\n\
         [contact]\n\
         model = \"imc\"\n\
         friction = {friction:?}\n\
         distance_tolerance = \"50 µm\"\n\
         slip_tolerance = \"0.01 mm/s\"\n\n\
         [time]\n\
         step = \"5 ms\"\n\
         end = {duration:.6}\n\n\
         [output]\n\
         interval = \"0.5 s\"\n\
         nodes = true\n",
        radius = rod.radius,
        edges = edges(rod),
        length = rod.length,
        friction = friction.unwrap_or(FRICTION),
    )
}

/// Position and quaternion w, x, y, z, without negative zeros.
fn parts(pose: &GripperPose) -> ([f64; 3], [f64; 4]) {
    let turned = pose.rotation;
    let position: [f64; 3] = pose.position.into();
    (
        position.map(|part| part + 0.0),
        [turned.w, turned.i, turned.j, turned.k].map(|part| part + 0.0),
    )
}
