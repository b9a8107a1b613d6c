//! Evaluates expressions and names with `{...}` in the tree, guided by the JSON Schema.

use super::parameters::Parameters;
use super::scope::{Place, Scope, WORDS};
use crate::scenario::document::{Node, Value};
use crate::scenario::error::Located;
use crate::scenario::expression::{Amount, Expression, Mistake, Names, parse};
use crate::scenario::issue::{Issue, nearest};
use crate::scenario::schema_tree::{Accepted, SchemaTree};
use crate::scenario::source::{Sources, Span};
use crate::scenario::units;
use serde_json::Value as Json;

/// Largest whole number that is exact.
const LARGEST_WHOLE: f64 = 9e15;

/// Evaluates the expressions in a tree.
pub struct Evaluator<'a> {
    /// The texts of the scenario.
    pub sources: &'a Sources,
    /// The JSON Schema.
    pub tree: SchemaTree<'a>,
    /// The parameters.
    pub parameters: &'a Parameters,
}

/// Whether a node contains text that could be an expression at some key.
pub fn is_candidate(node: &Node, parameters: &Parameters) -> bool {
    match &node.value {
        Value::Table(entries) => entries
            .iter()
            .any(|entry| is_candidate(&entry.node, parameters)),
        Value::Array(elements) => elements
            .iter()
            .any(|element| is_candidate(element, parameters)),
        Value::String(text) => is_candidate_text(text, parameters),
        _ => false,
    }
}

fn is_candidate_text(text: &str, parameters: &Parameters) -> bool {
    let has_operator = text.contains(['+', '-', '*', '/', '^', '(']);
    !is_plain(text) && (has_operator || nearest_parameter(text, parameters))
}

fn nearest_parameter(text: &str, parameters: &Parameters) -> bool {
    nearest(text.trim(), parameters.names()).is_some()
}

/// Whether text is a number, with a unit or without.
pub fn is_plain(text: &str) -> bool {
    units::parse_any(text).is_some() || text.trim().parse::<f64>().is_ok()
}

/// Whether text that is not an expression was probably meant as a number with a unit. The message
/// then lists the units of the key.
fn is_meant_as_quantity(text: &str) -> bool {
    let text = text.trim();
    let length = units::number_length(text);
    length > 0 && !text[length..].contains(['+', '-', '*', '(', ')', ','])
}

/// Whether text is a word for some key, such as "auto" or "implicit-euler", rather than an
/// expression. No name in it is defined, and it does not resemble a defined name.
fn is_word(text: &str, expression: &Expression, scope: &Scope<'_>) -> bool {
    let names = expression.names();
    let all = scope.all();
    let is_near = || nearest(text.trim(), all.iter().map(String::as_str)).is_some();
    names.iter().all(|name| scope.value(name).is_none())
        && (names.iter().any(|name| WORDS.contains(name)) || !is_near())
}

/// A mistake in the text of a node. The fault is located within the text if the text was typed
/// without escapes.
pub fn located(sources: &Sources, place: &Place, node: &Node, mistake: Mistake) -> Located {
    let issue = Issue {
        copy: place.copy,
        ..Issue::new(place.path.clone(), mistake.message).with_help(mistake.help)
    };
    let span = match &node.value {
        Value::String(text) => part_of(sources, &node.span, text, &mistake.bytes),
        _ => node.span.clone(),
    };
    Located::new(sources, issue, Some(span))
}

/// The span of some bytes of a text that was typed at `span`; the whole span if the text was typed
/// with escapes.
fn part_of(sources: &Sources, span: &Span, text: &str, bytes: &std::ops::Range<usize>) -> Span {
    let text_of_source = sources.get(span.source).text.as_ref();
    let typed = text_of_source.and_then(|text| text.get(span.bytes.clone()));
    let typed = typed.unwrap_or_default();
    let offset = if typed == format!("\"{text}\"") || typed == format!("'{text}'") {
        1
    } else if typed == text {
        0
    } else {
        return span.clone();
    };
    if bytes.end > text.len() || bytes.start >= bytes.end {
        return span.clone();
    }
    let start = span.bytes.start + offset;
    Span {
        source: span.source,
        bytes: start + bytes.start..start + bytes.end,
    }
}

