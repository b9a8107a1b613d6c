//! Rods in fluid over the whole range of ratios of drag to inertia, single and joined.

use super::judged::{Case, STEPS};
use super::random::Random;
use std::f64::consts::PI;
use std::fmt::Write;

/// Sizes and numbers of a scene in fluid.
struct Flow {
    length: f64,
    radius: f64,
    edges: u64,
    step: f64,
    /// Travel within the whole time, m.
    way: f64,
    /// Force per length that causes this travel against drag and inertia, N/m.
    force: f64,
    /// Young's modulus, Pa, so large that this force stretches a rod by less than a per cent.
    modulus: f64,
    density: f64,
    viscosity: f64,
}

impl Flow {
    fn new(random: &mut Random) -> Self {
        let length = random.decades(1e-6, 1.0);
        let edges = match random.between(0.0, 1.0) {
            part if part < 0.97 => random.one_of(&[5, 8, 12, 20, 32]),
            _ => random.one_of(&[100, 200]),
        };
        let edge = length / edges as f64;
        let radius = edge / random.decades(2.5, 40.0);
        let viscosity = random.decades(1e-3, 1e3);
        let density = random.decades(500.0, 5000.0);
        let step = random.decades(1e-6, 1e-2);
        let time = step * STEPS as f64;
        let way = length * random.decades(1e-3, 0.2);
        let drag = 4.0 * PI * viscosity / ((length / radius).ln() + 0.5);
        let mass = density * PI * radius * radius;
        let force = way * (drag / time + 2.0 * mass / (time * time));
        let stiffest = random.decades(1.0, 1e5);
        let modulus = stiffest * 100.0 * force * length / (PI * radius * radius);
        Self {
            length,
            radius,
            edges,
            step,
            way,
            force,
            modulus,
            density,
            viscosity,
        }
    }

    /// The tables of material, fluid and time.
    fn head(&self, random: &mut Random, schemes: &[&str]) -> (String, Vec<String>) {
        let scheme = random.one_of(schemes);
        let model = random.one_of(&["rss", "rss", "resistive"]);
        let step = if random.chance(0.2) || scheme == "implicit-midpoint" {
            "\"auto\"".to_owned()
        } else {
            format!("{:e}", self.step)
        };
        let Self {
            modulus,
            density,
            viscosity,
            ..
        } = self;
        let end = self.step * STEPS as f64;
        let flow = self.flow(random.0);
        let text = format!(
            "experiment = \"scene\"\n[material]\nyoungs_modulus = {modulus:e}\npoissons_ratio = 0.5\ndensity = {density:e}\n\
             [fluid]\nmodel = \"{model}\"\nviscosity = {viscosity:e}\n{flow}[time]\nscheme = \"{scheme}\"\nstep = {step}\nend = {end:e}\n"
        );
        let second = if scheme == "implicit-euler" {
            "backward-differences"
        } else {
            "implicit-euler"
        };
        (text, vec![format!("time.scheme = \"{second}\"")])
    }

    /// A flow of the fluid in three of five scenes, chosen by `state` so that the other random
    /// numbers of the scenes are the same with and without it.
    fn flow(&self, state: u64) -> String {
        let time = self.step * STEPS as f64;
        match state % 5 {
            0 => format!(
                "[fluid.flow]\nkind = \"uniform\"\nvelocity = [0, {:e}, 0]\n",
                self.way / time
            ),
            1 => format!(
                "[fluid.flow]\nkind = \"shear\"\ndirection = [0, 0.6, 0.8]\ngradient = [1, 0, 0]\nrate = {:e}\n",
                self.way / (self.length * time)
            ),
            2 => format!(
                "[fluid.flow]\nkind = \"extension\"\nstretched = [0, 0.6, 0.8]\nrate = {:e}\n",
                self.way / (self.length * time)
            ),
            _ => String::new(),
        }
    }

