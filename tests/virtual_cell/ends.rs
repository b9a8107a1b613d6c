//! Tasks that end early, at any time, and the state that they leave.

use super::{DEPLOY, Served, again, said, serve};
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Runs a check at ten times spread over `most`, s, five in parallel.
fn at_ten_moments(most: f64, check: impl Fn(f64) + Sync) {
    let moments: Vec<f64> = (1..=10)
        .map(|k| most * (f64::from(k) * 0.618_034).fract())
        .collect();
    for moments in moments.chunks(5) {
        std::thread::scope(|scope| {
            for moment in moments {
                scope.spawn(|| check(*moment));
            }
        });
    }
}

/// Checks the log of a task that did not finish.
fn log_is_whole(served: &Served, status: &str, moment: f64) {
    let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
    assert_eq!(manifest["status"], status, "{moment}");
    assert!(manifest["error"].is_string(), "{moment}");
    assert!(served.read("laid/report.md").contains(status), "{moment}");
    assert!(
        !served.read("laid/approach/state.csv").is_empty(),
        "{moment}"
    );
}

/// Checks manifest and report of an interrupted task: the completed steps, the laid length, the
/// place of the hand, and the advice.
fn says_how_it_left_the_cell(served: &Served) {
    let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
    let stopped = &manifest["stopped"];
    let during = stopped["during"].as_str().unwrap();
    let [laid, path] = ["laid_m", "path_m"].map(|key| stopped["laid"][0][key].as_f64().unwrap());
    assert!((0.0..=path).contains(&laid), "{manifest}");
    if ["going to the first point", "taking the rod"].contains(&during) {
        assert_eq!(laid, 0.0, "{manifest}");
    }
    let hand = &stopped["hands"][0];
    assert_eq!(hand["arm"], "gantry", "{manifest}");
    assert_eq!(
        hand["position_m"].as_array().unwrap().len(),
        3,
        "{manifest}"
    );
    let next = stopped["next"].as_str().unwrap();
    let report = served.read("laid/report.md");
    for words in [during, &next.replace('`', r"\`"), "| hand | gantry: at "] {
        assert!(report.contains(words), "{words}: {report}");
    }
}

#[test]
fn a_link_that_drops_at_any_moment_leaves_the_arm_still_and_a_whole_log() {
    at_ten_moments(10.0, |moment| {
        let fault = format!("drop-link@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_joint_that_freezes_at_any_moment_leaves_the_arm_still_and_a_whole_log() {
    at_ten_moments(10.0, |moment| {
        let fault = format!("freeze-joint@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_rod_that_slips_out_of_the_gripper_at_any_moment_ends_the_task() {
    at_ten_moments(14.0, |moment| {
        let fault = format!("slip-grasp@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        let words = "slipped out of the gripper";
        assert!(said(&output).contains(words), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_camera_that_is_lost_at_any_moment_ends_the_task() {
    at_ten_moments(14.0, |moment| {
        let fault = format!("lose-camera@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        let words = "is the camera started";
        assert!(said(&output).contains(words), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_task_that_is_interrupted_at_any_moment_holds_the_arm() {
    at_ten_moments(1.0, |moment| {
        let served = serve(&["--rate", "10"], "");
        let mut task = served
            .command(&DEPLOY)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        served.wait_for_motion();
        std::thread::sleep(Duration::from_secs_f64(moment));
        let told = Command::new("kill")
            .args(["-INT", &task.id().to_string()])
            .status();
        assert!(told.unwrap().success());
        assert_eq!(task.wait().unwrap().code(), Some(130), "{moment}");
        assert!(served.stands_soon(), "{moment}");
        log_is_whole(&served, "interrupted", moment);
        says_how_it_left_the_cell(&served);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_task_that_is_killed_at_any_moment_leaves_the_arm_still() {
    at_ten_moments(1.0, |moment| {
        let served = serve(&["--rate", "10"], "");
        let mut task = served
            .command(&DEPLOY)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        served.wait_for_motion();
        std::thread::sleep(Duration::from_secs_f64(moment));
        // As kill -9 does.
        task.kill().unwrap();
        task.wait().unwrap();
        assert!(served.stands_soon(), "{moment}");
        assert!(
            !served.read("laid/approach/state.csv").is_empty(),
            "{moment}"
        );
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_cell_that_is_killed_at_any_moment_ends_the_task() {
    at_ten_moments(1.0, |moment| {
        let mut served = serve(&["--rate", "10"], "");
        let task = served
            .command(&DEPLOY)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        served.wait_for_motion();
        std::thread::sleep(Duration::from_secs_f64(moment));
        served.child.kill().unwrap();
        served.child.wait().unwrap();
        let output = task.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{moment}: {}", said(&output));
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_task_continues_after_an_inspection() {
    let served = serve(&["--rate", "50", "--fault", "drop-link@2s"], "");
    assert_eq!(served.deploy().status.code(), Some(1));
    served.asks_for_a_look_before(&again());
    let mut again = DEPLOY.to_vec();
    again.extend(["--checked"]);
    again[DEPLOY.len() - 1] = "again";
    let output = served.run(&again);
    assert!(output.status.success(), "{}", said(&output));
    // The task has finished, so that the next one requires no inspection.
    again.pop();
    again[DEPLOY.len() - 1] = "third";
    let output = served.run(&again);
    assert!(output.status.success(), "{}", said(&output));
}
