//! Physical dimensions and the units in which scenario files may give them.

/// A physical dimension with its units; the first unit is the SI unit.
pub trait Dimension: 'static {
    /// Name of a quantity of this dimension, with its article.
    const NAME: &'static str;
    /// Units in the order in which messages list them.
    const UNITS: &'static [Unit];
    /// Powers of metre, second and kilogram in the SI unit.
    const POWERS: Powers;
}

/// Powers of metre, second and kilogram.
pub type Powers = [i32; 3];

/// A unit of measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The symbol, without spaces, with `^` for powers.
    pub symbol: &'static str,
    /// Size of the unit in SI units.
    pub size: Size,
}

/// The size of a unit in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// A power of ten. The decimal point of the typed number is moved, which avoids a second
    /// rounding.
    Decimal(i32),
    /// Any other factor.
    Factor(f64),
}

const fn decimal(symbol: &'static str, exponent: i32) -> Unit {
    Unit {
        symbol,
        size: Size::Decimal(exponent),
    }
}

const fn factor(symbol: &'static str, factor: f64) -> Unit {
    Unit {
        symbol,
        size: Size::Factor(factor),
    }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const TURN: f64 = std::f64::consts::TAU;

/// Declares the dimensions and the table of all of them.
macro_rules! dimensions {
    ($($(#[$doc:meta])* $dimension:ident = $name:literal, $powers:expr, [$($unit:expr),* $(,)?];)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $dimension;

            impl Dimension for $dimension {
                const NAME: &'static str = $name;
                const UNITS: &'static [Unit] = &[$($unit),*];
                const POWERS: Powers = $powers;
            }
        )*

        /// Every dimension's name and units.
        const DIMENSIONS: &[(&str, &[Unit])] =
            &[$((<$dimension as Dimension>::NAME, <$dimension as Dimension>::UNITS)),*];

        /// Every dimension's name and its powers of metre, second and kilogram.
        const POWERS: &[(&str, Powers)] =
            &[$((<$dimension as Dimension>::NAME, <$dimension as Dimension>::POWERS)),*];
    };
}

dimensions! {
    /// A pure number.
    Dimensionless = "a pure number", [0, 0, 0], [];
    /// Length, m.
    Length = "a length", [1, 0, 0], [
        decimal("m", 0), decimal("cm", -2), decimal("mm", -3), decimal("µm", -6), decimal("um", -6),
        decimal("nm", -9), decimal("km", 3), factor("in", 0.0254),
    ];
    /// Time, s.
    Time = "a time", [0, 1, 0], [
        decimal("s", 0), decimal("ms", -3), decimal("µs", -6), decimal("us", -6),
        factor("min", 60.0), factor("h", 3600.0),
    ];
    /// Angle, rad.
    Angle = "an angle", [0, 0, 0], [
        decimal("rad", 0), decimal("mrad", -3), factor("deg", DEGREE), factor("°", DEGREE),
        factor("turn", TURN), factor("turns", TURN),
    ];
    /// Velocity, m/s.
    Velocity = "a velocity", [1, -1, 0], [
        decimal("m/s", 0), decimal("cm/s", -2), decimal("mm/s", -3), decimal("µm/s", -6),
        decimal("um/s", -6),
    ];
    /// Frequency, 1/s.
    Frequency = "a frequency", [0, -1, 0], [decimal("Hz", 0), decimal("1/s", 0), decimal("kHz", 3)];
    /// Angular velocity, rad/s.
    AngularVelocity = "an angular velocity", [0, -1, 0], [
        decimal("rad/s", 0), factor("deg/s", DEGREE), factor("°/s", DEGREE),
        factor("rpm", TURN / 60.0), factor("turn/s", TURN),
    ];
    /// Acceleration, m/s².
    Acceleration = "an acceleration", [1, -2, 0], [
        decimal("m/s^2", 0), decimal("cm/s^2", -2), decimal("mm/s^2", -3),
    ];
    /// Pressure or elastic modulus, Pa.
    Pressure = "a pressure", [-1, -2, 1], [
        decimal("Pa", 0), decimal("kPa", 3), decimal("MPa", 6), decimal("GPa", 9),
        decimal("N/m^2", 0), decimal("N/mm^2", 6),
    ];
    /// Density, kg/m³.
    Density = "a density", [-3, 0, 1], [decimal("kg/m^3", 0), decimal("g/cm^3", 3)];
    /// Mass, kg.
    Mass = "a mass", [0, 0, 1], [decimal("kg", 0), decimal("g", -3), decimal("mg", -6), decimal("t", 3)];
    /// Moment of inertia, kg m².
    MomentOfInertia = "a moment of inertia", [2, 0, 1], [
        decimal("kgm^2", 0), decimal("gm^2", -3), decimal("kgmm^2", -6), decimal("gmm^2", -9), decimal("gcm^2", -7),
    ];
    /// Dynamic viscosity, Pa s.
    Viscosity = "a viscosity", [-1, -1, 1], [decimal("Pas", 0), decimal("mPas", -3), decimal("cP", -3), decimal("kPas", 3), decimal("MPas", 6)];
    /// Force, N.
    Force = "a force", [1, -2, 1], [
        decimal("N", 0), decimal("kN", 3), decimal("mN", -3), decimal("µN", -6), decimal("uN", -6),
    ];
    /// Moment, N m.
    Moment = "a moment", [2, -2, 1], [
        decimal("Nm", 0), decimal("Nmm", -3), decimal("mNm", -3), decimal("µNm", -6),
        decimal("uNm", -6),
    ];
    /// Force per length, N/m.
    ForcePerLength = "a force per length", [0, -2, 1], [
        decimal("N/m", 0), decimal("mN/m", -3), decimal("N/mm", 3),
    ];
    /// Moment per angle, N m/rad.
    TurningStiffness = "a turning stiffness", [2, -2, 1], [
        decimal("Nm/rad", 0), decimal("Nmm/rad", -3), decimal("mNm/rad", -3), decimal("µNm/rad", -6),
        decimal("uNm/rad", -6), factor("Nm/deg", 1.0 / DEGREE), factor("Nm/°", 1.0 / DEGREE),
    ];
    /// Bending or twisting stiffness, N m².
    Rigidity = "a bending stiffness", [3, -2, 1], [
        decimal("Nm^2", 0), decimal("Nmm^2", -6), decimal("mNm^2", -3), decimal("µNm^2", -6),
        decimal("uNm^2", -6),
    ];
    /// Curvature, 1/m.
    Curvature = "a curvature", [-1, 0, 0], [decimal("1/m", 0), decimal("1/cm", 2), decimal("1/mm", 3)];
    /// Twist, rad/m.
    Twist = "a twist", [-1, 0, 0], [
        decimal("rad/m", 0), factor("deg/m", DEGREE), factor("turn/m", TURN), decimal("1/m", 0),
    ];
    /// Drag coefficient of the velocity per length, N s/m².
    LinearDrag = "a drag coefficient", [-1, -1, 1], [decimal("Ns/m^2", 0), decimal("Pas", 0), decimal("mPas", -3)];
    /// Drag coefficient of the spin per length, N s.
    SpinDrag = "a drag coefficient of spin", [1, -1, 1], [decimal("Ns", 0), decimal("mNs", -3)];
}

/// The name with its article, and the powers, of a dimension given by its name without article.
pub fn with_article(name: &str) -> Option<(&'static str, Powers)> {
    let without_article = |known: &'static str| known.split_once(' ').map(|(_, name)| name);
    let mut known = POWERS.iter().copied();
    known.find(|(known, _)| without_article(known) == Some(name))
}

/// Name of the first dimension with these powers, or its unit if it has no name.
pub fn dimension_of(powers: Powers) -> String {
    if let Some((name, _)) = POWERS.iter().find(|(_, known)| *known == powers) {
        return (*name).to_owned();
    }
    let parts = powers.iter().zip(["m", "s", "kg"]);
    let parts = parts.filter(|(power, _)| **power != 0);
    let symbols: Vec<String> = parts
        .map(|(power, symbol)| match power {
            1 => symbol.to_owned(),
            power => format!("{symbol}^{power}"),
        })
        .collect();
    format!("a quantity in {}", symbols.join(" "))
}

/// The longest unit at the beginning of `text`, written without spaces: its length in bytes, the unit, its powers.
pub fn leading_unit(text: &str) -> Option<(usize, Unit, Powers)> {
    let is_part = |character: char| {
        character.is_alphanumeric() || matches!(character, '/' | '^' | '°' | '·' | '²' | '³')
    };
    let lexeme = text.split(|character| !is_part(character)).next()?;
    let is_word =
        |character: char| is_part(character) && !matches!(character, '/' | '^') || character == '_';
    let ends = lexeme
        .char_indices()
        .map(|(at, character)| at + character.len_utf8());
    let ends = ends
        .filter(|end| !text[*end..].starts_with(is_word))
        .collect::<Vec<_>>();
    ends.into_iter().rev().find_map(|end| {
        let symbol = normalised(&text[..end]);
        let dimensions = DIMENSIONS.iter().zip(POWERS);
        let mut units = dimensions
            .flat_map(|((_, units), (_, powers))| units.iter().map(|unit| (*unit, *powers)));
        let (unit, powers) = units.find(|(unit, _)| unit.symbol == symbol)?;
        Some((end, unit, powers))
    })
}

/// Whether a name is in the denominator of some unit, so that `1 m/s` would be read as a unit.
pub fn is_denominator(name: &str) -> bool {
    let mut units = DIMENSIONS.iter().flat_map(|(_, units)| units.iter());
    units.any(|unit| {
        let below = unit.symbol.split_once('/').map(|(_, below)| below);
        below.is_some_and(|below| below.split('^').next() == Some(name))
    })
}

/// Converts a number with a unit, such as `"1.6 mm"`, to SI units.
///
/// # Errors
/// A message with the fault and the allowed units.
pub fn parse<D: Dimension>(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (number, unit) = text.split_at(number_length(text));
    let unit = normalised(unit);
    if number.parse::<f64>().is_err() {
        return Err(format!(
            "{text:?} does not begin with a number; {}",
            allowed::<D>()
        ));
    }
    if unit.is_empty() {
        return Err(format!(
            "{text:?} has no unit; write it without quotes for SI units, or {}",
            allowed::<D>()
        ));
    }
    if let Some(unit) = D::UNITS.iter().find(|known| known.symbol == unit) {
        return Ok(scaled(number, unit.size));
    }
    let other = DIMENSIONS
        .iter()
        .find(|(_, units)| units.iter().any(|known| known.symbol == unit));
    Err(match other {
        Some((name, _)) => format!(
            "{text:?} is {name}, but this key takes {}; {}",
            D::NAME,
            allowed::<D>()
        ),
        None => format!("{text:?} has an unknown unit; {}", allowed::<D>()),
    })
}

/// Reads a time outside of scenario files: a number of seconds, or text with a unit.
///
/// # Errors
/// A message with the fault and the allowed units.
pub fn seconds(text: &str) -> Result<f64, String> {
    text.trim().parse().or_else(|_| parse::<Time>(text))
}

/// Reads a length outside of scenario files: a number of metres, or text with a unit.
///
/// # Errors
/// A message with the fault and the allowed units.
pub fn metres(text: &str) -> Result<f64, String> {
    text.trim().parse().or_else(|_| parse::<Length>(text))
}

/// Reads an angle outside of scenario files, in radians: text with a unit, or a number of degrees.
///
/// # Errors
/// A message with the fault and the allowed units.
pub fn angle(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse::<f64>();
    degrees
        .map(f64::to_radians)
        .or_else(|_| parse::<Angle>(text))
}

/// The number in front of a unit, and the unit.
///
/// # Errors
/// A message, if `text` does not begin with a number.
pub fn split_number(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim();
    let (number, unit) = text.split_at(number_length(text));
    let number = number
        .parse()
        .map_err(|_| format!("{text:?} does not begin with a number"))?;
    Ok((number, unit.trim()))
}

/// Converts a number with any supported unit to SI units; a symbol means the same wherever it is allowed.
pub fn parse_any(text: &str) -> Option<f64> {
    let text = text.trim();
    let (number, unit) = text.split_at(number_length(text));
    number.parse::<f64>().ok()?;
    let unit = normalised(unit);
    let mut units = DIMENSIONS.iter().flat_map(|(_, units)| units.iter());
    units
        .find(|known| known.symbol == unit)
        .map(|known| scaled(number, known.size))
}

/// The sentence that lists the units of a dimension.
pub fn allowed<D: Dimension>() -> String {
    if D::UNITS.is_empty() {
        return "this key takes a pure number".to_owned();
    }
    let symbols: Vec<&str> = D::UNITS.iter().map(|unit| unit.symbol).collect();
    format!("allowed units: {}", symbols.join(", "))
}

/// Length of the decimal number at the beginning of `text`, in bytes.
pub fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        from + bytes[from..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit() || **byte == b'.')
            .count()
    };
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let mantissa = digits(sign);
    if !matches!(bytes.get(mantissa), Some(b'e' | b'E')) {
        return mantissa;
    }
    let sign = usize::from(matches!(bytes.get(mantissa + 1), Some(b'+' | b'-')));
    let exponent = digits(mantissa + 1 + sign);
    if exponent > mantissa + 1 + sign {
        exponent
    } else {
        mantissa
    }
}

