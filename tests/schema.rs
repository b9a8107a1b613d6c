//! The JSON Schema with which editors check scenarios accepts the same files as the program.

use rodlab::experiment::json_schema;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Faults of a value according to the part of JSON Schema that the program prints.
///
/// # Panics
/// The schema has a keyword that this function does not support.
fn faults(root: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let Value::Object(keywords) = schema else {
        return match schema {
            Value::Bool(true) => Vec::new(),
            _ => vec![format!("{at}: nothing is allowed here")],
        };
    };
    let holds = |schema: &Value| faults(root, schema, value, at).is_empty();
    let mut found = Vec::new();
    for (keyword, argument) in keywords {
        let list = argument.as_array().map_or(&[][..], Vec::as_slice);
        let number = argument.as_f64().unwrap_or(f64::NAN);
        let is_met = match keyword.as_str() {
            "$ref" => {
                let pointer = argument.as_str().unwrap().trim_start_matches('#');
                found.extend(faults(root, root.pointer(pointer).unwrap(), value, at));
                true
            }
            "type" => match argument {
                Value::String(name) => is_of(value, name),
                _ => list.iter().any(|name| is_of(value, name.as_str().unwrap())),
            },
            "x-range" | "x-unit" | "x-required" | "x-default" => true,
            "const" => value == argument,
            "enum" => list.contains(value),
            "anyOf" => list.iter().any(holds),
            "oneOf" => list.iter().filter(|schema| holds(schema)).count() == 1,
            "required" => value.as_object().is_none_or(|table| {
                list.iter()
                    .all(|key| table.contains_key(key.as_str().unwrap()))
            }),
            "minItems" => value
                .as_array()
                .is_none_or(|items| items.len() as f64 >= number),
            "maxItems" => value
                .as_array()
                .is_none_or(|items| items.len() as f64 <= number),
            "minimum" => value.as_f64().is_none_or(|value| value >= number),
            "prefixItems" => {
                for (k, (item, schema)) in
                    value.as_array().into_iter().flatten().zip(list).enumerate()
                {
                    found.extend(faults(root, schema, item, &format!("{at}[{k}]")));
                }
                true
            }
            "items" => {
                let first = keywords.get("prefixItems").and_then(Value::as_array);
                let first = first.map_or(0, Vec::len);
                for (k, item) in value
                    .as_array()
                    .into_iter()
                    .flatten()
                    .enumerate()
                    .skip(first)
                {
                    found.extend(faults(root, argument, item, &format!("{at}[{k}]")));
                }
                true
            }
            "properties" | "additionalProperties" => {
                for (key, member) in value.as_object().into_iter().flatten() {
                    let known = keywords.get("properties").and_then(|known| known.get(key));
                    let schema = match keyword.as_str() {
                        "properties" => known,
                        _ => Some(argument).filter(|_| known.is_none()),
                    };
                    let schema = schema.unwrap_or(&Value::Bool(true));
                    found.extend(faults(root, schema, member, &format!("{at}.{key}")));
                }
                true
            }
            "$defs" | "$schema" | "title" | "description" | "format" | "default" | "examples" => {
                true
            }
            other => panic!("the keyword {other} is not supported by this test"),
        };
        if !is_met {
            found.push(format!("{at}: {keyword} {argument}"));
        }
    }
    found
}

fn is_of(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("the type {other} is not supported by this test"),
    }
}

fn checked(schema: &Value, text: &str) -> Vec<String> {
    let tree: toml::Table = text.parse().unwrap();
    faults(schema, schema, &serde_json::to_value(tree).unwrap(), "")
}

#[test]
fn the_schema_accepts_all_shipped_scenarios_and_refuses_unknown_keys() {
    let schema = json_schema();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            let text = fs::read_to_string(&path).unwrap();
            let found = checked(&schema, &text);
            assert!(found.is_empty(), "{}: {found:#?}", path.display());
            count += 1;
        }
    }
    assert!(count > 40);
    for (bad, key) in [
        ("experiment = \"scene\"\nradius = 1.0\n", "radius"),
        ("[time]\nstep = true\n", "time"),
        ("[[sweep.zip]]\ntime.end = [1.0]\nrods = 3\n", "sweep"),
    ] {
        let found = checked(&schema, bad).join("\n");
        assert!(found.contains(key), "{bad}: {found}");
    }
}
