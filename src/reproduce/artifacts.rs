//! The list of what can be reproduced.

use super::artifact::Artifact;
use super::{
    auto_steps, cell_correction, cost, deployment_correction, deployment_errors, drag_steps,
    figure_2_5, figure_2_6, figure_2_7, figure_2_8, figure_3_4, figure_3_9, figure_4_5, figure_4_9,
    figure_4_10, figure_4_11, figure_4_11_cell, figure_5_4, figure_5_5, figure_5_6, figure_5_8,
    figure_6_2, figure_6_5, figure_6_6_robot, inversion_factors, knot_convergence, laid_patterns,
    simplified_inversion, table_2_1, table_2_2, table_4_1, table_5_2, table_5_2_cell, table_5_3,
    table_5_4, table_5_4_cell,
};

/// All tables and figures.
pub static ARTIFACTS: [Artifact; 41] = [
    table_2_1::ARTIFACT,
    table_2_2::ARTIFACT,
    figure_2_5::ARTIFACT,
    figure_2_6::ARTIFACT,
    figure_2_7::ARTIFACT,
    figure_2_8::ARTIFACT,
    figure_3_4::ARTIFACT,
    inversion_factors::FIGURE_3_5,
    inversion_factors::FIGURE_3_6,
    inversion_factors::FIGURE_3_7,
    figure_3_9::ARTIFACT,
    simplified_inversion::FIGURE_3_10,
    simplified_inversion::FIGURE_3_11,
    figure_4_5::ARTIFACT,
    figure_4_9::ARTIFACT,
    figure_4_10::ARTIFACT,
    figure_4_11::ARTIFACT,
    figure_4_11_cell::ARTIFACT,
    table_4_1::ARTIFACT,
    figure_5_4::ARTIFACT,
    figure_5_5::ARTIFACT,
    figure_5_6::ARTIFACT,
    figure_5_8::ARTIFACT,
    laid_patterns::FIGURE_5_10,
    laid_patterns::FIGURE_5_11,
    table_5_2::ARTIFACT,
    table_5_2_cell::ARTIFACT,
    table_5_3::ARTIFACT,
    table_5_4::ARTIFACT,
    table_5_4_cell::ARTIFACT,
    figure_6_2::FIGURE_6_2,
    figure_6_5::ARTIFACT,
    figure_6_2::FIGURE_6_6,
    figure_6_6_robot::ARTIFACT,
    knot_convergence::ARTIFACT,
    deployment_errors::ARTIFACT,
    deployment_correction::ARTIFACT,
    cell_correction::ARTIFACT,
    cost::ARTIFACT,
    drag_steps::ARTIFACT,
    auto_steps::ARTIFACT,
];

impl Artifact {
    /// The artefact of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        ARTIFACTS.iter().find(|artifact| artifact.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn artefacts_are_found_by_their_names() {
        for artifact in &ARTIFACTS {
            let found = Artifact::named(artifact.name()).unwrap();
            assert_eq!(found.title(), artifact.title());
        }
        assert_eq!(Artifact::named("tab9.9"), None);
    }

    #[test]
    fn runs_of_an_artefact_have_different_ids() {
        for artifact in &ARTIFACTS {
            for quick in [false, true] {
                let ids = artifact.recipe.ids(quick);
                let different: BTreeSet<&String> = ids.iter().collect();
                assert_eq!(different.len(), ids.len(), "{artifact:?}");
            }
        }
    }

    /// One of each kind; the test of the pages prepares more.
    #[test]
    fn runs_of_an_artefact_are_scenarios() {
        let is_full = crate::reproduce::tests_are_full();
        let mut kinds = BTreeSet::new();
        for artifact in &ARTIFACTS {
            let is_new = kinds.insert(artifact.recipe.kind());
            if is_full {
                artifact.recipe.check_scenarios(false, usize::MAX);
                artifact.recipe.check_scenarios(true, usize::MAX);
            } else if is_new {
                artifact.recipe.check_scenarios(true, 1);
            }
        }
    }
}
