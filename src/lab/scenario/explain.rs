//! The JSON Schema of scenario files, and explanations of its keys.

use super::expansion::PARAMETERS;
use super::experiments::Experiments;
use super::expression::FUNCTIONS;
use super::issue::did_you_mean;
use super::schema;
use super::sentences;
use serde_json::Value;
use std::fmt::Write;

/// JSON Schema (draft 2020-12) of scenario files, for completion and checks in editors.
pub fn json_schema(experiments: Experiments) -> Value {
    schema::as_written(experiments.schema())
}

/// Explains a dotted key such as `rods.shape.radius`. Indices and names of rods are optional. The
/// empty key explains the whole file.
///
/// # Errors
/// A message with the nearest key, if there is no such key.
pub fn explain(experiments: Experiments, key: &str) -> Result<String, String> {
    let schema = json_schema(experiments);
    let explainer = Explainer { root: &schema };
    let (meanings, walked) = explainer.walk(key)?;
    if let Some((table, "kind")) = key.rsplit_once('.') {
        let (tables, _) = explainer.walk(table)?;
        let kinds = explainer.kinds(&tables);
        if !kinds.is_empty() {
            return Ok(format!("{walked}\n{kinds}"));
        }
    }
    let mut text = String::new();
    for meaning in &meanings {
        explainer.describe(&mut text, &walked, meaning);
    }
    if walked == PARAMETERS {
        text.push_str(&functions());
    }
    Ok(text)
}

/// The functions of expressions, one per line.
fn functions() -> String {
    let width = FUNCTIONS.iter().map(|of| of.usage.len()).max().unwrap_or(0);
    let lines = FUNCTIONS
        .iter()
        .map(|of| format!("    {:<width$}  {}\n", of.usage, of.meaning));
    let list: String = lines.collect();
    format!("  functions of expressions, beside + - * / ^ ( ) and pi:\n{list}")
}

/// The SI unit of a dotted key; `None` if it has none or the key does not exist. The key may
/// contain names of rods.
pub fn unit(schema: &Value, key: &str) -> Option<String> {
    let explainer = Explainer { root: schema };
    let steps: Vec<&str> = key.split('.').collect();
    let without_name = || [&steps[..1], &steps[2..]].concat().join(".");
    let (meanings, _) = explainer
        .walk(key)
        .ok()
        .or_else(|| (steps.len() > 2).then(|| explainer.walk(&without_name()).ok())?)?;
    let schemas = meanings
        .iter()
        .flat_map(|meaning| explainer.expanded(meaning.schema));
    schemas
        .filter_map(|schema| schema.get("description")?.as_str())
        .find_map(|words| {
            Some(
                words
                    .strip_prefix("A number in ")?
                    .split_once(',')?
                    .0
                    .to_owned(),
            )
        })
}

/// A possible schema of a key. In a table with several kinds a key may have several meanings.
#[derive(Clone)]
struct Meaning<'a> {
    kind: Option<&'a str>,
    schema: &'a Value,
}

/// A description, with its schema.
struct Sentence<'a> {
    schema: &'a Value,
    /// Whether it is one of several alternatives.
    is_alternative: bool,
    words: String,
}

impl Sentence<'_> {
    /// Whether a sentence about the type of a key can be left out, because the text about the key
    /// lists the alternatives of the type, or has the same meaning.
    fn adds_nothing_to(&self, of_key: &str) -> bool {
        let is_heading = self.schema.get("oneOf").is_some();
        !self.words.contains('\n')
            && self.schema.get("const").is_none()
            && kind(self.schema).is_none()
            && (self.is_alternative
                || is_heading
                || !sentences::is_quantity(&self.words) && sentences::repeats(of_key, &self.words))
    }
}

struct Explainer<'a> {
    root: &'a Value,
}

