//! A snake that crawls on a plane by a travelling wave of its curvature (Hu, Nirody, Scott and
//! Shelley 2009, PNAS 106, 10081).
//!
//! The body is an inextensible curve of the length L and of uniform mass whose signed curvature is
//! prescribed,
//!
//! κ(s, t) = K sin(ks − ωt),   θ̂(s, t) = ∫₀ˢ κ ds = (K/k)(cos ωt − cos(ks − ωt)),
//!
//! with the angle θ̂ of its tangent in a frame that turns with its start. In this frame, with the
//! centre of mass at the origin, its points are at x̂(s, t) and move with ∂x̂/∂t. The frame has the
//! position X and the angle ϑ, so that a point moves with u = Ẋ + ϑ̇ ẑ × R x̂ + R ∂x̂/∂t. Each
//! length bears its own weight, and its friction per mass is
//!
//! a = −g [μ_f H(û·s) + μ_b (1 − H(û·s))] (û·s) s − g μ_n (û·n) n,   û = u/‖u‖.
//!
//! With the mean ⟨·⟩ over the body, momentum and angular momentum per mass, P = Ẋ and
//! h = ⟨x × u⟩ = ϑ̇ ⟨x²⟩ + ⟨x̂ × ∂x̂/∂t⟩, obey
//!
//! Ṗ = ⟨a⟩,   ḣ = ⟨x × a⟩.
//!
//! These six equations are integrated by the rule of Runge and Kutta of fourth order.

use std::f64::consts::TAU;

/// Pieces of the body.
const PIECES: usize = 200;
/// Steps of a period.
const STEPS: usize = 1000;

/// A snake and its wave.
#[derive(Clone, Copy, Debug)]
pub struct Crawler {
    /// L, m.
    pub length: f64,
    /// K, 1/m.
    pub curvature: f64,
    /// Length of the wave 2π/k, m.
    pub wavelength: f64,
    /// Frequency ω/2π, Hz; negative for a wave towards the start of the body.
    pub frequency: f64,
    /// g, m/s².
    pub gravity: f64,
    /// μ_f, μ_b and μ_n.
    pub friction: [f64; 3],
}

/// Position, angle ϑ, momentum and angular momentum, per mass.
type State = [f64; 6];

/// The middle of a piece: its tangent, its position relative to the centre of mass (m), and its
/// velocity (m/s) in the frame that turns with the start.
#[derive(Clone, Copy, Default)]
struct Piece {
    tangent: [f64; 2],
    place: [f64; 2],
    velocity: [f64; 2],
}

impl Crawler {
    /// Distance over which the centre of mass moves in a period, over the period, m/s; after a
    /// number of periods that begin at rest.
    pub fn speed(&self, periods: usize) -> f64 {
        let step = 1.0 / (self.frequency.abs() * STEPS as f64);
        let mut state = State::default();
        let mut before = state;
        for index in 0..periods * STEPS {
            if index + STEPS == periods * STEPS {
                before = state;
            }
            state = self.advance(index as f64 * step, step, &state);
        }
        libm::hypot(state[0] - before[0], state[1] - before[1]) * self.frequency.abs()
    }

    fn advance(&self, time: f64, step: f64, state: &State) -> State {
        let moved = |rates: &State, by: f64| std::array::from_fn(|k| state[k] + by * rates[k]);
        let first = self.rates(time, state);
        let second = self.rates(time + 0.5 * step, &moved(&first, 0.5 * step));
        let third = self.rates(time + 0.5 * step, &moved(&second, 0.5 * step));
        let fourth = self.rates(time + step, &moved(&third, step));
        let mean =
            std::array::from_fn(|k| (first[k] + 2.0 * (second[k] + third[k]) + fourth[k]) / 6.0);
        moved(&mean, step)
    }