    fn rod(&self, text: &mut String, name: &str, shape: &str, more: &str) {
        let Self { radius, edges, .. } = self;
        let _ = write!(
            text,
            "[[rods]]\nname = \"{name}\"\nradius = {radius:e}\nedges = {edges}\nshape = {shape}\n{more}"
        );
    }

    fn case(&self, text: String, second: Vec<String>) -> Case {
        Case {
            text,
            radius: self.radius,
            step: self.step,
            resolved_by: (second.iter())
                .any(|key| key.contains("backward-differences"))
                .then_some(100.0),
            second,
            forceless: Vec::new(),
        }
    }
}

fn times(vector: [f64; 3], factor: f64) -> [f64; 3] {
    vector.map(|x| factor * x)
}

fn straight(start: [f64; 3], end: [f64; 3]) -> String {
    format!("{{ kind = \"straight\", start = {start:?}, end = {end:?} }}")
}

const SCHEMES: [&str; 5] = [
    "auto",
    "auto",
    "backward-differences",
    "implicit-euler",
    "implicit-midpoint",
];

/// One or two rods, pulled, driven, rotated or thrown.
pub fn filament(seed: u64) -> Case {
    let mut random = Random(seed);
    let flow = Flow::new(&mut random);
    let (mut text, second) = flow.head(&mut random, &SCHEMES);
    let (l, way, end) = (flow.length, flow.way, flow.step * STEPS as f64);
    let direction = random.direction();
    let line = straight([0.0; 3], [l, 0.0, 0.0]);
    let arc = |angle: f64| {
        format!(
            "{{ kind = \"arc\", start = [0, 0, 0], tangent = [1, 0, 0], normal = [0, 0.6, 0.8], radius = {:e}, angle = {angle:e} }}",
            l / angle
        )
    };
    let pulled = |text: &mut String, rod: &str, force: [f64; 3]| {
        let _ = write!(
            text,
            "[[loads]]\nkind = \"distributed\"\nrod = \"{rod}\"\nforce_per_length = {force:?}\n"
        );
    };
    match random.one_of(&[0, 1, 2, 3, 4, 5, 6, 7]) {
        0 => {
            flow.rod(&mut text, "a", &line, "");
            pulled(&mut text, "a", times(direction, flow.force));
        }
        1 => {
            flow.rod(
                &mut text,
                "a",
                &arc(random.between(0.3, 3.0)),
                "natural_shape = \"as-placed\"\n",
            );
            pulled(&mut text, "a", times(direction, flow.force));
        }
        2 => {
            flow.rod(&mut text, "a", &line, "");
            text.push_str("[[clamps]]\nrod = \"a\"\nat = \"start\"\n");
            pulled(&mut text, "a", times(direction, flow.force));
        }
        3 => {
            flow.rod(&mut text, "a", &line, "");
            let to = times(direction, way);
            let _ = write!(
                text,
                "[[clamps]]\nrod = \"a\"\nat = \"start\"\nmove = [[0, [0, 0, 0]], [{end:e}, {to:?}]]\n"
            );
        }
        4 => {
            let (radius, turns) = (0.05 * l, 2.0);
            let pitch = ((l / turns).powi(2) - (std::f64::consts::TAU * radius).powi(2)).sqrt();
            let helix = format!(
                "{{ kind = \"helix\", start = [0, 0, 0], axis = [1, 0, 0], radius = {radius:e}, pitch = {pitch:e}, turns = {turns} }}"
            );
            flow.rod(&mut text, "a", &helix, "natural_shape = \"as-placed\"\n");
            let rate = way / (radius * end);
            let _ = write!(
                text,
                "[[clamps]]\nrod = \"a\"\nat = \"start\"\naxis = [1, 0, 0]\nangular_velocity = {:e}\n",
                rate.min(2.0 / end)
            );
        }
        5 => {
            flow.rod(&mut text, "a", &line, "");
            let y = flow.radius * random.decades(4.0, 40.0);
            flow.rod(
                &mut text,
                "b",
                &straight([0.2 * l, y, 0.0], [1.2 * l, y, 0.0]),
                "",
            );
            pulled(&mut text, "a", times(direction, flow.force));
            if random.chance(0.5) {
                pulled(&mut text, "b", times(direction, -flow.force));
            }
        }
        6 => {
            flow.rod(
                &mut text,
                "a",
                &line,
                &format!("velocity = {:?}\n", times(direction, way / end)),
            );
        }
        _ => {
            flow.rod(&mut text, "a", &line, "");
            let force = [flow.force * l, 0.0, 0.0];
            let _ = write!(
                text,
                "[[loads]]\nkind = \"force\"\nrod = \"a\"\nat = \"end\"\nforce = {force:?}\n"
            );
        }
    }
    flow.case(text, second)
}