impl<'a> Explainer<'a> {
    /// The meanings of a dotted key, and the key without indices.
    ///
    /// # Errors
    /// A message with the nearest key.
    fn walk(&self, key: &str) -> Result<(Vec<Meaning<'a>>, String), String> {
        let mut meanings = vec![Meaning {
            kind: None,
            schema: self.root,
        }];
        let mut walked = String::new();
        for step in key.split('.').filter(|step| !step.is_empty()) {
            if step.parse::<usize>().is_ok() {
                continue;
            }
            let keys: Vec<(Meaning<'_>, &str)> = meanings
                .iter()
                .flat_map(|meaning| self.keys(meaning.schema))
                .collect();
            let found: Vec<Meaning<'_>> = keys
                .iter()
                .filter(|(_, name)| *name == step)
                .map(|(meaning, _)| meaning.clone())
                .collect();
            if found.is_empty() {
                let place = if walked.is_empty() {
                    "at the top of a scenario".to_owned()
                } else {
                    format!("in `{walked}`")
                };
                let names = keys.iter().map(|(_, name)| *name);
                let advice = did_you_mean(step, names).unwrap_or_else(|| {
                    let mut names: Vec<&str> = keys.iter().map(|(_, name)| *name).collect();
                    names.dedup();
                    format!("the keys are: {}", names.join(", "))
                });
                return Err(format!("there is no key `{step}` {place}; {advice}"));
            }
            meanings = found;
            if !walked.is_empty() {
                walked.push('.');
            }
            walked.push_str(step);
        }
        Ok((meanings, walked))
    }

    /// The kinds of tables, one per line; empty if there are none.
    fn kinds(&self, tables: &[Meaning<'a>]) -> String {
        let schemas = tables.iter().flat_map(|table| self.expanded(table.schema));
        let mut lines: Vec<String> = Vec::new();
        for schema in schemas {
            let Some(name) = kind(schema) else { continue };
            let description = schema.get("description").and_then(Value::as_str);
            let first = description.and_then(|words| words.lines().next());
            let line = format!("  {name:?}: {}\n", first.unwrap_or_default());
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
        lines.concat()
    }

    /// All schemas that contribute to a schema: itself, its references, alternatives and elements.
    fn expanded(&self, schema: &'a Value) -> Vec<&'a Value> {
        let mut found = vec![schema];
        if let Some(reference) = schema.get("$ref").and_then(Value::as_str) {
            let target = reference
                .strip_prefix('#')
                .and_then(|path| self.root.pointer(path));
            found.extend(target.into_iter().flat_map(|target| self.expanded(target)));
        }
        for list in ["anyOf", "oneOf", "allOf"] {
            let alternatives = schema.get(list).and_then(Value::as_array);
            for alternative in alternatives.into_iter().flatten() {
                found.extend(self.expanded(alternative));
            }
        }
        if let Some(items) = schema.get("items") {
            found.extend(self.expanded(items));
        }
        found
    }

    /// The target of a reference.
    fn target(&self, schema: &Value) -> Option<&'a Value> {
        let path = schema.get("$ref")?.as_str()?.strip_prefix('#')?;
        self.root.pointer(path)
    }

    /// The descriptions of a schema and of the types that contribute to it. Lists of quantities
    /// have one sentence.
    fn described(&self, schema: &'a Value) -> Vec<Sentence<'a>> {
        let mut found = Vec::new();
        self.collect(schema, false, &mut found);
        found
    }

    fn collect(&self, schema: &'a Value, is_alternative: bool, found: &mut Vec<Sentence<'a>>) {
        if let Some(words) = description(schema) {
            found.push(Sentence {
                schema,
                is_alternative,
                words: sentences::legible(words),
            });
        }
        if let Some(target) = self.target(schema) {
            self.collect(target, false, found);
        }
        for list in ["anyOf", "oneOf", "allOf"] {
            let alternatives = schema.get(list).and_then(Value::as_array);
            for alternative in alternatives.into_iter().flatten() {
                self.collect(alternative, list == "anyOf", found);
            }
        }
        match (self.list(schema), schema.get("items")) {
            (Some(words), _) => found.push(Sentence {
                schema,
                is_alternative: false,
                words,
            }),
            (None, Some(items)) => self.collect(items, false, found),
            (None, None) => {}
        }
    }

    /// Sentence about a list of quantities; `None` for other schemas.
    fn list(&self, mut schema: &'a Value) -> Option<String> {
        let mut sizes = Vec::new();
        while let Some(items) = schema.get("items") {
            let bound = |name: &str| schema.get(name).and_then(Value::as_u64);
            sizes.push(bound("minItems").filter(|least| bound("maxItems") == Some(*least)));
            schema = self.target(items).unwrap_or(items);
        }
        let element = description(schema).filter(|_| !sizes.is_empty())?;
        sentences::list(element, &sizes)
    }

    /// The keys of a table, each with its kind of table.
    fn keys(&self, schema: &'a Value) -> Vec<(Meaning<'a>, &'a str)> {
        let mut keys: Vec<(Meaning<'a>, &'a str)> = Vec::new();
        let mut collect = |kind: Option<&'a str>, schema: &'a Value| {
            let properties = schema.get("properties").and_then(Value::as_object);
            for (name, schema) in properties.into_iter().flatten() {
                let known = keys
                    .iter()
                    .any(|(meaning, known)| known == name && std::ptr::eq(meaning.schema, schema));
                if !known {
                    keys.push((Meaning { kind, schema }, name));
                }
            }
        };
        for schema in self.expanded(schema) {
            match kind(schema) {
                // The schema of a kind may refer to the schema with its keys.
                Some(kind) => self
                    .expanded(schema)
                    .into_iter()
                    .for_each(|schema| collect(Some(kind), schema)),
                None => collect(None, schema),
            }
        }
        keys
    }

    fn describe(&self, text: &mut String, key: &str, meaning: &Meaning<'a>) {
        let of_kind = meaning
            .kind
            .map_or(String::new(), |kind| format!(" (of kind {kind:?})"));
        if !key.is_empty() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{key}{of_kind}");
        }
        let of_key = description(meaning.schema);
        let mut written: Vec<String> = Vec::new();
        for sentence in self.described(meaning.schema) {
            let is_type = !std::ptr::eq(sentence.schema, meaning.schema);
            let is_known = is_type && of_key.is_some_and(|words| sentence.adds_nothing_to(words));
            if is_known || written.contains(&sentence.words) {
                continue;
            }
            // Fences are for web pages; in a terminal drawings need none.
            let lines = sentence
                .words
                .lines()
                .filter(|line| !line.starts_with("```"));
            let words = lines.collect::<Vec<_>>().join("\n");
            match sentence.schema.get("const") {
                Some(word) => {
                    let words = format!("{word}: {words}");
                    let _ = writeln!(text, "{}", sentences::indented(&words, 2));
                }
                None if kind(sentence.schema).is_none() => {
                    let _ = writeln!(text, "{}", sentences::indented(&words, 2));
                }
                None => continue,
            }
            written.push(sentence.words);
        }
        if let Some(range) = meaning.schema.get("x-range").and_then(Value::as_str) {
            let _ = writeln!(text, "  range: {range}");
        }
        if meaning.schema.get("x-required").is_some() {
            let _ = writeln!(text, "  required");
        }
        let kinds = self.keys_of_kinds(meaning.schema);
        let mut common: Vec<&str> = Vec::new();
        for (_, name) in self.keys(meaning.schema) {
            if kinds.iter().all(|(_, keys)| keys.contains(&name)) && !common.contains(&name) {
                common.push(name);
            }
        }
        let mut list = |what: &str, names: &[&str]| {
            if !names.is_empty() {
                let names = format!("{what}: {}", names.join(", "));
                let _ = writeln!(text, "{}", sentences::indented(&names, 4));
            }
        };
        let names: Vec<&str> = kinds.iter().map(|(kind, _)| *kind).collect();
        list("kinds", &names);
        let every = if kinds.is_empty() {
            "keys"
        } else {
            "keys of every kind"
        };
        list(every, &common);
        for (kind, mut keys) in kinds {
            keys.retain(|key| !common.contains(key));
            list(&format!("keys of {kind:?}"), &keys);
        }
    }

    /// The kinds of a table, each with its keys.
    fn keys_of_kinds(&self, schema: &'a Value) -> Vec<(&'a str, Vec<&'a str>)> {
        let of_kind = |schema: &'a Value| {
            let tables = self.expanded(schema).into_iter();
            let properties = tables.filter_map(|table| table.get("properties")?.as_object());
            let names = properties.flat_map(|properties| properties.keys().map(String::as_str));
            Some((
                kind(schema)?,
                names.filter(|name| *name != "kind").collect(),
            ))
        };
        self.expanded(schema)
            .into_iter()
            .filter_map(of_kind)
            .collect()
    }
}

fn description(schema: &Value) -> Option<&str> {
    schema.get("description")?.as_str()
}

/// The kind that a schema requires.
fn kind(schema: &Value) -> Option<&str> {
    schema.pointer("/properties/kind/const")?.as_str()
}

#[cfg(test)]
mod tests {
    use super::super::tests::EXPERIMENTS;
    use super::*;

    #[test]
    fn keys_are_explained_in_words() {
        insta::assert_snapshot!(explain(*EXPERIMENTS, "contact.friction").unwrap(), @r###"
contact.friction
  Coulomb friction coefficient. Default: 0.
  A pure number.
  range: at least 0
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "rods.0.radius").unwrap(), @r###"
rods.radius
  Radius of the surface that touches other rods and the fluid, and of a circular cross-section.
  Default for a rectangle: half its smaller side.
  A number in m, or text with a unit; allowed units: m, cm, mm, µm, um, nm, km, in.
  range: greater than 0
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "rods.shape.radius").unwrap(), @r###"
rods.shape.radius (of kind "helix")
  Radius of the helix.
  A number in m, or text with a unit; allowed units: m, cm, mm, µm, um, nm, km, in.
  range: greater than 0
  required
rods.shape.radius (of kind "arc")
  Radius of the circle.
  A number in m, or text with a unit; allowed units: m, cm, mm, µm, um, nm, km, in.
  range: greater than 0
  required
rods.shape.radius (of kind "ring")
  Radius of the circle.
  A number in m, or text with a unit; allowed units: m, cm, mm, µm, um, nm, km, in.
  range: greater than 0
  required
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "rods.shape").unwrap(), @r###"
rods.shape
  The placed shape of the rod.
  kinds: straight, helix, arc, ring, catenary, slack, coil, points
  keys of "straight": end, start
  keys of "helix": axis, centre, handedness, length, phase, pitch, radius, start, turns
  keys of "arc": angle, normal, radius, start, tangent
  keys of "ring": centre, normal, radius
  keys of "catenary": down, end, length, start
  keys of "slack": end, length, start, towards
  keys of "coil": centre, inner_radius, length, normal, phase, spacing
  keys of "points": file, points
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "loads.acceleration").unwrap(), @r###"
loads.acceleration (of kind "gravity")
  Acceleration of free fall, for example [0, 0, -9.81].
  A list of 3 numbers in m/s^2, or texts with a unit; allowed units: m/s^2, cm/s^2, mm/s^2.
  required
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "time").unwrap(), @r###"
time
  Dynamic, static or along a path of equilibria, and the time steps.
  keys: begin, end, maximum_step, mode, scheme, step, tolerance
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "time.mode").unwrap(), @r###"
time.mode
  "dynamic" (the default), "static" (equilibrium by Newton's method without inertia: there is no
  time, so clamps that move and loads with a schedule are errors), or "continuation" (equilibria
  along a path, with folds, bifurcations and stability; see [continuation]).
  "dynamic": Time steps from zero to `end`.
  "static": Equilibrium, without inertia.
  "continuation": Equilibria along a path.
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "clamps.at").unwrap(), @r###"
clamps.at
  "start", "end", or the number of a node, counted from zero.
  required
