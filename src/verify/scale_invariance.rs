//! Scenes in other units, to check that no constant in the code has a dimension.
//!
//! A scene with lengths scaled by L, times by T and masses by M is the same scene, and its motion
//! is scaled accordingly. Positions, velocities and energies are compared over all outputs, each
//! relative to its largest value.

use super::{Check, Expectation, GroupError, scenario};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_lab::experiment;
use rodlab_lab::run::Mode;
use rodlab_lab::scenario::Scales;

const SCALE_INVARIANCE: Expectation =
    Expectation::new("x(L, T, M; t T) = L x(t)", "dimensional analysis");
const BOUND: f64 = 1e-10;
/// Number of outputs of each motion.
const OUTPUTS: usize = 10;

/// Units of length from nanometres to kilometres, with unrelated units of time and mass.
const UNITS: [(&str, Scales); 4] = [
    ("nm", scales(1e-9, 1e-6, 1e-15)),
    ("µm", scales(1e-6, 1e-3, 1e-12)),
    ("mm", scales(1e-3, 1e-1, 1e-6)),
    ("km", scales(1e3, 1e2, 1e6)),
];

const fn scales(length: f64, time: f64, mass: f64) -> Scales {
    Scales { length, time, mass }
}

/// A falling cantilever with automatic steps; a pile with friction; a joint and a body; a filament
/// in fluid.
const SCENES: [(&str, &str); 4] = [
    (
        "cantilever, automatic steps",
        include_str!("scenes/scaled_cantilever.toml"),
    ),
    ("rods that rub", include_str!("scenes/scaled_contact.toml")),
    ("hinge and body", include_str!("scenes/scaled_joints.toml")),
    (
        "filament in fluid",
        include_str!("scenes/scaled_filament.toml"),
    ),
];

/// Checks the largest difference over all units.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for (name, text) in SCENES {
        let reference = Motion::of(text)?;
        let mut worst = 0.0_f64;
        for (_, scales) in UNITS {
            let scaled = Motion::of(&experiment::rescaled(text, &scales)?)?;
            worst = worst.max(reference.difference(&scaled, &scales));
        }
        let name = format!("{name}, in nm to km: largest difference");
        checks.push(SCALE_INVARIANCE.of(name, "").zero(worst, BOUND));
    }
    Ok(checks)
}

/// Result of a sceneat every output, or at every point of a path.
#[derive(Clone, Debug, Default)]
struct Motion {
    positions: Vec<Vector3>,
    velocities: Vec<Vector3>,
    energies: Vec<f64>,
    /// Steps and Newton iterations of the whole run.
    work: [usize; 2],
}

impl Motion {
    fn of(text: &str) -> Result<Self, GroupError> {
        let prepared = scenario::prepared(text, &[])?;
        let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
        let mut motion = Self::default();
        match prepared.mode {
            Mode::Static => {
                motion.work[1] = simulation.find_equilibrium()?.newton_iterations;
                motion.record(&simulation);
            }
            Mode::Continuation(plan) => {
                let mut path = simulation.path(plan)?;
                while let Some(point) = simulation.next_point(&mut path)? {
                    motion.work[0] += 1;
                    motion.work[1] += point.iterations;
                    motion.record(&simulation);
                }
            }
            Mode::Dynamic { end, .. } => {
                for output in 1..=OUTPUTS {
                    let until = end * output as f64 / OUTPUTS as f64;
                    while simulation.time() < until {
                        let report = simulation.advance(until)?;
                        motion.work[0] += 1;
                        motion.work[1] += report.newton_iterations;
                    }
                    motion.record(&simulation);
                }
            }
        }
        Ok(motion)
    }

    fn record(&mut self, simulation: &Simulation) {
        self.positions.extend(simulation.positions());
        self.velocities.extend(simulation.velocities());
        let energies = simulation.energies();
        self.energies.extend([energies.kinetic, energies.elastic()]);
    }

