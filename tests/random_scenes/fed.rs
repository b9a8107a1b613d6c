//! Rods that are fed out of sheaths, drawn in and turned, by given lengths or by forces, straight and
//! curved by nature, with and without a wall before them.

use super::judged::{Case, STEPS};
use super::random::Random;
use std::f64::consts::PI;
use std::fmt::Write;

/// A rod in a sheath.
pub fn rod(seed: u64) -> Case {
    let mut random = Random(seed);
    let radius = random.decades(2e-4, 5e-3);
    let length = radius * random.decades(40.0, 120.0);
    let edges = random.one_of(&[10, 16, 30]);
    let step = random.decades(1e-4, 2e-3);
    let end = step * STEPS as f64;
    let modulus = random.decades(1e6, 1e9);
    let touches = random.chance(0.5);
    let model = random.one_of(&["imc", "ipc", "complementarity"]);
    let scheme = match (touches, model) {
        (true, "complementarity") => "implicit-euler",
        _ => random.one_of(&["implicit-euler", "backward-differences"]),
    };
    let edge = length / edges as f64;
    let inside = length * random.between(0.3, 0.8);
    let most = (inside - edge).min(0.3 * length);
    let fed = random.between(-0.3 * length, most) * random.between(0.1, 1.0);
    // The rod is turned by as much as its surface travels when it is fed.
    let turned = random.between(-1.0, 1.0) * most / length * 3.0;
    let from = random.one_of(&["start", "end"]);
    let curvature = random.one_of(&[0.0, 1.0]) * random.between(0.5, 2.0) / length;
    // A rod that is curved by nature is released straight. Backward differences do not damp its
    // vibration, which bounces on a plane in steps that do not resolve it.
    let bounces = touches && scheme == "backward-differences";
    let curvature = if bounces { 0.0 } else { curvature };
    let ends = match from {
        "start" => [0.0, length],
        _ => [length, 0.0],
    };
    let mut text = format!(
        "experiment = \"scene\"\n[material]\nyoungs_modulus = {modulus:e}\npoissons_ratio = 0.5\ndensity = 1000\n\
         [time]\nscheme = \"{scheme}\"\nstep = {step:e}\nend = {end:e}\n\
         [[loads]]\nkind = \"gravity\"\nacceleration = [{:e}, {:e}, -9.81]\n\
         [[rods]]\nname = \"a\"\nradius = {radius:e}\nedges = {edges}\nnatural_curvature = [0, {curvature:e}]\n\
         shape = {{ kind = \"straight\", start = [{:e}, 0, 0], end = [{:e}, 0, 0] }}\n\
         [[sheaths]]\nrod = \"a\"\nfrom = \"{from}\"\ninside = {inside:e}\n\
         fed = [[0, 0], [{end:e}, {fed:e}]]\nturned = [[0, 0], [{end:e}, {turned:e}]]\n",
        random.between(-9.81, 9.81),
        random.between(-3.0, 3.0),
        ends[0],
        ends[1],
    );
    if touches {
        let friction = random.one_of(&[0.0, 0.3]);
        let before = length + random.between(0.02, 0.1) * length + radius;
        let below = radius * random.between(1.01, 3.0);
        let _ = write!(
            text,
            "[contact]\nmodel = \"{model}\"\nfriction = {friction:?}\n\
             [[planes]]\npoint = [{before:e}, 0, 0]\nnormal = [-0.8, 0, 0.6]\n\
             [[planes]]\npoint = [0, 0, {:e}]\nnormal = [0, 0, 1]\n",
            -below
        );
    }
    if random.chance(0.4) {
        // Without other forces this force feeds the same length.
        let mass = 1000.0 * PI * radius * radius * length;
        let force = 2.0 * mass * fed / (end * end);
        let fed = format!("fed = [[0, 0], [{end:e}, {fed:e}]]");
        text = text.replace(&fed, &format!("pushed = [[0, {force:e}]]"));
    }
    let second = match scheme {
        _ if touches && model == "complementarity" => "contact.model = \"ipc\"",
        "implicit-euler" => "time.scheme = \"backward-differences\"",
        _ => "time.scheme = \"implicit-euler\"",
    };
    Case {
        text,
        radius,
        step,
        second: vec![second.to_owned()],
        resolved_by: Some(match scheme {
            "implicit-euler" => 100.0,
            _ => 10.0,
        }),
        forceless: Vec::new(),
    }
}
