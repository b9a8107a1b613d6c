//! A rod that is bent at the mouth of a tube, so that the rim pushes it out.
//!
//! Along a rod without loads between its ends, M²/2EI + T is constant, with the moment M and the
//! tension T. A frictionless rim does not change it, since its force is normal to the rod, and
//! neither does a frictionless wall along the rod. The tension deep in the tube therefore equals
//! M²/2EI + T at the free end: P sin θ for a dead load P across the tube at an end that has turned
//! by θ. With little clearance it is M²/2EI for the moment M at the mouth, as in a sleeve (Bigoni,
//! Dal Corso, Bosi and Misseroni 2015).

use super::scenario::moved;
use super::{Check, Expectation, GroupError};

const PUSHED_OUT: Expectation = Expectation::new(
    "T = P sin θ",
    "M²/2EI + T along a rod; Bigoni, Dal Corso, Bosi and Misseroni 2015",
);

/// Load at the end, N; see the scene.
const LOAD: f64 = 0.028;
/// Number of edges of the rod; with twice as many the error is smaller.
const EDGES: usize = 75;
/// Time after which the rod is at rest, s.
const REST: f64 = 2.0;

/// Checks the rod with all contact models.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for model in ["imc", "ipc", "complementarity"] {
        let [expected, got] = tensions(model, EDGES)?;
        let name = format!("rod bent out of a tube, {model}: axial tension in the tube");
        checks.push(PUSHED_OUT.of(name, "N").relative(expected, got, 2e-2));
    }
    Ok(checks)
}

/// Tension in the tube in theory and in the simulation, N.
fn tensions(model: &str, edges: usize) -> Result<[f64; 2], GroupError> {
    let overrides = [
        format!("rods.0.edges={edges}"),
        format!("contact.model={model}"),
    ];
    let simulation = moved(include_str!("scenes/sleeve.toml"), &overrides, REST)?;
    let nodes = simulation.positions();
    let last = nodes[edges] - nodes[edges - 1];
    let expected = LOAD * -last.z / last.norm();
    Ok([expected, simulation.reaction(0).x.abs()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_push_of_the_rim_comes_nearer_to_theory_with_finer_edges() {
        for model in ["imc", "ipc", "complementarity"] {
            let errors = [EDGES, 2 * EDGES].map(|edges| {
                let [expected, got] = tensions(model, edges).unwrap();
                (got / expected - 1.0).abs()
            });
            assert!(
                errors[0] < 0.015 && errors[1] < 0.8 * errors[0],
                "{model}: {errors:?}"
            );
        }
    }
}
