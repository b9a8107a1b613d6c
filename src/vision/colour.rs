//! Colour rules for rods, their presets, and conversions between colour spaces.

use super::VisionError;
use std::sync::LazyLock;

/// A rule that selects the pixels of a rod.
#[derive(Clone, Debug, PartialEq)]
pub enum ColourRule {
    /// All colours that differ from the most common colour of the image.
    Background,
    /// A box in hue, saturation and value.
    Hsv(HsvBox),
    /// A ball in CIE L\*a\*b\*.
    Lab(LabBall),
    /// A ball around the colour of a pixel of the image.
    Pick {
        /// The pixel, from the left.
        u: u32,
        /// The pixel, from the top.
        v: u32,
        /// Largest colour difference ΔE (CIE 1976).
        radius: f64,
    },
    /// Pixels darker than the mean of their surroundings, such as pen on paper in uneven light.
    Pen {
        /// Difference in brightness, out of 255.
        offset: u8,
    },
    /// Pixels lighter than the mean of their surroundings.
    Lighter {
        /// Difference in brightness, out of 255.
        offset: u8,
    },
    /// All colours that differ from the background and from its shades, such as shadows on a table
    /// and the grain of wood.
    Tint,
    /// Lighter or darker than the surroundings, with the parts between: a white rod on white.
    Relief,
}

/// A box in hue, saturation and value. The hue is cyclic: a range with a lower end above the upper
/// one passes through 0°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HsvBox {
    /// Hue, degrees, 0 to 360.
    pub hue: [f64; 2],
    /// Saturation, 0 to 1.
    pub saturation: [f64; 2],
    /// Value, 0 to 1.
    pub value: [f64; 2],
}

/// All colours within a colour difference ΔE (CIE 1976, the distance in L\*a\*b\*) of a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabBall {
    /// L\*, a\*, b\* of the centre.
    pub centre: [f64; 3],
    /// Largest colour difference.
    pub radius: f64,
}

/// Default radius of colour samples: roughly the range of colours with a common name.
const SAMPLE_RADIUS: f64 = 30.0;
/// Default difference in brightness of a pen stroke from its surroundings.
const PEN_OFFSET: u8 = 20;

/// Names of hue ranges, degrees.
const HUES: [(&str, [f64; 2]); 8] = [
    ("red", [330.0, 20.0]),
    ("orange", [15.0, 42.0]),
    ("yellow", [42.0, 70.0]),
    ("green", [70.0, 165.0]),
    ("cyan", [165.0, 200.0]),
    ("blue", [200.0, 260.0]),
    ("purple", [260.0, 300.0]),
    ("pink", [300.0, 345.0]),
];

