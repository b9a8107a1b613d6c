//! Obstacles from scenario files: rejected input with its messages, and the support of a rod by
//! every shape.

use crate::test_support::{self, advance_to, cases};
use rodlab_engine::mechanics::dynamics::Simulation;

const ROD: &str = "experiment = \"scene\"\n[material]\nyoungs_modulus = 1e6\npoissons_ratio = 0.5\ndensity = 1000.0\n\
    [[rods]]\nname = \"rod\"\nradius = 0.005\nedges = 20\nshape = { kind = \"straight\", start = [-0.5, 0, 0.1], end = [0.5, 0, 0.1] }\n";

fn simulation(rest: &str) -> Result<Simulation, String> {
    let text = format!(
        "{ROD}{rest}
[time]
step = 0.001
end = 0.1
"
    );
    test_support::simulation("rod", &text)
}

fn fault(rest: &str) -> String {
    match simulation(rest) {
        Err(message) => message,
        Ok(_) => panic!("{rest} is accepted"),
    }
}

fn with(shape: &str) -> String {
    format!("[contact]\nfriction = 0.3\n[[obstacles]]\nname = \"body\"\nshape = {shape}\n")
}

const OCTAHEDRON: &str = "position = [0, 0, 0.04], \
    vertices = [[0.05,0,0],[-0.05,0,0],[0,0.05,0],[0,-0.05,0],[0,0,0.05],[0,0,-0.05]], \
    triangles = [[0,2,4],[2,1,4],[1,3,4],[3,0,4],[2,0,5],[1,2,5],[3,1,5],[0,3,5]]";
const TETRAHEDRON: &str = "vertices = [[0,0,0],[0.1,0,0],[0,0.1,0],[0,0,0.05]]";

#[test]
fn faults_name_the_obstacle_and_what_is_allowed() {
    let shapes = r#"
        { kind = "ball", radius = 1 } => sphere
        { kind = "sphere", radius = 0.05 } => missing key `centre`
        { kind = "sphere", centre = [0,0,0], radius = -1 } => greater than 0
        { kind = "box", centre = [0,0,0], size = [1,0,1] } => obstacles.0.shape.size.1
        { kind = "box", centre = [0,0,0], size = [1,1,0.1], rounding = 0.05 } => half of the shortest side
        { kind = "tube", start = [0,0,0], end = [0,0,0], radius = 1 } => no axis
        { kind = "mesh" } => an STL or OBJ file
        { kind = "mesh", file = "nowhere.stl" } => nowhere.stl
        { kind = "mesh", TETRAHEDRON, triangles = [[0,2,1],[0,1,3],[0,3,2]] } => holes
        { kind = "mesh", TETRAHEDRON, triangles = [[0,1,2],[0,1,3],[0,3,2],[1,2,3]] } => face opposite ways
        { kind = "mesh", TETRAHEDRON, triangles = [[0,1,2],[0,3,1],[0,2,3],[1,3,2]] } => inwards
        { kind = "mesh", TETRAHEDRON, triangles = [[0,1,1]] } => no area
        { kind = "mesh", TETRAHEDRON, triangles = [[0,1,7]] } => allowed: 0 to 3
        { kind = "mesh", unit = 1e4, TETRAHEDRON, triangles = [[0,2,1],[0,1,3],[0,3,2],[1,2,3]] } => in another unit
        { kind = "mesh", crease_angle = "30 deg", TETRAHEDRON, triangles = [[0,2,1],[0,1,3],[0,3,2],[1,2,3]] } => `smooth = true`
        { kind = "mesh", smooth = true, crease_angle = "91 deg", OCTAHEDRON } => from 0 to 90 deg
        { kind = "mesh", smooth = true, crease_angle = "80 deg", OCTAHEDRON } => the edges of rod `rod`
        { kind = "heights", spacing = 0.1, heights = [[0, 0], [0]] } => the first row has 2
        { kind = "heights", spacing = 0.1, heights = [[0, 0]] } => 2 by 1
    "#;
    let of_shapes = cases(shapes).map(|(shape, expected)| {
        let shape = shape.replace("TETRAHEDRON", TETRAHEDRON);
        let shape = shape.replace("OCTAHEDRON", OCTAHEDRON);
        (with(&shape), expected)
    });
    let others = [
        (
            "[[obstacles]]\nshape = { kind = \"sphere\", centre = [0,0,0], radius = 0.05 }\n"
                .to_owned(),
            "[contact] table",
        ),
        (
            format!(
                "{}[[probes]]\nkind = \"contact_force\"\nname = \"force\"\nfrom_obstacle = \"boddy\"\n",
                with("{ kind = \"sphere\", centre = [0,0,0], radius = 0.05 }")
            ),
            "there are: body",
        ),
    ];
    for (text, expected) in of_shapes.chain(others) {
        let message = fault(&text);
        assert!(message.contains(expected), "{text}\n{message}");
    }
}

