//! Numbers of arguments.

/// A parser of allowed numbers; rejects others with the message `needed`.
pub fn number(
    is_allowed: fn(f64) -> bool,
    needed: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        let number = text.trim().parse().ok();
        let number = number.filter(|number| is_allowed(*number));
        number.ok_or_else(|| needed.into())
    }
}

/// Numbers separated by commas; `None` if any of them is not a number.
pub fn numbers(text: &str) -> Option<Vec<f64>> {
    let numbers = text.split(',').map(|part| part.trim().parse().ok());
    numbers.collect()
}

/// Whether a number is above zero and finite.
pub fn is_positive(number: f64) -> bool {
    number > 0.0 && number.is_finite()
}

/// A number above zero.
pub fn positive(text: &str) -> Result<f64, String> {
    number(is_positive, "a number above 0 is needed")(text)
}
