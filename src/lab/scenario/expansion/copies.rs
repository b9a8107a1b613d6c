//! `count`: copies of a table.

use super::definitions::define;
use super::origins::Origin;
use super::scatter;
use super::scope::{INDICES, Place, Scope};
use super::values::{Evaluator, as_value, located, name_of};
use crate::scenario::document::{Entry, Node, Value};
use crate::scenario::error::Located;
use crate::scenario::expression::{Amount, Mistake, parse};
use crate::scenario::issue::{Issue, KeyPath};
use crate::scenario::schema_tree::Accepted;
use serde_json::Value as Json;

/// Number of copies.
pub const COUNT: &str = "count";
/// Names of one copy.
pub const LET: &str = "let";
/// Random places.
pub const SCATTER: &str = "scatter";

/// Most copies of one table.
const MOST_COPIES: usize = 100_000;

/// Whether a value is a table with keys that control copies.
pub fn is_copied(node: &Node) -> bool {
    [COUNT, LET, SCATTER]
        .iter()
        .any(|key| node.entry(key).is_some())
}

/// Expands the array of a key, and returns the origin of each of its tables.
pub fn expand(
    evaluator: &Evaluator<'_>,
    array: &mut Entry,
    schema: Option<&Json>,
    faults: &mut Vec<Located>,
) -> Vec<Origin> {
    let path = KeyPath::from(array.key.as_str());
    let mut origins = Vec::new();
    let Value::Array(elements) = &mut array.node.value else {
        return origins;
    };
    let mut expanded = Vec::new();
    for (written, mut element) in std::mem::take(elements).into_iter().enumerate() {
        let schema = schema.and_then(|schema| evaluator.tree.item(schema, written));
        let number = written.to_string();
        let name = name_of(&element).unwrap_or_else(|| number.clone());
        let place = Place::uncopied(path.clone()).element(&number, &name);
        if is_copied(&element) {
            let copies = Template::read(evaluator, element, place, faults)
                .map_or_else(Vec::new, |template| {
                    template.copies(evaluator, schema, faults)
                });
            for (copy, element) in copies.into_iter().enumerate() {
                let copy = Some(copy);
                origins.push(Origin { written, copy });
                expanded.push(element);
            }
        } else {
            evaluator.visit(&mut element, schema, &place, faults);
            let copy = None;
            origins.push(Origin { written, copy });
            expanded.push(element);
        }
    }
    *elements = expanded;
    origins
}

/// A table that will be copied.
struct Template {
    /// The table without the keys that control its copies.
    table: Node,
    place: Place,
    /// Number of copies along each direction.
    counts: Vec<usize>,
    names: Option<Entry>,
    /// Values of the random names of each copy.
    scattered: Option<Vec<Vec<(String, Amount)>>>,
}

impl Template {
    fn read(
        evaluator: &Evaluator<'_>,
        mut table: Node,
        place: Place,
        faults: &mut Vec<Located>,
    ) -> Option<Self> {
        let before = faults.len();
        let count = table.remove(COUNT);
        let counts = match &count {
            Some(count) => read_counts(evaluator, count, &place, faults),
            None => vec![1],
        };
        let total = counts.iter().product();
        let names = table.remove(LET);
        let scattered = table.remove(SCATTER).and_then(|table| {
            let place = place.key(SCATTER);
            scatter::places(evaluator, &table, &place, total, faults)
        });
        if let Some(name) = table.entry("name")
            && total > 1
            && matches!(&name.node.value, Value::String(text) if !text.contains('{'))
        {
            let message = "the copies need different names";
            let help = name_of(&table).map(|name| format!("write \"{name}{{i}}\""));
            let issue = Issue::new(place.path.key("name"), message).with_help(help);
            let span = name.node.span.clone();
            faults.push(Located::new(evaluator.sources, issue, Some(span)));
        }
        (faults.len() == before).then_some(Self {
            table,
            place,
            counts,
            names,
            scattered,
        })
    }

