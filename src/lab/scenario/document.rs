//! TOML as a tree of keys and values with their positions in the text.
//!
//! Trees of several texts can be merged. A scenario that extends another file and has overrides on
//! the command line still reports the right file, line and column.

use super::issue::KeyPath;
use super::source::Span;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Position of the value. For a `[table]`, the position of its header.
    pub span: Span,
}

/// A TOML value.
#[derive(Clone, Debug)]
pub enum Value {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// Any other number.
    Float(f64),
    /// Text.
    String(String),
    /// A date or time; scenarios use none.
    Datetime,
    /// Values in order.
    Array(Vec<Node>),
    /// Keys and values.
    Table(Vec<Entry>),
}

/// A key and its value.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Place of the key.
    pub key_span: Span,
    /// The value.
    pub node: Node,
}

/// A mistake in TOML itself.
#[derive(Clone, Debug)]
pub struct SyntaxError {
    /// Description of the fault.
    pub message: String,
    /// Place of the fault.
    pub bytes: Range<usize>,
}

/// Parses the text of `source`.
///
/// # Errors
/// All mistakes that the TOML parser finds in one pass.
pub fn parse(source: usize, text: &str) -> Result<Node, Vec<SyntaxError>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        // The parser would report an open bracket far below, and at many places.
        if let Some(byte) = unclosed_bracket(text) {
            return Err(vec![SyntaxError {
                message: format!("this `{}` is not closed", &text[byte..=byte]),
                bytes: byte..byte + 1,
            }]);
        }
        return Err(errors
            .into_iter()
            .map(|error| SyntaxError {
                message: error.message().to_owned(),
                bytes: error.span().unwrap_or(0..0),
            })
            .collect());
    }
    Ok(Node {
        value: table_value(source, table.get_ref()),
        span: Span {
            source,
            bytes: 0..0,
        },
    })
}

/// Whether the bracket or brace at a place does not match the one that was opened last.
fn is_of_another_kind(bytes: &[u8], open: &[usize], place: usize) -> bool {
    let opened = open.last().map(|at| bytes[*at]);
    matches!(
        (opened, bytes[place]),
        (Some(b'['), b'}') | (Some(b'{'), b']')
    )
}

/// Whether a list that begins at `place` is beyond the end of the innermost open list: it begins a
/// line, and the item before it, which ended at `before`, is no list.
fn is_beyond_list(bytes: &[u8], open: &[usize], before: usize, place: usize) -> bool {
    let [.., outer, inner] = open else {
        return false;
    };
    before > *inner
        && bytes[*outer] == b'['
        && bytes[*inner] == b'['
        && !matches!(bytes[before], b']' | b'}')
        && bytes[before..place].contains(&b'\n')
}

/// Whether the bracket at `place`, which closes the innermost open list, looks as if it closed the
/// outer list: the bracket begins a line, and of both lists only the outer one began at the end of
/// a line.
fn closes_outer_list(bytes: &[u8], open: &[usize], place: usize) -> bool {
    let [.., outer, inner] = open else {
        return false;
    };
    let blank = |byte: &&u8| !matches!(**byte, b' ' | b'\t' | b'\r');
    let ends_line = |at: usize| matches!(bytes[at + 1..].iter().find(blank), Some(b'\n' | b'#'));
    let begins_line = bytes[..place].iter().rev().find(blank) == Some(&b'\n');
    begins_line && ends_line(*outer) && !ends_line(*inner)
}

