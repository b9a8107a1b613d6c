//! The list of all artefacts.

use super::artifact::Artifact;
use super::validation;
use std::sync::LazyLock;

/// All tables and figures.
pub static ARTIFACTS: LazyLock<Vec<Artifact>> = LazyLock::new(|| {
    OTHERS
        .iter()
        .cloned()
        .chain(validation::artifacts())
        .collect()
});

/// All but the published cases.
static OTHERS: &[Artifact] = &[
    super::table_2_1::ARTIFACT,
    super::table_2_2::ARTIFACT,
    super::figure_2_5::ARTIFACT,
    super::figure_2_6::ARTIFACT,
    super::figure_2_7::ARTIFACT,
    super::figure_2_8::ARTIFACT,
    super::figure_3_4::ARTIFACT,
    super::inversion_factors::FIGURE_3_5,
    super::inversion_factors::FIGURE_3_6,
    super::inversion_factors::FIGURE_3_7,
    super::figure_3_9::ARTIFACT,
    super::simplified_inversion::FIGURE_3_10,
    super::simplified_inversion::FIGURE_3_11,
    super::figure_4_5::ARTIFACT,
    super::figure_4_9::ARTIFACT,
    super::figure_4_10::ARTIFACT,
    super::figure_4_11::ARTIFACT,
    super::figure_4_11_cell::ARTIFACT,
    super::table_4_1::ARTIFACT,
    super::figure_5_4::ARTIFACT,
    super::figure_5_5::ARTIFACT,
    super::figure_5_6::ARTIFACT,
    super::figure_5_8::ARTIFACT,
    super::laid_patterns::FIGURE_5_10,
    super::laid_patterns::FIGURE_5_11,
    super::table_5_2::ARTIFACT,
    super::table_5_2_cell::ARTIFACT,
    super::table_5_3::ARTIFACT,
    super::table_5_4::ARTIFACT,
    super::table_5_4_cell::ARTIFACT,
    super::figure_6_2::FIGURE_6_2,
    super::figure_6_5::ARTIFACT,
    super::figure_6_2::FIGURE_6_6,
    super::figure_6_6_robot::ARTIFACT,
    super::knot_convergence::ARTIFACT,
    super::deployment_errors::ARTIFACT,
    super::deployment_correction::ARTIFACT,
    super::cell_correction::ARTIFACT,
    super::cost::ARTIFACT,
    super::drag_steps::ARTIFACT,
    super::auto_steps::ARTIFACT,
];

impl Artifact {
    /// The artefact with a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        ARTIFACTS.iter().find(|artifact| artifact.name == name)
    }

    /// The artefacts in the folder of this one.
    pub(super) fn parts(&self) -> impl Iterator<Item = &'static Self> {
        let folder = format!("{}/", self.name);
        let parts = ARTIFACTS.iter();
        parts.filter(move |artifact| artifact.name.starts_with(&folder))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn artefacts_are_found_by_their_names() {
        for artifact in ARTIFACTS.iter() {
            let found = Artifact::named(artifact.name()).unwrap();
            assert_eq!(found.title(), artifact.title());
        }
        assert_eq!(Artifact::named("tab9.9"), None);
    }

    #[test]
    fn runs_of_an_artefact_have_different_ids() {
        for artifact in ARTIFACTS.iter() {
            for quick in [false, true] {
                let ids = artifact.recipe.ids(quick);
                let different: BTreeSet<&String> = ids.iter().collect();
                assert_eq!(different.len(), ids.len(), "{artifact:?}");
            }
        }
    }

    /// Prepares one run of each kind. The test of the pages includes more.
    #[test]
    fn runs_of_an_artefact_are_scenarios() {
        let is_full = crate::reproduce::tests_are_full();
        let mut kinds = BTreeSet::new();
        for artifact in ARTIFACTS.iter() {
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
