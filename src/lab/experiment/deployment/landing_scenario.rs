//! The scenario of a planned deployment: `rodlab run` lays the rod along the planned trajectory.

use super::rod_file::RodFile;
use rodlab_planning::plan::deployment::OptimalGrasps;
use rodlab_planning::plan::pattern::PatternSource;
use rodlab_planning::plan::request::DeploymentRequest;
use rodlab_planning::plan::tying::Pass;
use serde::Serialize;

/// Default friction of the simulated table.
const FRICTION: f64 = 0.4;
/// Time for which a tied rod settles, s.
const SETTLING: f64 = 2.0;

/// Data of a landing scenario.
pub struct Landing<'a> {
    /// The rod.
    pub rod: &'a RodFile,
    /// Description of the pattern for readers.
    pub name: &'a str,
    /// The pattern itself.
    pub source: &'a PatternSource,
    /// Scheme of the gripper's path.
    pub request: &'a DeploymentRequest<'a>,
    /// Length of its lead-in, m.
    pub lead_in: f64,
    /// Duration of the landing, s.
    pub duration: f64,
}

impl Landing<'_> {
    /// The points of a drawing, in a file beside the scenario, which reads them.
    pub const DRAWING: &'static str = "drawing.csv";

    /// The scenario.
    pub fn scenario(&self) -> String {
        let RodFile {
            title,
            rod,
            density,
            edges,
            ..
        } = self.rod;
        let edges = edges.map_or_else(String::new, |edges| format!("edges = {edges}\n"));
        let title = toml::Value::from(format!("{title} is laid along {}", self.name));
        let pattern = match self.source {
            PatternSource::Line(line) => format!("kind = \"line\", length = {:?}", line.length),
            PatternSource::Circle(circle) => {
                format!("kind = \"circle\", radius = {:?}", circle.radius)
            }
            PatternSource::Sine(sine) => format!(
                "kind = \"sine\", amplitude = {:?}, wavelength = {:?}, waves = {:?}",
                sine.amplitude, sine.wavelength, sine.waves
            ),
            PatternSource::Drawn { deviation, .. } => {
                format!("file = \"{}\", deviation = {deviation:?}", Self::DRAWING)
            }
        };
        let request = self.request;
        let settling = if request.knot.is_empty() {
            0.0
        } else {
            SETTLING
        };
        let scheme = word(&request.scheme);
        format!(
            "# A gripper lays the rod along the pattern, as in trajectory.csv. rodlab explain deployment describes the keys.\n\
             experiment = \"deployment\"\n\
             title = {title}\n\n\
             [deployment]\n\
             pattern = {{ {pattern} }}\n\
             lead_in = {lead_in:?}\n\
             scheme = {scheme}\n{solver}{knot}\n\
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
            lead_in = self.lead_in,
            unit = rod.gravito_bending_length,
            radius = rod.radius,
            length = rod.length,
            friction = request.friction.unwrap_or(FRICTION),
            duration = self.duration + settling,
        )
    }
}

/// The keys of a knot; both grippers release the rods after tying.
fn knot_keys(passes: &[Pass]) -> String {
    if passes.is_empty() {
        return String::new();
    }
    let words = passes.iter().map(word).collect::<Vec<_>>().join(", ");
    format!("knot = {{ crossings = [{words}] }}\nrelease = {SETTLING:?}\n")
}

/// A word as a quoted TOML string.
fn word(word: &impl Serialize) -> String {
    let value = toml::Value::try_from(word);
    value.expect("names are TOML values").to_string()
}
