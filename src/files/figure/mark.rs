//! Marks of points on curves.

use super::drawing::number;

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Disc,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
    Star,
    Pentagon,
    Plus,
}

impl Mark {
    pub const ALL: [Self; 8] = [
        Self::Disc,
        Self::Square,
        Self::Triangle,
        Self::Diamond,
        Self::TriangleDown,
        Self::Star,
        Self::Pentagon,
        Self::Plus,
    ];

    /// Path data of the mark around a point; all shapes have approximately the area of a disc of
    /// the given radius.
    pub fn path(self, [x, y]: [f64; 2], radius: f64) -> String {
        let polygon = |corners: &[(f64, f64)]| {
            let corner = |(index, (turn, distance)): (usize, &(f64, f64))| {
                // Angles are clockwise from above, in fractions of a turn.
                let (sine, cosine) = libm::sincos(std::f64::consts::TAU * turn);
                let command = if index == 0 { 'M' } else { 'L' };
                let [x, y] =
                    [x + radius * distance * sine, y - radius * distance * cosine].map(number);
                format!("{command}{x} {y}")
            };
            corners.iter().enumerate().map(corner).collect::<String>() + "Z"
        };
        let regular = |count: usize, from: f64, size: f64| {
            let corner = |k: usize| (from + k as f64 / count as f64, size);
            polygon(&(0..count).map(corner).collect::<Vec<_>>())
        };
        match self {
            Self::Disc => {
                let (left, r) = (number(x - radius), number(radius));
                let (y, d) = (number(y), number(2.0 * radius));
                format!("M{left} {y}a{r} {r} 0 1 1 {d} 0a{r} {r} 0 1 1 -{d} 0Z")
            }
            Self::Square => regular(4, 0.125, 1.25),
            Self::Diamond => regular(4, 0.0, 1.3),
            Self::Triangle => regular(3, 0.0, 1.45),
            Self::TriangleDown => regular(3, 0.5, 1.45),
            Self::Pentagon => regular(5, 0.0, 1.2),
            Self::Star => {
                let corner =
                    |k: usize| (0.1 * k as f64, if k.is_multiple_of(2) { 1.6 } else { 0.65 });
                polygon(&(0..10).map(corner).collect::<Vec<_>>())
            }
            Self::Plus => {
                let (long, short) = (1.3, 0.42);
                let [reach, inner] = [libm::hypot(long, short), libm::hypot(short, short)];
                let turn = libm::atan(short / long) / std::f64::consts::TAU;
                let arm = |k: usize| {
                    let middle = 0.25 * k as f64;
                    [
                        (middle - turn, reach),
                        (middle + turn, reach),
                        (middle + 0.125, inner),
                    ]
                };
                polygon(&(0..4).flat_map(arm).collect::<Vec<_>>())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_stand_about_their_point() {
        for mark in Mark::ALL {
            let path = mark.path([50.0, 20.0], 3.0);
            assert!(path.starts_with('M') && path.ends_with('Z') && !path.contains("NaN"));
        }
        assert_eq!(
            Mark::Square.path([0.0, 0.0], 1.6),
            "M1.41 -1.41L1.41 1.41L-1.41 1.41L-1.41 -1.41Z"
        );
    }
}