impl ColourRule {
    /// Parses a rule.
    ///
    /// `auto`, `tint`, `relief`, `pen` or `darker`, `lighter`, each of these three also with
    /// `:OFFSET`, `black`, `white`, a hue (`red`, `orange`, `yellow`, `green`, `cyan`, `blue`,
    /// `purple`, `pink`), `#rrggbb`, `#rrggbb:RADIUS`, `pick:U,V`, `pick:U,V:RADIUS` or `hsv:H-H,S-S,V-V` with
    /// degrees and per cent.
    ///
    /// # Errors
    /// [`VisionError::Colour`] with the allowed forms.
    pub fn parse(text: &str) -> Result<Self, VisionError> {
        let fault = |reason: &str| VisionError::Colour {
            text: text.into(),
            reason: reason.into(),
        };
        let hsv = |hue, saturation, value| {
            Self::Hsv(HsvBox {
                hue,
                saturation,
                value,
            })
        };
        if let Some((_, hue)) = HUES.iter().find(|(name, _)| *name == text) {
            return Ok(hsv(*hue, [0.25, 1.0], [0.2, 1.0]));
        }
        match text {
            "auto" => return Ok(Self::Background),
            "tint" => return Ok(Self::Tint),
            "relief" => return Ok(Self::Relief),
            "pen" | "darker" => return Ok(Self::Pen { offset: PEN_OFFSET }),
            "lighter" => return Ok(Self::Lighter { offset: PEN_OFFSET }),
            "black" => return Ok(hsv([0.0, 360.0], [0.0, 1.0], [0.0, 0.25])),
            "white" => return Ok(hsv([0.0, 360.0], [0.0, 0.25], [0.75, 1.0])),
            _ => {}
        }
        if let Some((name @ ("pen" | "darker" | "lighter"), offset)) = text.split_once(':') {
            let offset = offset.parse().ok().filter(|offset| *offset > 0);
            let offset = offset.ok_or_else(|| fault("the offset is a whole number, 1 to 255"))?;
            return Ok(match name {
                "lighter" => Self::Lighter { offset },
                _ => Self::Pen { offset },
            });
        }
        if let Some(sample) = text.strip_prefix('#') {
            let (digits, radius) = sample.split_once(':').unwrap_or((sample, ""));
            let colour = u32::from_str_radix(digits, 16)
                .ok()
                .filter(|_| digits.len() == 6 && !digits.starts_with('+'))
                .ok_or_else(|| fault("a colour is # and six hexadecimal digits, as in #c83c46"))?;
            let [_, red, green, blue] = colour.to_be_bytes();
            let radius = parse_radius(radius).ok_or_else(|| fault(RADIUS))?;
            return Ok(Self::Lab(LabBall {
                centre: lab([red, green, blue]),
                radius,
            }));
        }
        if let Some(sample) = text.strip_prefix("pick:") {
            let (pixel, radius) = sample.split_once(':').unwrap_or((sample, ""));
            let pixel = pixel.split_once(',');
            let pixel = pixel
                .and_then(|(u, v)| Some((u.trim().parse().ok()?, v.trim().parse().ok()?)))
                .ok_or_else(|| fault("a pixel is two whole numbers, as in pick:320,240"))?;
            let radius = parse_radius(radius).ok_or_else(|| fault(RADIUS))?;
            return Ok(Self::Pick {
                u: pixel.0,
                v: pixel.1,
                radius,
            });
        }
        if let Some(ranges) = text.strip_prefix("hsv:") {
            return parse_hsv(ranges).ok_or_else(|| {
                fault(
                    "a box is three ranges: hue in degrees, saturation and value in per cent, \
                     as in hsv:340-20,40-100,30-100",
                )
            });
        }
        Err(fault(
            "expected auto, tint, relief, pen, darker, lighter, black, white, red, orange, yellow, green, cyan, blue, purple, pink, \
             #rrggbb[:radius], pick:u,v[:radius] or hsv:h-h,s-s,v-v",
        ))
    }
}

const RADIUS: &str = "the radius is a colour difference, above 0 and at most 200";

fn parse_radius(text: &str) -> Option<f64> {
    if text.is_empty() {
        return Some(SAMPLE_RADIUS);
    }
    let radius: f64 = text.trim().parse().ok()?;
    (radius > 0.0 && radius <= 200.0).then_some(radius)
}

fn parse_hsv(text: &str) -> Option<ColourRule> {
    let ranges: Vec<[f64; 2]> = text
        .split(',')
        .map(|range| {
            let (from, to) = range.split_once('-')?;
            Some([from.trim().parse().ok()?, to.trim().parse().ok()?])
        })
        .collect::<Option<_>>()?;
    let [hue, saturation, value] = ranges.try_into().ok()?;
    let within = |range: [f64; 2], most: f64| range.iter().all(|end| (0.0..=most).contains(end));
    let rises = |range: [f64; 2]| range[0] < range[1];
    let valid = within(hue, 360.0)
        && within(saturation, 100.0)
        && within(value, 100.0)
        && rises(saturation)
        && rises(value);
    valid.then_some(ColourRule::Hsv(HsvBox {
        hue,
        saturation: saturation.map(|end| end / 100.0),
        value: value.map(|end| end / 100.0),
    }))
}

impl HsvBox {
    /// Whether a colour lies in the box.
    pub fn contains(&self, rgb: [u8; 3]) -> bool {
        let [hue, saturation, value] = hsv(rgb);
        let within = |range: [f64; 2], x: f64| range[0] <= x && x <= range[1];
        if !within(self.saturation, saturation) || !within(self.value, value) {
            return false;
        }
        if self.hue[0] <= self.hue[1] {
            within(self.hue, hue)
        } else {
            hue >= self.hue[0] || hue <= self.hue[1]
        }
    }
}

/// Hue in degrees (0 for greys), saturation and value from 0 to 1.
pub fn hsv(rgb: [u8; 3]) -> [f64; 3] {
    let [red, green, blue] = rgb.map(|channel| f64::from(channel) / 255.0);
    let most = red.max(green).max(blue);
    let spread = most - red.min(green).min(blue);
    if spread == 0.0 {
        return [0.0, 0.0, most];
    }
    let sixth = if most == red {
        ((green - blue) / spread).rem_euclid(6.0)
    } else if most == green {
        (blue - red) / spread + 2.0
    } else {
        (red - green) / spread + 4.0
    };
    [60.0 * sixth, spread / most, most]
}

