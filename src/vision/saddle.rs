//! Saddles of the brightness, where four squares of a checkerboard meet, located to a hundredth of
//! a pixel.
//!
//! They are detected by second derivatives, refined to the point where the surrounding gradients
//! are orthogonal to the direction to the corner, and then fitted. The fit uses all pixels around
//! a saddle, while gradients use only those on edges.

use super::Point;
use image::RgbImage;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

/// A grey picture.
pub(super) struct Grey {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

impl Grey {
    pub fn new(picture: &RgbImage) -> Self {
        let value = |pixel: &image::Rgb<u8>| {
            0.299 * f64::from(pixel[0]) + 0.587 * f64::from(pixel[1]) + 0.114 * f64::from(pixel[2])
        };
        Self {
            width: picture.width() as usize,
            height: picture.height() as usize,
            values: picture.pixels().map(value).collect(),
        }
    }

    fn pixel(&self, column: i32, row: i32) -> f64 {
        let column = column.clamp(0, self.width as i32 - 1) as usize;
        let row = row.clamp(0, self.height as i32 - 1) as usize;
        self.values[row * self.width + column]
    }

    pub fn at(&self, point: Point) -> f64 {
        let (column, row) = (point.x.floor(), point.y.floor());
        let (s, t) = (point.x - column, point.y - row);
        let (column, row) = (column as i32, row as i32);
        (self.pixel(column, row) * (1.0 - s) + self.pixel(column + 1, row) * s) * (1.0 - t)
            + (self.pixel(column, row + 1) * (1.0 - s) + self.pixel(column + 1, row + 1) * s) * t
    }

