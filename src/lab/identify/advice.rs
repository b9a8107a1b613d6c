//! Describes combinations that the data do not determine, and advises experiments that would.

/// Advised experiments, for words in the last two parts of a dotted key.
const EXPERIMENTS: &[(&[&str], &str)] = &[
    (
        &["twisting", "poissons_ratio", "gj", "torsion"],
        "turn a clamp about the axis of a bent rod and measure its shape or the moment (probe `reaction`), or the turn at which a loop leaves its plane (`critical_parameter` with time.mode = \"continuation\")",
    ),
    (
        &["density", "mass", "mass_per_length", "weight"],
        "weigh the rod and leave this key out, or measure a force at a clamp (probe `reaction`)",
    ),
    (
        &["stretching", "ea"],
        "pull the rod along its axis and measure its force and length",
    ),
    (
        &[
            "viscosity",
            "loss_factor",
            "relaxing_modulus",
            "relaxation_time",
            "translation",
            "rotation",
            "damping",
        ],
        "let the rod swing freely and record markers until the motion has decayed",
    ),
    (
        &["yield_stress", "tangent_modulus"],
        "bend the rod beyond its elastic range, release it, and measure the shape that it keeps",
    ),
    (
        &["friction", "mu"],
        "let the rod slide, and record its motion, the tangential force, or when it begins to slide as a load grows (`sliding_onset_s`)",
    ),
    (
        &["natural_curvature", "natural_twist", "curvature"],
        "record the shape of the rod where it hangs or lies free, held at one end",
    ),
    (
        &["youngs_modulus", "bending_1", "bending_2", "bending", "ei"],
        "measure a force or a moment at a clamp (probe `reaction`); a shape alone determines stiffness over load",
    ),
    (
        &["radius", "width", "thickness"],
        "measure the cross-section directly and leave this key out",
    ),
];

/// Describes a combination in a sentence; `changes` are relative changes of keys.
pub fn in_words(changes: &[(String, f64)], standard_error: f64) -> String {
    let effect = match standard_error.is_finite() {
        true => "change the data by less than their noise",
        false => "leave the data unchanged",
    };
    match changes {
        [(key, _)] => format!("the data do not determine `{key}`: its changes {effect}"),
        changes => {
            let largest = changes
                .iter()
                .map(|(_, part)| part.abs())
                .fold(0.0, f64::max);
            let leading = changes.iter().find(|(_, part)| part.abs() == largest);
            let sign = leading.map_or(1.0, |(_, part)| part.signum());
            let parts = changes
                .iter()
                .map(|(key, part)| format!("`{key}` {:+.2} %", sign * part / largest));
            format!(
                "the data do not determine these keys one by one: {} together {effect}",
                parts.collect::<Vec<_>>().join(", ")
            )
        }
    }
}

/// Advises what to measure in addition.
pub fn experiment_for(changes: &[(String, f64)]) -> String {
    let words = |key: &str| -> Vec<String> {
        let steps = key.split('.').rev().take(2);
        let steps = steps.map(str::to_lowercase);
        steps
            .filter(|step| step.parse::<usize>().is_err())
            .collect()
    };
    let concerns = |known: &&[&str]| {
        let mut keys = changes.iter().flat_map(|(key, _)| words(key));
        keys.any(|word| known.contains(&word.as_str()))
    };
    let found = EXPERIMENTS.iter().find(|(known, _)| concerns(known));
    let general =
        "add an experiment in which the keys act differently, or state one of them by --prior";
    found.map_or(general, |(_, advice)| advice).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_are_stated_with_the_experiment_that_separates_them() {
        let one = [("rods.wire.stiffness.twisting".to_owned(), 1.0)];
        assert!(
            in_words(&one, f64::INFINITY)
                .contains("do not determine `rods.wire.stiffness.twisting`")
        );
        assert!(experiment_for(&one).contains("turn a clamp"));
        let both = [
            ("material.youngs_modulus".to_owned(), -0.7),
            ("material.density".to_owned(), -0.7),
        ];
        assert!(
            in_words(&both, 3.0)
                .contains("`material.youngs_modulus` +1.00 %, `material.density` +1.00 % together")
        );
        assert!(experiment_for(&both).contains("weigh the rod"));
        assert!(experiment_for(&[("parameters.gj".to_owned(), 1.0)]).contains("turn a clamp"));
        assert!(experiment_for(&[("parameters.phase".to_owned(), 1.0)]).contains("--prior"));
    }
}