/// Two or three rods that share a point.
pub fn joined(seed: u64) -> Case {
    let mut random = Random(seed);
    let flow = Flow::new(&mut random);
    let schemes = ["auto", "auto", "implicit-euler", "backward-differences"];
    let (mut text, second) = flow.head(&mut random, &schemes);
    let l = flow.length;
    flow.rod(&mut text, "a", &straight([0.0; 3], [l, 0.0, 0.0]), "");
    let bend = random.between(-2.0, 2.0);
    let far = [l + l * bend.cos(), l * bend.sin(), 0.0];
    let kind = random.one_of(&["ball", "rigid", "hinge", "slide", "spring"]);
    let at = if kind == "slide" {
        let middle = flow.edges / 2;
        let x = l * middle as f64 / flow.edges as f64;
        flow.rod(&mut text, "b", &straight([x, 0.0, 0.0], [x, l, 0.0]), "");
        let friction = ["", "friction = 0.2\n", "friction = 2.0\n"][seed as usize % 3];
        format!("kind = \"slide\"\n{friction}rods = [\"b\", \"a\"]\nat = [\"start\", {middle}]\n")
    } else {
        flow.rod(&mut text, "b", &straight([l, 0.0, 0.0], far), "");
        let rods = "rods = [\"a\", \"b\"]\nat = [\"end\", \"start\"]\n";
        let ties = flow.force * l / (0.1 * l);
        match kind {
            "hinge" => format!("kind = \"hinge\"\naxis = [0, 0, 1]\n{rods}"),
            // As with friction, the choice leaves all other random numbers of the scene unchanged.
            "spring" => {
                let only = match seed % 3 {
                    0 => format!("only = \"tension\"\nrest_length = {:e}\n", 0.02 * l),
                    _ => String::new(),
                };
                format!("kind = \"spring\"\nstiffness = {ties:e}\n{only}{rods}")
            }
            _ => format!("kind = \"{kind}\"\n{rods}"),
        }
    };
    let _ = write!(text, "[[joints]]\n{at}");
    if matches!(kind, "ball" | "rigid") && random.chance(0.4) {
        flow.rod(
            &mut text,
            "c",
            &straight([l, 0.0, 0.0], [1.4 * l, 0.0, 0.7 * l]),
            "",
        );
        let _ = write!(
            text,
            "[[joints]]\nkind = \"{kind}\"\nrods = [\"a\", \"c\"]\nat = [\"end\", \"start\"]\n"
        );
    }
    if random.chance(0.5) {
        text.push_str("[[clamps]]\nrod = \"a\"\nat = \"start\"\n");
    }
    if kind == "slide" && seed.is_multiple_of(2) {
        text.push_str("[[clamps]]\nrod = \"b\"\nat = \"start\"\n");
    }
    let force = times(random.direction(), flow.force);
    let rod = random.one_of(&["", "rod = \"b\"\n"]);
    let _ = write!(
        text,
        "[[loads]]\nkind = \"distributed\"\n{rod}force_per_length = {force:?}\n"
    );
    flow.case(text, second)
}
