//! Evaluates the tree of an expression.

use super::amount::Amount;
use super::function::Function;
use super::{Expression, Mistake, Operation, Operator, PI};
use crate::scenario::issue::did_you_mean;

/// Values of names in expressions.
pub trait Names {
    /// The value of a name.
    fn value(&self, name: &str) -> Option<Amount>;

    /// All names of values.
    fn all(&self) -> Vec<String>;

    /// Uniform random numbers in [0, 1) for the random function with this index in the expression.
    fn uniform(&self, draw: usize) -> Box<dyn FnMut() -> f64>;
}

impl Expression {
    /// The value.
    ///
    /// # Errors
    /// The first mistake: an unknown name, or dimensions that do not match.
    pub fn evaluate(&self, names: &dyn Names) -> Result<Amount, Mistake> {
        let mistake = |message: String| Mistake {
            message,
            help: None,
            bytes: self.bytes.clone(),
        };
        match &self.operation {
            Operation::Literal(amount) => Ok(*amount),
            Operation::Name(name) if name == PI => Ok(Amount::pure(std::f64::consts::PI)),
            Operation::Name(name) => names.value(name).ok_or_else(|| {
                let all = names.all();
                let mut known: Vec<&str> = all.iter().map(String::as_str).collect();
                for function in Function::names() {
                    known.push(function);
                }
                let list = match all.as_slice() {
                    [] => "there are no [parameters]".to_owned(),
                    names => format!("the names are: {}", names.join(", ")),
                };
                Mistake {
                    help: Some(did_you_mean(name, known).unwrap_or(list)),
                    ..mistake(format!("unknown name `{name}`"))
                }
            }),
            Operation::Negative(of) => {
                let amount = of.evaluate(names)?;
                Ok(amount.with(-amount.value))
            }
            Operation::Binary(operator, sides) => {
                let [left, right] = sides.as_ref();
                let (left, right) = (left.evaluate(names)?, right.evaluate(names)?);
                combine(*operator, &left, &right).map_err(mistake)
            }
            Operation::Call {
                function,
                arguments,
                draw,
            } => {
                let amounts = arguments.iter().map(|argument| argument.evaluate(names));
                let amounts = amounts.collect::<Result<Vec<_>, _>>()?;
                let mut uniform = match function.is_random() {
                    true => names.uniform(*draw),
                    false => Box::new(|| 0.0),
                };
                function.value(&amounts, &mut uniform).map_err(mistake)
            }
        }
    }
}

fn combine(operator: Operator, left: &Amount, right: &Amount) -> Result<Amount, String> {
    match operator {
        Operator::Add => {
            left.must_match(right, "cannot be added to")?;
            Ok(left.with(left.value + right.value))
        }
        Operator::Subtract => {
            left.must_match(right, "cannot be subtracted from")?;
            Ok(left.with(left.value - right.value))
        }
        Operator::Multiply => Ok(left.times(right)),
        Operator::Divide => Ok(left.over(right)),
        Operator::Power => left.raised(right),
    }
}
