//! Every VTK file that the program writes is read back by VTK itself.

use crate::parts::python_with;
use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process;

/// Reads the given files with VTK and prints one line of JSON for each; warnings of VTK end the
/// program.
const READER: &str = r"
import json, sys
import vtk
from vtk.util.numpy_support import vtk_to_numpy

def complain(*_):
    sys.exit('VTK complains of ' + name)

def arrays(data):
    return {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)).ravel().tolist() for k in range(data.GetNumberOfArrays())}

def cells(cells):
    ids, found = vtk.vtkIdList(), []
    cells.InitTraversal()
    while cells.GetNextCell(ids):
        found.append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
    return found

for name in sys.argv[1:]:
    reader = vtk.vtkXMLPolyDataReader()
    for part in (reader, reader.GetExecutive()):
        part.AddObserver('ErrorEvent', complain)
        part.AddObserver('WarningEvent', complain)
    reader.SetFileName(name)
    reader.Update()
    data = reader.GetOutput()
    print(json.dumps({
        'points': vtk_to_numpy(data.GetPoints().GetData()).tolist(),
        'lines': cells(data.GetLines()), 'polygons': cells(data.GetPolys()),
        'of_points': arrays(data.GetPointData()), 'of_cells': arrays(data.GetCellData()),
    }))
";

/// A rod and a ring that fall; every point array is written.
const FALL: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "4 ms" }
output = { interval = "2 ms", vtk = true, forces = true }
contact = { distance_tolerance = "0.1 mm" }
fluid = { model = "rss", viscosity = 0.01 }

[[rods]]
name = "rope"
radius = "2 mm"
edges = 10
shape = { kind = "straight", start = [-0.1, 0, 0.004], end = [0.1, 0, 0.004] }

[[rods]]
name = "ring"
radius = "1 mm"
edges = 12
closed = true
shape = { kind = "ring", centre = [0, 0, 0.1], radius = 0.03 }

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#;

/// A Python with VTK, in the build directory since it is large.
fn python_with_vtk() -> Option<PathBuf> {
    let purpose = "to read back the files for ParaView";
    python_with("vtk", "vtk>=9.3,<10", purpose)
}

fn rodlab(directory: &Path, arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    let run = command.current_dir(directory).args(arguments);
    run.assert().success();
}

/// Content of files as read by VTK.
fn read(python: &Path, files: &[PathBuf]) -> Vec<Value> {
    let output = process::Command::new(python)
        .args(["-c", READER])
        .args(files)
        .output()
        .unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaints}");
    let text = String::from_utf8(output.stdout).unwrap();
    let read = text.lines().map(|line| serde_json::from_str(line).unwrap());
    read.collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap_or_else(|| panic!("{value}"));
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Positions of the nodes at each time of `nodes.csv`.
fn positions(directory: &Path) -> BTreeMap<String, Vec<Vec<f64>>> {
    let mut found: BTreeMap<String, Vec<Vec<f64>>> = BTreeMap::new();
    let mut reader = csv::Reader::from_path(directory.join("nodes.csv")).unwrap();
    for row in reader.records() {
        let row = row.unwrap();
        let point = [3, 4, 5].map(|column| row[column].parse().unwrap());
        found
            .entry(row[0].to_owned())
            .or_default()
            .push(point.into());
    }
    found
}

#[test]
fn vtk_reads_every_frame_of_a_run() {
    let Some(python) = python_with_vtk() else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("fall.toml"), FALL).unwrap();
    rodlab(directory.path(), &["run", "fall.toml", "--out", "fall"]);
    let results = directory.path().join("fall");
    let collection = fs::read_to_string(results.join("rods.pvd")).unwrap();
    let files: Vec<PathBuf> = collection
        .split("file=\"")
        .skip(1)
        .map(|rest| results.join(rest.split('"').next().unwrap()))
        .collect();
    let frames = read(&python, &files);
    let positions = positions(&results);
    assert_eq!((frames.len(), positions.len()), (3, 3));
    for (frame, positions) in frames.iter().zip(positions.values()) {
        let points: Vec<Vec<f64>> = frame["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(numbers)
            .collect();
        assert_eq!(&points, positions);
        let rope: Vec<u64> = (0..11).collect();
        let ring: Vec<u64> = (11..23).chain([11]).collect();
        assert_eq!(frame["lines"], serde_json::json!([rope, ring]));
        assert_eq!(frame["polygons"], serde_json::json!([]));
        let radii = numbers(&frame["of_points"]["radius"]);
        assert!(radii[..11].iter().all(|radius| *radius == 2e-3));
        assert!(radii[11..].iter().all(|radius| *radius == 1e-3));
        for vectors in ["velocity", "contact_force", "fluid_force"] {
            let read = numbers(&frame["of_points"][vectors]);
            assert_eq!(read.len(), 3 * 23, "{vectors}");
        }
        assert_eq!(numbers(&frame["of_cells"]["rod"]), [0.0, 1.0]);
    }
}