#[test]
fn rods_within_obstacles_are_refused_with_edge_and_depth() {
    let shapes = [
        "{ kind = \"sphere\", centre = [0, 0, 0.05], radius = 0.08 }",
        "{ kind = \"box\", centre = [0, 0, 0.1], size = [0.5, 0.5, 0.5] }",
        "{ kind = \"tube\", start = [-1, 0, 0], end = [1, 0, 0], radius = 0.102 }",
    ];
    for shape in shapes {
        let message = fault(&with(shape));
        assert!(
            message.contains("of rod `rod`") && message.contains("obstacle `body`"),
            "{message}"
        );
    }
}

#[test]
fn every_shape_bears_a_rod_with_every_model() {
    let tetrahedron = format!(
        "{{ kind = \"mesh\", position = [0, 0, 0.044], {TETRAHEDRON}, triangles = [[0,2,1],[0,1,3],[0,3,2],[1,2,3]] }}"
    );
    let shapes = [
        "{ kind = \"sphere\", centre = [0, 0, 0.044], radius = 0.05 }",
        "{ kind = \"capsule\", start = [0, -0.1, 0.044], end = [0, 0.1, 0.044], radius = 0.05 }",
        "{ kind = \"cylinder\", point = [0, 0, 0.044], direction = [0, 1, 0], radius = 0.05 }",
        "{ kind = \"box\", centre = [0, 0, 0.044], size = [0.1, 0.1, 0.1], rounding = 0.01 }",
        "{ kind = \"heights\", origin = [-1, -0.1, 0.094], spacing = 0.2, heights = [[0,0,0,0,0,0,0,0,0,0,0],[0,0,0,0,0,0,0,0,0,0,0]] }",
        "{ kind = \"heights\", origin = [-1, -0.1, 0.094], smooth = true, spacing = 0.2, heights = [[0,0,0,0,0,0,0,0,0,0,0],[0,0,0,0,0,0,0,0,0,0,0]] }",
        "{ kind = \"tube\", start = [-1, 0, 1.094], end = [1, 0, 1.094], radius = 1 }",
        tetrahedron.as_str(),
    ];
    for shape in shapes {
        for model in ["imc", "ipc", "complementarity"] {
            let text = format!(
                "{}[[loads]]\nkind = \"gravity\"\nacceleration = [0, 0, -9.81]\n",
                with(shape).replace("friction", &format!("model = \"{model}\"\nfriction"))
            );
            let mut simulation = simulation(&text).unwrap();
            advance_to(&mut simulation, 0.1);
            let middle = simulation.positions()[10].z;
            assert!(
                (0.0987..0.105).contains(&middle),
                "{shape} {model}: {middle}"
            );
            let lifted: f64 = simulation
                .contact_forces()
                .iter()
                .map(|force| force.z)
                .sum();
            assert!(lifted > 0.0, "{shape} {model}");
        }
    }
}

