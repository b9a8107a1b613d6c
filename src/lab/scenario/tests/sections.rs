//! Sections along a rod: defaults, what is refused, and the resolved file.

use super::{BEAM, read};
use crate::scenario::{CrossSection, Inertia, Scenario};

/// The beam, 1 m long, with lines after its shape.
fn beam(lines: &str) -> String {
    let shape = "shape = { kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }\n";
    assert!(BEAM.contains(shape));
    BEAM.replacen(shape, &format!("{shape}{lines}"), 1)
}

fn sections(lines: &str) -> String {
    beam(&format!("[[rods.sections]]\n{lines}"))
}

fn good(lines: &str) -> Scenario {
    read(&sections(lines)).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(lines: &str) -> String {
    read(&sections(lines)).unwrap_err().to_string()
}

#[test]
fn keys_that_are_not_given_are_those_of_the_rod_and_of_the_neighbours() {
    let scenario = good(
        "to = \"20 cm\"\nend_radius = \"2 mm\"\n[[rods.sections]]\n[[rods.sections]]\nfrom = 0.6\ndensity = 7000\n",
    );
    let rod = &scenario.rods[0];
    let [first, second, third] = rod.sections.as_slice() else {
        panic!("{:?}", rod.sections);
    };
    assert_eq!((first.from, first.to), (0.0, Some(0.2)));
    assert_eq!((second.from, second.to), (0.2, Some(0.6)));
    assert_eq!((third.from, third.to), (0.6, None));
    assert_eq!((first.radius, first.end_radius), (5e-3, 2e-3));
    assert_eq!((second.radius, second.end_radius), (5e-3, 5e-3));
    assert_eq!((second.density, third.density), (1000.0, 7000.0));
    assert_eq!(third.youngs_modulus, 1e8);
    assert_eq!(rod.least_radius(), 2e-3);
    // The same section everywhere would be needed for consistent inertia.
    assert_eq!(rod.inertia, Inertia::Lumped);
    assert_eq!(read(BEAM).unwrap().rods[0].inertia, Inertia::Consistent);
}

#[test]
fn rectangles_and_tubes_taper() {
    let scenario = good(
        "to = 0.5\ncross_section = { kind = \"rectangle\", width = 0.02, thickness = 0.01 }\nend_width = 0.004\n\
         [[rods.sections]]\ncross_section = { kind = \"tube\", wall = \"1 mm\" }\nend_radius = \"3 mm\"\n",
    );
    let [strip, tube] = scenario.rods[0].sections.as_slice() else {
        panic!("two sections");
    };
    let (radius, shape) = strip.at(0.5);
    assert!((radius - 0.0035).abs() < 1e-15, "{radius}");
    let CrossSection::Rectangle { width, thickness } = shape else {
        panic!("{shape:?}");
    };
    assert!((width - 0.012).abs() < 1e-15 && thickness == 0.01);
    let (radius, shape) = tube.at(1.0);
    let expected = std::f64::consts::PI * (9e-6 - 4e-6);
    assert!((shape.area(radius) / expected - 1.0).abs() < 1e-14);
    let expected = 0.25 * std::f64::consts::PI * (81e-12 - 16e-12);
    assert!((shape.second_moments(radius)[1] / expected - 1.0).abs() < 1e-14);
    assert!((shape.torsion_constant(radius) / expected - 2.0).abs() < 1e-14);
}

#[test]
fn resolved_sections_read_back_to_themselves() {
    let scenario = good(
        "to = 0.3\nend_radius = \"2 mm\"\nnatural_curvature = [0, 3]\n[[rods.sections]]\nnatural_twist = 2.0\nyoungs_modulus = \"2 GPa\"\n",
    );
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
}

#[test]
fn faults_name_the_section_and_what_is_allowed() {
    for (lines, key, word) in [
        (
            "to = 0.5\n[[rods.sections]]\nfrom = 0.4\n",
            "rods.0.sections.1.from",
            "at least 0.5 m",
        ),
        (
            "from = 0.5\nto = 0.4\n",
            "rods.0.sections.0.to",
            "must have a length",
        ),
        (
            "from = 0.5\n[[rods.sections]]\nfrom = 0.5\n",
            "rods.0.sections.0.from",
            "must have a length",
        ),
        (
            "[[rods.sections]]\nradius = 0.01\n",
            "rods.0.sections.1",
            "missing key `from`",
        ),
        ("radius = 0\n", "rods.0.sections.0.radius", "greater than 0"),
        (
            "end_width = 0.01\n",
            "rods.0.sections.0.end_width",
            "only a rectangle",
        ),
        (
            "cross_section = { kind = \"tube\", wall = 0.004 }\nend_radius = 0.003\n",
            "rods.0.sections.0.cross_section.wall",
            "at most the radius, 0.003 m",
        ),
        (
            "cross_section = { kind = \"tube\" }\n",
            "rods.0.sections.0.cross_section",
            "missing key `wall`",
        ),
        ("radus = 1\n", "rods.0.sections.0.radus", "`radius`"),
    ] {
        let message = fault(lines);
        assert!(
            message.contains(key) && message.contains(word),
            "{lines}: {message}"
        );
    }
    let consistent = read(&beam(
        "inertia = \"consistent\"\n[[rods.sections]]\nradius = 0.01\n",
    ));
    let message = consistent.unwrap_err().to_string();
    assert!(
        message.contains("`rods.0.inertia`: a rod with `sections`"),
        "{message}"
    );
    let helix = "natural_shape = { kind = \"helix\", start = [0, 0, 0], axis = [0, 0, 1], radius = 0.1, pitch = 0.1, turns = 1 }\n";
    let bent = read(&beam(&format!(
        "{helix}[[rods.sections]]\nnatural_twist = 1.0\n"
    )));
    let message = bent.unwrap_err().to_string();
    assert!(
        message.contains("`rods.0.sections`") && message.contains("straight"),
        "{message}"
    );
}

#[test]
fn a_profile_is_short_for_sections_between_its_rows() {
    let profile = beam(
        "profile = { arc_length = [0, \"30 cm\", 1], radius = [\"5 mm\", \"3 mm\", 0.002] }\n",
    );
    let sections = sections(
        "to = 0.3\nend_radius = 0.003\n[[rods.sections]]\nto = 1\nradius = 0.003\nend_radius = 0.002\n",
    );
    assert_eq!(
        read(&profile).unwrap().to_toml(),
        read(&sections).unwrap().to_toml()
    );
    for (keys, word) in [
        (
            "arc_length = [0, 1], radius = [0.1]",
            "1 numbers, but `arc_length` has 2",
        ),
        (
            "arc_length = [0, 0], radius = [0.1, 0.1]",
            "number 2: 0 m does not exceed",
        ),
        ("arc_length = [0], radius = [0.1]", "at least 2 rows"),
        (
            "arc_length = [0, 1], radius = [0.1, 0]",
            "`rods.0.profile.radius.1`: 0.0 is out of range",
        ),
        ("radius = [0.1, 0.2]", "missing key `arc_length`"),
        ("file = \"nowhere.csv\"", "nowhere.csv cannot be read"),
        (
            "file = \"nowhere.csv\", radius = [1]",
            "give `file` or lists",
        ),
    ] {
        let message = read(&beam(&format!("profile = {{ {keys} }}\n")))
            .unwrap_err()
            .to_string();
        assert!(message.contains(word), "{keys}: {message}");
    }
}

#[test]
fn friction_of_a_rod_needs_contact_and_a_motion() {
    let motion = |text: &str, contact: &str| {
        text.replace("mode = \"static\"", "step = \"1 ms\"\nend = \"1 s\"")
            .replace("[time]", &format!("{contact}[time]"))
    };
    let own = "friction = 0.3\n[[rods.sections]]\nto = 0.5\nfriction = 0.1\n";
    let contact = "[contact]\nmodel = \"imc\"\nfriction = 0.2\n";
    let scenario = read(&motion(&beam(own), contact)).unwrap();
    let rod = &scenario.rods[0];
    assert_eq!(
        (rod.friction, rod.sections[0].friction),
        (Some(0.3), Some(0.1))
    );
    let scales = "[[planes]]\npoint = [0, 0, -1]\ndirected_friction = { forwards = 0.1, backwards = 0.2, sideways = 0.3 }\n";
    for (text, reason) in [
        (motion(&beam(own), ""), "without a [contact] table"),
        (
            beam(own).replace("[time]", "[contact]\nmodel = \"imc\"\n[time]"),
            "an equilibrium has no friction",
        ),
        (
            motion(&beam(own), &format!("{contact}{scales}")),
            "`directed_friction`",
        ),
    ] {
        let faults = read(&text).unwrap_err().to_string();
        for key in ["`rods.0.friction`", "`rods.0.sections.0.friction`"] {
            let of_key = faults.lines().find(|line| line.contains(key));
            assert!(of_key.is_some_and(|line| line.contains(reason)), "{faults}");
        }
    }
}