impl Evaluator<'_> {
    /// Evaluates all expressions in a node with this schema.
    pub fn visit(
        &self,
        node: &mut Node,
        schema: Option<&Json>,
        place: &Place,
        faults: &mut Vec<Located>,
    ) {
        let has_templates = place.copy.is_some();
        if !has_templates && !is_candidate(node, self.parameters) {
            return;
        }
        let kind = kind_of(node).map(str::to_owned);
        match &mut node.value {
            Value::Table(entries) => {
                for entry in entries {
                    let below = schema
                        .and_then(|schema| self.tree.property(schema, &entry.key, kind.as_deref()));
                    self.visit(&mut entry.node, below, &place.key(&entry.key), faults);
                }
            }
            Value::Array(elements) => {
                for (index, element) in elements.iter_mut().enumerate() {
                    let below = schema.and_then(|schema| self.tree.item(schema, index));
                    let number = index.to_string();
                    let name = name_of(element).unwrap_or_else(|| number.clone());
                    self.visit(element, below, &place.element(&number, &name), faults);
                }
            }
            Value::String(text) => {
                let accepted = schema.map(|schema| self.tree.accepted(schema));
                let value = match accepted.filter(Accepted::is_numeric) {
                    Some(accepted) => self.number(text, &accepted, place),
                    None if has_templates && text.contains(['{', '}']) => self
                        .filled(text, place)
                        .map(|text| Some(Value::String(text))),
                    None => Ok(None),
                };
                match value {
                    Ok(Some(value)) => node.value = value,
                    Ok(None) => {}
                    Err(mistake) => faults.push(located(self.sources, place, node, mistake)),
                }
            }
            _ => {}
        }
    }

    /// The value of an expression; `None` for text that is not an expression.
    fn number(
        &self,
        text: &str,
        accepted: &Accepted<'_>,
        place: &Place,
    ) -> Result<Option<Value>, Mistake> {
        if is_plain(text) || accepted.words.contains(&text) {
            return Ok(None);
        }
        let scope = Scope {
            parameters: self.parameters,
            place,
        };
        let expression = match parse(text) {
            Ok(expression) => expression,
            Err(_) if is_meant_as_quantity(text) => return Ok(None),
            Err(mistake) => return Err(mistake),
        };
        if expression.is_wordlike() && is_word(text, &expression, &scope) {
            return Ok(None);
        }
        let amount = expression.evaluate(&scope)?;
        let of_text = |message: String| Mistake {
            message,
            help: None,
            bytes: 0..text.len(),
        };
        as_value(amount, accepted)
            .map(Some)
            .map_err(|message| of_text(format!("{text:?} {message}")))
    }

    /// Replaces expressions in braces by their values; `{{` and `}}` are literal braces.
    fn filled(&self, text: &str, place: &Place) -> Result<String, Mistake> {
        let scope = Scope {
            parameters: self.parameters,
            place,
        };
        let mut filled = String::new();
        let mut at = 0;
        while let Some(character) = text[at..].chars().next() {
            let mistake = |message: &str, bytes: std::ops::Range<usize>| Mistake {
                message: message.to_owned(),
                help: Some("write `{{` and `}}` for braces".to_owned()),
                bytes,
            };
            let rest = &text[at..];
            if rest.starts_with("{{") || rest.starts_with("}}") {
                filled.push(character);
                at += 2;
            } else if character == '}' {
                return Err(mistake("this `}` closes nothing", at..at + 1));
            } else if character == '{' {
                let length = rest.find('}');
                let length =
                    length.ok_or_else(|| mistake("this `{` is not closed", at..text.len()))?;
                let of_text = |mistake: Mistake| Mistake {
                    bytes: at + 1 + mistake.bytes.start..at + 1 + mistake.bytes.end,
                    ..mistake
                };
                let expression = parse(&rest[1..length]).map_err(of_text)?;
                let amount = expression.evaluate(&scope).map_err(of_text)?;
                let number = amount.pure_number("text");
                let number = number.map_err(|message| mistake(&message, at + 1..at + length))?;
                if !number.is_finite() {
                    let written = &rest[1..length];
                    return Err(Mistake {
                        message: format!("{written:?} is {number}, not a finite number"),
                        help: None,
                        bytes: at + 1..at + length,
                    });
                }
                filled.push_str(&in_text(number));
                at += length + 1;
            } else {
                filled.push(character);
                at += character.len_utf8();
            }
        }
        Ok(filled)
    }
}

/// The name of a table, if it has one.
pub fn name_of(node: &Node) -> Option<String> {
    word_of(node, "name").map(str::to_owned)
}

/// The kind of a table, if it has one.
pub fn kind_of(node: &Node) -> Option<&str> {
    word_of(node, "kind")
}

fn word_of<'a>(node: &'a Node, key: &str) -> Option<&'a str> {
    match &node.entry(key)?.node.value {
        Value::String(word) => Some(word),
        _ => None,
    }
}

/// A number as part of a name: whole numbers have no decimal point.
fn in_text(number: f64) -> String {
    match whole(number) {
        Some(whole) => whole.to_string(),
        None => number.to_string(),
    }
}

fn whole(number: f64) -> Option<i64> {
    let is_whole = number.fract() == 0.0 && number.abs() < LARGEST_WHOLE;
    // Whole numbers in this range are exact.
    is_whole.then_some(number as i64)
}

/// Converts an amount to the value of a key, or returns the fault.
pub fn as_value(amount: Amount, accepted: &Accepted<'_>) -> Result<Value, String> {
    if !amount.value.is_finite() {
        return Err(format!("is {}, not a finite number", amount.value));
    }
    let is_pure = amount.powers == [0; 3];
    match accepted.quantity {
        Some((_, powers)) if is_pure || powers == amount.powers => Ok(Value::Float(amount.value)),
        Some((name, _)) => Err(format!(
            "is {}, but this key takes {name}",
            amount.dimension()
        )),
        None if !is_pure => Err(format!(
            "is {}, but this key takes a pure number",
            amount.dimension()
        )),
        None if !accepted.integer => Ok(Value::Float(amount.value)),
        None => match whole(amount.value) {
            Some(whole) => Ok(Value::Integer(whole)),
            None if accepted.number => Ok(Value::Float(amount.value)),
            None => Err(format!(
                "is {}, but this key takes a whole number; round it by round(x), floor(x) or ceil(x)",
                amount.value
            )),
        },
    }
}
