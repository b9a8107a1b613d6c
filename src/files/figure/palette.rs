//! Colours that colour-blind readers can distinguish.

/// A colour: red, green, blue from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Color(pub [f64; 3]);

/// The palette of Okabe and Ito (2008), with a grey instead of its black, which is used for axes,
/// and without its yellow, which is pale on white.
const OKABE_ITO: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [110, 110, 110],
];

/// Colours from low to high values, each lighter than the one before: viridis (van der Walt and Smith 2015) at equal steps.
const SEQUENCE: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

impl Color {
    pub const WHITE: Self = Self([1.0; 3]);
    pub const BLACK: Self = Self([0.0; 3]);

    /// Colour number `index`; they repeat after seven.
    pub fn of(index: usize) -> Self {
        Self(OKABE_ITO[index % OKABE_ITO.len()].map(|channel| f64::from(channel) / 255.0))
    }

    /// The colour of a value at a fraction (0 to 1) from the lowest to the highest.
    pub fn of_part(part: f64) -> Self {
        let steps = (SEQUENCE.len() - 1) as f64;
        let place = part.clamp(0.0, 1.0) * steps;
        let below = place.floor().min(steps - 1.0);
        let [low, high] = [0, 1].map(|step| {
            Self(SEQUENCE[below as usize + step].map(|channel| f64::from(channel) / 255.0))
        });
        low.towards(high, place - below)
    }

    /// The colour at a fraction (0 to 1) towards another.
    pub fn towards(self, other: Self, part: f64) -> Self {
        let mix = |channel: usize| self.0[channel] + part * (other.0[channel] - self.0[channel]);
        Self([mix(0), mix(1), mix(2)])
    }

    /// Red, green, blue from 0 to 255.
    pub fn bytes(self) -> [u8; 3] {
        self.0
            .map(|channel| (255.0 * channel.clamp(0.0, 1.0)).round() as u8)
    }

    /// The colour in SVG notation.
    pub fn hex(self) -> String {
        let [red, green, blue] = self.bytes();
        format!("#{red:02x}{green:02x}{blue:02x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_in_the_palette_differ_and_mixing_reaches_both_ends() {
        for index in 0..OKABE_ITO.len() {
            assert_ne!(Color::of(index), Color::of(index + 1));
        }
        assert_eq!(Color::of(0).hex(), "#0072b2");
        let ends = [-1.0, 0.0, 0.5, 1.0, 2.0].map(|part| Color::of_part(part).hex());
        assert_eq!(
            ends,
            ["#440154", "#440154", "#21918c", "#fde725", "#fde725"]
        );
        assert_eq!(Color::of(1).towards(Color::WHITE, 0.0), Color::of(1));
        assert_eq!(Color::of(1).towards(Color::WHITE, 1.0).hex(), "#ffffff");
    }
}
