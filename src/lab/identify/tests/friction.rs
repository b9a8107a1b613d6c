//! Friction from the onset of sliding.

use super::*;

/// A rod along an incline that becomes steeper: the tangent of its angle is t/10.
const INCLINE: &str = r#"experiment = "scene"
[parameters]
mu = 0.3
[material]
youngs_modulus = "10 MPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "rod"
radius = "5 mm"
edges = 4
shape = { kind = "straight", start = [-0.05, 0, 0.00502], end = [0.05, 0, 0.00502] }
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[[loads]]
kind = "gravity"
acceleration = [9.81, 0, 0]
schedule = [[0, 0], [10, 1]]
[[planes]]
point = [0, 0, 0]
normal = [0, 0, 1]
[contact]
friction = "mu"
distance_tolerance = "50 µm"
slip_tolerance = "0.02 mm/s"
[time]
step = "20 ms"
end = 6.0
"#;

#[test]
fn friction_is_found_from_the_angle_at_which_a_rod_begins_to_slide() {
    // Measured angles: tan α = μ.
    let mut noise = Noise::new(21);
    let mut text = "sliding_onset_s,sliding_onset_s_sd\n".to_owned();
    for _ in 0..5 {
        writeln!(text, "{},0.05", 3.0 + 0.05 * noise.next()).unwrap();
    }
    let file = DataFile::from_text(Path::new("onset.csv"), &text, &BTreeMap::new()).unwrap();
    let late = predicted(&scenario(INCLINE), &file)[0] - 3.0;
    println!("onset {late} s late");
    assert!((0.0..0.02).contains(&late), "{late}");
    let start = elsewhere(INCLINE, &[("mu", "0.5")]);
    let experiment = Experiment {
        scenario: start,
        files: vec![file],
    };
    let found = fit(&task(vec![experiment], &["parameters.mu"]));
    let error = found.parameters[0].standard_error.unwrap();
    println!("{} ± {error}", found.parameters[0].value);
    assert!(
        found.converged && deviations(&found, &[0.3])[0].abs() < 3.0,
        "{}",
        brief(&found)
    );
    // The time is proportional to the friction, so the relative error of the friction is that of
    // the mean of five times.
    assert!(
        (error / (0.05 / 5f64.sqrt() / 10.0) - 1.0).abs() < 0.05,
        "{error}"
    );
    let never = elsewhere(INCLINE, &[("mu", "2.0")]);
    let prepared = prepare(&never.scenario_of(0).unwrap().scenario).unwrap();
    let files = [DataFile::from_text(
        Path::new("onset.csv"),
        "sliding_onset_s\n3\n",
        &BTreeMap::new(),
    )
    .unwrap()];
    let observation = Observation::new(&prepared, &files).unwrap();
    let Err(Unpredicted::NoValue(_, _, reason)) = observation.predict(&prepared, &|| true) else {
        panic!("it slides");
    };
    assert!(reason.contains("nothing begins to slide"), "{reason}");
}