    /// All copies up to the first faulty one; the last index varies fastest.
    fn copies(
        &self,
        evaluator: &Evaluator<'_>,
        schema: Option<&Json>,
        faults: &mut Vec<Located>,
    ) -> Vec<Node> {
        let before = faults.len();
        let mut copies = Vec::new();
        for number in 0..self.counts.iter().product() {
            let place = self.place_of(number, evaluator, faults);
            if faults.len() == before {
                let mut copy = self.table.clone();
                evaluator.visit(&mut copy, schema, &place, faults);
                copies.push(copy);
            }
            if faults.len() > before {
                break;
            }
        }
        copies
    }

    /// The place of a copy, with all its names.
    fn place_of(
        &self,
        number: usize,
        evaluator: &Evaluator<'_>,
        faults: &mut Vec<Located>,
    ) -> Place {
        let mut place = Place {
            copy: Some(number),
            ..self.place.clone()
        };
        let mut after: usize = self.counts.iter().product();
        for (name, count) in INDICES.iter().zip(&self.counts) {
            after /= count;
            let index = Amount::pure((number / after % count) as f64);
            place.locals.push(((*name).to_owned(), index));
        }
        if let Some(scattered) = &self.scattered {
            place.locals.extend(scattered[number].iter().cloned());
        }
        if let Some(names) = &self.names {
            let sources = evaluator.sources;
            let known: Vec<String> = place.locals.iter().map(|(name, _)| name.clone()).collect();
            let taken = |name: &str| {
                if evaluator.parameters.value(name).is_some() {
                    return Some(format!(
                        "`{name}` is a parameter of the file; choose another name"
                    ));
                }
                let is_known = known.iter().any(|known| known == name);
                is_known.then(|| format!("`{name}` is a name of `scatter`; choose another name"))
            };
            let of_names = place.key(LET);
            let values = define(
                sources,
                evaluator.parameters,
                &of_names,
                &names.node,
                &taken,
                faults,
            );
            place.locals.extend(values);
        }
        place
    }
}

/// Reads `count`: a number, or an array of up to three numbers.
fn read_counts(
    evaluator: &Evaluator<'_>,
    count: &Entry,
    place: &Place,
    faults: &mut Vec<Located>,
) -> Vec<usize> {
    let place = place.key(COUNT);
    let refusal = |node: &Node, message: String| {
        let mistake = Mistake {
            message,
            help: None,
            bytes: 0..usize::MAX,
        };
        located(evaluator.sources, &place, node, mistake)
    };
    let nodes: Vec<&Node> = match &count.node.value {
        Value::Array(nodes) => nodes.iter().collect(),
        _ => vec![&count.node],
    };
    if !(1..=INDICES.len()).contains(&nodes.len()) {
        let message =
            "expected a number of copies, or up to three: [20, 10] has the indices i and j";
        faults.push(refusal(&count.node, message.to_owned()));
        return Vec::new();
    }
    let mut counts = Vec::new();
    for node in nodes {
        match read_count(evaluator, node, &place) {
            Ok(count) => counts.push(count),
            Err(mistake) => faults.push(located(evaluator.sources, &place, node, mistake)),
        }
    }
    let total = counts.iter().copied().fold(1, usize::saturating_mul);
    if total > MOST_COPIES {
        let message = format!("{total} copies are too many; allowed: at most {MOST_COPIES}");
        faults.push(refusal(&count.node, message));
        return Vec::new();
    }
    counts
}

fn read_count(evaluator: &Evaluator<'_>, node: &Node, place: &Place) -> Result<usize, Mistake> {
    let of_node = |message: String| Mistake {
        message,
        help: None,
        bytes: 0..usize::MAX,
    };
    let value = match &node.value {
        Value::String(text) => {
            let scope = Scope {
                parameters: evaluator.parameters,
                place,
            };
            let amount = parse(text)?.evaluate(&scope)?;
            let accepted = Accepted {
                integer: true,
                ..Accepted::default()
            };
            as_value(amount, &accepted).map_err(|message| of_node(format!("{text:?} {message}")))?
        }
        other => other.clone(),
    };
    match value {
        Value::Integer(count) => usize::try_from(count)
            .ok()
            .filter(|count| *count <= MOST_COPIES)
            .ok_or_else(|| {
                of_node(format!(
                    "{count} is out of range; allowed: 0 to {MOST_COPIES}"
                ))
            }),
        _ => Err(of_node(format!(
            "expected a whole number, found {}",
            node.description()
        ))),
    }
}