/// The first bracket or brace of a value that is still open at the next key, the next table or the
/// end of the text.
fn unclosed_bracket(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let mut open: Vec<usize> = Vec::new();
    let mut in_value = false;
    // The end of the last item, and a list that was probably closed by a bracket of another one.
    let (mut item, mut suspect) = (0, None);
    let guilty = |suspect: Option<usize>, first: Option<&usize>| {
        suspect.filter(|at| Some(at) > first).or(first.copied())
    };
    let mut place = 0;
    while place < bytes.len() {
        let start = place;
        match bytes[place] {
            b'#' => place += line_length(&text[place..]),
            quote @ (b'"' | b'\'') => place = end_of_text(text, place, quote)?,
            b'\n' if open.is_empty() => (in_value, suspect) = (false, None),
            b'=' if open.is_empty() => in_value = true,
            // A key in a list: the open bracket should have been closed before. Inline tables have
            // keys of their own.
            b'=' if open.iter().all(|at| bytes[*at] == b'[') => {
                return guilty(suspect, open.first());
            }
            b'[' if in_value && is_beyond_list(bytes, &open, item, place) => {
                return open.last().copied();
            }
            b'[' | b'{' if in_value => open.push(place),
            b']' | b'}' if in_value && is_of_another_kind(bytes, &open, place) => {
                return guilty(suspect, open.last());
            }
            b']' | b'}' if in_value => {
                if closes_outer_list(bytes, &open, place) {
                    suspect = suspect.or(open.last().copied());
                }
                open.pop();
            }
            _ => {}
        }
        if !matches!(bytes[start], b'#' | b',' | b' ' | b'\t' | b'\r' | b'\n') {
            item = place;
        }
        place += 1;
    }
    guilty(suspect, open.first())
}

fn line_length(text: &str) -> usize {
    // The caller checks the line break itself next.
    text.find('\n').unwrap_or(text.len()).saturating_sub(1)
}

/// Last byte of the quoted text that begins at `start`; `None` if it is not closed.
fn end_of_text(text: &str, start: usize, quote: u8) -> Option<usize> {
    let bytes = text.as_bytes();
    let triple = [quote; 3];
    let (from, width) = match bytes[start..].starts_with(&triple) {
        true => (start + 3, 3),
        false => (start + 1, 1),
    };
    let mut place = from;
    while place < bytes.len() {
        match bytes[place] {
            b'\\' if quote == b'"' => place += 1,
            b'\n' if width == 1 => return None,
            _ if bytes[place..].starts_with(&triple[..width]) => return Some(place + width - 1),
            _ => {}
        }
        place += 1;
    }
    None
}

fn table_value(source: usize, table: &DeTable<'_>) -> Value {
    let mut entries: Vec<Entry> = table
        .iter()
        .map(|(key, value)| Entry {
            key: key.get_ref().to_string(),
            key_span: Span {
                source,
                bytes: key.span(),
            },
            node: node(source, value),
        })
        .collect();
    entries.sort_by_key(|entry| entry.key_span.bytes.start);
    Value::Table(entries)
}

