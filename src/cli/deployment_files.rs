//! Files of a planned deployment.

use super::deployed_rod::RodFile;
use super::prelude::*;
use rodlab_files::finite::{self, NotFinite};
use rodlab_planning::plan::deployment::{
    LaidPath, OptimalGrasps, Scheme, TimedPose, deployment_figure,
};
use rodlab_planning::plan::pattern::{Crossing, PatternSource, Point};
use rodlab_planning::plan::request::DeploymentRequest;
use rodlab_planning::plan::tying::Pass;

/// Friction of the simulated table where none is given.
const FRICTION: f64 = 0.4;
/// How long a tied rod is left to itself, s.
const SETTLING: f64 = 2.0;
/// The points of a drawing beside the scenario that reads them.
pub const DRAWING: &str = "drawing.csv";

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

/// Columns time_s, x_m, y_m, z_m, qw, qx, qy, qz.
pub fn trajectory_csv(poses: &[TimedPose]) -> Result<String, NotFinite> {
    check_finite(poses)?;
    let mut text = String::from("time_s,x_m,y_m,z_m,qw,qx,qy,qz\n");
    for pose in poses {
        let (time, [x, y, z], [w, i, j, k]) = parts(pose);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{time:.9},{x:.9},{y:.9},{z:.9},{w:.12},{i:.12},{j:.12},{k:.12}"
        );
    }
    Ok(text)
}

/// Whether all times and poses are finite.
fn check_finite(poses: &[TimedPose]) -> Result<(), NotFinite> {
    const NAMES: [&str; 8] = ["time_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"];
    for (index, pose) in poses.iter().enumerate() {
        let (time, [x, y, z], [w, i, j, k]) = parts(pose);
        finite::check(&[time, x, y, z, w, i, j, k], |number| {
            format!("`{}` of pose {}", NAMES[number], index + 1)
        })?;
    }
    Ok(())
}

