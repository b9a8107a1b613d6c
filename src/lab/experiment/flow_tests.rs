//! Walls of the flow from scenario files: the chosen plane, rejected scenes, and reports of parts
//! that the flow leaves out.

use super::derived_numbers;
use crate::run::PreparedRun;
use crate::test_support::{self, ran};
use rodlab_engine::mechanics::dynamics::Simulation;

/// A filament three radii above the plane z = 0, pulled along itself.
const GLIDING: &str = r#"
    experiment = "scene"
    material = { youngs_modulus = "1 GPa", poissons_ratio = 0.5, density = 1000.0 }
    time = { scheme = "implicit-euler", step = "10 us", end = "1 ms" }
    [[rods]]
    name = "f"
    radius = "0.1 mm"
    edges = 20
    shape = { kind = "straight", start = [0, 0, "0.3 mm"], end = ["20 mm", 0, "0.3 mm"] }
    [[loads]]
    kind = "distributed"
    force_per_length = ["1e-3 N/m", 0, 0]
"#;
const FLUID: &str = "[fluid]\nmodel = \"rss\"\nviscosity = \"1 Pa s\"\n";

fn prepared(rest: &str) -> Result<PreparedRun, String> {
    test_support::prepared("flow", &format!("{GLIDING}{rest}"))
}

fn simulation(rest: &str) -> Result<Simulation, String> {
    test_support::simulation("flow", &format!("{GLIDING}{rest}"))
}

/// Speed of the filament after a millisecond.
fn speed(rest: &str) -> f64 {
    let mut simulation = simulation(rest).unwrap();
    for _ in 0..100 {
        simulation.advance(f64::INFINITY).unwrap();
    }
    simulation.velocities()[10].x
}

fn remarks(rest: &str) -> Vec<String> {
    let (outcome, _) = ran(&prepared(rest).unwrap()).unwrap();
    outcome.case.remarks
}

#[test]
fn a_plane_beside_a_fluid_slows_a_filament_that_glides_along_it() {
    // From a dense solution with images: 2.729e-4 over 7.615e-4 m/s.
    let free = speed(FLUID);
    for plane in [
        "[[planes]]\n",
        "[[planes]]\nwall = true\n",
        "[[planes]]\n[[planes]]\npoint = [0, 0, -1]\nwall = false\n",
        "[[planes]]\n[contact]\n",
    ] {
        let near = speed(&format!("{FLUID}{plane}"));
        assert!((near / free - 0.358).abs() < 0.01, "{plane}: {near} {free}");
    }
    let ignored = speed(&format!("{FLUID}[[planes]]\nwall = false\n"));
    assert!((ignored / free - 1.0).abs() < 1e-12, "{ignored} {free}");
}

#[test]
fn faults_of_walls_name_the_plane_and_what_is_allowed() {
    let two = "[[planes]]\n[[planes]]\npoint = [0, 0, 1]\nnormal = [0, 0, -1]\n";
    let resistive = "[fluid]\nmodel = \"resistive\"\nviscosity = 1\n[[planes]]\nwall = true\n";
    let cases = [
        (format!("{FLUID}{two}"), "`planes.1.wall`", "wall = false"),
        (resistive.to_owned(), "`planes.0.wall`", "\"rss\""),
        (
            "[[planes]]\nwall = true\n".to_owned(),
            "`planes.0.wall`",
            "\"rss\"",
        ),
    ];
    for (rest, key, advice) in cases {
        let fault = prepared(&rest).unwrap_err();
        assert!(fault.contains(key) && fault.contains(advice), "{fault}");
    }
    let behind = format!("{FLUID}[[planes]]\npoint = [0, 0, 1]\n");
    let fault = simulation(&behind).err().expect("a rod behind the wall");
    assert!(fault.contains("`f`") && fault.contains("behind"), "{fault}");
}

