//! Axes of a sweep: keys that vary together, and their values.

use super::range::{Interval, Number, Scale};
use crate::scenario::decode::decode;
use crate::scenario::document::{Entry, Node, Value};
use crate::scenario::issue::{Issue, Issues, KeyPath};
use crate::scenario::source::Span;
use crate::scenario::typed;

/// Maximum number of values of a range, equal to that of the cases of a sweep.
pub const MOST_VALUES: usize = 1_000_000;

/// Keys that vary together.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The dotted keys.
    pub keys: Vec<SweptKey>,
    /// Points along the axis: a value for each key.
    pub points: Vec<Vec<Node>>,
}

/// A varied key, and its position.
#[derive(Clone, Debug)]
pub struct SweptKey {
    /// The dotted key.
    pub key: String,
    /// Place of the key.
    pub span: Span,
}

/// A range without `count`, from which samples are taken.
#[derive(Clone, Debug)]
pub struct SampledRange {
    /// The key.
    pub key: SweptKey,
    /// Range of its values.
    pub interval: Interval,
}

/// Axes and ranges of a sweep.
#[derive(Default)]
pub struct Keys {
    /// An axis for each key with a list, or with a range with `count`.
    pub axes: Vec<Axis>,
    /// Ranges without a count.
    pub sampled: Vec<SampledRange>,
}

/// Reads the dotted keys below `entries`, from which the reserved keys were removed.
pub fn read_keys(entries: &[Entry], issues: &mut Issues) -> Keys {
    let mut keys = Keys::default();
    for entry in entries {
        read_entry(
            entry,
            &entry.key,
            &sweep_path().key(&entry.key),
            &mut keys,
            issues,
        );
    }
    keys
}

/// The path of the table `[sweep]`.
pub fn sweep_path() -> KeyPath {
    KeyPath::from("sweep")
}

fn read_entry(entry: &Entry, key: &str, path: &KeyPath, keys: &mut Keys, issues: &mut Issues) {
    let swept = SweptKey {
        key: key.to_owned(),
        span: entry.key_span.clone(),
    };
    match &entry.node.value {
        Value::Array(values) if values.is_empty() => {
            issues.push(Issue::new(
                path.clone(),
                "the list is empty; give at least one value",
            ));
        }
        Value::Array(values) => keys.axes.push(Axis {
            keys: vec![swept],
            points: values.iter().map(|value| vec![value.clone()]).collect(),
        }),
        Value::Table(_) if entry.node.entry("from").is_some() => {
            match read_range(&entry.node, path) {
                Ok((interval, Some(count))) => {
                    let node = |value| Node {
                        value,
                        span: entry.node.span.clone(),
                    };
                    keys.axes.push(Axis {
                        keys: vec![swept],
                        points: interval
                            .spaced(count)
                            .map(|value| vec![node(value)])
                            .collect(),
                    });
                }
                Ok((interval, None)) => keys.sampled.push(SampledRange {
                    key: swept,
                    interval,
                }),
                Err(faults) => faults.0.into_iter().for_each(|issue| issues.push(issue)),
            }
        }
        Value::Table(below) if !below.is_empty() => {
            for entry in below {
                let key = format!("{key}.{}", entry.key);
                read_entry(entry, &key, &path.key(&entry.key), keys, issues);
            }
        }
        _ => issues.push(Issue::new(
            path.clone(),
            format!(
                "expected a list of values or a range {{ from, to, count }}, found {}",
                entry.node.description()
            ),
        )),
    }
}

/// A range as typed.
#[derive(serde::Deserialize)]
struct Range {
    from: typed::End,
    to: typed::End,
    count: Option<i64>,
    scale: Option<RangeScale>,
}

#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
enum RangeScale {
    Linear,
    Log,
}

fn read_range(node: &Node, path: &KeyPath) -> Result<(Interval, Option<usize>), Issues> {
    let range: Range = decode(node).map_err(|issues: Issues| issues.below(path))?;
    let scale = match range.scale {
        Some(RangeScale::Log) => Scale::Log,
        Some(RangeScale::Linear) | None => Scale::Linear,
    };
    let end = |key: &str, end: &typed::End| {
        end.number()
            .map_err(|message| Issues::from(Issue::new(path.key(key), message)))
    };
    let interval = Interval::new(&end("from", &range.from)?, &end("to", &range.to)?, scale)
        .map_err(|message| Issues::from(Issue::new(path.clone(), message)))?;
    let count = range.count.map(|count| {
        usize::try_from(count)
            .ok()
            .filter(|count| (1..=MOST_VALUES).contains(count))
            .ok_or_else(|| {
                let message = format!("{count} is out of range; allowed: 1 to {MOST_VALUES}");
                Issues::from(Issue::new(path.key("count"), message))
            })
    });
    Ok((interval, count.transpose()?))
}

impl typed::End {
    /// The number with its unit.
    ///
    /// # Errors
    /// A message with the fault.
    pub fn number(&self) -> Result<Number, String> {
        Number::read(&match self {
            Self::Whole(whole) => Value::Integer(*whole),
            Self::Number(number) => Value::Float(*number),
            Self::Text(text) => Value::String(text.clone()),
        })
    }
}

/// Reads the tables of `[[sweep.zip]]`.
pub fn read_zips(zip: &Entry, issues: &mut Issues) -> Vec<Axis> {
    let path = sweep_path().key("zip");
    let Value::Array(tables) = &zip.node.value else {
        issues.push(Issue::new(
            path,
            "expected tables, each headed [[sweep.zip]]",
        ));
        return Vec::new();
    };
    let mut axes = Vec::new();
    for (index, table) in tables.iter().enumerate() {
        let path = path.index(index);
        let Value::Table(entries) = &table.value else {
            issues.push(Issue::new(path, "expected a table of lists"));
            continue;
        };
        let mut lists = Keys::default();
        for entry in entries {
            read_entry(entry, &entry.key, &path.key(&entry.key), &mut lists, issues);
        }
        for range in &lists.sampled {
            let message = "a range in [[sweep.zip]] needs a `count`";
            issues.push(Issue::new(path.key(&range.key.key), message));
        }
        match zipped(lists.axes) {
            Ok(Some(axis)) => axes.push(axis),
            Ok(None) => {}
            Err((key, message)) => issues.push(Issue::new(path.key(&key), message)),
        }
    }
    axes
}

/// Combines several axes of one key each into one. Returns the faulty key and a message if their
/// lengths differ.
fn zipped(axes: Vec<Axis>) -> Result<Option<Axis>, (String, String)> {
    let mut axes = axes.into_iter();
    let Some(mut joint) = axes.next() else {
        return Ok(None);
    };
    for axis in axes {
        if axis.points.len() != joint.points.len() {
            return Err((
                axis.keys[0].key.clone(),
                format!(
                    "{} values, but `{}` has {}; lists that vary together need the same length",
                    axis.points.len(),
                    joint.keys[0].key,
                    joint.points.len()
                ),
            ));
        }
        joint.keys.extend(axis.keys);
        for (point, more) in joint.points.iter_mut().zip(axis.points) {
            point.extend(more);
        }
    }
    Ok(Some(joint))
}