#[test]
fn a_smooth_mesh_of_creases_bears_a_rod_as_a_flat_one_does() {
    let corners = "[[-0.05,-0.05,0],[0.05,-0.05,0],[0.05,0.05,0],[-0.05,0.05,0],\
        [-0.05,-0.05,0.094],[0.05,-0.05,0.094],[0.05,0.05,0.094],[-0.05,0.05,0.094]]";
    let triangles = "[[0,2,1],[0,3,2],[4,5,6],[4,6,7],[0,1,5],[0,5,4],\
        [1,2,6],[1,6,5],[2,3,7],[2,7,6],[3,0,4],[3,4,7]]";
    let [flat, smooth] = [false, true].map(|smooth| {
        let shape = format!(
            "{{ kind = \"mesh\", smooth = {smooth}, vertices = {corners}, triangles = {triangles} }}"
        );
        let gravity = "[[loads]]\nkind = \"gravity\"\nacceleration = [0, 1, -9.81]\n";
        let mut simulation = simulation(&format!("{}{gravity}", with(&shape))).unwrap();
        advance_to(&mut simulation, 0.1);
        simulation.positions().to_vec()
    });
    // Ends have fallen, and the middle is held.
    assert!(flat[0].z < 0.08 && flat[10].z > 0.098);
    for (one, other) in flat.iter().zip(&smooth) {
        assert!((one - other).norm() < 1e-9, "{one} {other}");
    }
}

#[test]
fn an_obstacle_that_rises_lifts_the_rod() {
    for model in ["imc", "ipc", "complementarity"] {
        let text = format!(
            "[contact]\nmodel = \"{model}\"\n[[obstacles]]\nname = \"lifter\"\nshape = {{ kind = \"box\", centre = [0, 0, 0.04], size = [0.2, 0.2, 0.1] }}\n\
             move = [[0, [0, 0, 0]], [0.1, [0, 0, 0.02]]]\nangular_velocity = 2.0\n"
        );
        let mut simulation = simulation(&text).unwrap();
        advance_to(&mut simulation, 0.1);
        // Its top has risen to 0.11 m.
        let middle = simulation.positions()[10].z;
        assert!((0.1149..0.13).contains(&middle), "{model}: {middle}");
    }
}

#[test]
fn a_rod_shot_at_an_obstacle_at_ten_diameters_a_step_does_not_pass() {
    let shapes = [
        (
            "{ kind = \"cylinder\", point = [0.01, 0, 0.04], direction = [0, 1, 0], radius = 0.03 }",
            0.07,
        ),
        (
            "{ kind = \"capsule\", start = [0.01, -2, 0.04], end = [0.01, 2, 0.04], radius = 0.03 }",
            0.07,
        ),
        (
            "{ kind = \"box\", centre = [0, 0, -0.93], size = [2, 2, 2], rounding = 0.01 }",
            0.07,
        ),
        (
            "{ kind = \"heights\", origin = [-1, -1, 0.07], spacing = 0.4, heights = [[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0]] }",
            0.07,
        ),
        (
            "{ kind = \"heights\", origin = [-1, -1, 0.07], smooth = true, spacing = 0.4, heights = [[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0]] }",
            0.07,
        ),
        (
            "{ kind = \"tube\", start = [-1, 0, 0.57], end = [1, 0, 0.57], radius = 0.5 }",
            0.07,
        ),
    ];
    for (shape, height) in shapes {
        for model in ["imc", "ipc", "complementarity"] {
            let text = with(shape).replace("friction", &format!("model = \"{model}\"\nfriction"));
            // 100 m/s, a tenth of the wave speed, at steps of 1 ms.
            let shot = ROD
                .replace("youngs_modulus = 1e6", "youngs_modulus = 1e9")
                .replace("edges = 20", "edges = 20\nvelocity = [0, 0, -100]");
            let text = format!("{shot}{text}\n[time]\nstep = 0.001\nend = 0.004\n");
            let mut simulation = test_support::simulation("rod", &text).unwrap();
            while simulation.time() < 0.004 && simulation.advance(0.004).is_ok() {
                let middle = simulation.positions()[10].z;
                assert!(
                    middle > height,
                    "{shape} {model}: {middle} at {}",
                    simulation.time()
                );
            }
        }
    }
}