"###);
        insta::assert_snapshot!(explain(*EXPERIMENTS, "").unwrap(), @r###"
A rodlab scenario. Numbers are in SI units; text may carry a unit, such as "1.6 mm".
keys: actuation, bodies, clamps, contact, continuation, experiment, extends, flagella, fluid,
  free_bodies, helix_stability, include, joints, knot, loads, material, networks, obstacles,
  output, parameters, planes, probes, rod, rods, sheaths, solver, start, stop_when, sweep,
  tendons, time, title, unset
"###);
    }

    #[test]
    fn the_kinds_of_tables_are_explained() {
        for (key, kinds) in [
            (
                "rods.shape.kind",
                &[
                    "straight", "helix", "arc", "ring", "catenary", "slack", "coil", "points",
                ][..],
            ),
            (
                "loads.kind",
                &["gravity", "force", "moment", "distributed", "drag"],
            ),
            ("rods.0.natural_shape.kind", &["as-placed", "curved"]),
            (
                "joints.kind",
                &["ball", "rigid", "hinge", "slide", "spring"],
            ),
            ("bodies.shape.kind", &["sphere", "disk", "box"]),
            ("networks.shape.kind", &["grid", "table"]),
        ] {
            let text = explain(*EXPERIMENTS, key).unwrap();
            for kind in kinds {
                let line = text
                    .lines()
                    .find_map(|line| line.strip_prefix(&format!("  {kind:?}: ")));
                assert!(
                    line.is_some_and(|words| !words.is_empty()),
                    "{kind} in {text}"
                );
            }
        }
        // A key called `kind` that does not distinguish tables is explained like any other key.
        let text = explain(*EXPERIMENTS, "knot.kind").unwrap();
        assert!(text.starts_with("knot.kind\n  "), "{text}");
    }

    /// The kinds of a table as a table in Markdown: their keys and descriptions.
    fn table_of_kinds(key: &str) -> String {
        let schema = json_schema(*EXPERIMENTS);
        let explainer = Explainer { root: &schema };
        let (meanings, walked) = explainer.walk(key).unwrap();
        let mut text = format!("| `{walked}.kind` | keys | what it is |\n|---|---|---|\n");
        for (name, keys) in explainer.keys_of_kinds(meanings[0].schema) {
            let schemas = explainer.expanded(meanings[0].schema).into_iter();
            let mut of_kind = schemas.filter(|schema| kind(schema) == Some(name));
            let words = of_kind.find_map(|schema| schema["description"].as_str());
            let words = words.unwrap_or_default().replace('\n', " ");
            let _ = writeln!(text, "| `{name}` | `{}` | {words} |", keys.join("`, `"));
        }
        text
    }

    /// If the page differs, replace its table by the one that the test prints.
    #[test]
    fn the_guide_has_the_keys_of_obstacles() {
        let page = include_str!("../../guide/obstacles.md");
        let table = table_of_kinds("obstacles.shape");
        assert!(page.contains(&table), "src/guide/obstacles.md: {table}");
    }

    #[test]
    fn keys_have_units_and_may_hold_names_of_rods() {
        let schema = json_schema(*EXPERIMENTS);
        for (key, expected) in [
            ("rods.beam.radius", Some("m")),
            ("rods.0.radius", Some("m")),
            ("material.youngs_modulus", Some("Pa")),
            ("contact.friction", None),
            ("contact.model", None),
            ("no.such.key", None),
        ] {
            assert_eq!(unit(&schema, key).as_deref(), expected, "{key}");
        }
    }

    #[test]
    fn unknown_keys_get_advice() {
        insta::assert_snapshot!(explain(*EXPERIMENTS, "contact.frictoin").unwrap_err(), @"there is no key `frictoin` in `contact`; did you mean `friction`?");
        insta::assert_snapshot!(explain(*EXPERIMENTS, "kontakt").unwrap_err(), @"there is no key `kontakt` at the top of a scenario; did you mean `contact`?");
        insta::assert_snapshot!(explain(*EXPERIMENTS, "solver.qqq").unwrap_err(), @"there is no key `qqq` in `solver`; the keys are: displacement_tolerance, force_tolerance, maximum_iterations, minimum_step");
    }

    #[test]
    fn every_key_has_a_description() {
        let schema = json_schema(*EXPERIMENTS);
        let tables = std::iter::once(&schema).chain(schema["$defs"].as_object().unwrap().values());
        let mut keys = 0;
        for table in tables {
            let alternatives = table["oneOf"].as_array().into_iter().flatten();
            for table in std::iter::once(table).chain(alternatives) {
                for (name, schema) in table["properties"].as_object().into_iter().flatten() {
                    assert!(
                        name == "kind" || schema.get("description").is_some(),
                        "{name} of {table}"
                    );
                    keys += 1;
                }
            }
        }
        assert!(keys > 90, "{keys}");
    }
}
