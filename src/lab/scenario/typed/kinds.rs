//! Kinds as text: `"circle"` for `{ kind = "circle" }`.

use schemars::Schema;
use serde_json::{Value, json};

/// Lets the schema of a table with a `kind` accept some kinds as text, too.
pub fn allow_text(schema: &mut Schema, kinds: &[&str]) {
    if let Some(Value::Array(alternatives)) = schema.get_mut("oneOf") {
        alternatives.push(json!({ "type": "string", "enum": kinds }));
    }
}