fn node(source: usize, value: &toml::Spanned<DeValue<'_>>) -> Node {
    let span = Span {
        source,
        bytes: value.span(),
    };
    let value = match value.get_ref() {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Boolean(boolean) => Value::Boolean(*boolean),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .map_or(Value::Float(f64::INFINITY), Value::Integer),
        DeValue::Float(float) => Value::Float(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Datetime(_) => Value::Datetime,
        DeValue::Array(array) => {
            Value::Array(array.iter().map(|element| node(source, element)).collect())
        }
        DeValue::Table(table) => table_value(source, table),
    };
    Node { value, span }
}

impl Node {
    /// Kind of this value, as text.
    pub fn description(&self) -> &'static str {
        match self.value {
            Value::Boolean(_) => "a boolean",
            Value::Integer(_) => "a whole number",
            Value::Float(_) => "a number",
            Value::String(_) => "text",
            Value::Datetime => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }

    /// The entry of a key, if this is a table with that key.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.key == key),
            _ => None,
        }
    }

    /// Merges `over` into this node: tables are merged key by key, anything else is replaced.
    pub fn merge(&mut self, over: Node) {
        match (&mut self.value, over.value) {
            (Value::Table(under), Value::Table(over_entries)) => {
                for entry in over_entries {
                    match under.iter_mut().find(|known| known.key == entry.key) {
                        Some(known) => {
                            known.key_span = entry.key_span;
                            known.node.merge(entry.node);
                        }
                        None => under.push(entry),
                    }
                }
                self.span = over.span;
            }
            (_, value) => {
                *self = Node {
                    value,
                    span: over.span,
                };
            }
        }
    }

    /// Adds a key to a table that does not have it. The key has the position of the table.
    pub fn insert(&mut self, key: &str, value: Value) {
        let span = self.span.clone();
        if let Value::Table(entries) = &mut self.value {
            entries.push(Entry {
                key: key.to_owned(),
                key_span: span.clone(),
                node: Node { value, span },
            });
        }
    }

    /// Removes a key from a table.
    pub fn remove(&mut self, key: &str) -> Option<Entry> {
        match &mut self.value {
            Value::Table(entries) => {
                let index = entries.iter().position(|entry| entry.key == key)?;
                Some(entries.remove(index))
            }
            _ => None,
        }
    }

    /// Positions of the key and the value at `path`, or of the last existing step if the path
    /// extends beyond the tree. Elements of arrays have the key of the array.
    pub fn locate(&self, path: &KeyPath) -> (Span, Span) {
        let (mut key, mut node) = (self.span.clone(), self);
        for step in path.steps() {
            match &node.value {
                Value::Table(_) => match node.entry(step) {
                    Some(entry) => (key, node) = (entry.key_span.clone(), &entry.node),
                    None => break,
                },
                Value::Array(elements) => {
                    match step
                        .parse()
                        .ok()
                        .and_then(|index: usize| elements.get(index))
                    {
                        Some(element) => node = element,
                        None => break,
                    }
                }
                _ => break,
            }
        }
        (key, node.span.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_unclosed_bracket_is_reported_once_at_its_place() {
        for text in [
            "a = 1\nb = [1, 2\nc = 3\n[d]\ne = [4]\n",
            "a = 1\nb = [[1], [2]\n\n[d]\ne = [4]\n",
            "# [\nb = [\"]\", ']', 2\nc = [3]\nd = [4]\n",
            "b = { x = [1, 2 }\nc = 3\n",
        ] {
            let errors = parse(0, text).unwrap_err();
            let [error] = errors.as_slice() else {
                panic!("{text}: {errors:?}");
            };
            let line = text[..error.bytes.start].matches('\n').count();
            assert!(
                text.lines().nth(line).unwrap().starts_with("b = "),
                "{error:?}"
            );
            assert!(error.message.contains("is not closed"), "{error:?}");
        }
    }

    #[test]
    fn the_bracket_that_another_kind_closes_is_the_unclosed_one() {
        let text = "shape = { start = [0, 0, 0, end = [1, 0, 0] }\n[time]\n";
        let errors = parse(0, text).unwrap_err();
        assert_eq!(errors[0].bytes.start, text.find("[0").unwrap());
    }

    #[test]
    fn an_unclosed_list_in_a_list_over_several_lines_is_named() {
        for text in [
            "shape = { points = [\n [0, 0, 0],\n [0, 0, 0.1\n [0, 0, 0.2],\n] }\n[time]\n",
            "points = [\n [0, 0, 0],\n [0, 0, 0.1, # here\n [0, 0, 0.2],\n]\n[time]\n",
            "points = [\n [0, 0, 0.1\n]\n[time]\n",
        ] {
            let errors = parse(0, text).unwrap_err();
            let guilty = text.find("[0, 0, 0.1").unwrap();
            assert_eq!(errors[0].bytes.start, guilty, "{text}: {errors:?}");
        }
    }

    #[test]
    fn other_mistakes_are_not_taken_for_brackets() {
        for text in [
            "a = \n",
            "a = [1, 2]]\n",
            "a = [1 2]\n",
            "[a\nb = 1\n",
            "a = \"[\n",
        ] {
            let errors = parse(0, text).unwrap_err();
            assert!(
                errors
                    .iter()
                    .all(|error| !error.message.contains("is not closed")),
                "{text}"
            );
        }
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "[a-c=\\[\\]{}\"'#\\\\ \n1µ]{0,40}") {
            let _ = parse(0, &text);
        }
    }
}