/// A unit symbol without spaces and product signs, with `^` for powers.
fn normalised(unit: &str) -> String {
    unit.chars()
        .filter(|character| !character.is_whitespace() && !matches!(character, '*' | '·'))
        .flat_map(|character| match character {
            '²' => vec!['^', '2'],
            '³' => vec!['^', '3'],
            'μ' => vec!['µ'], // Greek letter to micro sign
            other => vec![other],
        })
        .collect()
}

/// The product of a typed number and the size of its unit.
pub fn scaled(number: &str, size: Size) -> f64 {
    let parsed = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    match size {
        Size::Factor(factor) => parsed(number) * factor,
        Size::Decimal(shift) => match number.split_once(['e', 'E']) {
            None => parsed(&format!("{number}e{shift}")),
            Some((mantissa, exponent)) => match exponent.parse::<i32>() {
                Ok(exponent) => parsed(&format!("{mantissa}e{}", exponent.saturating_add(shift))),
                Err(_) => f64::NAN,
            },
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn decimal_units_are_exact() {
        assert_eq!(parse::<Length>("1.6 mm"), Ok(1.6e-3));
        assert_eq!(parse::<Length>("1.6e1mm"), Ok(1.6e-2));
        assert_eq!(parse::<Length>("-7 µm"), Ok(-7e-6));
        // The Greek letter looks the same as the micro sign.
        assert_eq!(parse::<Length>("-7 \u{3bc}m"), Ok(-7e-6));
        assert_eq!(parse::<Pressure>("0.18 MPa"), Ok(0.18e6));
        assert_eq!(parse::<Density>("1.18 g/cm³"), Ok(1180.0));
        assert_eq!(parse::<Moment>("3 mN·m"), Ok(3e-3));
        assert_eq!(parse::<Viscosity>("0.1 Pa s"), Ok(0.1));
        assert_eq!(parse::<Viscosity>("2 kPa s"), Ok(2e3));
    }

    #[test]
    fn other_units_are_converted() {
        assert_eq!(parse::<Time>("2 min"), Ok(120.0));
        assert_eq!(parse::<Angle>("90 deg"), Ok(90.0 * DEGREE));
        assert_eq!(parse::<AngularVelocity>("15 rpm"), Ok(15.0 * (TURN / 60.0)));
        assert_eq!(parse::<Acceleration>("9.81 m/s²"), Ok(9.81));
    }

    #[test]
    fn wrong_dimensions_are_named() {
        insta::assert_snapshot!(parse::<Pressure>("1.6 mm").unwrap_err(), @r#""1.6 mm" is a length, but this key takes a pressure; allowed units: Pa, kPa, MPa, GPa, N/m^2, N/mm^2"#);
        insta::assert_snapshot!(parse::<Density>("3 furlongs").unwrap_err(), @r#""3 furlongs" has an unknown unit; allowed units: kg/m^3, g/cm^3"#);
        insta::assert_snapshot!(parse::<Density>("3").unwrap_err(), @r#""3" has no unit; write it without quotes for SI units, or allowed units: kg/m^3, g/cm^3"#);
        insta::assert_snapshot!(parse::<Density>("mm").unwrap_err(), @r#""mm" does not begin with a number; allowed units: kg/m^3, g/cm^3"#);
        insta::assert_snapshot!(parse::<Dimensionless>("3 mm").unwrap_err(), @r#""3 mm" is a length, but this key takes a pure number; this key takes a pure number"#);
    }

    #[test]
    fn a_symbol_means_the_same_in_every_dimension() {
        let units = || DIMENSIONS.iter().flat_map(|(_, units)| units.iter());
        for unit in units() {
            let same = units().filter(|other| other.symbol == unit.symbol);
            assert!(
                same.into_iter().all(|other| other.size == unit.size),
                "{unit:?}"
            );
        }
        assert_eq!(parse_any("1.6 mm"), Some(1.6e-3));
        assert_eq!(parse_any("15 rpm"), Some(15.0 * (TURN / 60.0)));
        assert_eq!(parse_any("imc"), None);
        assert_eq!(split_number("-1.5e-3 N m"), Ok((-1.5e-3, "N m")));
    }

    #[test]
    fn powers_agree_with_the_symbols_of_units() {
        assert_eq!(with_article("force"), Some(("a force", [1, -2, 1])));
        let rigidity = Some(("a bending stiffness", [3, -2, 1]));
        assert_eq!(with_article("bending stiffness"), rigidity);
        assert_eq!(with_article("place"), None);
        assert_eq!(dimension_of([0, 0, 0]), "a pure number");
        assert_eq!(dimension_of([2, -1, 0]), "a quantity in m^2 s^-1");
        // Dimensions that share a unit, such as "1/m" or "Pas", have the same powers.
        let powers = |name: &str| POWERS.iter().find(|(known, _)| *known == name).unwrap().1;
        for (name, units) in DIMENSIONS {
            for (other, others) in DIMENSIONS {
                if units.iter().any(|unit| others.contains(unit)) {
                    assert_eq!(powers(name), powers(other), "{name} and {other}");
                }
            }
        }
    }

    #[test]
    fn every_dimension_has_its_si_unit_first() {
        for (name, units) in DIMENSIONS.iter().filter(|(_, units)| !units.is_empty()) {
            assert_eq!(units[0].size, Size::Decimal(0), "{name}");
        }
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in ".*") {
            let _ = parse::<Length>(&text);
        }

        #[test]
        fn metres_read_as_the_number_itself(number in proptest::num::f64::NORMAL) {
            prop_assert_eq!(parse::<Length>(&format!("{number:e} m")), Ok(number));
        }
    }
}
