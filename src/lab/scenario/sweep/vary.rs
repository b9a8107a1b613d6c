//! `--vary key=a,b,c` and `--vary key=from:to:step`.

use super::axis::{Axis, MOST_VALUES, SweptKey};
use super::range::{Interval, Number, Scale};
use crate::scenario::document::{Node, Value};
use crate::scenario::overrides::parse_value;
use crate::scenario::source::Span;

/// Reads the argument; `source` is its index among the sources.
///
/// # Errors
/// A message with the fault.
pub fn read(source: usize, argument: &str) -> Result<Axis, String> {
    let Some((key, values)) = argument.split_once('=') else {
        return Err("expected key=from:to:step or key=a,b,c".to_owned());
    };
    let whole = Span {
        source,
        bytes: key.len() + 1..argument.len(),
    };
    let node = |value| Node {
        value,
        span: whole.clone(),
    };
    let parts: Vec<&str> = values.split(':').collect();
    let each: Vec<Option<Number>> = parts
        .iter()
        .map(|part| Number::read(&Value::String((*part).trim().to_owned())).ok())
        .collect();
    if let Some(fault) = part_without_number(values, &parts, &each) {
        return Err(fault);
    }
    let numbers: Option<Vec<Number>> = each.into_iter().collect();
    let values: Vec<Node> = match numbers.as_deref() {
        Some([from, to, step]) => stepped(from, to, step)?.into_iter().map(node).collect(),
        Some([_, _]) => {
            return Err(format!(
                "{values:?} is a range without its step; expected from:to:step, as in {values}:{}",
                parts[0].trim()
            ));
        }
        _ => {
            let mut offset = key.len() + 1;
            split_list(values)
                .into_iter()
                .map(|text| {
                    let value = parse_value(source, offset, text);
                    offset += text.len() + 1;
                    value
                })
                .collect()
        }
    };
    if values.is_empty() {
        return Err("the list is empty; give at least one value".to_owned());
    }
    Ok(Axis {
        keys: vec![SweptKey {
            key: key.trim().to_owned(),
            span: Span {
                source,
                bytes: 0..key.len(),
            },
        }],
        points: values.into_iter().map(|value| vec![value]).collect(),
    })
}

/// Message about the single part of a range that is not a number.
fn part_without_number(values: &str, parts: &[&str], numbers: &[Option<Number>]) -> Option<String> {
    let [from, to, step] = numbers else {
        return None;
    };
    let (name, part) = match (from, to, step) {
        (None, Some(_), Some(_)) => ("first value", parts[0].trim()),
        (Some(_), None, Some(_)) => ("last value", parts[1].trim()),
        (Some(_), Some(_), None) => ("step", parts[2].trim()),
        _ => return None,
    };
    Some(match part {
        "" => format!("{values:?} is a range without its {name}; expected from:to:step"),
        _ => format!("{values:?}: the {name} {part:?} is not a number; expected from:to:step"),
    })
}

fn stepped(from: &Number, to: &Number, step: &Number) -> Result<Vec<Value>, String> {
    if step.unit != from.unit {
        return Err(format!(
            "the step needs the unit of the ends; found {:?} and {:?}",
            step.unit, from.unit
        ));
    }
    Interval::new(from, to, Scale::Linear)?.stepped(step.value, MOST_VALUES)
}

/// Splits at commas outside brackets, braces and quotes.
fn split_list(text: &str) -> Vec<&str> {
    let (mut depth, mut quoted, mut start) = (0usize, false, 0);
    let mut parts = Vec::new();
    for (position, character) in text.char_indices() {
        match character {
            '"' => quoted = !quoted,
            '[' | '{' if !quoted => depth += 1,
            ']' | '}' if !quoted => depth = depth.saturating_sub(1),
            ',' if !quoted && depth == 0 => {
                parts.push(&text[start..position]);
                start = position + 1;
            }
            _ => {}
        }
    }
    if !text[start..].trim().is_empty() || !parts.is_empty() {
        parts.push(&text[start..]);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn values(argument: &str) -> Vec<String> {
        let axis = read(0, argument).unwrap();
        let text = |point: &Vec<Node>| format!("{:?}", point[0].value);
        axis.points.iter().map(text).collect()
    }

    #[test]
    fn lists_and_ranges_are_distinguished() {
        assert_eq!(
            values("contact.model=imc,ipc"),
            [r#"String("imc")"#, r#"String("ipc")"#]
        );
        assert_eq!(values("flagella.count=2,3"), ["Integer(2)", "Integer(3)"]);
        assert_eq!(
            values("contact.friction=0.1:0.3:0.1"),
            ["Float(0.1)", "Float(0.2)", "Float(0.3)"]
        );
        assert_eq!(
            values("rods.0.radius=1mm:2mm:0.5mm"),
            [
                r#"String("1.0 mm")"#,
                r#"String("1.5 mm")"#,
                r#"String("2.0 mm")"#
            ]
        );
        assert_eq!(values("loads.0.acceleration=[0,0,-1],[0,0,-2]").len(), 2);
        assert_eq!(values("title=\"a, b\",c").len(), 2);
        assert_eq!(values("flagella.count=4"), ["Integer(4)"]);
    }

    #[test]
    fn faults_name_what_is_expected() {
        assert!(
            read(0, "friction")
                .unwrap_err()
                .contains("key=from:to:step")
        );
        assert!(read(0, "friction=").unwrap_err().contains("empty"));
        for range in ["3mm:7mm", "0.1 : 0.2"] {
            let error = read(0, &format!("radius={range}")).unwrap_err();
            assert!(error.contains("without its step"), "{error}");
        }
        assert!(read(0, "radius=1 mm:2 mm:1").unwrap_err().contains("unit"));
        for (range, expected) in [
            ("3mm:7mm:", "without its step"),
            ("3mm::1mm", "without its last value"),
            (":7mm:1mm", "without its first value"),
            ("3mm:7mm:small", "the step \"small\" is not a number"),
            (
                "7mm:3mm:1mm",
                "steps of 1 mm do not lead from 7 mm to 3 mm; allowed: a step below 0",
            ),
            (
                "0:1:-1",
                "steps of -1 do not lead from 0 to 1; allowed: a step above 0",
            ),
        ] {
            let error = read(0, &format!("rods.0.radius={range}")).unwrap_err();
            assert!(error.contains(expected), "{range}: {error}");
        }
    }

    proptest! {
        #[test]
        fn no_argument_makes_it_panic(text in ".{0,40}") {
            let _ = read(0, &text);
        }

        #[test]
        fn no_list_makes_it_panic(text in "[a-z]=[-0-9.,:\\[\\]{}\" a-z=\n]{0,30}") {
            let _ = read(0, &text);
        }
    }
}
