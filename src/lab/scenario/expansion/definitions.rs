//! The names of `[parameters]` and of `let`. They may refer to each other in any order.

use super::SEED;
use super::parameters::Parameters;
use super::scope::{INDICES, Place, Scope, WORDS};
use super::values::located;
use crate::scenario::document::{Entry, Node, Value};
use crate::scenario::error::Located;
use crate::scenario::expression::{Amount, Expression, FUNCTIONS, Mistake, Names, PI, parse};
use crate::scenario::issue::{Issue, KeyPath};
use crate::scenario::source::Sources;
use crate::scenario::units;
use std::collections::BTreeMap;

/// A name and the expression of its value.
struct Definition<'a> {
    entry: &'a Entry,
    expression: Result<Amount, Expression>,
}

/// Reads `[parameters]`.
pub fn read_parameters(sources: &Sources, table: &Entry, faults: &mut Vec<Located>) -> Parameters {
    let place = Place::uncopied(KeyPath::from(table.key.as_str()));
    let none = Parameters::default();
    let values = define(sources, &none, &place, &table.node, &|_| None, faults);
    let parameters: Parameters = values.into_iter().collect();
    if let Some(seed) = parameters.value(SEED)
        && !is_seed(&seed)
    {
        let message = "the seed of random numbers is a whole number, 0 or greater";
        let issue = Issue::new(place.path.key(SEED), message);
        let span = table.node.entry(SEED).map(|entry| entry.node.span.clone());
        faults.push(Located::new(sources, issue, span));
    }
    parameters
}

fn is_seed(amount: &Amount) -> bool {
    let is_whole = amount.value.fract() == 0.0 && (0.0..9e15).contains(&amount.value);
    amount.powers == [0; 3] && is_whole
}

/// Reason why a name is not allowed; `None` if it is.
fn reserved(name: &str) -> Option<String> {
    let is_word = |character: char| character.is_ascii_alphanumeric() || character == '_';
    let is_name =
        name.chars().all(is_word) && !name.starts_with(|first: char| first.is_ascii_digit());
    let functions = FUNCTIONS.iter().filter_map(|of| of.usage.split_once('('));
    if !is_name || name.is_empty() {
        return Some(
            "a name has letters, digits and `_`, and begins with a letter or `_`".to_owned(),
        );
    }
    if INDICES.contains(&name) {
        return Some(format!(
            "`{name}` is the index of a copy; choose another name"
        ));
    }
    if name == PI || functions.into_iter().any(|(function, _)| function == name) {
        return Some(format!(
            "`{name}` has a meaning in expressions; choose another name"
        ));
    }
    if WORDS.contains(&name) {
        return Some(format!(
            "`{name}` is a word of scenario files; choose another name"
        ));
    }
    if units::is_denominator(name) {
        return Some(format!(
            "`{name}` is a unit, as in \"1 m/s\" or \"1 N/m\"; choose another name"
        ));
    }
    None
}

/// Evaluates the names defined in a table at `place`. They may refer to each other, to the names
/// at that place and to the parameters. `taken` returns the reason why a name is not available.
pub fn define(
    sources: &Sources,
    parameters: &Parameters,
    place: &Place,
    table: &Node,
    taken: &dyn Fn(&str) -> Option<String>,
    faults: &mut Vec<Located>,
) -> Vec<(String, Amount)> {
    let refusal = |entry: &Entry, labels_key: bool, message: String| {
        let issue = Issue {
            labels_key,
            copy: place.copy,
            ..Issue::new(place.path.key(&entry.key), message)
        };
        let span = if labels_key {
            &entry.key_span
        } else {
            &entry.node.span
        };
        Located::new(sources, issue, Some(span.clone()))
    };
    let Value::Table(entries) = &table.value else {
        let message = format!("expected a table of names, found {}", table.description());
        let issue = Issue::new(place.path.clone(), message);
        faults.push(Located::new(sources, issue, Some(table.span.clone())));
        return Vec::new();
    };
    let before = faults.len();
    let mut definitions: Vec<Definition<'_>> = Vec::new();
    for entry in entries {
        if let Some(message) = reserved(&entry.key).or_else(|| taken(&entry.key)) {
            faults.push(refusal(entry, true, message));
        }
        match read(entry) {
            Ok(definition) => definitions.push(definition),
            Err(None) => {
                let found = entry.node.description();
                let message = format!(
                    "expected a number, or text with a unit or an expression, found {found}"
                );
                faults.push(refusal(entry, false, message));
            }
            Err(Some(mistake)) => {
                faults.push(located(
                    sources,
                    &place.key(&entry.key),
                    &entry.node,
                    mistake,
                ));
            }
        }
    }
    if faults.len() > before {
        return Vec::new();
    }
    match order(&definitions) {
        Ok(order) => evaluated(sources, parameters, place, &definitions, &order, faults),
        Err(circle) => {
            let names: Vec<String> = circle
                .iter()
                .chain(&circle[..1])
                .map(|number| format!("`{}`", definitions[*number].entry.key))
                .collect();
            for number in circle {
                let entry = definitions[number].entry;
                let message = format!("a circle: {}", names.join(" uses "));
                faults.push(refusal(entry, false, message));
            }
            Vec::new()
        }
    }
}

