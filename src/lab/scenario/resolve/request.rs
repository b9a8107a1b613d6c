//! Inputs with which a kind of experiment resolves its own tables.

use super::rod::{material, refuse_degenerate};
use super::{Context, polyline};
use crate::scenario::own_tables::OwnTables;
use crate::scenario::resolved::{
    BuilderRod, Contact, CrossSection, Fluid, Material, Parts, Rod, Stiffness, Time,
};
use crate::scenario::section::Section;
use crate::scenario::typed::{ScenarioFile, Vector};
use crate::scenario::units::Length;
use std::any::Any;
use std::ops::RangeInclusive;

/// Input of a kind of experiment: the scenario file with its tables.
pub struct Request<'a> {
    /// The top of the file.
    pub top: &'a Section<'a>,
    /// Mode and time steps.
    pub time: &'a Time,
    pub(super) file: &'a ScenarioFile,
    pub(super) own: &'a OwnTables,
    pub(super) context: &'a Context<'a>,
}

/// The resolved common tables, for the checks of the kind.
pub struct CommonTables<'a> {
    /// The rods listed in the file.
    pub rods: &'a [Rod],
    /// Parts of the scene with tables of their own.
    pub parts: &'a Parts,
    /// Contact model.
    pub contact: &'a Contact,
    /// Surrounding fluid.
    pub fluid: &'a Fluid,
    /// Mode and time steps.
    pub time: &'a Time,
}

/// Rod and material from the tables `[rod]` and `[material]`.
pub struct BuiltRod {
    /// Material.
    pub material: Material,
    /// Radius, m.
    pub radius: f64,
    /// Number of nodes; `None` if it is faulty, which was reported.
    pub nodes: Option<usize>,
    /// Stiffness of the circular cross-section.
    pub stiffness: Stiffness,
}

impl BuiltRod {
    /// Radius and nodes.
    pub fn rod(&self) -> Option<BuilderRod> {
        Some(BuilderRod {
            radius: self.radius,
            nodes: self.nodes?,
        })
    }
}

impl<'a> Request<'a> {
    /// The required table `[key]` of this kind.
    pub fn table<T: Any>(&self, key: &str) -> Option<&'a T> {
        let table = self.own.get(key);
        self.top.needed(key, table, &format!("a table [{key}]"))
    }

    /// Whether the tables `[rod]` and `[material]` exist; reports missing ones.
    pub fn needs_rod(&self) -> bool {
        let common = self.file;
        let help = "a table [rod] with radius and nodes";
        let rod = self.top.needed("rod", common.rod.as_ref(), help);
        let help = "a table [material] with youngs_modulus, poissons_ratio and density";
        let material = self.top.needed("material", common.material.as_ref(), help);
        rod.is_some() && material.is_some()
    }

    /// The round rod of the tables `[rod]` and `[material]`, with a number of nodes in this range;
    /// `None` without the tables.
    pub fn rod(&self, nodes: RangeInclusive<usize>) -> Option<BuiltRod> {
        let common = self.file;
        let (rod, table) = (common.rod.as_ref()?, common.material.as_ref()?);
        let section = self.top.below("rod");
        let nodes = section.count("nodes", rod.nodes, nodes);
        let material = material(&self.top.below("material"), table);
        let radius = rod.radius(&section);
        let stiffness = CrossSection::Circle.stiffness(radius, &material);
        refuse_degenerate(&section, &stiffness);
        Some(BuiltRod {
            material,
            radius,
            nodes,
            stiffness,
        })
    }

    /// Reports the tables among `keys` that are present but not allowed.
    pub fn refuse(&self, keys: &[&str], message: &str) {
        for key in keys {
            if self.context.document.entry(key).is_some() {
                self.top.fault(key, message);
            }
        }
    }

    /// Corners of a polyline from the CSV file that `key` names, or from the key `points`; empty
    /// after a fault.
    pub fn corners(
        &self,
        section: &Section<'_>,
        key: &str,
        file: &Option<String>,
        points: &Option<Vec<Vector<Length>>>,
    ) -> Vec<[f64; 3]> {
        polyline::corners(section, key, file, points)
    }
}