/// The same as JSON, with what it belongs to.
pub fn trajectory_json(
    poses: &[TimedPose],
    pattern: &str,
    file: &RodFile,
) -> Result<String, Failure> {
    check_finite(poses)?;
    let poses = poses.iter().map(|pose| {
        let (time_s, position_m, quaternion) = parts(pose);
        PoseEntry {
            time_s,
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
    let text = serde_json::to_string_pretty(&whole).map_err(Failure::system)?;
    Ok(text + "\n")
}

/// The pattern of a path with columns s_m, x_m, y_m, curvature_per_m, friction_demand, and the figure of it.
pub fn path_files(
    title: &str,
    path: &LaidPath,
    demands: &[f64],
    crossings: &[Crossing],
    friction: Option<f64>,
) -> [(String, String); 2] {
    let LaidPath { points, poses, .. } = path;
    let figure = deployment_figure(title, points, poses, demands, friction, crossings);
    let mut text = String::from("s_m,x_m,y_m,curvature_per_m,friction_demand\n");
    for (point, demand) in points.iter().zip(demands) {
        let _ = writeln!(
            text,
            "{:.9},{:.9},{:.9},{:.9},{demand:.9}",
            point.s, point.position.x, point.position.y, point.curvature
        );
    }
    let names = ["pattern.csv", "deployment.svg"].map(str::to_owned);
    let [pattern, drawn] = names;
    [(pattern, text), (drawn, figure)]
}

/// Columns x_m, y_m.
pub fn drawing_csv(points: &[Point]) -> String {
    let mut text = String::from("x_m,y_m\n");
    for point in points {
        let _ = writeln!(text, "{:.12},{:.12}", point.x, point.y);
    }
    text
}

/// What a landing is written from.
pub struct Landing<'a> {
    /// The rod.
    pub file: &'a RodFile,
    /// The pattern for people.
    pub name: &'a str,
    /// The pattern itself.
    pub source: &'a PatternSource,
    /// How it is laid.
    pub request: &'a DeploymentRequest<'a>,
    /// Length of its lead-in, m.
    pub lead_in: f64,
    /// How long it takes, s.
    pub duration: f64,
}

/// A scenario in which the rod is laid down along the trajectory.
pub fn landing(landing: &Landing) -> String {
    let RodFile {
        title,
        rod,
        density,
        edges,
        ..
    } = landing.file;
    let edges = edges.map_or_else(String::new, |edges| format!("edges = {edges}\n"));
    let title = toml::Value::from(format!("{title} is laid along {}", landing.name));
    let pattern = match landing.source {
        PatternSource::Line(line) => format!("kind = \"line\", length = {:?}", line.length),
        PatternSource::Circle(circle) => {
            format!("kind = \"circle\", radius = {:?}", circle.radius)
        }
        PatternSource::Sine(sine) => format!(
            "kind = \"sine\", amplitude = {:?}, wavelength = {:?}, waves = {:?}",
            sine.amplitude, sine.wavelength, sine.waves
        ),
        PatternSource::Drawn { deviation, .. } => {
            format!("file = \"{DRAWING}\", deviation = {deviation:?}")
        }
    };
    let request = landing.request;
    let scheme = match request.scheme {
        Scheme::Optimal => "optimal",
        Scheme::Intuitive => "intuitive",
    };
    format!(
        "# A gripper lays the rod along the pattern, as in trajectory.csv. rodlab explain deployment says more of its keys.\n\
         experiment = \"deployment\"\n\
         title = {title}\n\n\
         [deployment]\n\
         pattern = {{ {pattern} }}\n\
         lead_in = {lead_in:?}\n\
         scheme = \"{scheme}\"\n{solver}{knot}\n\
         [deployment.rod]\n\
         gravito_bending_length = {unit:?}\n\
         radius = {radius:?}\n\
         length = {length:?}\n\
         density = {density:?}\n{edges}\n\
         [contact]\n\
         friction = {friction:?}\n\
         distance_tolerance = \"50 µm\"\n\
         slip_tolerance = \"0.01 mm/s\"\n\n\
         [time]\n\
         step = \"5 ms\"\n\
         end = {duration:.6}\n\n\
         [output]\n\
         interval = \"0.5 s\"\n",
        solver = match request.grasps {
            OptimalGrasps::Neural(_) => "solver = \"neural\"\n",
            OptimalGrasps::Exact => "",
        },
        knot = knot_keys(&request.knot),
        lead_in = landing.lead_in,
        unit = rod.gravito_bending_length,
        radius = rod.radius,
        length = rod.length,
        friction = request.friction.unwrap_or(FRICTION),
        duration = landing.duration
            + if request.knot.is_empty() {
                0.0
            } else {
                SETTLING
            },
    )
}

/// The keys of a knot, after which both grippers let go.
fn knot_keys(passes: &[Pass]) -> String {
    if passes.is_empty() {
        return String::new();
    }
    let words = passes.iter().map(|pass| match pass {
        Pass::Over => "\"over\"",
        Pass::Under => "\"under\"",
    });
    let words = words.collect::<Vec<_>>().join(", ");
    format!("knot = {{ crossings = [{words}] }}\nrelease = {SETTLING:?}\n")
}

/// Time, position and quaternion w, x, y, z, without negative zeros.
fn parts(&(time, position, turned): &TimedPose) -> (f64, [f64; 3], [f64; 4]) {
    let position: [f64; 3] = position.into();
    (
        time,
        position.map(|part| part + 0.0),
        [turned.w, turned.i, turned.j, turned.k].map(|part| part + 0.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::{UnitQuaternion, Vector3};

    #[test]
    fn a_pose_that_is_not_finite_is_not_written() {
        let pose =
            |time: f64, x: f64| (time, Vector3::new(x, 0.0, 0.1), UnitQuaternion::identity());
        let written = trajectory_csv(&[pose(0.0, 0.0), pose(1.0, 0.1)]).unwrap();
        assert_eq!(written.lines().count(), 3);
        let error = trajectory_csv(&[pose(0.0, 0.0), pose(1.0, f64::NAN)]).unwrap_err();
        assert_eq!(error.to_string(), "`x_m` of pose 2 is not a finite number");
        assert!(trajectory_csv(&[pose(f64::INFINITY, 0.0)]).is_err());
    }
}
