//! `rodlab init`.

use super::failure::Failure;
use super::output::print;
use clap::{Args, ValueEnum};

/// Arguments of `rodlab init`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rodlab init scene > my_scene.toml && rodlab run my_scene.toml")]
pub struct InitArguments {
    /// The experiment for which to write a template
    pub experiment: Template,
}

/// The templates, one per experiment.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Template {
    /// Rods as listed, with clamps, loads and planes.
    Scene,
    /// Helical flagella turned at their heads in a viscous fluid.
    Flagella,
    /// A knot whose ends are pulled apart.
    KnotTightening,
    /// An overhand knot that is pulled until its loop snaps onto the braid.
    KnotInversion,
    /// Where clamped helical rods lose stability.
    HelixStability,
}

impl Template {
    fn text(self) -> &'static str {
        match self {
            Self::Scene => include_str!("templates/scene.toml"),
            Self::Flagella => include_str!("templates/flagella.toml"),
            Self::KnotTightening => include_str!("templates/knot_tightening.toml"),
            Self::KnotInversion => include_str!("templates/knot_inversion.toml"),
            Self::HelixStability => include_str!("templates/helix_stability.toml"),
        }
    }
}

/// Writes a template.
pub fn init(arguments: &InitArguments) -> Result<(), Failure> {
    print(arguments.experiment.text())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::prepare;
    use crate::scenario::from_text;
    use std::path::Path;

    #[test]
    fn templates_are_scenarios() {
        for template in Template::value_variants() {
            let loaded = from_text("template", template.text(), Path::new(""))
                .unwrap_or_else(|error| panic!("{error}"));
            prepare(&loaded.scenario).unwrap_or_else(|error| panic!("{error}"));
        }
    }

    #[test]
    fn the_keys_that_templates_leave_commented_out_are_valid_too() {
        for template in Template::value_variants() {
            let text: String = template
                .text()
                .lines()
                .map(|line| format!("{}\n", line.strip_prefix("#: ").unwrap_or(line)))
                .collect();
            assert_ne!(text, template.text());
            let loaded = from_text("template", &text, Path::new(""))
                .unwrap_or_else(|error| panic!("{error}"));
            prepare(&loaded.scenario).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}