    fn rates(&self, time: f64, state: &State) -> State {
        let [_, _, angle, p_x, p_y, h] = *state;
        let pieces = self.pieces(time);
        let of_shape = pieces.iter().map(|one| cross(one.place, one.velocity));
        let inertia = pieces.iter().map(|one| dot(one.place, one.place));
        let inertia = inertia.sum::<f64>() / PIECES as f64;
        let spin = (h - of_shape.sum::<f64>() / PIECES as f64) / inertia;
        let (sine, cosine) = libm::sincos(angle);
        let turned = |[x, y]: [f64; 2]| [cosine * x - sine * y, sine * x + cosine * y];
        let (mut force, mut moment) = ([0.0; 2], 0.0);
        for piece in &pieces {
            let (place, velocity) = (turned(piece.place), turned(piece.velocity));
            let own = self.friction_per_mass(
                turned(piece.tangent),
                [
                    p_x + velocity[0] - spin * place[1],
                    p_y + velocity[1] + spin * place[0],
                ],
            );
            force = [force[0] + own[0], force[1] + own[1]];
            moment += cross(place, own);
        }
        let mean = |sum: f64| sum / PIECES as f64;
        [p_x, p_y, spin, mean(force[0]), mean(force[1]), mean(moment)]
    }

    /// a, m/s², for a tangent and a velocity (m/s).
    fn friction_per_mass(&self, tangent: [f64; 2], velocity: [f64; 2]) -> [f64; 2] {
        let speed = libm::hypot(velocity[0], velocity[1]);
        if speed == 0.0 {
            return [0.0; 2];
        }
        let [forwards, backwards, sideways] = self.friction;
        let along = dot(velocity, tangent) / speed;
        let across = cross(tangent, velocity) / speed;
        let own = if along > 0.0 { forwards } else { backwards };
        let (along, across) = (self.gravity * own * along, self.gravity * sideways * across);
        [
            across * tangent[1] - along * tangent[0],
            -across * tangent[0] - along * tangent[1],
        ]
    }

    /// The body in the frame that turns with its start.
    fn pieces(&self, time: f64) -> [Piece; PIECES] {
        let (k, omega) = (TAU / self.wavelength, TAU * self.frequency);
        let length = self.length / PIECES as f64;
        let (sine, cosine) = libm::sincos(omega * time);
        let mut pieces = [Piece::default(); PIECES];
        let mut end = Piece::default();
        let mut centre = Piece::default();
        for (index, piece) in pieces.iter_mut().enumerate() {
            let (wave, quarter) = libm::sincos(k * (index as f64 + 0.5) * length - omega * time);
            let angle = self.curvature / k * (cosine - quarter);
            let rate = -self.curvature / k * omega * (sine + wave);
            let (t_y, t_x) = libm::sincos(angle);
            piece.tangent = [t_x, t_y];
            let half = [0.5 * length * t_x, 0.5 * length * t_y];
            let turning = [-half[1] * rate, half[0] * rate];
            piece.place = [end.place[0] + half[0], end.place[1] + half[1]];
            piece.velocity = [end.velocity[0] + turning[0], end.velocity[1] + turning[1]];
            for axis in 0..2 {
                end.place[axis] += 2.0 * half[axis];
                end.velocity[axis] += 2.0 * turning[axis];
                centre.place[axis] += piece.place[axis] / PIECES as f64;
                centre.velocity[axis] += piece.velocity[axis] / PIECES as f64;
            }
        }
        for piece in &mut pieces {
            for axis in 0..2 {
                piece.place[axis] -= centre.place[axis];
                piece.velocity[axis] -= centre.velocity[axis];
            }
        }
        pieces
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SNAKE: Crawler = Crawler {
        length: 1.0,
        curvature: 7.0,
        wavelength: 1.0,
        frequency: -1.0,
        gravity: 9.81,
        friction: [0.1, 0.15, 0.3],
    };

    /// A body that cannot slip sideways follows its own track: in a period it advances by the
    /// chord of a wave, λ J₀(K/k).
    #[test]
    fn a_body_that_cannot_slip_sideways_advances_by_a_chord_per_period() {
        let snake = Crawler {
            friction: [1e-2, 1e-2, 100.0],
            ..SNAKE
        };
        let found = snake.speed(4);
        let expected = libm::j0(snake.curvature * snake.wavelength / TAU);
        println!("{found} {expected}");
        assert!((found / expected - 1.0).abs() < 2e-3);
    }

    /// Seen from its other end, a body has a wave in the other direction, and forwards is
    /// backwards.
    #[test]
    fn both_ends_are_equal() {
        let turned = Crawler {
            frequency: -SNAKE.frequency,
            friction: [0.15, 0.1, 0.3],
            ..SNAKE
        };
        let (one, other) = (SNAKE.speed(2), turned.speed(2));
        assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
    }
}
