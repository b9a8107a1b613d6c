//! `rodlab fold`, `rodlab plan fold` and `rodlab solve fold` from outside: files, numbers, and
//! rejected input.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

fn rodlab(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = output.status.code().unwrap();
    (code, text(output.stdout), text(output.stderr))
}

fn plan(paper: &str, more: &[&str], out: &Path) -> (i32, String, String) {
    let out = out.to_str().unwrap();
    rodlab(&[&["plan", "fold", "--paper", paper, "--out", out], more].concat())
}

/// A sheet file with the given lines in its table.
fn paper(folder: &Path, lines: &str) -> String {
    let path = folder.join("paper.toml");
    fs::write(&path, format!("[folding.paper]\n{lines}\n")).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn the_seven_scenarios_of_the_thesis_are_planned() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    for (name, crease) in [
        ("a4", "25 cm"),
        ("a4", "half"),
        ("us_letter", "20 cm"),
        ("us_letter", "half"),
        ("cardboard", "20 cm"),
        ("cardboard", "half"),
        ("origami", "diagonal-strip"),
    ] {
        let file = format!("scenarios/papers/{name}.toml");
        let demand = |objective: &str| {
            let more = ["--crease", crease, "--objective", objective];
            let (code, stdout, stderr) = plan(&file, &more, &out);
            assert_eq!(code, 0, "{name} {crease}: {stderr}");
            let report: Value = serde_json::from_str(&stdout).unwrap();
            let table = fs::read_to_string(out.join("trajectory.csv")).unwrap();
            let (header, rows) = table.split_once('\n').unwrap();
            assert_eq!(header, "time_s,x_m,y_m,z_m,qw,qx,qy,qz");
            assert_eq!(
                rows.lines().count() as u64,
                report["poses"].as_u64().unwrap()
            );
            let last: Vec<f64> = rows
                .lines()
                .last()
                .unwrap()
                .split(',')
                .map(|cell| cell.parse().unwrap())
                .collect();
            let target = report["target_m"].as_f64().unwrap();
            assert!(
                (last[1] - target).abs() < 1e-8 && last[3].abs() < 1e-8,
                "{last:?}"
            );
            assert!(
                fs::read_to_string(out.join("fold.svg"))
                    .unwrap()
                    .contains("<svg")
            );
            report["friction_demand"].as_f64().unwrap()
        };
        assert!(demand("friction") < demand("sum"), "{name} {crease}");
    }
}

#[test]
fn a_sheet_is_folded_by_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("fold");
    let arguments = [
        "fold",
        "--paper",
        "scenarios/papers/a4.toml",
        "--simulate",
        "--quiet",
        "--out",
        out.to_str().unwrap(),
    ];
    let (code, stdout, stderr) = rodlab(&arguments);
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stdout.contains("fold  ") && stdout.contains("slid  "),
        "{stdout}"
    );
    let page = fs::read_to_string(out.join("view.html")).unwrap();
    assert!(page.contains("<html"));
    let summary = fs::read_to_string(out.join("summary.csv")).unwrap();
    let mut lines = summary.lines().map(|line| line.split(','));
    let (names, values) = (lines.next().unwrap(), lines.next().unwrap());
    let slid = names
        .zip(values)
        .find(|(name, _)| *name == "largest_sliding_m");
    let slid: f64 = slid.unwrap().1.parse().unwrap();
    assert!(slid < 2e-4, "{slid}");
    // Running the same command again reports that the fold is finished.
    let (code, stdout, _) = rodlab(&arguments);
    assert_eq!(code, 0);
    assert!(stdout.contains("already finished"), "{stdout}");
}

/// With a moment at the gripper, the friction of the table holds a sheet that it would not hold
/// without the moment.
#[test]
fn a_moment_holds_a_sheet_with_low_friction() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    let report = |objective: &str| -> Value {
        let more = ["--crease", "half", "--objective", objective];
        let (code, stdout, stderr) = plan("scenarios/papers/us_letter.toml", &more, &out);
        assert_eq!(code, 0, "{stderr}");
        serde_json::from_str(&stdout).unwrap()
    };
    let (free, held) = (report("sum"), report("moment"));
    assert_eq!(
        (&free["holds"], &held["holds"]),
        (&false.into(), &true.into())
    );
    assert!(free["slides_m"].as_f64().unwrap() > 5e-3);
    assert_eq!(held["slides_m"], 0.0);
    assert!(free["largest_moment"].as_f64().unwrap() < 1e-9);
    let moment = held["largest_moment"].as_f64().unwrap();
    assert!((0.5..1.2).contains(&moment), "{moment}");
}

