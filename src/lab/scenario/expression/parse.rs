//! Parses text into a tree of operations.

use super::amount::Amount;
use super::function::Function;
use super::{Expression, Mistake, Operation, Operator};
use crate::scenario::issue::did_you_mean;
use crate::scenario::units;
use std::ops::Range;
use winnow::combinator::Infix::{Left, Right};
use winnow::combinator::{
    Prefix, alt, cut_err, delimited, dispatch, expression, fail, opt, separated,
};
use winnow::error::{ContextError, ErrMode, ModalResult, StrContext};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location};
use winnow::token::{one_of, take, take_while};

/// Maximum length of an expression, bytes.
const LONGEST: usize = 2_000;
/// Maximum depth of nested parentheses, powers and signs: each is a recursive call of the parser.
const DEEPEST: usize = 100;

type Input<'a> = LocatingSlice<&'a str>;

/// Labels of errors. The messages are composed where the text is available.
const UNIT: &str = "unit";
const POWER_OF_UNIT: &str = "power of a unit";
const FUNCTION: &str = "function";
const CLOSING: &str = "closing parenthesis";

/// Parses an expression.
///
/// # Errors
/// The first mistake, with its place in the text.
pub fn parse(text: &str) -> Result<Expression, Mistake> {
    if text.len() > LONGEST || depth(text) > DEEPEST {
        return Err(Mistake {
            message: format!(
                "the expression is too long; allowed: {LONGEST} characters, {DEEPEST} parentheses and powers"
            ),
            help: None,
            bytes: 0..text.len(),
        });
    }
    let parsed = sum.parse(LocatingSlice::new(text));
    let mut expression = parsed.map_err(|error| mistake(text, error.offset(), error.inner()))?;
    number_draws(&mut expression, &mut 0);
    expression.check_arguments()?;
    Ok(expression)
}

/// An upper bound of the nesting depth of operations.
fn depth(text: &str) -> usize {
    let mut previous_is_sign = true;
    let characters = text.chars().filter(|character| !character.is_whitespace());
    characters
        .filter(|character| {
            let is_sign = matches!(character, '-' | '+');
            let nests = matches!(character, '(' | '^') || is_sign && previous_is_sign;
            previous_is_sign = is_sign;
            nests
        })
        .count()
}

fn mistake(text: &str, offset: usize, error: &ContextError) -> Mistake {
    let label = error.context().find_map(|context| match context {
        StrContext::Label(label) => Some(*label),
        _ => None,
    });
    let rest = &text[offset..];
    let word: String = rest
        .chars()
        .take_while(|character| character.is_alphanumeric() || *character == '_')
        .collect();
    let (message, help) = match label {
        Some(UNIT) => (
            format!("`{word}` is not a unit"),
            Some("a product needs `*`".to_owned()),
        ),
        Some(POWER_OF_UNIT) => (
            "a power of a number with a unit".to_owned(),
            Some("write (3 m)^2, or 3 m * 1 m".to_owned()),
        ),
        Some(FUNCTION) => (
            format!("there is no function `{word}`"),
            did_you_mean(&word, Function::names()),
        ),
        Some(_) => ("expected `,` or `)`".to_owned(), None),
        None if rest.is_empty() => (
            "the expression is not complete".to_owned(),
            Some("expected a number, a name or `(`".to_owned()),
        ),
        None => {
            let found = rest.chars().next().unwrap_or_default();
            let expected = match text[..offset].trim_end().chars().last() {
                None | Some('+' | '-' | '*' | '/' | '^' | '(' | ',') => "a number, a name or `(`",
                _ => "an operator",
            };
            (format!("expected {expected}, found `{found}`"), None)
        }
    };
    let length = word
        .len()
        .max(rest.chars().next().map_or(0, char::len_utf8));
    Mistake {
        message,
        help,
        bytes: offset..offset + length,
    }
}

fn sum(input: &mut Input<'_>) -> ModalResult<Expression> {
    expression(delimited(spaces, operand, spaces))
        .prefix(dispatch! { symbol(['-', '+']);
            '-' => Prefix(30, |_, of: Expression| Ok(negative(of))),
            '+' => Prefix(30, |_, of| Ok(of)),
            _ => fail,
        })
        .infix(dispatch! { symbol(['+', '-', '*', '/', '^']);
            '+' => Left(10, |_, a, b| Ok(binary(Operator::Add, a, b))),
            '-' => Left(10, |_, a, b| Ok(binary(Operator::Subtract, a, b))),
            '*' => Left(20, |_, a, b| Ok(binary(Operator::Multiply, a, b))),
            '/' => Left(20, |_, a, b| Ok(binary(Operator::Divide, a, b))),
            '^' => Right(40, |_, a, b| Ok(binary(Operator::Power, a, b))),
            _ => fail,
        })
        .parse_next(input)
}

fn spaces(input: &mut Input<'_>) -> ModalResult<()> {
    take_while(0.., char::is_whitespace)
        .void()
        .parse_next(input)
}

