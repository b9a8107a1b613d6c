//! Expressions in scenario files: `"2*radius + 1 mm"`.
//!
//! | file | what |
//! |---|---|
//! | `amount` | numbers with a physical dimension |
//! | `parse` | from text to a tree of operations |
//! | `function` | the functions, and their arguments |
//! | `evaluate` | from the tree to an amount |
//!
//! The grammar uses the operator precedence parser of the crate `winnow`, which also parses TOML
//! for the crate `toml`. The expression crate `exmex` is not suitable: its operators are plain
//! functions without the context that random numbers and units need, its errors have no positions,
//! and it splits a name that begins like an operator (`minimum`, `max_angle`).
//!
//! Sines, powers and logarithms come from the crate `libm`, so that results have the same bytes on
//! every machine.

mod amount;
mod evaluate;
mod function;
mod parse;

pub use amount::Amount;
pub use evaluate::Names;
pub use function::{FUNCTIONS, uniform_between};
pub use parse::parse;

use function::Function;
use std::ops::Range;

/// Name of the constant π.
pub const PI: &str = "pi";

/// A parsed expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    operation: Operation,
    /// Bytes of the expression in the text.
    bytes: Range<usize>,
}

#[derive(Clone, Debug, PartialEq)]
enum Operation {
    Literal(Amount),
    Name(String),
    Negative(Box<Expression>),
    Binary(Operator, Box<[Expression; 2]>),
    Call {
        function: Function,
        arguments: Vec<Expression>,
        /// Number of random functions that precede this one in the text.
        draw: usize,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

/// Fault of an expression, and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Description of the fault.
    pub message: String,
    /// Advice on what to type instead.
    pub help: Option<String>,
    /// Bytes of the text.
    pub bytes: Range<usize>,
}

impl Expression {
    /// The names that the expression uses, each once.
    pub fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        self.collect_names(&mut names);
        names
    }

    fn collect_names<'a>(&'a self, names: &mut Vec<&'a str>) {
        match &self.operation {
            Operation::Name(name) if name != PI && !names.contains(&name.as_str()) => {
                names.push(name);
            }
            Operation::Literal(_) | Operation::Name(_) => {}
            Operation::Negative(of) => of.collect_names(names),
            Operation::Binary(_, sides) => {
                sides.iter().for_each(|side| side.collect_names(names));
            }
            Operation::Call { arguments, .. } => {
                arguments.iter().for_each(|of| of.collect_names(names));
            }
        }
    }

    /// Whether the expression consists of names and signs only, such as the word `implicit-euler`.
    pub fn is_wordlike(&self) -> bool {
        match &self.operation {
            Operation::Name(_) => true,
            Operation::Binary(Operator::Subtract, sides) => {
                sides.iter().all(Expression::is_wordlike)
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests;
