//! Warnings about unintended properties of a scene that can be found before a run: polylines that
//! become shorter when they are cut into edges, and scenes in which no rod can move or nothing
//! acts.

use crate::scenario::{NaturalShape, Scenario, Shape};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{self as mechanics, LoadKind, Scene};

/// Fraction of its length that a polyline may lose without a warning.
const SHORTENED: f64 = 1e-4;

/// The warnings, a sentence each.
pub(super) fn warnings(scenario: &Scenario, scene: &Scene, has_controllers: bool) -> Vec<String> {
    let mut warnings = cut_corners(scenario, scene);
    if !can_move(scene) {
        warnings.push(
            "no rod can move: every one is held, or clamped at all of its nodes and edges"
                .to_owned(),
        );
    } else if !has_controllers && is_at_rest(scene) {
        warnings.push(
            "nothing acts on the rods, which stay as they are placed: there is no load, no motion of a clamp, no velocity and no stress"
                .to_owned(),
        );
    }
    warnings
}

/// Polylines with corners between nodes, which edges cut off.
fn cut_corners(scenario: &Scenario, scene: &Scene) -> Vec<String> {
    let built = scene.rods.len() - scenario.rods.len();
    let placed = &scene.rods[built..];
    let mut warnings = Vec::new();
    for (rod, description) in scenario.rods.iter().zip(placed) {
        let mut compare = |what: &str, shape: &Shape, nodes: &[Vector3]| {
            let Shape::Points { points } = shape else {
                return;
            };
            let points: Vec<Vector3> = points.iter().map(|&point| Vector3::from(point)).collect();
            let (whole, left) = (length(&points, rod.closed), length(nodes, rod.closed));
            if whole - left > SHORTENED * whole {
                warnings.push(format!(
                    "rod `{}` is {left:.6} m long and the polyline of its {what} {whole:.6} m: edges cut corners between nodes; choose `edges` so that nodes lie at the corners, or leave it out",
                    rod.name
                ));
            }
        };
        // If the natural shape is another curve, the placed shape is only a start.
        if !matches!(rod.natural_shape, NaturalShape::Curve(_)) {
            compare("shape", &rod.shape, &description.centreline);
        }
        if let (NaturalShape::Curve(shape), mechanics::NaturalShape::Centreline(nodes)) =
            (&rod.natural_shape, &description.natural_shape)
        {
            compare("natural_shape", shape, nodes);
        }
    }
    warnings
}

/// Length of a polyline, m.
fn length(points: &[Vector3], closed: bool) -> f64 {
    let open = points.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    let closing = match points {
        [first, .., last] if closed => (first - last).norm(),
        _ => 0.0,
    };
    open.sum::<f64>() + closing
}

/// Whether any node or edge of a rod is free.
fn can_move(scene: &Scene) -> bool {
    scene.rods.iter().enumerate().any(|(index, rod)| {
        let clamps = || scene.clamps.iter().filter(|clamp| clamp.rod == index);
        let held_nodes = clamps().filter(|clamp| clamp.holds_position).count();
        let is_turned = clamps().any(|clamp| clamp.holds_frame);
        // An edge between two held nodes can still rotate about itself, unless a clamp holds its
        // frame.
        !rod.held && (held_nodes < rod.centreline.len() || !is_turned)
    })
}

/// Whether nothing acts on the rods, so that they stay as placed.
fn is_at_rest(scene: &Scene) -> bool {
    let without_stress = |rod: &mechanics::RodDescription| {
        let is_natural = match rod.natural_shape {
            mechanics::NaturalShape::AsPlaced => true,
            mechanics::NaturalShape::Straight => is_straight(&rod.centreline, rod.closed),
            _ => false,
        };
        rod.held
            || is_natural
                && rod.twist == 0.0
                && rod.pretension == 0.0
                && rod.velocity == Vector3::zeros()
                && rod.angular_velocity == Vector3::zeros()
    };
    scene
        .loads
        .iter()
        .all(|load| matches!(load.kind, LoadKind::Drag { .. }))
        && scene.actuations.is_empty()
        && scene.springs.is_empty()
        && scene.forces.is_empty()
        && scene.tendons.is_empty()
        && scene.sheaths.is_empty()
        && scene.contact.is_none()
        && scene.fluid.is_none()
        && scene.start.is_none()
        && scene.clamps.iter().all(|clamp| !clamp.motion.moves())
        && scene.rods.iter().all(without_stress)
        && !scene.joints.iter().any(|joint| {
            matches!(
                joint.kind,
                mechanics::JointKind::Hinge {
                    spring: Some(_),
                    ..
                }
            )
        })
}

