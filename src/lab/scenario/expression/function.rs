//! Functions of expressions, and their arguments.

use super::amount::Amount;
use crate::scenario::units;
use std::f64::consts::TAU;

/// A function, given by its index in [`FUNCTIONS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function(usize);

/// Uniform random numbers in [0, 1).
pub type Uniform<'a> = &'a mut dyn FnMut() -> f64;

/// A function of expressions.
pub struct Described {
    /// Syntax of the function.
    pub usage: &'static str,
    /// Description of its value.
    pub meaning: &'static str,
    /// Minimum and maximum number of arguments.
    arguments: (usize, usize),
    compute: Compute,
}

enum Compute {
    /// A function from a pure number to a pure number.
    Pure(fn(f64) -> f64),
    Amounts(fn(&[Amount]) -> Result<Amount, String>),
    Random(fn(&[Amount], Uniform<'_>) -> f64),
}

const fn pure(usage: &'static str, meaning: &'static str, of: fn(f64) -> f64) -> Described {
    Described {
        usage,
        meaning,
        arguments: (1, 1),
        compute: Compute::Pure(of),
    }
}

const fn amounts(
    usage: &'static str,
    meaning: &'static str,
    arguments: (usize, usize),
    of: fn(&[Amount]) -> Result<Amount, String>,
) -> Described {
    Described {
        usage,
        meaning,
        arguments,
        compute: Compute::Amounts(of),
    }
}

const fn random(
    usage: &'static str,
    meaning: &'static str,
    of: fn(&[Amount], Uniform<'_>) -> f64,
) -> Described {
    Described {
        usage,
        meaning,
        arguments: (2, 2),
        compute: Compute::Random(of),
    }
}

/// Maximum number of arguments of `min` and `max`.
const MANY: usize = 100;

/// All functions.
pub const FUNCTIONS: &[Described] = &[
    pure("sin(x)", "sine of an angle", libm::sin),
    pure("cos(x)", "cosine of an angle", libm::cos),
    pure("tan(x)", "tangent of an angle", libm::tan),
    pure("asin(x)", "angle of a sine", libm::asin),
    pure("acos(x)", "angle of a cosine", libm::acos),
    pure("atan(x)", "angle of a tangent", libm::atan),
    amounts("atan2(y, x)", "angle of the point x, y", (2, 2), |of| {
        of[0].must_match(&of[1], "cannot be compared with")?;
        Ok(Amount::pure(libm::atan2(of[0].value, of[1].value)))
    }),
    pure("exp(x)", "power of e", libm::exp),
    pure("ln(x)", "natural logarithm", libm::log),
    amounts("sqrt(x)", "square root", (1, 1), |of| {
        let root = of[0].raised(&Amount::pure(0.5))?;
        Ok(root.with(of[0].value.sqrt()))
    }),
    amounts("abs(x)", "magnitude", (1, 1), |of| {
        Ok(of[0].with(of[0].value.abs()))
    }),
    amounts("min(a, b, ...)", "the smallest", (1, MANY), |of| {
        extreme(of, f64::min)
    }),
    amounts("max(a, b, ...)", "the largest", (1, MANY), |of| {
        extreme(of, f64::max)
    }),
    pure("floor(x)", "whole number below", f64::floor),
    pure("ceil(x)", "whole number above", f64::ceil),
    pure("frac(x)", "x - floor(x)", |x| x - x.floor()),
    amounts("mod(x, y)", "x - y*floor(x/y)", (2, 2), |of| {
        of[0].must_match(&of[1], "cannot divide")?;
        let (x, y) = (of[0].value, of[1].value);
        Ok(of[0].with(x - y * (x / y).floor()))
    }),
    amounts(
        "round(x) or round(x, step)",
        "nearest whole number, or nearest multiple of a step",
        (1, 2),
        rounded,
    ),
    random(
        "random(low, high)",
        "uniform random number",
        |of, uniform| uniform_between(of[0].value, of[1].value, uniform()),
    ),
    random(
        "normal(mean, deviation)",
        "normal random number",
        |of, uniform| {
            // Box and Muller 1958; 1 - u is greater than 0.
            let radius = (-2.0 * libm::log(1.0 - uniform())).sqrt();
            of[0].value + of[1].value * radius * libm::cos(TAU * uniform())
        },
    ),
];

/// Linear interpolation between `low` and `high`.
pub fn uniform_between(low: f64, high: f64, fraction: f64) -> f64 {
    low + fraction * (high - low)
}

fn extreme(of: &[Amount], choose: fn(f64, f64) -> f64) -> Result<Amount, String> {
    let mut chosen = of[0];
    for other in &of[1..] {
        chosen.must_match(other, "cannot be compared with")?;
        chosen.value = choose(chosen.value, other.value);
    }
    Ok(chosen)
}

fn rounded(of: &[Amount]) -> Result<Amount, String> {
    let Some(step) = of.get(1) else {
        let number = of[0].pure_number("round(x) without a step")?;
        return Ok(Amount::pure(number.round()));
    };
    of[0].must_match(step, "is not a step of")?;
    if !(step.value > 0.0) {
        return Err("the step of round(x, step) must be greater than 0".to_owned());
    }
    // A step such as 1e-5 is the reciprocal of a whole number. Division by that whole number gives
    // exactly the decimal number; multiplication by the step would not. Adding 0.0 removes the
    // sign of zero.
    let whole = (1.0 / step.value).round();
    let value = match 1.0 / whole == step.value {
        true => (of[0].value * whole).round() / whole,
        false => (of[0].value / step.value).round() * step.value,
    };
    Ok(of[0].with(value + 0.0))
}

fn name_of(described: &'static Described) -> &'static str {
    let usage = described.usage;
    usage.split_once('(').map_or(usage, |(name, _)| name)
}

impl Function {
    /// The function of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::names().position(|known| known == name).map(Self)
    }

    /// The names of all.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FUNCTIONS.iter().map(name_of)
    }

    /// Syntax of the function.
    pub fn usage(self) -> &'static str {
        FUNCTIONS[self.0].usage
    }

    /// Whether the function accepts this number of arguments.
    pub fn accepts(self, count: usize) -> bool {
        let (fewest, most) = FUNCTIONS[self.0].arguments;
        (fewest..=most).contains(&count)
    }

    /// Whether the function draws random numbers.
    pub fn is_random(self) -> bool {
        matches!(FUNCTIONS[self.0].compute, Compute::Random(_))
    }

    /// The value of the function; the number of `arguments` is valid.
    ///
    /// # Errors
    /// A message about the dimensions of the arguments.
    pub fn value(self, arguments: &[Amount], uniform: Uniform<'_>) -> Result<Amount, String> {
        match FUNCTIONS[self.0].compute {
            Compute::Pure(of) => {
                let what = name_of(&FUNCTIONS[self.0]);
                arguments[0].pure_number(what).map(of).map(Amount::pure)
            }
            Compute::Amounts(of) => of(arguments),
            Compute::Random(of) => {
                let dimensions = arguments.iter().map(|of| units::dimension_of(of.powers));
                if arguments[0].powers != arguments[1].powers {
                    let words: Vec<String> = dimensions.collect();
                    return Err(format!(
                        "{} has {} and {}",
                        self.usage(),
                        words[0],
                        words[1]
                    ));
                }
                Ok(arguments[0].with(of(arguments, uniform)))
            }
        }
    }
}
