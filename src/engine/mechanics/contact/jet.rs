//! Functions of a few variables to first or second order: value, gradient, second derivatives.

use std::array::from_fn;
use std::ops::{Add, Mul, Neg, Sub};

/// A number with its first and second derivatives with respect to N variables; the second are those
/// with respect to the first M variables: all of them, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jet<const N: usize, const M: usize> {
    /// The value.
    pub value: f64,
    /// First derivatives.
    pub slopes: [f64; N],
    /// Second derivatives.
    pub curvatures: [[f64; M]; M],
}

impl<const N: usize, const M: usize> Jet<N, M> {
    /// A constant.
    pub(crate) fn constant(value: f64) -> Self {
        Self {
            value,
            slopes: [0.0; N],
            curvatures: [[0.0; M]; M],
        }
    }

    /// One of the variables.
    pub(crate) fn variable(index: usize, value: f64) -> Self {
        let mut variable = Self::constant(value);
        variable.slopes[index] = 1.0;
        variable
    }

    /// f(x) for a function with this value and these first and second derivatives at x.
    fn through(self, value: f64, slope: f64, curvature: f64) -> Self {
        Self {
            value,
            slopes: self.slopes.map(|own| slope * own),
            curvatures: from_fn(|row| {
                from_fn(|column| {
                    slope * self.curvatures[row][column]
                        + curvature * self.slopes[row] * self.slopes[column]
                })
            }),
        }
    }

    /// 1/x.
    pub(crate) fn recip(self) -> Self {
        let inverse = 1.0 / self.value;
        let square = inverse * inverse;
        self.through(inverse, -square, 2.0 * square * inverse)
    }

    /// √x.
    pub(crate) fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let half = 0.5 / root;
        self.through(root, half, -half / (2.0 * self.value))
    }

    /// The product rule.
    fn times(&self, other: &Self) -> Self {
        Self {
            value: self.value * other.value,
            slopes: from_fn(|k| self.value * other.slopes[k] + other.value * self.slopes[k]),
            curvatures: from_fn(|k| {
                from_fn(|l| {
                    self.value * other.curvatures[k][l]
                        + other.value * self.curvatures[k][l]
                        + self.slopes[k] * other.slopes[l]
                        + self.slopes[l] * other.slopes[k]
                })
            }),
        }
    }

    /// x².
    pub(crate) fn square(self) -> Self {
        self.through(self.value * self.value, 2.0 * self.value, 2.0)
    }
}

impl<const M: usize> Jet<2, M> {
    /// a(s) + b(s) t + c(s) t² as a function of s and t.
    pub(crate) fn quadratic<const L: usize>([a, b, c]: [Jet<1, L>; 3], t: f64) -> Self {
        let along = a + b * t + c * (t * t);
        let mixed = b.slopes[0] + 2.0 * t * c.slopes[0];
        Self {
            value: along.value,
            slopes: [along.slopes[0], b.value + 2.0 * t * c.value],
            curvatures: from_fn(|k| {
                from_fn(|l| match k + l {
                    0 => along.curvatures[0][0],
                    1 => mixed,
                    _ => 2.0 * c.value,
                })
            }),
        }
    }

    /// The function at s(x, y) and at t, the third variable.
    pub(crate) fn at<const L: usize>(&self, s: &Jet<3, L>) -> Jet<3, L> {
        let [by_s, by_t] = self.slopes;
        let t = [0.0, 0.0, 1.0];
        Jet {
            value: self.value,
            slopes: from_fn(|k| by_s * s.slopes[k] + by_t * t[k]),
            curvatures: from_fn(|k| {
                from_fn(|l| {
                    let [[ss, st], [_, tt]] = [0, 1].map(|i| [0, 1].map(|j| self.curvatures[i][j]));
                    by_s * s.curvatures[k][l]
                        + ss * s.slopes[k] * s.slopes[l]
                        + st * (s.slopes[k] * t[l] + t[k] * s.slopes[l])
                        + tt * t[k] * t[l]
                })
            }),
        }
    }
}

impl<const N: usize, const M: usize> Add for Jet<N, M> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slopes: from_fn(|k| self.slopes[k] + other.slopes[k]),
            curvatures: from_fn(|k| from_fn(|l| self.curvatures[k][l] + other.curvatures[k][l])),
        }
    }
}

impl<const N: usize, const M: usize> Neg for Jet<N, M> {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl<const N: usize, const M: usize> Sub for Jet<N, M> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            slopes: from_fn(|k| self.slopes[k] - other.slopes[k]),
            curvatures: from_fn(|k| from_fn(|l| self.curvatures[k][l] - other.curvatures[k][l])),
        }
    }
}

impl<const N: usize, const M: usize> Add<f64> for Jet<N, M> {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        Self {
            value: self.value + other,
            ..self
        }
    }
}

impl<const N: usize, const M: usize> Mul<f64> for Jet<N, M> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            slopes: self.slopes.map(|own| own * factor),
            curvatures: self.curvatures.map(|row| row.map(|own| own * factor)),
        }
    }
}

impl<const N: usize, const M: usize> Mul for Jet<N, M> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.times(&other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function<const M: usize>([x, y, z]: [Jet<3, M>; 3]) -> Jet<3, M> {
        let root = (x.square() + y * z * 0.3 + 2.0).sqrt();
        (root - x * y.recip() * z + -z).square() + root * 0.7
    }

    /// A function of s and t, with s(x, y), evaluated in two stages.
    fn composed<const L: usize, const M: usize, const K: usize>(
        [x, y, z]: [Jet<3, K>; 3],
    ) -> Jet<3, K> {
        let place = x * y;
        let s = Jet::<1, L>::variable(0, place.value);
        let coefficients = [s.square() * 0.3, s.sqrt(), s.recip() + 2.0];
        let both: Jet<2, M> = Jet::quadratic(coefficients, z.value);
        both.square().at(&place)
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let to_second = [function::<3>, composed::<1, 2, 3>];
        let to_first = [function::<0>, composed::<0, 0, 0>];
        for (of, first) in to_second.into_iter().zip(to_first) {
            let at = |place: [f64; 3]| of(from_fn(|k| Jet::variable(k, place[k])));
            let place = [0.7, 1.3, -0.4];
            let found = at(place);
            let alone = first(from_fn(|k| Jet::variable(k, place[k])));
            assert_eq!((alone.value, alone.slopes), (found.value, found.slopes));
            let step = 1e-5;
            for column in 0..3 {
                let [after, before] = [step, -step].map(|offset| {
                    let mut moved = place;
                    moved[column] += offset;
                    at(moved)
                });
                let slope = (after.value - before.value) / (2.0 * step);
                assert!((found.slopes[column] - slope).abs() < 1e-8);
                for row in 0..3 {
                    let bend = (after.slopes[row] - before.slopes[row]) / (2.0 * step);
                    assert!((found.curvatures[row][column] - bend).abs() < 1e-8);
                }
            }
        }
    }
}