/// Whether nodes lie on a line.
fn is_straight(nodes: &[Vector3], closed: bool) -> bool {
    let [first, .., last] = nodes else {
        return true;
    };
    let along = (last - first).normalize();
    !closed
        && nodes
            .iter()
            .all(|node| (node - first).cross(&along).norm() < 1e-9 * (last - first).norm())
}

#[cfg(test)]
mod tests {
    use crate::experiment::derived_numbers;
    use crate::test_support::prepared;

    const MATERIAL: &str = "experiment = \"scene\"\nmaterial = { youngs_modulus = \"1 GPa\", poissons_ratio = 0.3, density = 1000.0 }\n";
    const GRAVITY: &str = "[[loads]]\nkind = \"gravity\"\nacceleration = [0, 0, -9.81]\n";

    fn warnings(rest: &str) -> Vec<String> {
        let text = format!("{MATERIAL}time = {{ end = 1.0 }}\n{rest}");
        let numbers = derived_numbers(&prepared("scene", &text).unwrap());
        let words = numbers.to_string();
        let shown = numbers
            .warnings
            .iter()
            .all(|warning| words.contains(warning));
        assert!(shown, "{words}");
        numbers.warnings
    }

    #[test]
    fn a_polyline_that_is_cut_shorter_is_reported() {
        let line = |edges: usize| {
            let rod = format!(
                "[[rods]]\nname = \"line\"\nradius = \"5 mm\"\nedges = {edges}\n\
                 shape = {{ kind = \"points\", points = [[0, 0, 0], [300, 0, -40], [700, 0, 20]] }}\n"
            );
            warnings(&(rod + GRAVITY))
        };
        // The first part has 302.66 m of 707.14 m.
        let found = line(10);
        assert!(
            found.len() == 1 && found[0].contains("`line`") && found[0].contains("707.1"),
            "{found:?}"
        );
        assert!(line(2).is_empty());
    }

    #[test]
    fn a_scene_in_which_no_rod_can_move_is_reported() {
        let rod = "[[rods]]\nname = \"bar\"\nradius = \"5 mm\"\nedges = 3\n\
                   shape = { kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }\n";
        let clamps: String = (0..4)
            .map(|node| format!("[[clamps]]\nrod = \"bar\"\nat = {node}\n"))
            .collect();
        let found = warnings(&format!("{rod}{clamps}{GRAVITY}"));
        assert!(
            found.len() == 1 && found[0].contains("no rod can move"),
            "{found:?}"
        );
        assert!(warnings(&format!("{rod}{GRAVITY}")).is_empty());
        let found = warnings(rod);
        assert!(
            found.len() == 1 && found[0].contains("nothing acts"),
            "{found:?}"
        );
        assert!(warnings(&format!("{rod}velocity = [1, 0, 0]\n")).is_empty());
    }

    #[test]
    fn a_rope_that_turns_sharply_at_an_eye_is_reported_before_it_runs() {
        let pulley = |edges: usize, bending: &str| {
            warnings(&format!(
                "[[rods]]\nname = \"rope\"\nradius = \"1 mm\"\nedges = {edges}\n\
                 shape = {{ kind = \"points\", points = [[0, 0, -0.5], [0.01, 0, 0], [0.02, 0, -0.5]] }}\n\
                 natural_shape = \"straight\"\n\
                 stiffness = {{ bending_1 = \"{bending}\", bending_2 = \"{bending}\" }}\n\
                 [[rods]]\nname = \"eye\"\nradius = \"4 mm\"\nedges = 2\n\
                 shape = {{ kind = \"straight\", start = [0.01, 0, 0], end = [0.01, 0, 0.02] }}\n\
                 [[joints]]\nkind = \"slide\"\nrods = [\"eye\", \"rope\"]\nat = [\"start\", {}]\n\
                 [[clamps]]\nrod = \"eye\"\nat = \"end\"\n\
                 [[bodies]]\nrod = \"rope\"\nat = \"end\"\nmass = \"1 kg\"\n{GRAVITY}",
                edges / 2
            ))
        };
        let found = pulley(40, "1e-6 N m^2");
        assert!(
            found.len() == 1 && found[0].contains("friction coefficient of about"),
            "{found:?}"
        );
        assert!(pulley(40, "0.1 N m^2").is_empty());
    }
}
