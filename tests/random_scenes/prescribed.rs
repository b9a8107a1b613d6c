//! Rods that are held at the place of contact: clamped in a floor or in the wall of a tube, in one
//! chuck, in one root.

use super::judged::{Case, STEPS};
use super::random::Random;
use std::fmt::Write;

/// A scene with contact between prescribed parts.
pub fn contact(seed: u64) -> Case {
    let mut random = Random(seed);
    let radius = random.decades(2e-4, 5e-3);
    let length = radius * random.decades(20.0, 80.0);
    let edges = random.one_of(&[8, 12, 20]);
    let step = random.decades(1e-4, 2e-3);
    let end = step * STEPS as f64;
    let model = random.one_of(&["imc", "ipc", "complementarity"]);
    let scheme = if model == "complementarity" {
        "implicit-euler"
    } else {
        random.one_of(&["implicit-euler", "backward-differences"])
    };
    let friction = random.one_of(&[0.0, 0.3]);
    let modulus = random.decades(1e6, 1e9);
    let mut text = format!(
        "experiment = \"scene\"\n[material]\nyoungs_modulus = {modulus:e}\npoissons_ratio = 0.5\ndensity = 1000\n\
         [contact]\nmodel = \"{model}\"\nfriction = {friction:?}\n[time]\nscheme = \"{scheme}\"\nstep = {step:e}\nend = {end:e}\n\
         [[loads]]\nkind = \"gravity\"\nacceleration = [{:e}, 0, -9.81]\n",
        random.between(-9.81, 9.81)
    );
    let mut rod = |name: &str, start: [f64; 3], end: [f64; 3], more: &str| {
        let _ = write!(
            text,
            "[[rods]]\nname = \"{name}\"\nradius = {radius:e}\nedges = {edges}\nshape = {{ kind = \"straight\", start = {start:?}, end = {end:?} }}\n{more}"
        );
    };
    let clamp = |name: &str| format!("[[clamps]]\nrod = \"{name}\"\nat = \"start\"\n");
    let mut forceless = Vec::new();
    let more = match random.one_of(&[0, 1, 2, 3, 4]) {
        0 => {
            let tilt = random.between(-0.5, 0.5) * length;
            rod("a", [0.0; 3], [tilt, 0.0, length], "");
            format!(
                "{}[[planes]]\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n",
                clamp("a")
            )
        }
        1 => {
            let near = 2.0 * radius * random.between(0.99, 1.02);
            rod("a", [0.0; 3], [length, 0.0, 0.0], "");
            rod(
                "b",
                [0.0, near, 0.0],
                [length, near + 0.3 * length, 0.0],
                "",
            );
            clamp("a") + &clamp("b")
        }
        2 => {
            let near = 2.0 * radius * random.between(0.99, 1.01);
            rod("a", [0.0; 3], [length, 0.0, 0.0], "held = true\n");
            rod("b", [0.0, near, 0.0], [length, near, 0.0], "held = true\n");
            rod("c", [0.0, 0.0, length], [length, 0.0, length], "");
            forceless = vec![0, 1];
            String::new()
        }
        3 => {
            for (k, name) in ["a", "b", "c"].into_iter().enumerate() {
                let angle = 2.1 * k as f64 + random.between(0.0, 0.5);
                let [x, y] = [angle.cos(), angle.sin()].map(|x| 0.5 * length * x);
                rod(name, [0.0; 3], [x, y, length], "");
            }
            ["a", "b", "c"].map(clamp).concat()
        }
        _ => {
            // A rod from the wall of a tube towards its axis.
            let wide = 0.8 * length;
            rod("a", [wide, 0.0, 0.0], [0.0, 0.0, 0.3 * length], "");
            format!(
                "{}[[obstacles]]\nname = \"tube\"\nshape = {{ kind = \"tube\", start = [0, 0, {:e}], end = [0, 0, {:e}], radius = {wide:e} }}\n",
                clamp("a"),
                -2.0 * length,
                2.0 * length
            )
        }
    };
    text += &more;
    let second = if model == "complementarity" {
        vec!["contact.model = \"ipc\"".to_owned()]
    } else if scheme == "implicit-euler" {
        vec!["time.scheme = \"backward-differences\"".to_owned()]
    } else {
        vec!["time.scheme = \"implicit-euler\"".to_owned()]
    };
    Case {
        text,
        radius,
        step,
        second,
        resolved_by: Some(if scheme == "implicit-euler" {
            100.0
        } else {
            10.0
        }),
        forceless,
    }
}
