//! The derived numbers as text.

use super::{DerivedNumbers, DerivedRod};
use crate::experiment::OwnNumbers;
use crate::run::decimals;
use rodlab_engine::mechanics::dynamics::Scheme;
use std::fmt;

/// Largest relative difference of numbers of two rods that count as equal.
const ALIKE: f64 = 1e-4;
impl fmt::Display for DerivedNumbers {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, value: String| writeln!(formatter, "  {name:<26}{value}");
        line("title", self.title.clone())?;
        line("experiment", self.experiment.clone())?;
        for group in groups_of(&self.rods) {
            let rod = &self.rods[group[0]];
            line("rod", self.names_of(&group))?;
            line("  nodes", rod.nodes.to_string())?;
            let lengths = group.iter().map(|index| self.rods[*index].length);
            let [least, largest] = lengths.fold([f64::INFINITY, 0.0], |[low, high], length| {
                [low.min(length), high.max(length)]
            });
            let [least, largest] = [least, largest].map(|length| decimals(length, 6));
            line(
                "  length",
                if least == largest {
                    format!("{least} m")
                } else {
                    format!("{least} to {largest} m")
                },
            )?;
            line("  EA", format!("{:.6e} N", rod.stretching_stiffness))?;
            let [first, second] = rod.bending_stiffness;
            if first == second {
                line("  EI", format!("{first:.6e} N m²"))?;
            } else {
                line("  EI₁, EI₂", format!("{first:.6e}, {second:.6e} N m²"))?;
            }
            line("  GJ", format!("{:.6e} N m²", rod.twisting_stiffness))?;
            if let Some(length) = rod.gravito_bending_length {
                line(
                    "  gravito-bending length",
                    format!("{} m", decimals(length, 6)),
                )?;
            }
            line("  bending period", format!("{:.4e} s", rod.bending_period))?;
        }
        for slide in &self.slides {
            line("slide", format!("{} along {}", slide.name, slide.rail))?;
            line("  edge", format!("{:.4e} m", slide.edge))?;
            let friction = format!(
                "{:.2e} at about {:.3e} N across",
                slide.apparent_friction, slide.force
            );
            line("  apparent friction", friction)?;
        }
        for obstacle in &self.obstacles {
            line("obstacle", obstacle.name.clone())?;
            let [x, y, z] = obstacle.extents.map(|extent| decimals(extent, 4));
            line("  extents", format!("{x}, {y}, {z} m"))?;
            if obstacle.triangles > 0 {
                line("  triangles", obstacle.triangles.to_string())?;
            }
        }
        if let Some(sentence) = &self.flow {
            line("flow", sentence.clone())?;
        }
        for (name, value) in self.own.iter().flat_map(OwnNumbers::lines) {
            line(name, value.clone())?;
        }
        line("degrees of freedom", self.degrees_of_freedom.to_string())?;
        if let Some(number) = self.reynolds_number {
            line("Reynolds number", decimals(number, 3))?;
        }
        if let Some(step) = self.advised_step {
            line("advised step", format!("{step:.1e} s"))?;
        }
        if let Some(steps) = self.steps {
            line("steps", steps.to_string())?;
        }
        if let Some(creep) = self.creep {
            line(
                "creep while sticking",
                format!(
                    "at up to {:.1e} m/s, {:.1e} m in the run, {:.2} radii (slip_tolerance {:.1e} m/s, at 90 % of the friction)",
                    creep.speed, creep.way, creep.way_in_radii, creep.slip_tolerance
                ),
            )?;
        }
        if let (Some(lost), Some(longer)) = (self.lost_per_period, self.longer_period) {
            let scheme = match self.scheme {
                Scheme::ImplicitEuler => "implicit Euler",
                Scheme::ImplicitMidpoint => "the midpoint rule",
                Scheme::BackwardDifferences => "backward differences",
            };
            line(
                "slowest mode",
                format!(
                    "{scheme}: damped {:.2} % a period, period error {:+.2} %",
                    100.0 * lost,
                    100.0 * longer
                ),
            )?;
        }
        for warning in &self.warnings {
            line("warning", warning.clone())?;
        }
        Ok(())
    }
}

/// Largest number of rods of a group that are all named.
const MOST_NAMED: usize = 4;

impl DerivedNumbers {
    /// Names of the rods of a group.
    fn names_of(&self, group: &[usize]) -> String {
        let name = |index: usize| self.rods[index].name.as_str();
        let (first, last) = (group[0], group[group.len() - 1]);
        if group.len() > 2 && last - first + 1 == group.len() {
            return format!("{} to {}", name(first), name(last));
        }
        let named: Vec<&str> = group.iter().take(MOST_NAMED).map(|k| name(*k)).collect();
        match group.len() {
            1 => named[0].to_owned(),
            2 => named.join(" and "),
            count if count > MOST_NAMED => {
                format!("{} and {} more", named.join(", "), count - MOST_NAMED)
            }
            _ => named.join(", "),
        }
    }
}

/// Indices of rods that differ only in name, such as flagella and the links of a chain. Groups are
/// in the order of their first rods.
fn groups_of(rods: &[DerivedRod]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, rod) in rods.iter().enumerate() {
        let alike = |group: &&mut Vec<usize>| rods[group[0]].is_like(rod);
        match groups.iter_mut().find(alike) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}

impl DerivedRod {
    /// Whether two rods differ only in name, and in rounding errors of their typed positions.
    fn is_like(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= ALIKE * a.abs();
        let [first, second] = self.bending_stiffness;
        self.nodes == other.nodes
            && near(self.length, other.length)
            && near(self.stretching_stiffness, other.stretching_stiffness)
            && near(first, other.bending_stiffness[0])
            && near(second, other.bending_stiffness[1])
            && near(self.twisting_stiffness, other.twisting_stiffness)
            && match (self.gravito_bending_length, other.gravito_bending_length) {
                (Some(own), Some(others)) => near(own, others),
                (own, others) => own == others,
            }
    }
}