/// A sheet is folded in half, and then folded in half again.
#[test]
fn a_sheet_is_folded_twice() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("twice");
    let reports = |layers: &str| -> Vec<Value> {
        let more = ["--crease", "half", "--times", "2", "--layers", layers];
        let (code, stdout, stderr) = plan("scenarios/papers/a4.toml", &more, &out);
        assert_eq!(code, 0, "{stderr}");
        serde_json::from_str(&stdout).unwrap()
    };
    let number = |report: &Value, key: &str| report[key].as_f64().unwrap();
    let (loose, stuck) = (reports("loose"), reports("stuck"));
    for (plans, stiffer) in [(&loose, 1.0), (&stuck, 4f64.cbrt())] {
        let [first, second] = [&plans[0], &plans[1]];
        assert!((number(first, "length_m") - 2.0 * number(second, "length_m")).abs() < 1e-12);
        let ratio =
            number(second, "gravito_bending_length_m") / number(first, "gravito_bending_length_m");
        assert!((ratio - stiffer).abs() < 1e-12);
        assert!(number(second, "friction_demand") > number(first, "friction_demand"));
        assert!(out.join("fold_2/trajectory.csv").exists());
    }
    assert!(number(&stuck[1], "friction_demand") > number(&loose[1], "friction_demand"));
    let more = ["--crease", "20 cm", "--times", "2"];
    let (code, _, stderr) = plan("scenarios/papers/a4.toml", &more, &folder.path().join("x"));
    assert_eq!(code, 2);
    assert!(stderr.contains("--crease half"), "{stderr}");
}

/// Sheets with the same L_gb and length have the same fold, whatever their stiffness and weight
/// are.
#[test]
fn only_the_gravito_bending_length_matters() {
    let folder = tempfile::tempdir().unwrap();
    let plans = [
        "youngs_modulus = \"2 GPa\"\nthickness = \"0.1 mm\"\ndensity = 800",
        "youngs_modulus = \"1 GPa\"\nthickness = \"0.2 mm\"\ndensity = 1600",
    ]
    .map(|material| {
        let lines = format!("length = \"30 cm\"\nwidth = \"20 cm\"\n{material}");
        let file = paper(folder.path(), &lines);
        let out = folder.path().join("out");
        let (code, _, stderr) = plan(&file, &["--crease", "half"], &out);
        assert_eq!(code, 0, "{stderr}");
        fs::read_to_string(out.join("folds.csv")).unwrap()
    });
    assert_eq!(plans[0], plans[1]);
}

#[test]
fn faults_of_a_fold_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let sides = "length = \"30 cm\"\nwidth = \"20 cm\"";
    let good = format!("{sides}\ngravito_bending_length = \"5 cm\"");
    for (lines, crease, named) in [
        (
            format!("{sides}\ngravito_bending_length = 0"),
            "half",
            "paper.toml:4",
        ),
        (sides.to_owned(), "half", "gravito_bending_length"),
        (format!("{good}\nstiffness = 1"), "half", "unknown key"),
        (
            format!("{good}\nleast_suspended_length = -1"),
            "half",
            "least_suspended_length",
        ),
        (good.clone(), "31 cm", "opposite"),
        (good.clone(), "diagonal-strip", "square"),
        (good.clone(), "diagonal", "is a triangle"),
        (good.clone(), "1 cm", "targets from"),
        (good.clone(), "quarter", "half"),
        (format!("{good}\nthickness = -1"), "half", "paper.toml:5"),
    ] {
        let file = paper(folder.path(), &lines);
        let (code, _, stderr) = plan(&file, &["--crease", crease], &out);
        assert_eq!(code, 2, "{lines} {crease}: {stderr}");
        assert!(stderr.contains(named), "{lines} {crease}: {stderr}");
        assert!(!out.exists());
    }
    let (code, _, stderr) = rodlab(&["solve", "fold", "--x", "14", "--z", "1"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("nearest"), "{stderr}");
}

#[test]
fn a_fold_is_the_same_by_theory_and_by_the_discrete_rod() {
    let answer = |method: &str| -> Value {
        let place = [
            "solve", "fold", "--x", "3.4", "--z", "1.7", "--method", method,
        ];
        let (code, stdout, stderr) = rodlab(&place);
        assert_eq!(code, 0, "{stderr}");
        serde_json::from_str(&stdout).unwrap()
    };
    let (theory, discrete) = (answer("theory"), answer("der"));
    for key in [
        "lambda",
        "alpha",
        "suspended_length",
        "horizontal_force",
        "vertical_force",
    ] {
        let [one, other] = [&theory, &discrete].map(|answer| answer[key].as_f64().unwrap());
        assert!((one - other).abs() < 3e-4, "{key}: {one} {other}");
        assert!(one != other);
    }
    assert_eq!(theory["stable"], true);
}
