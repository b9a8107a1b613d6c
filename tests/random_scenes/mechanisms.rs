//! Clamped rods that tendons, winches and bungees pull, wires that yield, and rods on scales that slide
//! more easily forwards than backwards.

use super::judged::{Case, STEPS};
use super::random::Random;
use std::f64::consts::PI;

/// A rod with one of these.
pub fn rod(seed: u64) -> Case {
    let mut random = Random(seed);
    let radius = random.decades(2e-4, 5e-3);
    let length = radius * random.decades(40.0, 150.0);
    let edges = random.one_of(&[8, 12, 20]);
    let step = random.decades(1e-4, 2e-3);
    let end = step * STEPS as f64;
    let modulus = random.decades(1e6, 1e9);
    let bending = modulus * PI * radius.powi(4) / 4.0;
    let scheme = random.one_of(&["implicit-euler", "backward-differences"]);
    let unit = bending / (length * length);
    let [across, up] = [(); 2].map(|()| unit * random.between(-3.0, 3.0));
    let clamp = "[[clamps]]\nrod = \"a\"\nat = \"start\"\n";
    let load = format!(
        "[[loads]]\nkind = \"force\"\nrod = \"a\"\nat = \"end\"\nforce = [0, {across:e}, {up:e}]\n\
         schedule = [[0, 0], [{end:e}, 1]]\n"
    );
    let arm = radius * random.between(1.5, 4.0);
    let through = format!(
        "through = [{{ position = [0, {arm:e}, 0] }}, {{ rod = \"a\", at = 1, to = \"end\", offset = [{arm:e}, 0] }}]\n"
    );
    let mut material = String::new();
    let rest = match random.one_of(&[0, 1, 2, 3, 4]) {
        0 => {
            let tension = bending / (arm * length) * random.between(0.1, 1.5);
            let friction = random.one_of(&[0.0, 0.2]);
            format!(
                "{clamp}{load}[[tendons]]\nname = \"t\"\ntension = [[0, 0], [{end:e}, {tension:e}]]\nfriction = {friction:?}\n{through}"
            )
        }
        1 => {
            let stiffness = modulus * PI * radius * radius * random.decades(0.01, 1.0);
            let taken_in = arm * random.between(-0.5, 1.0);
            format!(
                "{clamp}{load}[[tendons]]\nname = \"t\"\nstretching_stiffness = {stiffness:e}\ntaken_in = [[0, 0], [{end:e}, {taken_in:e}]]\n{through}"
            )
        }
        2 => {
            let strength = modulus * random.decades(1e-3, 2e-2);
            let hardening = modulus * random.one_of(&[0.0, 0.05]);
            material = format!("yield_stress = {strength:e}\ntangent_modulus = {hardening:e}\n");
            format!("{clamp}{load}")
        }
        3 => {
            let stiffness = unit / length * random.decades(0.1, 100.0);
            let only = random.one_of(&["tension", "compression"]);
            let side = length * random.between(-1.0, 1.0);
            format!(
                "{clamp}{load}[[rods]]\nname = \"b\"\nheld = true\nradius = {radius:e}\nedges = 1\n\
                 shape = {{ kind = \"straight\", start = [{length:e}, {side:e}, {length:e}], end = [0, {side:e}, {length:e}] }}\n\
                 [[joints]]\nkind = \"spring\"\nonly = \"{only}\"\nstiffness = {stiffness:e}\nrods = [\"a\", \"b\"]\nat = [\"end\", \"start\"]\n"
            )
        }
        _ => {
            let model = random.one_of(&["imc", "ipc"]);
            let [forwards, backwards, sideways] = [(); 3].map(|()| random.between(0.05, 0.8));
            let weight = 9.81 * 1000.0 * PI * radius * radius * length;
            let [along, aside] = [(); 2].map(|()| weight * random.between(-1.0, 1.0));
            format!(
                "[contact]\nmodel = \"{model}\"\n[[planes]]\npoint = [0, 0, {:e}]\nnormal = [0, 0, 1]\n\
                 directed_friction = {{ forwards = {forwards:e}, backwards = {backwards:e}, sideways = {sideways:e} }}\n\
                 [[loads]]\nkind = \"gravity\"\nacceleration = [0, 0, -9.81]\n\
                 [[loads]]\nkind = \"force\"\nrod = \"a\"\nat = {}\nforce = [{along:e}, {aside:e}, 0]\n",
                -1.001 * radius,
                edges / 2
            )
        }
    };
    let text = format!(
        "experiment = \"scene\"\n[material]\nyoungs_modulus = {modulus:e}\npoissons_ratio = 0.5\ndensity = 1000\n{material}\
         [[rods]]\nname = \"a\"\nradius = {radius:e}\nedges = {edges}\ndirector = [0, 1, 0]\n\
         shape = {{ kind = \"straight\", start = [0, 0, 0], end = [{length:e}, 0, 0] }}\n\
         {rest}[time]\nscheme = \"{scheme}\"\nstep = {step:e}\nend = {end:e}\n"
    );
    let (second, finer) = match scheme {
        "implicit-euler" => ("backward-differences", 100.0),
        _ => ("implicit-euler", 10.0),
    };
    Case {
        text,
        radius,
        step,
        second: vec![format!("time.scheme = \"{second}\"")],
        resolved_by: Some(finer),
        forceless: Vec::new(),
    }
}
