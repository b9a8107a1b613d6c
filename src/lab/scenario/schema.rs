//! The JSON Schema of scenario files as written, with expressions and copies.

use super::expansion::{COUNT, LET, SCATTER, Scatter};
use super::schema_tree::is_quantity;
use super::typed::Parameter;
use schemars::SchemaGenerator;
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;

/// Extends the schema of expanded files to files as written: with expressions in place of numbers,
/// and with the keys of copies in all arrays of tables.
pub fn as_written(mut schema: Json) -> Json {
    accept_expressions(&mut schema);
    let mut generator = SchemaGenerator::default();
    let names = generator.subschema_for::<BTreeMap<String, Parameter>>();
    let scatter = generator.subschema_for::<Scatter>();
    let mut added = generator.take_definitions(true);
    let whole = json!({ "type": ["integer", "string"] });
    let keys = [
        (
            COUNT,
            json!({
                "description": "Number of copies of this table, 1 by default, or up to three numbers, such as [20, 10].\nIn expressions i, j and k are the indices of a copy, from 0; in text they are in braces, as in \"rod{i}\". The last index varies fastest.",
                "anyOf": [whole, { "type": "array", "items": whole, "minItems": 1, "maxItems": 3 }],
            }),
        ),
        (
            LET,
            described(
                names.to_value(),
                "Names for the expressions of each copy, like [parameters] for the whole file: let = { angle = \"i*30 deg\" }.",
            ),
        ),
        (
            SCATTER,
            described(
                scatter.to_value(),
                "Random places of the copies, without overlap. Expressions may use the centre x, y, z and the unit direction u, v, w.",
            ),
        ),
    ];
    let copied: Vec<(String, String)> = arrays_of_tables(&schema);
    let definitions = schema["$defs"].clone();
    let mut of_copies = Map::new();
    for (key, name) in copied {
        let mut table = definitions[&name].clone();
        add_keys(&mut table, &keys);
        let copied_name = format!("copied_{name}");
        schema["properties"][&key]["items"] = json!({ "$ref": format!("#/$defs/{copied_name}") });
        of_copies.insert(copied_name, table);
    }
    for (_, definition) in &mut added {
        accept_expressions(definition);
    }
    if let Some(Json::Object(definitions)) = schema.get_mut("$defs") {
        for (name, definition) in added {
            definitions.entry(name).or_insert(definition);
        }
        definitions.extend(of_copies);
    }
    schema
}

fn described(mut schema: Json, description: &str) -> Json {
    schema["description"] = description.into();
    schema
}

/// The top-level arrays of tables: their keys, and the names of the definitions of the tables.
fn arrays_of_tables(schema: &Json) -> Vec<(String, String)> {
    let properties = schema["properties"].as_object().into_iter().flatten();
    let array = |(key, schema): (&String, &Json)| {
        let name = schema.pointer("/items/$ref")?.as_str()?;
        Some((key.clone(), name.strip_prefix("#/$defs/")?.to_owned()))
    };
    properties.filter_map(array).collect()
}

/// Adds keys to a table, or to all kinds of a table.
fn add_keys(table: &mut Json, keys: &[(&str, Json)]) {
    if let Some(Json::Object(properties)) = table.get_mut("properties") {
        for (key, schema) in keys {
            properties.insert((*key).to_owned(), schema.clone());
        }
    }
    if let Some(Json::Array(kinds)) = table.get_mut("oneOf") {
        for kind in kinds {
            add_keys(kind, keys);
        }
    }
}

/// Allows text for every number of a schema.
fn accept_expressions(schema: &mut Json) {
    match schema {
        Json::Object(keys) => {
            let is_number = |word: &Json| word == "number" || word == "integer";
            let accepts_text = is_quantity(&Json::Object(keys.clone()));
            match keys.get_mut("type") {
                Some(word) if is_number(word) => *word = json!([word.clone(), "string"]),
                Some(Json::Array(words)) if !accepts_text && words.iter().any(is_number) => {
                    words.push("string".into());
                }
                _ => {}
            }
            for (_, below) in keys.iter_mut().filter(|(key, _)| *key != "examples") {
                accept_expressions(below);
            }
        }
        Json::Array(elements) => elements.iter_mut().for_each(accept_expressions),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::explain::json_schema;
    use super::super::tests::EXPERIMENTS;
    use serde_json::Value as Json;

    #[test]
    fn numbers_may_be_text_and_tables_of_arrays_have_copies() {
        let schema = json_schema(*EXPERIMENTS);
        let tables = schema["properties"].as_object().unwrap();
        let arrays = tables
            .iter()
            .filter(|(_, table)| table.get("items").is_some());
        let mut seen = 0;
        for (key, array) in arrays.filter(|(key, _)| *key != "unset") {
            let name = array["items"]["$ref"].as_str().unwrap();
            let table = schema.pointer(&name[1..]).unwrap();
            let whole = vec![table.clone()];
            let kinds = table["oneOf"].as_array().unwrap_or(&whole);
            for kind in kinds {
                for added in ["count", "let", "scatter"] {
                    assert!(kind["properties"].get(added).is_some(), "{added} of {key}");
                }
            }
            seen += 1;
        }
        assert!(seen >= 9, "{seen}");
        // The rod of a network has no keys of copies.
        let rod = &schema["$defs"]["rod"]["properties"];
        assert_eq!(rod.get("count"), None);
        let accepts_text = |schema: &Json| {
            schema["type"]
                .as_array()
                .unwrap()
                .contains(&"string".into())
        };
        assert!(accepts_text(&rod["edges"]));
        assert!(accepts_text(&schema["$defs"]["pure_number"]));
        assert!(accepts_text(&schema["$defs"]["length"]));
    }
}
