//! Contact problems that once stopped a run, from the scenario file to the end of the run.

use crate::run::{RunError, RunOutcome};
use crate::test_support::{self, prepared};
use rodlab_engine::mechanics::dynamics::SimulationError;

fn ran(text: &str) -> Result<RunOutcome, RunError> {
    let prepared = prepared("contact", text).unwrap();
    test_support::ran(&prepared).map(|(outcome, _)| outcome)
}

/// A soft rope falls onto a held post, hangs over it and swings, with high friction, at steps of 1
/// ms.
#[test]
fn a_rope_over_a_post_passes_with_ipc() {
    let text = r#"
        experiment = "scene"
        material = { youngs_modulus = "0.1 MPa", poissons_ratio = 0.5, density = 1000.0 }
        time = { step = "1 ms", end = 0.6 }
        output = { interval = 0.1 }
        [[rods]]
        name = "post"
        radius = "3 mm"
        edges = 10
        held = true
        shape = { kind = "straight", start = [0, -0.1, 0], end = [0, 0.1, 0] }
        [[rods]]
        name = "rope"
        radius = "3 mm"
        edges = 40
        shape = { kind = "straight", start = [-0.4, 0, 0.03], end = [0.4, 0.02, 0.03] }
        [[loads]]
        kind = "gravity"
        acceleration = [0, 0, -9.81]
        [contact]
        model = "ipc"
        friction = 0.3
    "#;
    let case = ran(text).unwrap().case;
    assert!((case.simulated_time - 0.6).abs() < 1e-12);
    assert!(case.minimum_distance_ratio.unwrap() > 1.0);
    // The rope hangs over the post: it touches the post, and its ends have fallen on both sides.
    assert!(case.steps_with_contact > 400, "{case:?}");
    assert!(case.gravitational_energy.unwrap() < 0.0);
    assert!(
        case.steps < 660,
        "{} steps where 600 were asked for",
        case.steps
    );
    assert!(case.newton_iterations_mean().unwrap() < 8.0);
}

/// Two soft rings that meet at 34 m/s, four times the wave speed in them. Implicit Euler damps the
/// impact, even in a run with the midpoint rule, and the run continues with rods stretched beyond
/// the theory. Otherwise the run ends for this reason, or because of spurious energy.
#[test]
fn an_impact_faster_than_the_waves_in_a_rod_never_passes_without_that_reason() {
    for (scheme, model) in [
        ("implicit-midpoint", "imc"),
        ("implicit-euler", "imc"),
        ("implicit-euler", "ipc"),
    ] {
        let text = format!(
            r#"
            experiment = "scene"
            material = {{ youngs_modulus = 65840.0, poissons_ratio = 0.5, density = 1000.0 }}
            time = {{ step = "auto", end = 0.05, scheme = "{scheme}" }}
            output = {{ interval = 0.002 }}
            contact = {{ model = "{model}", friction = 0.5 }}
            [[rods]]
            name = "a"
            radius = 0.00012339486554793934
            edges = 20
            shape = {{ kind = "ring", centre = [0, 0, 0], normal = [0, 0, 1], radius = 0.0067809228067860034 }}
            velocity = [-16.65172095551637, -13.438793459165932, 10.061703678969224]
            angular_velocity = [741.096625694669, 315.49996185003283, -221.44234836440592]
            [[rods]]
            name = "b"
            radius = 0.00012339486554793934
            edges = 20
            shape = {{ kind = "ring", centre = [0.0067809228067860034, 0, 0], normal = [0, 1, 0], radius = 0.0067809228067860034 }}
            velocity = [-16.96470202458155, 11.154557965027006, 11.69981811605656]
            "#
        );
        let message = match ran(&text) {
            Err(error) => {
                let is_unphysical = matches!(
                    &error,
                    RunError::Simulation {
                        source: SimulationError::Unphysical(_),
                        ..
                    }
                );
                assert!(is_unphysical, "{scheme}, {model}: {error}");
                error.to_string()
            }
            Ok(outcome) => {
                assert!(outcome.case.minimum_distance_ratio.unwrap() > 0.95);
                outcome.case.remarks.join("; ")
            }
        };
        assert!(
            message.contains("the theory of rods") || message.contains("spurious energy"),
            "{scheme}, {model}: {message}"
        );
    }
}
