//! Values of expressions, and rejected expressions.

use super::{Amount, Names, parse};
use proptest::prelude::*;

/// Defines a radius of 2 mm and a count of 12; all random numbers are 0.5.
struct Known;

impl Names for Known {
    fn value(&self, name: &str) -> Option<Amount> {
        match name {
            "radius" => Some(Amount {
                value: 0.002,
                powers: [1, 0, 0],
            }),
            "minimum" => Some(Amount::pure(12.0)),
            _ => None,
        }
    }

    fn all(&self) -> Vec<String> {
        vec!["radius".to_owned(), "minimum".to_owned()]
    }

    fn uniform(&self, _: usize) -> Box<dyn FnMut() -> f64> {
        Box::new(|| 0.5)
    }
}

fn value(text: &str) -> f64 {
    amount(text).unwrap().value
}

fn amount(text: &str) -> Result<Amount, String> {
    let evaluated = parse(text).and_then(|expression| expression.evaluate(&Known));
    evaluated.map_err(|mistake| {
        let help = mistake.help.map(|help| format!(" ({help})"));
        let bytes = &mistake.bytes;
        let shown = text.get(bytes.clone()).unwrap_or("?");
        format!("{shown:?}: {}{}", mistake.message, help.unwrap_or_default())
    })
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, expected) in [
        ("1 + 2*3 - 4/2", 5.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("(1 + 2)*3", 9.0),
        ("8/2/2", 2.0),
        ("5 - 3 - 1", 1.0),
        ("2*-3", -6.0),
        (" 1e3 + .5 ", 1000.5),
        ("minimum", 12.0),
        ("max(1, min(5, 3), minimum/6)", 3.0),
        ("frac(2.25) + floor(2.5) + ceil(2.5) + round(2.5)", 8.25),
        ("mod(-1, 4)", 3.0),
        ("random(2, 4)", 3.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    assert_eq!(value("cos(pi)"), -1.0);
    assert_eq!(
        value("sin(30 deg)"),
        libm::sin(30.0 * (std::f64::consts::PI / 180.0))
    );
}

#[test]
fn units_are_part_of_numbers() {
    for (text, expected, powers) in [
        ("2*radius + 1 mm", 0.005, [1, 0, 0]),
        ("3 mm + 2*2.25mm", 0.003 + 2.0 * 0.00225, [1, 0, 0]),
        ("1.6 mm", 1.6e-3, [1, 0, 0]),
        ("1 m/s * 2 s", 2.0, [1, 0, 0]),
        ("9.81 m/s^2 * 2 kg", 19.62, [1, -2, 1]),
        ("sqrt((3 m)^2 + (4 m)^2)", 5.0, [1, 0, 0]),
        ("2 N·m / 1 m", 2.0, [1, -2, 1]),
        ("1/(2 mm)", 500.0, [-1, 0, 0]),
    ] {
        let found = amount(text).unwrap();
        assert_eq!((found.value, found.powers), (expected, powers), "{text}");
    }
}

#[test]
fn rounded_numbers_are_those_of_their_digits() {
    assert_eq!(value("round(0.0755201, 1e-5)"), 0.07552);
    assert_eq!(value("round(1.2345 mm, 0.01 mm)"), 1.23e-3);
    assert_eq!(value("round(7, 5)"), 5.0);
    assert_eq!(value("round(-1e-9, 1e-5)").to_bits(), 0.0f64.to_bits());
}

#[test]
fn mistakes_name_their_place() {
    let fault = |text: &str| amount(text).unwrap_err();
    insta::assert_snapshot!(fault("radius + 2 s"), @r#""radius + 2 s": a time cannot be added to a length"#);
    insta::assert_snapshot!(fault("1 - radius"), @r#""1 - radius": a length cannot be subtracted from a pure number"#);
    insta::assert_snapshot!(fault("2*raduis"), @r#""raduis": unknown name `raduis` (did you mean `radius`?)"#);
    insta::assert_snapshot!(fault("qqq + 1"), @r#""qqq": unknown name `qqq` (the names are: radius, minimum)"#);
    insta::assert_snapshot!(fault("sine(1)"), @r#""sine": there is no function `sine` (did you mean `sin`?)"#);
    insta::assert_snapshot!(fault("sin(radius)"), @r#""sin(radius)": sin needs a pure number, found a length"#);
    insta::assert_snapshot!(fault("sqrt(radius)"), @r#""sqrt(radius)": a length to the power of 0.5 would have fractional powers of units"#);
    insta::assert_snapshot!(fault("frac(1, 2)"), @r#""frac(1, 2)": 2 arguments are given; the function is frac(x)"#);
    insta::assert_snapshot!(fault("random(1, radius)"), @r#""random(1, radius)": random(low, high) has a pure number and a length"#);
    insta::assert_snapshot!(fault("2 radius"), @r#""radius": `radius` is not a unit (a product needs `*`)"#);
    insta::assert_snapshot!(fault("3 m^2"), @r#""^": a power of a number with a unit (write (3 m)^2, or 3 m * 1 m)"#);
    insta::assert_snapshot!(fault("2 +"), @r#""": the expression is not complete (expected a number, a name or `(`)"#);
    insta::assert_snapshot!(fault("2 $ 3"), @r#""$": expected an operator, found `$`"#);
    insta::assert_snapshot!(fault("(1 + 2"), @r#""": expected `,` or `)`"#);
    assert!(fault(&"(".repeat(3000)).contains("too long"));
    assert!(fault(&"-".repeat(1000)).contains("too long"));
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(text in "[-+*/^(),. 0-9a-eimnrs°µ²]{0,40}") {
        let _ = amount(&text);
    }

    #[test]
    fn any_text_is_parsed_or_refused(text in ".{0,40}") {
        let _ = amount(&text);
    }

    #[test]
    fn numbers_are_read_as_they_are(number in proptest::num::f64::POSITIVE) {
        prop_assert_eq!(value(&format!("{number:e}")), number);
        prop_assert_eq!(value(&format!("0 m + {number:e} m")), number);
    }
}