#[test]
fn what_the_flow_leaves_out_is_remarked_and_checked() {
    let ball = "[[obstacles]]\nname = \"ball\"\nshape = { kind = \"sphere\", centre = [0, 0, 1], radius = 0.1 }\n[contact]\n";
    let resistive = FLUID.replace("rss", "resistive");
    let cases = [
        (format!("{FLUID}{ball}"), "obstacle `ball`"),
        (format!("{resistive}{ball}"), "obstacle `ball`"),
        (format!("{resistive}[[planes]]\n"), "plane 0"),
    ];
    for (rest, what) in cases {
        let found = remarks(&rest);
        let is_told = |text: &String| text.contains(what) && text.contains("not part of the flow");
        assert!(found.iter().any(is_told), "{found:?}");
        let numbers = derived_numbers(&prepared(&rest).unwrap());
        assert!(numbers.warnings.iter().any(is_told), "{numbers}");
        assert!(numbers.to_string().contains(what), "{numbers}");
    }
    for rest in [
        FLUID.to_owned(),
        format!("{FLUID}[[planes]]\n"),
        format!("{resistive}[[planes]]\nwall = false\n"),
    ] {
        assert!(remarks(&rest).is_empty(), "{rest}");
    }
    let numbers = derived_numbers(&prepared(&format!("{FLUID}[[planes]]\n")).unwrap());
    assert!(numbers.to_string().contains("no-slip wall"), "{numbers}");
}

#[test]
fn a_rod_nearer_to_the_wall_than_its_radius_is_remarked() {
    let low = format!("{FLUID}[[planes]]\npoint = [0, 0, \"0.15 mm\"]\n");
    let found = remarks(&low);
    assert!(
        found.len() == 1 && found[0].contains("0.500 radii") && found[0].contains("lubrication"),
        "{found:?}"
    );
}

#[test]
fn a_rod_that_stands_on_the_wall_moves_as_if_set_into_it() {
    let standing = |depth: &str| {
        let text = format!(
            r#"
            experiment = "scene"
            material = {{ youngs_modulus = "10 kPa", poissons_ratio = 0.5, density = 1000.0 }}
            time = {{ scheme = "implicit-euler", step = "1 ms", end = "1 s" }}
            [[rods]]
            name = "cilium"
            radius = "0.1 mm"
            edges = 20
            shape = {{ kind = "straight", start = [0, 0, "{depth}"], end = [0, 0, "10 mm"] }}
            [[clamps]]
            rod = "cilium"
            at = "start"
            [[planes]]
            [[loads]]
            kind = "distributed"
            force_per_length = ["1e-4 N/m", 0, 0]
            {FLUID}"#
        );
        let mut simulation = test_support::simulation("cilium", &text).unwrap();
        for _ in 0..20 {
            simulation.advance(f64::INFINITY).unwrap();
        }
        assert_eq!(simulation.fluid_forces()[0].norm(), 0.0);
        simulation.positions()[20].x
    };
    let (on, into) = (standing("0 mm"), standing("-0.02 mm"));
    assert!(on > 1e-7 && (into / on - 1.0).abs() < 0.02, "{on} {into}");
}

/// Tables of flows, and of quadratic drag.
const FLOWS: [&str; 6] = [
    "kind = \"uniform\"\nvelocity = [\"1 cm/s\", 0, 0]\nschedule = [[0, 0], [1, 2]]\n",
    "kind = \"shear\"\ndirection = [1, 0, 0]\ngradient = [0, 0, 2]\nrate = \"3 1/s\"\n",
    "kind = \"rotation\"\naxis = [0, 0, 1]\nangular_velocity = \"10 rpm\"\npoint = [1, 0, 0]\n",
    "kind = \"profile\"\ndirection = [1, 0, 0]\nalong = [0, 0, 1]\nvelocities = [[0, 0], [\"1 m\", \"2 m/s\"]]\n",
    "kind = \"extension\"\nrate = \"3 1/s\"\nstretched = [0, 1, 0]\ncompressed = [2, 0, 0]\n",
    "kind = \"extension\"\nrate = \"3 1/s\"\nstretched = [0, 1, 0]\npoint = [\"1 mm\", 0, 0]\n",
];
const QUADRATIC: &str = "[fluid]\nmodel = \"quadratic\"\ndensity = 1000\nnormal_drag = 1\n";