    /// Saddles of the blurred brightness, the strongest first.
    pub fn saddles(&self) -> Vec<Point> {
        let mut blurred: Vec<u8> = self.values.iter().map(|value| *value as u8).collect();
        for _ in 0..4 {
            super::averages::blur(&mut blurred, self.width, self.height);
        }
        let value = |column: usize, row: usize| f64::from(blurred[row * self.width + column]);
        let mut strength = vec![0.0; self.values.len()];
        const REACH: usize = 2;
        for row in REACH..self.height.saturating_sub(REACH) {
            for column in REACH..self.width.saturating_sub(REACH) {
                let h = REACH;
                let middle = 2.0 * value(column, row);
                let xx = value(column + h, row) + value(column - h, row) - middle;
                let yy = value(column, row + h) + value(column, row - h) - middle;
                let xy = (value(column + h, row + h) + value(column - h, row - h)
                    - value(column + h, row - h)
                    - value(column - h, row + h))
                    / 4.0;
                strength[row * self.width + column] = (xy * xy - xx * yy).max(0.0);
            }
        }
        let strongest = strength.iter().copied().fold(0.0, f64::max);
        // In uneven light, the strengths of the corners of a board differ by a small factor; noise
        // on plain areas is weaker by a far larger one.
        let least = (0.08 * strongest).max(100.0);
        let mut found: Vec<(f64, Point)> = Vec::new();
        const NEAR: usize = 4;
        for row in NEAR..self.height.saturating_sub(NEAR) {
            for column in NEAR..self.width.saturating_sub(NEAR) {
                let here = strength[row * self.width + column];
                if here < least {
                    continue;
                }
                let is_peak = (row - NEAR..=row + NEAR).all(|r| {
                    (column - NEAR..=column + NEAR).all(|c| {
                        let other = strength[r * self.width + c];
                        other < here || (other == here && (r, c) >= (row, column))
                    })
                });
                let place = Point::new(column as f64, row as f64);
                if is_peak && self.alternates_around(place) {
                    found.push((here, place));
                }
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        const MOST: usize = 2000;
        found
            .into_iter()
            .take(MOST)
            .map(|(_, point)| point)
            .collect()
    }

    /// Whether a ring around a point is alternately dark, bright, dark and bright, unlike the ring
    /// around a corner of a single square.
    fn alternates_around(&self, point: Point) -> bool {
        const SAMPLES: usize = 24;
        const RADIUS: f64 = 4.5;
        let ring: Vec<f64> = (0..SAMPLES)
            .map(|index| {
                let (sine, cosine) =
                    libm::sincos(index as f64 * std::f64::consts::TAU / SAMPLES as f64);
                self.at(point + Point::new(cosine, sine) * RADIUS)
            })
            .collect();
        let (least, most) = ring.iter().fold((f64::INFINITY, 0.0f64), |(a, b), value| {
            (a.min(*value), b.max(*value))
        });
        let bright = |index: usize| ring[index % SAMPLES] > 0.5 * (least + most);
        let changes = (0..SAMPLES).filter(|index| bright(*index) != bright(index + 1));
        changes.count() == 4
    }

    /// Moves a corner to the centre of the saddle that best fits the pixels within `reach`. Keeps
    /// the position if no saddle fits.
    pub fn refine(&self, corner: Point, reach: i32) -> Point {
        let start = self.gradient_corner(corner, reach);
        let Some(mut saddle) = self.first_saddle(start, reach) else {
            return start;
        };
        let mut damping = 1e-3;
        let (mut matrix, mut right, mut sum) = self.normal_equations(&saddle, reach);
        for _ in 0..30 {
            let mut damped = matrix;
            for k in 0..UNKNOWNS {
                damped[(k, k)] *= 1.0 + damping;
            }
            let Some(step) = damped.cholesky().map(|factor| factor.solve(&right)) else {
                return start;
            };
            let moved = saddle.moved(&step);
            let (new_matrix, new_right, new_sum) = self.normal_equations(&moved, reach);
            if new_sum <= sum {
                let is_done = step.fixed_rows::<2>(0).norm() < 1e-5;
                (saddle, matrix, right, sum) = (moved, new_matrix, new_right, new_sum);
                damping *= 0.2;
                if is_done {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        // A fit that moves far has found another feature.
        if (saddle.centre - start).norm() < 0.5 {
            saddle.centre
        } else {
            start
        }
    }

    /// JᵀWJ, JᵀWr and rᵀWr of the pixels around a saddle, with the residual r.
    fn normal_equations(&self, saddle: &Saddle, reach: i32) -> (Normal, Unknowns, f64) {
        let (mut matrix, mut right, mut sum) = (Normal::zeros(), Unknowns::zeros(), 0.0);
        let (column, row) = (
            saddle.centre.x.round() as i32,
            saddle.centre.y.round() as i32,
        );
        let sigma = 0.6 * f64::from(reach);
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let pixel = Point::new(f64::from(column + dx), f64::from(row + dy));
                let away = (pixel - saddle.centre).norm_squared();
                let weight = libm::exp(-away / (2.0 * sigma * sigma));
                let (value, derivatives) = saddle.look(pixel);
                let residual = self.pixel(column + dx, row + dy) - value;
                matrix += derivatives * derivatives.transpose() * weight;
                right += derivatives * (residual * weight);
                sum += residual * residual * weight;
            }
        }
        (matrix, right, sum)
    }

    /// A saddle with the edge directions of its second derivatives.
    fn first_saddle(&self, centre: Point, reach: i32) -> Option<Saddle> {
        // Second derivatives by least squares: Σ I (x² − mean) and similar sums, each up to a
        // factor.
        let (mut xx, mut yy, mut xy, mut mean) = (0.0, 0.0, 0.0, 0.0);
        let square = (f64::from(reach) * (f64::from(reach) + 1.0)) / 3.0;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (x, y) = (f64::from(dx), f64::from(dy));
                let value = self.at(centre + Point::new(x, y));
                xx += value * (x * x - square);
                yy += value * (y * y - square);
                xy += value * x * y;
                mean += value;
                (least, most) = (least.min(value), most.max(value));
            }
        }
        mean /= f64::from((2 * reach + 1) * (2 * reach + 1));
        // Use the same norm for x² and y² as for x y.
        let spread = {
            let fourth = |x: f64| (x * x - square).powi(2);
            let row: f64 = (-reach..=reach).map(|x| fourth(f64::from(x))).sum();
            row * f64::from(2 * reach + 1)
        };
        let mixed = {
            let row: f64 = (-reach..=reach).map(|x| f64::from(x * x)).sum();
            row * row
        };
        let (a, b, c) = (2.0 * xx / spread, xy / mixed, 2.0 * yy / spread);
        // The edge directions satisfy a cos² + 2 b cos sin + c sin² = 0.
        let (middle, half) = (0.5 * (a + c), libm::hypot(0.5 * (a - c), b));
        if !(half > middle.abs()) {
            return None;
        }
        let axis = 0.5 * libm::atan2(b, 0.5 * (a - c));
        let away = 0.5 * libm::acos(-middle / half);
        let mut saddle = Saddle {
            centre,
            angles: [axis - away, axis + away],
            blur: 1.0,
            mean,
            height: 0.5 * (most - least),
        };
        // In bright quadrants, both signs agree.
        let along = Point::new(libm::cos(axis), libm::sin(axis)) * f64::from(reach);
        if (self.at(centre + along) > mean) != (saddle.look(centre + along).0 > mean) {
            saddle.height = -saddle.height;
        }
        Some(saddle)
    }

    /// Moves a corner to the point at which Σ w g gᵀ (corner − pixel) = 0 for the surrounding
    /// gradients g (Förstner and Gülch 1987).
    fn gradient_corner(&self, corner: Point, reach: i32) -> Point {
        let mut current = corner;
        for _ in 0..20 {
            let (mut matrix, mut right) = (Matrix2::zeros(), Vector2::zeros());
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let offset = Vector2::new(f64::from(dx), f64::from(dy));
                    let place = current + offset;
                    let gradient = Vector2::new(
                        self.at(place + Vector2::x()) - self.at(place - Vector2::x()),
                        self.at(place + Vector2::y()) - self.at(place - Vector2::y()),
                    );
                    let sigma = 0.6 * f64::from(reach);
                    let weight = libm::exp(-offset.norm_squared() / (2.0 * sigma * sigma));
                    let product = gradient * gradient.transpose() * weight;
                    matrix += product;
                    right += product * place;
                }
            }
            let Some(inverse) = matrix.try_inverse() else {
                return corner;
            };
            let moved = inverse * right;
            if (moved - corner).norm() > f64::from(reach) {
                return corner;
            }
            let done = (moved - current).norm() < 1e-4;
            current = moved;
            if done {
                break;
            }
        }
        current
    }
}