/// One of the given characters between spaces; any other character is not consumed.
fn symbol<'a, const N: usize>(
    of: [char; N],
) -> impl Parser<Input<'a>, char, ErrMode<ContextError>> {
    delimited(spaces, one_of(of), spaces)
}

fn negative(of: Expression) -> Expression {
    Expression {
        bytes: of.bytes.clone(),
        operation: Operation::Negative(Box::new(of)),
    }
}

fn binary(operator: Operator, left: Expression, right: Expression) -> Expression {
    Expression {
        bytes: left.bytes.start..right.bytes.end,
        operation: Operation::Binary(operator, Box::new([left, right])),
    }
}

fn operand(input: &mut Input<'_>) -> ModalResult<Expression> {
    alt((number, named, parenthesised)).parse_next(input)
}

fn parenthesised(input: &mut Input<'_>) -> ModalResult<Expression> {
    let closing = || cut_err(')').context(StrContext::Label(CLOSING));
    delimited('(', cut_err(sum), closing()).parse_next(input)
}

fn backtrack<T>() -> ModalResult<T> {
    Err(ErrMode::Backtrack(ContextError::new()))
}

fn refused<T>(label: &'static str) -> ModalResult<T> {
    let mut error = ContextError::new();
    error.push(StrContext::Label(label));
    Err(ErrMode::Cut(error))
}

/// A number, with its unit if it has one.
fn number(input: &mut Input<'_>) -> ModalResult<Expression> {
    let rest: &str = input;
    let start = input.current_token_start();
    let length = units::number_length(rest);
    if rest.starts_with(['+', '-']) || rest[..length].parse::<f64>().is_err() {
        return backtrack();
    }
    let digits = take(rest[..length].chars().count()).parse_next(input)?;
    let before_unit = input.checkpoint();
    spaces(input)?;
    let rest: &str = input;
    let amount = match units::leading_unit(rest) {
        Some((length, unit, powers)) => {
            take(rest[..length].chars().count()).parse_next(input)?;
            if rest[length..].trim_start().starts_with('^') {
                return refused(POWER_OF_UNIT);
            }
            let value = units::scaled(digits, unit.size);
            Amount { value, powers }
        }
        None if rest.starts_with(char::is_alphabetic) => return refused(UNIT),
        None => {
            input.reset(&before_unit);
            Amount::pure(digits.parse().unwrap_or(f64::NAN))
        }
    };
    Ok(Expression {
        operation: Operation::Literal(amount),
        bytes: start..input.current_token_start(),
    })
}

/// A named value, or a call of a function.
fn named(input: &mut Input<'_>) -> ModalResult<Expression> {
    let start = input.checkpoint();
    let is_first = |character: char| character.is_ascii_alphabetic() || character == '_';
    let is_next = |character: char| character.is_ascii_alphanumeric() || character == '_';
    let (name, bytes): (&str, Range<usize>) = (take_while(1, is_first), take_while(0.., is_next))
        .take()
        .with_span()
        .parse_next(input)?;
    let Some(_) = opt((spaces, '(')).parse_next(input)? else {
        return Ok(Expression {
            operation: Operation::Name(name.to_owned()),
            bytes,
        });
    };
    let Some(function) = Function::named(name) else {
        input.reset(&start);
        return refused(FUNCTION);
    };
    let arguments = cut_err(separated(0.., sum, ',')).parse_next(input)?;
    cut_err((spaces, ')'))
        .context(StrContext::Label(CLOSING))
        .parse_next(input)?;
    Ok(Expression {
        operation: Operation::Call {
            function,
            arguments,
            draw: 0,
        },
        bytes: bytes.start..input.current_token_start(),
    })
}

/// Numbers the random functions in the order of the text.
fn number_draws(expression: &mut Expression, next: &mut usize) {
    match &mut expression.operation {
        Operation::Literal(_) | Operation::Name(_) => {}
        Operation::Negative(of) => number_draws(of, next),
        Operation::Binary(_, sides) => sides.iter_mut().for_each(|side| number_draws(side, next)),
        Operation::Call {
            function,
            arguments,
            draw,
        } => {
            if function.is_random() {
                *draw = *next;
                *next += 1;
            }
            arguments.iter_mut().for_each(|of| number_draws(of, next));
        }
    }
}

impl Expression {
    /// Rejects calls with too many or too few arguments.
    fn check_arguments(&self) -> Result<(), Mistake> {
        match &self.operation {
            Operation::Literal(_) | Operation::Name(_) => Ok(()),
            Operation::Negative(of) => of.check_arguments(),
            Operation::Binary(_, sides) => sides.iter().try_for_each(Self::check_arguments),
            Operation::Call {
                function,
                arguments,
                ..
            } => {
                if !function.accepts(arguments.len()) {
                    return Err(Mistake {
                        message: format!(
                            "{} arguments are given; the function is {}",
                            arguments.len(),
                            function.usage()
                        ),
                        help: None,
                        bytes: self.bytes.clone(),
                    });
                }
                arguments.iter().try_for_each(Self::check_arguments)
            }
        }
    }
}
