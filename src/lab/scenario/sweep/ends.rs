//! Ends of ranges and searches that are expressions over `[parameters]`.

use super::axis::sweep_path;
use crate::scenario::document::{Entry, Node, Value};
use crate::scenario::error::ScenarioError;
use crate::scenario::expansion::{evaluate_at, is_plain};
use crate::scenario::experiments::Experiments;
use crate::scenario::issue::KeyPath;
use crate::scenario::overrides::numbered_steps;
use crate::scenario::source::Sources;

const OF_RANGE: [&str; 2] = ["from", "to"];
const OF_SEARCH: [&str; 3] = ["from", "to", "tolerance"];

/// Evaluates expressions at the ends, with the parameters of the scenario itself.
pub struct Ends<'a> {
    /// The available experiments.
    pub experiments: Experiments,
    /// The texts of the scenario.
    pub sources: &'a Sources,
    /// The scenario without its sweep.
    pub document: &'a Node,
}

impl Ends<'_> {
    /// Evaluates the ends in a table `[sweep]`.
    ///
    /// # Errors
    /// Faults of the parameters and of the expressions.
    pub fn evaluate(&self, sweep: &mut Node) -> Result<(), ScenarioError> {
        let Value::Table(entries) = &mut sweep.value else {
            return Ok(());
        };
        for entry in entries {
            let path = sweep_path().key(&entry.key);
            match (entry.key.as_str(), &mut entry.node.value) {
                ("search", _) => {
                    let parameter = entry.node.entry("parameter");
                    if let Some(Value::String(key)) = parameter.map(|entry| &entry.node.value) {
                        let key = key.clone();
                        self.evaluate_ends(&mut entry.node, &OF_SEARCH, &key, &path)?;
                    }
                }
                ("derivatives", _) => {}
                ("zip", Value::Array(tables)) => {
                    for (index, table) in tables.iter_mut().enumerate() {
                        if let Value::Table(entries) = &mut table.value {
                            self.visit_all(entries, "", &path.index(index))?;
                        }
                    }
                }
                _ => self.visit(&mut entry.node, &entry.key, &path)?,
            }
        }
        Ok(())
    }

    fn visit_all(
        &self,
        entries: &mut [Entry],
        above: &str,
        path: &KeyPath,
    ) -> Result<(), ScenarioError> {
        entries.iter_mut().try_for_each(|entry| {
            let key = format!("{above}{}", entry.key);
            self.visit(&mut entry.node, &key, &path.key(&entry.key))
        })
    }

    /// A range, or a table of further keys.
    fn visit(&self, node: &mut Node, key: &str, path: &KeyPath) -> Result<(), ScenarioError> {
        if node.entry("from").is_some() {
            return self.evaluate_ends(node, &OF_RANGE, key, path);
        }
        match &mut node.value {
            Value::Table(entries) => self.visit_all(entries, &format!("{key}."), path),
            _ => Ok(()),
        }
    }

    /// Evaluates the ends of a range. If one of them is an expression, all become numbers in SI
    /// units.
    fn evaluate_ends(
        &self,
        range: &mut Node,
        ends: &[&str],
        key: &str,
        path: &KeyPath,
    ) -> Result<(), ScenarioError> {
        let Value::Table(entries) = &mut range.value else {
            return Ok(());
        };
        let texts: Vec<&mut Entry> = (entries.iter_mut())
            .filter(|entry| ends.contains(&entry.key.as_str()))
            .filter(|entry| matches!(entry.node.value, Value::String(_)))
            .collect();
        let is_expression = |entry: &&mut Entry| matches!(&entry.node.value, Value::String(text) if !is_plain(text));
        if !texts.iter().any(is_expression) {
            return Ok(());
        }
        let steps = numbered_steps(self.document, key);
        for end in texts {
            if let Value::String(text) = &mut end.node.value
                && is_plain(text)
            {
                *text = format!("({text})");
            }
            let path = path.key(&end.key);
            evaluate_at(
                self.experiments,
                self.sources,
                self.document,
                &steps,
                path,
                &mut end.node,
            )?;
        }
        Ok(())
    }
}