    /// The largest difference from the same scene in other units; infinite if the numbers of
    /// outputs differ.
    fn difference(&self, scaled: &Self, scales: &Scales) -> f64 {
        let flat = |vectors: &[Vector3]| vectors.iter().flatten().copied().collect::<Vec<f64>>();
        [
            relative(
                &flat(&self.positions),
                &flat(&scaled.positions),
                scales.of([1, 0, 0]),
            ),
            relative(
                &flat(&self.velocities),
                &flat(&scaled.velocities),
                scales.of([1, -1, 0]),
            ),
            relative(&self.energies, &scaled.energies, scales.of([2, -2, 1])),
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }
}

/// Largest |b/factor − a| over the largest |a|.
fn relative(a: &[f64], b: &[f64], factor: f64) -> f64 {
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    let largest = a.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
    let pairs = a.iter().zip(b);
    let apart = pairs.map(|(a, b)| (b / factor - a).abs());
    let farthest = apart.fold(
        0.0_f64,
        |most, d| if d > most || d.is_nan() { d } else { most },
    );
    if farthest == 0.0 {
        0.0
    } else {
        farthest / largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Powers of two whose square roots are powers of two, which cause no rounding errors.
    const BINARY: Scales = scales(
        1.0 / (1u64 << 36) as f64,
        1.0 / (1u64 << 12) as f64,
        1.0 / (1u64 << 48) as f64,
    );

    const ROD: &str = "experiment = 'scene'\n[material]\nyoungs_modulus = 1e6\npoissons_ratio = 0.5\ndensity = 1000\n";
    const CANTILEVER: &str = "[[rods]]\nname = 'a'\nradius = '5 mm'\nedges = 12\nshape = { kind = 'straight', start = [0, 0, 0], end = [0.3, 0, 0] }\n[[clamps]]\nrod = 'a'\nat = 'start'\n[[loads]]\nkind = 'gravity'\nacceleration = [0, 0, -9.81]\n";

    /// Asserts that a scene is the same in all units. In binary units most results agree to the
    /// last bit; the remaining ones compare or add forces and moments, which only changes
    /// rounding.
    fn assert_same(name: &str, text: &str) {
        let motion =
            |text: &str| Motion::of(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let reference = motion(text);
        let in_units = |scales: &Scales| motion(&experiment::rescaled(text, scales).unwrap());
        let mut report = format!("{name}: work {:?}", reference.work);
        let mut worst = 0.0_f64;
        for (unit, scales) in UNITS {
            let scaled = in_units(&scales);
            let difference = reference.difference(&scaled, &scales);
            report += &format!("; {unit} {difference:.1e} {:?}", scaled.work);
            worst = worst.max(difference);
        }
        let scaled = in_units(&BINARY);
        let binary = reference.difference(&scaled, &BINARY);
        println!("{report}; binary {binary:.1e} {:?}", scaled.work);
        assert!(worst.max(binary) < BOUND, "{report}; binary {binary:e}");
    }

    fn scene(tables: &str) -> String {
        format!("{ROD}{tables}")
    }

    #[test]
    fn a_cantilever_falls_alike_in_all_units() {
        for scheme in [
            "implicit-euler",
            "implicit-midpoint",
            "backward-differences",
        ] {
            for step in ["'2 ms'", "'auto'"] {
                let time = format!("[time]\nscheme = '{scheme}'\nstep = {step}\nend = 0.1\n");
                assert_same(
                    &format!("{scheme} {step}"),
                    &scene(&format!("{CANTILEVER}{time}")),
                );
            }
        }
        assert_same(
            "defaults",
            &scene(&format!("{CANTILEVER}[time]\nend = 0.1\n")),
        );
    }

    #[test]
    fn automatic_steps_grow_however_close_outputs_are() {
        let time = "[time]\nstep = 'auto'\nend = 1\n[output]\ninterval = 0.02\n";
        let text = scene(&format!("{CANTILEVER}{time}"));
        let reference = Motion::of(&text).unwrap();
        for (unit, scales) in UNITS {
            let scaled = Motion::of(&experiment::rescaled(&text, &scales).unwrap()).unwrap();
            assert_eq!(scaled.work, reference.work, "{unit}");
        }
        // A minimum step in the file affects only the initial step.
        let least = "[solver]\nminimum_step = '0.1 ms'\n";
        let coarse = Motion::of(&format!("{text}{least}")).unwrap();
        assert!(coarse.work[0] < 2 * reference.work[0], "{:?}", coarse.work);
    }

    #[test]
    fn equilibria_are_alike_in_all_units() {
        let time = "[time]\nmode = 'static'\n";
        assert_same("static", &scene(&format!("{CANTILEVER}{time}")));
        let column = "[[rods]]\nname = 'a'\nradius = '5 mm'\nedges = 16\nshape = { kind = 'straight', start = [0, 0, 0], end = [0.02, 0.01, 1] }\n[[clamps]]\nrod = 'a'\nat = 'start'\n[[loads]]\nkind = 'gravity'\nacceleration = [0, 0, -9.81]\n";
        assert_same("buckled column", &scene(&format!("{column}{time}")));
        let ring = "[[rods]]\nname = 'a'\nradius = '2 mm'\nedges = 24\nshape = { kind = 'ring', centre = [0, 0, 0], radius = 0.1 }\n[[clamps]]\nrod = 'a'\nat = 0\nhold = 'position'\n[[clamps]]\nrod = 'a'\nat = 12\nhold = 'position'\n[[loads]]\nkind = 'gravity'\nacceleration = [0, 0, -9.81]\n";
        assert_same("hanging ring", &scene(&format!("{ring}{time}")));
    }

    #[test]
    fn paths_of_equilibria_are_alike_in_all_units() {
        let path = "[[rods]]\nname = 'a'\nradius = '5 mm'\nedges = 12\nshape = { kind = 'straight', start = [0, 0, 0], end = [0.3, 0, 0] }\n[[clamps]]\nrod = 'a'\nat = 'start'\n[[loads]]\nkind = 'force'\nrod = 'a'\nat = 'end'\nforce = [-0.05, 0, 0.02]\nschedule = [[0, 0], [1, 1]]\n[time]\nmode = 'continuation'\n[continuation]\nto = 1\n";
        assert_same("path", &scene(path));
    }

    #[test]
    fn contact_is_alike_in_all_units() {
        for (model, friction) in [
            ("imc", 0.3),
            ("ipc", 0.3),
            ("complementarity", 0.3),
            ("ipc", 0.0),
        ] {
            let text = include_str!("scenes/scaled_contact.toml");
            let text = text
                .replace("\"imc\"", &format!("\"{model}\""))
                .replace("friction = 0.3", &format!("friction = {friction}"));
            let slip = "slip_tolerance = \"1 mm/s\"\n";
            let text = match model {
                "complementarity" => text.replace(slip, ""),
                _ => text,
            };
            assert_same(&format!("{model} {friction}"), &text);
        }
    }

    #[test]
    fn obstacles_are_alike_in_all_units() {
        let rod = "[[rods]]\nname = 'a'\nradius = '2 mm'\nedges = 10\nshape = { kind = 'straight', start = [-0.1, 0.003, 0], end = [0.1, 0, 0] }\n[[loads]]\nkind = 'gravity'\nacceleration = [0, 0, -9.81]\n[contact]\nmodel = 'ipc'\nfriction = 0.2\nslip_tolerance = '1 mm/s'\n[time]\nstep = '1 ms'\nend = 0.05\n[[obstacles]]\nname = 'o'\n";
        for shape in [
            "{ kind = 'cylinder', point = [0, 0, -0.02], direction = [0, 1, 0], radius = 0.01 }",
            "{ kind = 'sphere', centre = [0, 0, -0.02], radius = 0.01 }",
            "{ kind = 'box', centre = [0, 0, -0.02], size = [0.02, 0.02, 0.02], rounding = 0.002 }",
        ] {
            assert_same(shape, &scene(&format!("{rod}shape = {shape}\n")));
        }
    }

    #[test]
    fn joints_and_bodies_are_alike_in_all_units() {
        let joints = include_str!("scenes/scaled_joints.toml");
        assert_same("hinge", joints);
        for joint in [
            "kind = \"rigid\"",
            "kind = \"ball\"",
            "kind = \"slide\"",
            "kind = \"spring\"\nstiffness = 20\nturning_stiffness = 0.01",
        ] {
            let hinge = "kind = \"hinge\"\naxis = [0, 1, 0]\nstiffness = 0.01";
            assert!(joints.contains(hinge));
            assert_same(joint, &joints.replace(hinge, joint));
        }
        let fixed = joints.split("[time]").next().unwrap();
        assert_same("static", &format!("{fixed}[time]\nmode = 'static'\n"));
    }

    #[test]
    fn fluids_are_alike_in_all_units() {
        let filament = include_str!("scenes/scaled_filament.toml");
        for scheme in ["implicit-euler", "backward-differences"] {
            for model in ["rss", "resistive"] {
                let text = filament
                    .replace("\"rss\"", &format!("\"{model}\""))
                    .replace("\"implicit-euler\"", &format!("\"{scheme}\""));
                assert_same(&format!("{model} {scheme}"), &text);
            }
        }
    }

    #[test]
    fn damping_and_actuation_are_alike_in_all_units() {
        let damped = CANTILEVER.replace("[[clamps]]", "material = { youngs_modulus = 1e6, poissons_ratio = 0.5, density = 1000, viscosity = 2e3 }\n[[clamps]]");
        assert_same(
            "damped",
            &scene(&format!("{damped}[time]\nstep = '2 ms'\nend = 0.1\n")),
        );
        let driven = CANTILEVER.replace("at = 'start'", "at = 'start'\nmove = [[0, [0, 0, 0]], [0.05, [0, 0.05, 0.02]]]\nturn = [[0, 0], [0.1, 1]]");
        assert_same(
            "driven",
            &scene(&format!("{driven}[time]\nstep = 'auto'\nend = 0.1\n")),
        );
    }
}
