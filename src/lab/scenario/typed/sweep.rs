//! Sweeps as typed.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Many cases of one scenario: every combination of the values of the keys listed here. Each key is dotted and
/// has a list of values or a range { from, to, count, scale }, as in `flagella.count = [2, 3, 5]`. The ends of a range may be
/// expressions over `[parameters]`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(rename = "sweep")]
#[expect(
    dead_code,
    reason = "read key by key in `scenario::sweep`; this is its schema"
)]
pub struct Sweep {
    /// Keys that vary together: tables of lists of the same length. The first point has the first
    /// value of each list, and so on.
    #[serde(default)]
    pub zip: Vec<BTreeMap<String, Zipped>>,
    /// CSV file with a header line of dotted keys and a row per case, relative to this file.
    pub points: Option<String>,
    /// Samples of the ranges that have no `count`.
    pub sample: Option<Sample>,
    /// A search for one value of one key, instead of a grid of values.
    pub search: Option<Search>,
    /// Derivatives of probes at the end of each case: columns `d_COLUMN_d_KEY` of summary.csv.
    pub derivatives: Option<SweptDerivatives>,
}

/// The values of a key, or the keys of a table below it: `rod.radius = [...]` is a table `rod`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
#[expect(dead_code, reason = "read in `scenario::sweep`; this is its schema")]
pub enum Zipped {
    /// Values.
    List(Vec<serde_json::Value>),
    /// A range, or a table of further keys.
    Table(BTreeMap<String, serde_json::Value>),
}

/// Samples of the ranges of a sweep that have no `count`.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "sample")]
pub struct Sample {
    /// "sobol" (evenly spread, at most 10 ranges) or "random" (independent).
    pub method: SampleMethod,
    /// Number of samples, at least 1.
    pub count: i64,
    /// Seed of "random", or of the random shift of "sobol". Default: 0, with which "sobol" has no
    /// shift.
    #[serde(default)]
    pub seed: i64,
}

/// Ways to sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum SampleMethod {
    /// The Sobol' sequence.
    Sobol,
    /// Independent uniform numbers.
    Random,
}

/// Derivatives of probes with respect to keys, as `rodlab sensitivity` computes them.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "sweep_derivatives")]
pub struct SweptDerivatives {
    /// Dotted keys with respect to which the probes are differentiated, in SI units.
    pub to: Vec<String>,
    /// Names of probes, or of columns of them. Default: all probes.
    #[serde(default)]
    pub of: Vec<String>,
}

/// A search for the value of one key at which an outcome reaches a target, or has its minimum.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "search")]
pub struct Search {
    /// "bisect" (finds where the objective crosses `target`) or "golden" (finds its minimum).
    pub method: SearchMethod,
    /// The dotted key to vary.
    pub parameter: String,
    /// The objective: a column of summary.csv, or the last row of a column of series.csv.
    pub objective: String,
    /// One end of the interval: a number, text with a unit, or an expression over `[parameters]`.
    pub from: End,
    /// The other end of the interval, in the same form as `from`.
    pub to: End,
    /// Width of the interval at which the search ends, in the unit of `from` and `to`.
    pub tolerance: End,
    /// Target of the objective for "bisect". Default: 0.
    #[serde(default)]
    pub target: f64,
}

/// Ways to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum SearchMethod {
    /// Halves the interval in which the objective crosses the target.
    Bisect,
    /// Shrinks the interval around the minimum by the golden ratio.
    Golden,
}

/// A number, text with a unit, or an expression, of the dimension of the key.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum End {
    /// A whole number.
    Whole(i64),
    /// A number in SI units.
    Number(f64),
    /// A number with a unit, or an expression.
    Text(String),
}