/// A rod above a fixed box and a box that moves up and rotates.
const PUSHED: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "4 ms" }
output = { interval = "2 ms", vtk = true }
contact = { distance_tolerance = "0.1 mm" }

[[rods]]
name = "rope"
radius = "2 mm"
edges = 10
shape = { kind = "straight", start = [-0.1, 0, 0], end = [0.1, 0, 0] }

[[obstacles]]
name = "floor"
shape = { kind = "box", centre = [0, 0, -0.1], size = [0.4, 0.2, 0.1] }

[[obstacles]]
name = "lift"
shape = { kind = "box", centre = [0, 0.2, 0.1], size = [0.02, 0.04, 0.06] }
move = [[0, [0, 0, 0]], ["4 ms", [0, 0, "8 mm"]]]
turn = [[0, 0], ["4 ms", "90 deg"]]
axis = [0, 0, 1]
"#;

#[test]
fn vtk_reads_obstacles_where_they_are_at_each_time() {
    let Some(python) = python_with_vtk() else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("pushed.toml"), PUSHED).unwrap();
    rodlab(directory.path(), &["run", "pushed.toml", "--out", "pushed"]);
    let results = directory.path().join("pushed");
    let collection = fs::read_to_string(results.join("rods.pvd")).unwrap();
    let files: Vec<PathBuf> = (0..3)
        .map(|frame| results.join(format!("vtk/obstacles_{frame:06}.vtp")))
        .collect();
    for (frame, file) in files.iter().enumerate() {
        let name = file.strip_prefix(&results).unwrap().display();
        assert!(collection.contains(&format!("part=\"1\" file=\"{name}\"")));
        assert!(file.exists(), "{frame}");
    }
    for (frame, read) in read(&python, &files).iter().enumerate() {
        let points: Vec<Vec<f64>> = read["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(numbers)
            .collect();
        let triangles: Vec<Vec<f64>> = read["polygons"]
            .as_array()
            .unwrap()
            .iter()
            .map(numbers)
            .collect();
        let owners = numbers(&read["of_cells"]["obstacle"]);
        assert_eq!((points.len(), triangles.len(), owners.len()), (16, 24, 24));
        // The second box has rotated by half of a quarter turn, and by a quarter turn, about its
        // middle while it rises.
        let (sine, cosine) = (0.25 * std::f64::consts::PI * frame as f64).sin_cos();
        for (triangle, owner) in triangles.iter().zip(owners) {
            for corner in triangle {
                let point = &points[*corner as usize];
                let (centre, half) = match owner as usize {
                    0 => ([0.0, 0.0, -0.1], [0.2, 0.1, 0.05]),
                    _ => ([0.0, 0.2, 0.1 + 4e-3 * frame as f64], [0.01, 0.02, 0.03]),
                };
                let [x, y, z] = std::array::from_fn(|axis| point[axis] - centre[axis]);
                let (cosine, sine) = if owner == 0.0 {
                    (1.0, 0.0)
                } else {
                    (cosine, sine)
                };
                let own = [cosine * x + sine * y, cosine * y - sine * x, z];
                for axis in 0..3 {
                    assert!(
                        (own[axis].abs() - half[axis]).abs() < 1e-12,
                        "{frame} {point:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn vtk_reads_the_boundary_of_stable_helices() {
    let Some(python) = python_with_vtk() else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/helix_boundary.toml");
    let scenario = scenario.to_string_lossy().into_owned();
    let few = [
        "--set",
        "helix_stability.directions.count=60",
        "--set",
        "helix_stability.section_directions=3",
    ];
    let arguments = [&["run", &scenario, "--out", "helices"][..], &few].concat();
    rodlab(directory.path(), &arguments);
    let file = directory.path().join("helices/boundary.vtp");
    let surface = &read(&python, &[file])[0];
    let points = surface["points"].as_array().unwrap();
    let distances = numbers(&surface["of_points"]["distance"]);
    assert!(points.len() > 30 && distances.len() == points.len());
    for (point, distance) in points.iter().zip(&distances) {
        let square: f64 = numbers(point).iter().map(|part| part * part).sum();
        assert!((square.sqrt() / distance - 1.0).abs() < 1e-12);
    }
    let polygons = surface["polygons"].as_array().unwrap();
    assert!(polygons.len() > points.len() / 2);
    for polygon in polygons {
        let corners = numbers(polygon);
        let number_of_points = points.len() as f64;
        assert!(corners.len() == 3 && corners.iter().all(|corner| *corner < number_of_points));
    }
}