/// Number of unknowns of a saddle.
const UNKNOWNS: usize = 7;
type Unknowns = SVector<f64, UNKNOWNS>;
type Normal = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// A blurred corner of four squares: mean + height · erf(d₁/(√2 blur)) · erf(d₂/(√2 blur)) with the
/// distances d from two lines through the centre.
///
/// If the lines are not at right angles, this differs slightly from a Gaussian blur, but has the
/// same symmetry about the centre, which is sufficient here.
#[derive(Clone, Copy, Debug)]
struct Saddle {
    centre: Point,
    /// Directions of the lines, radians.
    angles: [f64; 2],
    /// Standard deviation of the blur, pixels.
    blur: f64,
    mean: f64,
    height: f64,
}

impl Saddle {
    /// Value at a pixel, and its derivatives with respect to centre, angles, blur, mean and
    /// height.
    fn look(&self, pixel: Point) -> (f64, Unknowns) {
        let way = pixel - self.centre;
        let scale = 1.0 / (std::f64::consts::SQRT_2 * self.blur);
        let edge = |angle: f64| {
            let (sine, cosine) = libm::sincos(angle);
            let normal = Point::new(-sine, cosine);
            let along = way.x * cosine + way.y * sine;
            let z = way.dot(&normal) * scale;
            let slope = std::f64::consts::FRAC_2_SQRT_PI * libm::exp(-z * z);
            // Derivatives with respect to centre and angle: d = n·way, ∂d/∂centre = −n, ∂d/∂angle
            // = −along.
            (
                libm::erf(z),
                -normal * (slope * scale),
                -along * slope * scale,
                -slope * z / self.blur,
            )
        };
        let [(e1, c1, a1, b1), (e2, c2, a2, b2)] = self.angles.map(edge);
        let by_centre = (c1 * e2 + c2 * e1) * self.height;
        let derivatives = Unknowns::from([
            by_centre.x,
            by_centre.y,
            self.height * a1 * e2,
            self.height * a2 * e1,
            self.height * (b1 * e2 + b2 * e1),
            1.0,
            e1 * e2,
        ]);
        (self.mean + self.height * e1 * e2, derivatives)
    }

    fn moved(&self, step: &Unknowns) -> Self {
        Self {
            centre: self.centre + Point::new(step[0], step[1]),
            angles: [self.angles[0] + step[2], self.angles[1] + step[3]],
            blur: (self.blur + step[4]).clamp(0.2, 10.0),
            mean: self.mean + step[5],
            height: self.height + step[6],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_saddle_agree_with_differences() {
        let saddle = Saddle {
            centre: Point::new(3.2, -1.1),
            angles: [0.3, 1.7],
            blur: 0.9,
            mean: 120.0,
            height: -80.0,
        };
        let pixel = Point::new(4.0, -0.5);
        let (_, derivatives) = saddle.look(pixel);
        for k in 0..UNKNOWNS {
            let mut step = Unknowns::zeros();
            step[k] = 1e-6;
            let (after, before) = (
                saddle.moved(&step).look(pixel).0,
                saddle.moved(&-step).look(pixel).0,
            );
            let difference = (after - before) / 2e-6;
            assert!(
                (derivatives[k] - difference).abs() < 1e-5,
                "{k}: {difference}"
            );
        }
    }

    #[test]
    fn a_saddle_is_found_to_a_hundredth_of_a_pixel_at_any_place_and_slant() {
        for index in 0..24 {
            let part = f64::from(index) / 24.0;
            let truth = Saddle {
                centre: Point::new(20.0 + part, 20.4 - 0.7 * part),
                angles: [0.2 + 3.0 * part, 1.4 + 3.3 * part],
                blur: 0.7 + 0.5 * part,
                mean: 125.0,
                height: 90.0,
            };
            let picture = RgbImage::from_fn(41, 41, |u, v| {
                let value = truth.look(Point::new(f64::from(u), f64::from(v))).0;
                image::Rgb([value.round() as u8; 3])
            });
            let found = Grey::new(&picture).refine(Point::new(20.6, 19.7), 7);
            assert!((found - truth.centre).norm() < 0.01, "{part}: {found}");
        }
    }
}
