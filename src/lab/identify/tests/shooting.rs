//! Motions through instabilities.

use super::*;

/// A buckled strip in a frame that is turned upside down and back: it snaps through and back.
const SNAPPING: &str = r#"
experiment = "scene"
[parameters]
ei = 4e-5
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000.0
viscosity = 20000.0
[[rods]]
name = "strip"
radius = "2 mm"
edges = 12
shape = { kind = "slack", start = [0, 0, 0], end = [0.36, 0, 0], length = 0.4, towards = [0, 0, 1] }
natural_shape = "straight"
stiffness = { bending_1 = "ei", bending_2 = "ei", twisting = "ei", stretching = 20.0 }
[[clamps]]
rod = "strip"
at = "start"
[[clamps]]
rod = "strip"
at = "end"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -12]
schedule = [[0, -1], [0.75, 1], [1.5, -1], [2.25, 1], [3, -1]]
[time]
begin = "equilibrium"
step = "10 ms"
end = 3.0
"#;

/// A fit of its stiffness and damping in windows.
fn snapping(file: &DataFile, windows: usize) -> Identified {
    let start = elsewhere(SNAPPING, &[("ei", "1.3e-5"), ("viscosity", "10000.0")]);
    let experiment = Experiment {
        scenario: start,
        files: vec![file.clone()],
    };
    let mut task = task(vec![experiment], &["parameters.ei", "material.viscosity"]);
    task.windows = windows;
    identify(&task, &Exact::default(), &|| true, &mut |_| {}).unwrap()
}

#[test]
fn a_strip_that_snaps_is_identified_in_windows_where_a_plain_fit_ends_elsewhere() {
    let mut rows = "time_s,marker,node,x_m,z_m\n".to_owned();
    for step in 0..=150 {
        for node in [3, 6, 9] {
            writeln!(rows, "{},m{node},{node},0,0", 0.02 * f64::from(step)).unwrap();
        }
    }
    let file = measured(&scenario(SNAPPING), &rows, |_| 1e-3, 1);
    let truth = [4e-5, 2e4];
    let plain = snapping(&file, 1);
    let error = plain.parameters[0].value / truth[0] - 1.0;
    println!("plain: {error:.2} of the stiffness off");
    assert!(error.abs() > 0.2, "{}", brief(&plain));
    let found = snapping(&file, 16);
    let off = deviations(&found, &truth);
    println!("{off:.2?}: {:?}", found.remarks);
    assert!(
        found.converged && off.iter().all(|off| off.abs() < 3.0),
        "{off:?} {}",
        brief(&found)
    );
    let error = found.parameters[0].standard_error.unwrap();
    assert!(error < 0.005 * truth[0], "{}", brief(&found));
    assert!(
        found.remarks[0].starts_with("multiple shooting in 16, 4 windows"),
        "{:?}",
        found.remarks
    );
}

#[test]
fn windows_need_markers_over_time() {
    let file = |rows: &str| DataFile::from_text(Path::new("data.csv"), rows, &BTreeMap::new());
    for (text, rows, windows, expected) in [
        (TWISTED, POINTS.to_owned(), 2, "time_s,marker,x_m,y_m,z_m"),
        (SWING, swing_rows(), 11, "at most 10 windows"),
    ] {
        let experiment = Experiment {
            scenario: scenario(text),
            files: vec![file(&rows).unwrap()],
        };
        let mut task = task(vec![experiment], &["material.density"]);
        task.windows = windows;
        let error = identify(&task, &Exact::default(), &|| true, &mut |_| {});
        let error = error.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