fn read(entry: &Entry) -> Result<Definition<'_>, Option<Mistake>> {
    let expression = match &entry.node.value {
        Value::Integer(number) => Ok(Amount::pure(*number as f64)),
        Value::Float(number) => Ok(Amount::pure(*number)),
        Value::String(text) => Err(parse(text).map_err(Some)?),
        _ => return Err(None),
    };
    Ok(Definition { entry, expression })
}

/// An order in which each definition comes after those that it uses; otherwise the indices of a
/// cycle.
fn order(definitions: &[Definition<'_>]) -> Result<Vec<usize>, Vec<usize>> {
    let numbers: BTreeMap<&str, usize> = definitions
        .iter()
        .enumerate()
        .map(|(number, definition)| (definition.entry.key.as_str(), number))
        .collect();
    let uses: Vec<Vec<usize>> = definitions
        .iter()
        .map(|definition| match &definition.expression {
            Ok(_) => Vec::new(),
            Err(expression) => {
                let names = expression.names().into_iter();
                names
                    .filter_map(|name| numbers.get(name).copied())
                    .collect()
            }
        })
        .collect();
    let mut order: Vec<usize> = Vec::new();
    let mut is_placed = vec![false; definitions.len()];
    loop {
        let before = order.len();
        for number in 0..definitions.len() {
            if !is_placed[number] && uses[number].iter().all(|used| is_placed[*used]) {
                is_placed[number] = true;
                order.push(number);
            }
        }
        if order.len() == definitions.len() {
            return Ok(order);
        }
        if order.len() == before {
            break;
        }
    }
    // Following the uses among the remaining definitions leads to a cycle.
    let next = |number: usize| uses[number].iter().copied().find(|used| !is_placed[*used]);
    let mut walked: Vec<usize> = is_placed
        .iter()
        .position(|placed| !placed)
        .into_iter()
        .collect();
    loop {
        let Some(number) = walked.last().copied().and_then(next) else {
            return Err(walked);
        };
        if let Some(start) = walked.iter().position(|earlier| *earlier == number) {
            return Err(walked.split_off(start));
        }
        walked.push(number);
    }
}

fn evaluated(
    sources: &Sources,
    parameters: &Parameters,
    place: &Place,
    definitions: &[Definition<'_>],
    order: &[usize],
    faults: &mut Vec<Located>,
) -> Vec<(String, Amount)> {
    let mut place = place.clone();
    let mut values = Vec::new();
    for definition in order.iter().map(|number| &definitions[*number]) {
        let entry = definition.entry;
        let of_entry = place.key(&entry.key);
        let scope = Scope {
            parameters,
            place: &of_entry,
        };
        let amount = match &definition.expression {
            Ok(amount) => Ok(*amount),
            Err(expression) => expression.evaluate(&scope as &dyn Names),
        };
        let amount = amount.and_then(|amount| match amount.value.is_finite() {
            true => Ok(amount),
            false => Err(Mistake {
                message: format!("{} is not a finite number", amount.value),
                help: None,
                bytes: 0..usize::MAX,
            }),
        });
        match amount {
            Ok(amount) => {
                place.locals.push((entry.key.clone(), amount));
                values.push((entry.key.clone(), amount));
            }
            Err(mistake) => {
                faults.push(located(sources, &of_entry, &entry.node, mistake));
                return values;
            }
        }
    }
    values
}
