//! Expands parameters, expressions and copies of tables in a scenario file.
//!
//! | file | what |
//! |---|---|
//! | `parameters`, `definitions` | `[parameters]` and the names of a copied table, which may use each other in any order |
//! | `scope` | meanings of names in an expression, and the random numbers |
//! | `values` | expressions and names with `{...}` in the tree, guided by the JSON Schema |
//! | `copies` | `count`: copies of a table |
//! | `scatter` | `scatter`: random places without overlap |
//! | `origins` | origin of each table: the table as written, and the number of the copy |
//!
//! Expansion follows merging and overriding, and precedes decoding. A file without parameters,
//! expressions and copies does not change. Text at a key that takes a number is an expression,
//! unless it is a number with a unit.

mod copies;
mod definitions;
mod origins;
mod parameters;
mod scatter;
mod scope;
mod values;

pub use copies::{COUNT, LET, SCATTER};
pub use origins::{Copied, Origins};
pub use scatter::Scatter;
pub use values::is_plain;

use super::document::{Node, Value};
use super::error::{Located, ScenarioError};
use super::experiments::Experiments;
use super::issue::KeyPath;
use super::schema_tree::SchemaTree;
use super::source::Sources;
use copies::is_copied;
use definitions::read_parameters;
use parameters::Parameters;
use scope::Place;
use values::{Evaluator, is_candidate, kind_of};

/// The table of parameters.
pub const PARAMETERS: &str = "parameters";
/// The parameter that seeds the random numbers.
pub const SEED: &str = "seed";

/// A document after expansion.
pub struct Expanded {
    /// Numbers and tables only.
    pub document: Node,
    /// Origins of its tables.
    pub origins: Origins,
}

/// Expands a document.
///
/// # Errors
/// All faults of parameters, expressions and copies, with their positions in the files.
pub fn expand(
    experiments: Experiments,
    sources: &Sources,
    mut document: Node,
) -> Result<Expanded, ScenarioError> {
    let mut faults: Vec<Located> = Vec::new();
    let parameters = match document.remove(PARAMETERS) {
        Some(table) => read_parameters(sources, &table, &mut faults),
        None => Parameters::default(),
    };
    let mut origins = Origins::default();
    let Value::Table(entries) = &mut document.value else {
        return Ok(Expanded { document, origins });
    };
    let concerns = |node: &Node| has_copies(node) || is_candidate(node, &parameters);
    if faults.is_empty() && entries.iter().any(|entry| concerns(&entry.node)) {
        let schema = experiments.shared_schema();
        let evaluator = Evaluator {
            sources,
            tree: SchemaTree::new(&schema),
            parameters: &parameters,
        };
        for entry in entries.iter_mut().filter(|entry| concerns(&entry.node)) {
            let path = KeyPath::from(entry.key.as_str());
            let key_schema = evaluator.tree.property(&schema, &entry.key, None);
            if has_copies(&entry.node) {
                let of = copies::expand(&evaluator, entry, key_schema, &mut faults);
                origins.insert(&entry.key, of);
            } else {
                let place = Place::uncopied(path);
                evaluator.visit(&mut entry.node, key_schema, &place, &mut faults);
            }
        }
    }
    if faults.is_empty() {
        return Ok(Expanded { document, origins });
    }
    faults.sort_by_key(Located::order);
    Err(ScenarioError(faults))
}

/// Evaluates an expression for the key at `steps` of a document, with elements of arrays as
/// numbers. Messages name `path`. Text is left unchanged if the document does not have the key or
/// the key takes no numbers.
///
/// # Errors
/// Faults of the parameters of the document and of the expression.
pub fn evaluate_at(
    experiments: Experiments,
    sources: &Sources,
    document: &Node,
    steps: &[String],
    path: KeyPath,
    expression: &mut Node,
) -> Result<(), ScenarioError> {
    let mut faults = Vec::new();
    let parameters = match document.entry(PARAMETERS) {
        Some(table) => read_parameters(sources, table, &mut faults),
        None => Parameters::default(),
    };
    let root = experiments.shared_schema();
    let tree = SchemaTree::new(&root);
    let (mut schema, mut node) = (Some(&*root), Some(document));
    for step in steps {
        schema = schema.and_then(|schema| match node.map(|node| &node.value) {
            Some(Value::Array(_)) => tree.item(schema, step.parse().ok()?),
            _ => tree.property(schema, step, node.and_then(kind_of)),
        });
        node = node.and_then(|node| match &node.value {
            Value::Array(elements) => elements.get(step.parse::<usize>().ok()?),
            _ => node.entry(step).map(|entry| &entry.node),
        });
    }
    if faults.is_empty() {
        let evaluator = Evaluator {
            sources,
            tree,
            parameters: &parameters,
        };
        evaluator.visit(expression, schema, &Place::uncopied(path), &mut faults);
    }
    match faults.is_empty() {
        true => Ok(()),
        false => Err(ScenarioError(faults)),
    }
}

/// Whether a value is an array of tables, some with keys that control copies.
fn has_copies(node: &Node) -> bool {
    matches!(&node.value, Value::Array(elements) if elements.iter().any(is_copied))
}