/// CIE L\*a\*b\* of an sRGB colour (IEC 61966-2-1), white point D65.
pub fn lab(rgb: [u8; 3]) -> [f64; 3] {
    static LINEAR: LazyLock<[f64; 256]> =
        LazyLock::new(|| std::array::from_fn(|channel| linear(channel as f64 / 255.0)));
    lab_of_linear(rgb.map(|channel| LINEAR[usize::from(channel)]))
}

/// Linear light of an sRGB channel, both from 0 to 1.
fn linear(channel: f64) -> f64 {
    if channel <= 0.040_45 {
        channel / 12.92
    } else {
        libm::pow((channel + 0.055) / 1.055, 2.4)
    }
}

fn lab_of_linear([red, green, blue]: [f64; 3]) -> [f64; 3] {
    let f = |t: f64| {
        const KNEE: f64 = 6.0 / 29.0;
        if t > KNEE * KNEE * KNEE {
            libm::cbrt(t)
        } else {
            t / (3.0 * KNEE * KNEE) + 4.0 / 29.0
        }
    };
    // XYZ relative to that of white.
    let x = f((0.412_456_4 * red + 0.357_576_1 * green + 0.180_437_5 * blue) / 0.950_47);
    let y = f(0.212_672_9 * red + 0.715_152_2 * green + 0.072_175_0 * blue);
    let z = f((0.019_333_9 * red + 0.119_192_0 * green + 0.950_304_1 * blue) / 1.088_83);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Colour difference ΔE (CIE 1976).
pub fn colour_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_agree_with_published_values() {
        let near = |found: [f64; 3], expected: [f64; 3], tolerance: f64| {
            assert!(
                colour_difference(found, expected) < tolerance,
                "{found:?} {expected:?}"
            );
        };
        // L*a*b* of the sRGB primaries, D65 (Lindbloom's tables).
        near(lab([255, 0, 0]), [53.24, 80.09, 67.20], 0.05);
        near(lab([0, 255, 0]), [87.73, -86.18, 83.18], 0.05);
        near(lab([0, 0, 255]), [32.30, 79.19, -107.86], 0.05);
        near(lab([255, 255, 255]), [100.0, 0.0, 0.0], 0.05);
        near(hsv([255, 0, 0]), [0.0, 1.0, 1.0], 1e-12);
        near(hsv([0, 128, 128]), [180.0, 1.0, 128.0 / 255.0], 1e-12);
        near(hsv([200, 100, 150]), [330.0, 0.5, 200.0 / 255.0], 1e-12);
    }

    #[test]
    fn rules_are_read_as_typed() {
        assert_eq!(
            ColourRule::parse("auto").expect("a rule"),
            ColourRule::Background
        );
        let ColourRule::Hsv(red) = ColourRule::parse("red").expect("a rule") else {
            panic!("red is a hue");
        };
        assert!(red.contains([200, 40, 60]) && red.contains([200, 60, 40]));
        assert!(!red.contains([40, 200, 60]) && !red.contains([200, 190, 190]));
        let ColourRule::Lab(ball) = ColourRule::parse("#c83c46:12").expect("a rule") else {
            panic!("a sample is a ball");
        };
        assert_eq!(ball.radius, 12.0);
        assert_eq!(
            ColourRule::parse("pick:3, 4").expect("a rule"),
            ColourRule::Pick {
                u: 3,
                v: 4,
                radius: SAMPLE_RADIUS
            }
        );
        assert!(matches!(
            ColourRule::parse("hsv:340-20,40-100,30-100").expect("a rule"),
            ColourRule::Hsv(_)
        ));
    }

    #[test]
    fn wrong_rules_are_rejected_with_the_allowed_forms() {
        for text in [
            "rad",
            "#12345",
            "#+12345",
            "pick:3",
            "pick:1,2:0",
            "hsv:0-20",
            "hsv:0-20,50-40,0-100",
            "pen:0",
            "pen:300",
            "lighter:0",
            "darker:x",
            "",
            "#ééé",
        ] {
            let error = ColourRule::parse(text).expect_err("a fault").to_string();
            assert!(error.contains(text), "{error}");
        }
    }
}