#[test]
fn flows_of_every_kind_read_back_and_move_rods() {
    for fluid in [FLUID, QUADRATIC] {
        for flow in FLOWS {
            let text = format!("{GLIDING}{fluid}[fluid.flow]\n{flow}");
            let loaded = test_support::loaded("flow", &text).unwrap();
            test_support::assert_reads_back("flow", &loaded.scenario);
            let prepared = test_support::prepared("flow", &text).unwrap();
            assert!(prepared.scene.flow.is_some());
        }
        // The pull is balanced by drag relative to the flow.
        let flow = "[fluid.flow]\nkind = \"uniform\"\nvelocity = [0.1, 0, 0]\n";
        assert!(speed(&format!("{fluid}{flow}")) > speed(fluid));
    }
}

#[test]
fn faults_of_flows_name_their_keys() {
    let flow = |flow: &str| format!("{FLUID}[fluid.flow]\n{flow}");
    for (rest, expected) in [
        (flow("kind = \"uniform\"\n"), "missing key `velocity`"),
        (flow("kind = \"vortex\"\n"), "rotation"),
        (
            flow("kind = \"shear\"\ndirection = [0, 0, 0]\ngradient = [0, 0, 1]\nrate = 1\n"),
            "fluid.flow.direction",
        ),
        (
            flow(FLOWS[4]).replace("[2, 0, 0]", "[2, 1, 0]"),
            "`fluid.flow.compressed`: it is not perpendicular",
        ),
        (
            flow("kind = \"shear\"\ndirection = [1, 0, 0]\ngradient = [1, 0, 1]\nrate = 1\n"),
            "`fluid.flow.gradient`: it is not perpendicular",
        ),
        (
            flow(FLOWS[3]).replace("along = [0, 0, 1]", "along = [0.1, 0, 1]"),
            "`fluid.flow.along`: it is not perpendicular",
        ),
        (
            flow(FLOWS[3]).replace("[[0, 0],", "[[2, 0],"),
            "positions must grow",
        ),
        (
            flow(FLOWS[3]).replace("[[0, 0], [\"1 m\", \"2 m/s\"]]", "[]"),
            "at least one row",
        ),
        (
            FLUID.to_owned() + "density = 1\n",
            "only the model \"quadratic\"",
        ),
        (QUADRATIC.to_owned() + "viscosity = 1\n", "has a density"),
        (
            QUADRATIC.to_owned() + "spin = false\n",
            "does not resist spin",
        ),
        (
            "[fluid]\nmodel = \"quadratic\"\n".to_owned(),
            "missing key `density`",
        ),
        (
            flow("kind = \"uniform\"\nvelocity = [1, 0, 0]\n") + "[[planes]]\n",
            "at rest on the wall",
        ),
    ] {
        let message = simulation(&rest).err().unwrap_or_default();
        assert!(message.contains(expected), "{rest}: {message}");
    }
    let text = format!("{GLIDING}{QUADRATIC}[fluid.flow]\n{}", FLOWS[0]);
    let dynamic = "time = { scheme = \"implicit-euler\", step = \"10 us\", end = \"1 ms\" }";
    let text = text.replace(dynamic, "time = { mode = \"static\" }");
    let message = test_support::loaded("flow", &text).err().unwrap();
    assert!(message.contains("a static run has no time"), "{message}");
}

#[test]
fn bodies_without_quadratic_drag_are_reported() {
    let body = "[[bodies]]\nrod = \"f\"\nat = \"end\"\nmass = \"1 mg\"\nshape = { kind = \"sphere\", radius = \"1 mm\" }\n";
    let numbers = derived_numbers(&prepared(&format!("{QUADRATIC}{body}")).unwrap());
    assert!(numbers.to_string().contains("has no drag"), "{numbers}");
}
